//! The command `run`.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::{Event, Outcome, Sample, Summary};
use archrock::dynamics::model::{MechanismModel, Recorder};
use archrock::dynamics::thrust::{EXCESS_LEVELS, Peak, ThrustRecord};
use archrock::mechanics::four_link::mechanism::Sway;
use archrock::output::rotations::{RotationsWriter, Scales};
use archrock::output::timeline::Timeline;
use archrock::output::{Folder, OutputError, results};
use archrock::scenario::{Scenario, Structure};

use super::{Failure, commands, results_folder};

#[derive(clap::Args)]
pub struct Arguments {
    /// Scenario file (TOML).
    scenario: PathBuf,
    /// Folder for the results [default: results/<name of the scenario file>].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Where the rotations go instead of a file: `-` for standard output. No other results are then
    /// written unless --out is given.
    #[arg(long, value_name = "-", value_parser = ["-"])]
    rotations: Option<String>,
    /// Add dimensionless columns to the rotations: p_t (time), acceleration_over_incipient and
    /// rotation_over_critical.
    #[arg(long)]
    dimensionless: bool,
}

const ROTATIONS: &str = "rotations.csv";
const EVENTS: &str = "events.csv";
const PICTURE: &str = "history.svg";
const IMPACTS: &str = "impacts.csv";
/// Written last: a folder that has it is complete.
const SUMMARY: &str = "summary.json";

pub fn run(arguments: &Arguments, quiet: bool) -> Result<(), Failure> {
    let scenario = Scenario::read(&arguments.scenario)?;
    scenario.check_for_run().map_err(Failure::Input)?;
    let model = commands::model(&scenario)?;
    let ground = scenario.ground_motion();
    let gravity_m_s2 = scenario.simulation.gravity_m_s2;
    let scales = arguments
        .dimensionless
        .then(|| {
            Scales::new(&*model, gravity_m_s2).ok_or_else(|| {
                Failure::Input(
                    "the mechanism has no unstable equilibrium to measure by: leave --dimensionless out"
                        .to_owned(),
                )
            })
        })
        .transpose()?;
    let to_stdout = arguments.rotations.is_some();
    let path = (!to_stdout || arguments.out.is_some())
        .then(|| results_folder(arguments.out.as_deref(), &arguments.scenario));
    // Opened before the work starts, so that a folder that cannot be written costs no time.
    let mut folder = path
        .map(|path| open(&path, to_stdout))
        .transpose()
        .map_err(|error| Failure::Input(format!("{error}; choose another folder with --out")))?;
    let bodies = model.bodies();
    let mut timeline = Timeline::new(&bodies, gravity_m_s2);
    let mut events = Vec::new();
    let (summary, rows) = {
        let writer: Box<dyn io::Write + '_> = match &mut folder {
            Some(folder) if !to_stdout => Box::new(folder.file(ROTATIONS)),
            _ => Box::new(BufWriter::new(io::stdout().lock())),
        };
        let mut results = Results {
            table: RotationsWriter::new(writer, &bodies, ground.has_vertical(), scales)?,
            timeline: &mut timeline,
            events: &mut events,
            written: Ok(()),
        };
        let summary = model.simulate(ground, &scenario.request(), Some(&mut results))?;
        results.written?;
        (summary, results.table.finish()?)
    };
    let mut text = human_summary(&scenario, &*model, ground, &summary, &events);
    if let Some(mut folder) = folder {
        results::write_events(folder.file(EVENTS), &bodies, &events)?;
        results::write_impacts(folder.file(IMPACTS), &*model, &events)?;
        let title = scenario.title.as_deref().unwrap_or("Rocking history");
        folder
            .file(PICTURE)
            .write_all(timeline.draw(title, &events).as_bytes())
            .map_err(|error| Failure::Work(format!("cannot write the picture: {error}")))?;
        let summary = results::summary(&scenario, &*model, ground, &summary)?;
        writeln!(folder.file(SUMMARY), "{summary:#}")
            .map_err(|error| Failure::Work(format!("cannot write the summary: {error}")))?;
        let path = folder.path().to_owned();
        folder.complete()?;
        let rotations = if to_stdout {
            String::new()
        } else {
            format!("{ROTATIONS} ({rows} rows), ")
        };
        let _ = writeln!(
            text,
            "  results in {}: {rotations}{EVENTS}, {IMPACTS}, {PICTURE}, {SUMMARY}",
            path.display()
        );
    }
    if !quiet {
        // Nobody is left to be told when standard error fails.
        let _ = io::stderr().write_all(text.as_bytes());
    }
    Ok(())
}

/// Where samples and events go.
struct Results<'a, W: io::Write> {
    table: RotationsWriter<W>,
    timeline: &'a mut Timeline,
    events: &'a mut Vec<Event>,
    /// Why the table could not be written, which ends the history.
    written: Result<(), OutputError>,
}

impl<W: io::Write> Recorder for Results<'_, W> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.timeline.push(sample);
        self.written = self.table.write(sample);
        match self.written {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        self.events.push(event.clone());
        ControlFlow::Continue(())
    }
}

