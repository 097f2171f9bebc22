//! Files and examples below the help of commands.

use archrock::studies::StudyKind;

/// Returns the files that studies may write, and examples of their command.
pub fn of_studies(kinds: &[StudyKind], examples: &str) -> String {
    let files: Vec<&str> = kinds.iter().flat_map(|kind| kind.files).copied().collect();
    format!("Possible files: {}.\n\n{examples}", files.join(", "))
}

pub const INIT: &str = "\
Examples:
  archrock init arch arch.toml      an arch to begin with
  archrock init column | less       the same of a column, on standard output";

pub const RUN: &str = "\
Examples:
  archrock run arch.toml                                 results in results/arch
  archrock run arch.toml --hinges four,free              two models of motion, compared
  archrock run arch.toml --point 0,4.2 --snapshots 0.2,0.5
  archrock run arch.toml --set ground.rectangular.amplitude_g=-0.4 --out stronger
  archrock run arch.toml --format json | jq .outcome";

pub const FILM: &str = "\
Files: film.mp4, or film.gif without ffmpeg; with --out that file.

Examples:
  archrock film arch.toml                                 results/arch/film.mp4
  archrock film arch.toml --speed 0.25 --exaggerate 5 --out talk.gif
  archrock film arch.toml --size 720x720 --background f5f0e6 --caption 'Arch, 5 m' --out arch.webm";

pub const LIMIT: &str = "\
Files: that of --plot; with --out also limit.html, limit.svg, limit.json; of a vehicle also vehicle.svg, limit.csv.

Examples:
  archrock limit arch.toml
  archrock limit arch.toml --out limit
  archrock limit arch.toml --plot mechanism.svg
  archrock limit arch.toml --format json | jq .incipient_acceleration_g";

pub const IMPACT: &str = "\
Files: only those of --plot and --line.

Examples:
  archrock impact arch.toml --count 3       the first three links of the chain
  archrock impact arch.toml --models        restitution by all impact models";

pub const CAPACITY: &str = "\
Examples:
  archrock capacity arch.toml
  archrock capacity arch.toml --format json";

pub const SPREAD: &str = "\
Examples:
  archrock spread arch.toml
  archrock spread arch.toml --springing left --angle 45 --angle -90";

pub const VERIFY: &str = "\
Examples:
  archrock verify arch.toml --out check     verify.html is the page to file";

pub const MAP: &str = "\
Examples:
  archrock map arch.toml --threads 4
  archrock map arch.toml --resume      continues after Ctrl-C
  archrock map arch.toml --shard 1/3 --out part-1    and 2/3, 3/3 elsewhere; then archrock merge";

pub const SUITE: &str = "\
Examples:
  archrock suite arch.toml
  archrock suite arch.toml --hinges free --format json";

pub const THRESHOLD: &str = "\
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
