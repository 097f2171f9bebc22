//! Files and examples below the help of commands.

pub const INIT: &str = "\
Examples:
  archrock init arch arch.toml      an arch to begin with
  archrock init column | less       the same of a column, on standard output";

pub const RUN: &str = "\
Files: rotations.csv, events.csv, impacts.csv, history.svg, report.html, summary.json;
  joints.csv with free hinges or elastic joints; overlay.svg of several models;
  poses.csv and snapshots.svg on request.

Examples:
  archrock run arch.toml                                 results in results/arch
  archrock run arch.toml --hinges four,free              two models of motion, compared
  archrock run arch.toml --point 0,4.2 --snapshots 0.2,0.5
  archrock run arch.toml --set ground.rectangular.amplitude_g=-0.4 --out stronger
  archrock run arch.toml --format json | jq .outcome";

pub const LIMIT: &str = "\
Files: only that of --plot.

Examples:
  archrock limit arch.toml
  archrock limit arch.toml --plot mechanism.svg
  archrock limit arch.toml --format json | jq .incipient_acceleration_g";

pub const IMPACT: &str = "\
Files: only those of --plot and --line.

Examples:
  archrock impact arch.toml --count 3       the first three links of the chain
  archrock impact arch.toml --models        restitution by all impact models";

pub const CAPACITY: &str = "\
Files: capacity.csv, capacity.svg, capacity.json.

Examples:
  archrock capacity arch.toml
  archrock capacity arch.toml --format json";

pub const SPREAD: &str = "\
Files: spread.csv, spread.svg, spread.json.

Examples:
  archrock spread arch.toml
  archrock spread arch.toml --springing left --angle 45 --angle -90";

pub const VERIFY: &str = "\
Files: verify.html, verify.json.

Examples:
  archrock verify arch.toml --out check     verify.html is the page to file";

pub const MAP: &str = "\
Files: map.csv, map.svg, map.html, map.json.

Examples:
  archrock map arch.toml --threads 4
  archrock map arch.toml --resume      continues after Ctrl-C
  archrock map arch.toml --shard 1/3 --out part-1    and 2/3, 3/3 elsewhere; then archrock merge";

pub const SUITE: &str = "\
Files: suite.csv, suite.svg, fragility.csv, fragility.json, capacities.csv, intensity.csv,
  ida.csv, ida.svg, peaks.csv, peaks.svg.

Examples:
  archrock suite arch.toml
  archrock suite arch.toml --hinges free --format json";

pub const THRESHOLD: &str = "\
Files: threshold.csv, threshold.svg, threshold.json; with --along those of threshold_along.

Examples:
  archrock threshold arch.toml
  archrock threshold arch.toml --from 0.8 --to 1.5 --stride 0.005 --hinges four,free
  archrock threshold arch.toml --along arch.mean_radius_m=4..6:5";

pub const MERGE: &str = "\
Files: those of the study.

Examples:
  archrock merge part-*/map-*.part --out map";

pub const CHECK: &str = "\
Files: only that of --plot.

Examples:
  archrock check arch.toml                  the scenario with all defaults
  archrock check record.at2 --plot record.svg
  archrock check table.csv --set unit=cm/s2";

pub const COMPLETIONS: &str = "\
Examples:
  archrock completions bash > ~/.local/share/bash-completion/completions/archrock";