/// Opens the folder for the results.
fn open(path: &Path, without_rotations: bool) -> Result<Folder, OutputError> {
    if without_rotations {
        let mut folder = Folder::open(path, &[EVENTS, IMPACTS, PICTURE, SUMMARY])?;
        folder.forget(ROTATIONS);
        Ok(folder)
    } else {
        Folder::open(path, &[ROTATIONS, EVENTS, IMPACTS, PICTURE, SUMMARY])
    }
}

/// What happened, when, and what it compares with.
fn human_summary(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    ground: &GroundMotion,
    history: &Summary,
    events: &[Event],
) -> String {
    let mut text = String::new();
    if let Some(title) = &scenario.title {
        let _ = writeln!(text, "{title}");
    }
    let time_s = history.outcome_time_s;
    let impacts = match history.impacts {
        0 => "without impact".to_owned(),
        1 => "after 1 impact".to_owned(),
        count => format!("after {count} impacts"),
    };
    let _ = match history.outcome {
        Outcome::NeverMoved => writeln!(text, "  never moved"),
        Outcome::Rest => writeln!(text, "  came to rest at {time_s:.4} s {impacts}"),
        Outcome::Overturned(sway) => {
            writeln!(
                text,
                "  overturned to the {} at {time_s:.4} s {impacts}",
                sway.name()
            )
        }
        Outcome::StillRocking => writeln!(text, "  still rocking at {time_s:.4} s {impacts}"),
    };
    let first = events
        .iter()
        .find_map(|event| Some((event.time_s, event.impact.as_ref()?)));
    if let Some((time_s, impact)) = first {
        let _ = writeln!(
            text,
            "  first impact at {time_s:.4} s, restitution (energy after/before) {:.4}",
            impact.restitution,
        );
    }
    if history.outcome != Outcome::NeverMoved {
        let _ = writeln!(
            text,
            "  peak rotation in rad: {}",
            commands::by_body(&model.bodies(), &history.peak_rotations_rad),
        );
        if let Some(peak) = history.peak_over_critical {
            let _ = writeln!(
                text,
                "  largest rotation {peak:.4} of that at the unstable equilibrium of the mechanism that moved"
            );
        }
        let _ = writeln!(
            text,
            "  energy defect {:.1e} of the first mechanism's barrier, {} steps, {} evaluations",
            history.energy_defect_ratio, history.cost.steps, history.cost.evaluations
        );
    }
    let incipient_g = model
        .incipient_acceleration_g(Sway::Right)
        .unwrap_or(f64::INFINITY);
    let peaks_g = ground.peaks_m_s2(history.end_s) / scenario.simulation.gravity_m_s2;
    let mut reaches = if peaks_g.x > 0.0 {
        format!(
            "reaches {:.4} g, {:.2} times as much",
            peaks_g.x,
            peaks_g.x / incipient_g
        )
    } else {
        "stays still".to_owned()
    };
    if peaks_g.y > 0.0 {
        let _ = write!(
            reaches,
            " sideways;\n    vertically it reaches {:.4} g, and A_L counts in gravity plus that",
            peaks_g.y
        );
    }
    let _ = writeln!(
        text,
        "  incipient acceleration A_L {incipient_g:.4} g; the ground {reaches}"
    );
    if history.end_s >= scenario.simulation.duration_s && ground.end_s() > history.end_s {
        let _ = writeln!(
            text,
            "  the run ends at {:.4} s and the ground moves until {:.4} s: a longer duration_s in [simulation] \
             shows the rest",
            history.end_s,
            ground.end_s()
        );
    }
    if let Some(thrust) = &history.thrust {
        let of_arch = matches!(scenario.structure, Structure::Arch(_));
        text += &trust(thrust, of_arch);
    }
    text
}

/// How far the motion can be trusted to be that of four links, or of a column on its toe.
fn trust(thrust: &ThrustRecord, of_arch: bool) -> String {
    let Some(shares) = thrust.shares_within() else {
        return String::new();
    };
    let Peak { value, time_s } = thrust.largest_excess;
    let [close, near] = shares.map(|share| 100.0 * share);
    let [least, most] = EXCESS_LEVELS;
    let mut text = if !of_arch {
        if value > 0.0 {
            format!(
                "  the ground would have to hold the column down (at {time_s:.4} s): it flies off\n"
            )
        } else {
            String::new()
        }
    } else if value <= least {
        format!("  four links suffice: the thrust line leaves the arch by {value:.4} t at most\n")
    } else {
        format!(
            "  four links do not suffice: the thrust line leaves the arch by up to {value:.3} t (at \
             {time_s:.4} s);\n    it stays within {least} t for {close:.1} % and within {most} t for \
             {near:.1} % of the rocking time. Not on the safe side.\n"
        )
    };
    let _ = writeln!(
        text,
        "  friction coefficient needed to prevent sliding: {:.3} (at {:.4} s)",
        thrust.largest_friction.value, thrust.largest_friction.time_s
    );
    text
}
