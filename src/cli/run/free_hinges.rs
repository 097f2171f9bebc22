//! `run` with free hinges.

use std::fmt::Write as _;
use std::io::Write as _;
use std::ops::ControlFlow;

use archrock::dynamics::free_hinges::{DOUBTFUL_ENERGY_ERROR, FreeHinges};
use archrock::dynamics::ground::GroundMotion;
use archrock::dynamics::history::{Event, HalfCycle, Impact, Outcome, Sample, Sliding, Summary};
use archrock::dynamics::model::{Model as _, Recorder};
use archrock::dynamics::spread::{Repetitions, SAME_PEAK_RATIO, Spread, SpreadError};
use archrock::mechanics::chain::Hinge;
use archrock::output::free_hinges::{JointsWriter, LandingsWriter, summary};
use archrock::output::overlay::Curves;
use archrock::output::pretty;
use archrock::output::results::EventsWriter;
use archrock::output::rotations::RotationsWriter;
use archrock::output::row_timeline::RowTimeline;
use archrock::output::scene::Scene;
use archrock::output::{Folder, OutputError};
use archrock::scenario::Scenario;

use super::extras::{Extras, File, POSES, PosesTable};
use super::progress::RunProgress;
use super::{
    EVENTS, IMPACTS, JOINTS, PICTURE, Place, ROTATIONS, SUMMARY, Told, cannot_write, cut_short,
    incipient, outcome, subject, written,
};
use crate::cli::Failure;

/// What can be asked of it.
#[derive(Clone, Copy)]
pub struct Options {
    /// Whether it is repeated in other ways, to see what depends on the computation.
    pub spread: bool,
    /// Whether no progress is shown.
    pub quiet: bool,
}

/// The model of a scenario that has free hinges.
pub fn model(scenario: &Scenario) -> Result<FreeHinges, Failure> {
    let steps = scenario.motion().row().unwrap_or_default();
    scenario
        .structure()
        .free_hinges(steps)
        .map_err(|error| Failure::Input(error.to_string()))
}

/// Runs it, and says what happened.
pub fn run(
    scenario: &Scenario,
    place: &Place,
    options: Options,
    curves: Option<&mut Curves>,
) -> Result<Told, Failure> {
    let model = model(scenario)?;
    let ground = scenario.ground_motion();
    let mut folder = place.open(&[JOINTS, EVENTS, IMPACTS, PICTURE, SUMMARY])?;
    let mut timeline = RowTimeline::new(model.row());
    let mut extras = Extras::new(
        &place.extras,
        folder.as_ref(),
        &Scene::of_row(model.row()),
        &model.bodies(),
        scenario.gravity_m_s2(),
    );
    let mut impacts = Notable::default();
    let repetitions = options
        .spread
        .then(|| Repetitions::start(&model, ground, &scenario.request()));
    let progress = RunProgress::new(scenario.simulation().duration_s, options.quiet);
    let (summary, rows) = {
        let mut results = Results {
            tables: Tables::new(&model, ground, place, folder.as_mut())?,
            timeline: &mut timeline,
            extras: &mut extras,
            impacts: &mut impacts,
            curves,
            progress: &progress,
            written: Ok(()),
        };
        let summary = model.simulate(ground, &scenario.request(), Some(&mut results))?;
        results.written?;
        (summary, results.tables.finish()?)
    };
    progress.repeating();
    let spread = repetitions.map(|repetitions| repetitions.spread(&summary));
    drop(progress);
    let spread = spread.as_ref();
    let mut text = words(scenario, &model, &summary, spread, &impacts);
    let mut json = self::summary(scenario, &model, &summary, spread)?;
    let row = summary.row.as_ref();
    if let Some(longest_step) = row.and_then(|row| row.longest_step.0) {
        // What a computation takes is told here, and belongs to no result.
        json["longest_step_us"] = (longest_step.as_secs_f64() * 1e6).round().into();
    }
    if let Some(mut folder) = folder {
        let title = scenario.title().unwrap_or("Rocking history");
        let subject = subject(scenario, &model, title);
        let picture = timeline.draw(place.figure, &subject, &summary);
        folder
            .file(PICTURE)
            .write_all(picture.as_bytes())
            .map_err(cannot_write("the picture"))?;
        extras.write(&mut folder, scenario, (place.figure, title), &mut text)?;
        folder
            .file(SUMMARY)
            .write_all(pretty(&json).as_bytes())
            .map_err(cannot_write("the summary"))?;
        let path = folder.path().to_owned();
        folder.complete()?;
        let names = [JOINTS, EVENTS, IMPACTS, PICTURE, SUMMARY];
        text += &written(&path, place, rows, &names);
    }
    Ok(Told {
        text,
        summary: json,
    })
}

/// The tables that are written while the motion is computed.
struct Tables<'a> {
    rotations: RotationsWriter<File<'a>>,
    poses: PosesTable<'a>,
    /// Those that only a folder can hold.
    joints: Option<JointsWriter<File<'a>>>,
    events: Option<EventsWriter<File<'a>>>,
    landings: Option<LandingsWriter<File<'a>>>,
}

impl<'a> Tables<'a> {
    fn new(
        model: &FreeHinges,
        ground: &GroundMotion,
        place: &Place,
        folder: Option<&'a mut Folder>,
    ) -> Result<Self, OutputError> {
        let blocks = model.bodies();
        let slip = model.friction_coefficient().is_some();
        let (mut rotations, mut poses): (Option<File<'a>>, Option<File<'a>>) = (None, None);
        let (mut joints, mut events, mut landings) = (None, None, None);
        for (name, file) in folder.into_iter().flat_map(Folder::files) {
            let file: File<'a> = Box::new(file);
            match name {
                ROTATIONS => rotations = Some(file),
                POSES => poses = Some(file),
                JOINTS => {
                    joints = Some(JointsWriter::new(file, model.row().joints().len(), slip)?);
                }
                EVENTS => events = Some(EventsWriter::of_row(file)?),
                IMPACTS => landings = Some(LandingsWriter::new(file, slip)?),
                _ => {}
            }
        }
        let rotations = rotations.unwrap_or_else(|| place.elsewhere());
        Ok(Self {
            rotations: RotationsWriter::of_row(rotations, &blocks, ground.has_vertical())?,
            poses: PosesTable::new(poses, &blocks)?,
            joints,
            events,
            landings,
        })
    }

    fn sample(&mut self, sample: &Sample) -> Result<(), OutputError> {
        self.rotations.write(sample)?;
        self.poses.write(sample)?;
        self.joints
            .as_mut()
            .map_or(Ok(()), |joints| joints.write(sample))
    }

    fn event(&mut self, event: &Event) -> Result<(), OutputError> {
        if let Some(events) = &mut self.events {
            events.write(event)?;
        }
        match (&mut self.landings, &event.impact) {
            (Some(landings), Some(impact)) => landings.write(event.time_s, impact),
            _ => Ok(()),
        }
    }

    /// Ends the tables and returns the number of samples.
    fn finish(self) -> Result<u64, OutputError> {
        self.poses.finish()?;
        self.joints.map_or(Ok(()), JointsWriter::finish)?;
        self.events.map_or(Ok(()), EventsWriter::finish)?;
        self.landings.map_or(Ok(()), LandingsWriter::finish)?;
        self.rotations.finish()
    }
}

/// Half cycles that the words of a run tell of.
const FIRST: usize = 3;

/// What turns by no more than this slides straight on: printed, it is zero.
const STRAIGHT_RAD: f64 = 5e-7;

/// Impacts that the words of a run tell of, with their times.
#[derive(Default)]
struct Notable {
    first: Option<(f64, Impact)>,
    /// The one that takes the most energy.
    hardest: Option<(f64, Impact)>,
}

impl Notable {
    fn note(&mut self, time_s: f64, impact: &Impact) {
        if self.first.is_none() {
            self.first = Some((time_s, impact.clone()));
        }
        let harder = |(_, hardest): &(f64, Impact)| taken_j(impact) > taken_j(hardest);
        if self.hardest.as_ref().is_none_or(harder) {
            self.hardest = Some((time_s, impact.clone()));
        }
    }
}

fn taken_j(impact: &Impact) -> f64 {
    impact.energy_before_j - impact.energy_after_j
}

/// Where samples and events go.
struct Results<'a> {
    tables: Tables<'a>,
    timeline: &'a mut RowTimeline,
    extras: &'a mut Extras,
    impacts: &'a mut Notable,
    curves: Option<&'a mut Curves>,
    progress: &'a RunProgress,
    /// Why a table could not be written, which ends the history.
    written: Result<(), OutputError>,
}

impl Results<'_> {
    fn go_on(&mut self, written: Result<(), OutputError>) -> ControlFlow<()> {
        self.written = written;
        match self.written {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    }
}

impl Recorder for Results<'_> {
    fn sample(&mut self, sample: &Sample) -> ControlFlow<()> {
        self.progress.reached(sample.time_s);
        self.timeline.push(sample);
        self.extras.push(sample);
        if let Some(curves) = &mut self.curves {
            curves.push(sample);
        }
        let written = self.tables.sample(sample);
        self.go_on(written)
    }

    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        if let Some(impact) = &event.impact {
            self.impacts.note(event.time_s, impact);
        }
        // Of a history that was ended because a table failed, the end is no event of the tables.
        if self.written.is_err() {
            return ControlFlow::Break(());
        }
        let written = self.tables.event(event);
        self.go_on(written)
    }

    fn wants_thrust_line(&self) -> bool {
        self.extras.want_thrust_line()
    }
}

/// What happened, when, and what it compares with.
fn words(
    scenario: &Scenario,
    model: &FreeHinges,
    history: &Summary,
    spread: Option<&Result<Spread, SpreadError>>,
    impacts: &Notable,
) -> String {
    let ground = scenario.ground_motion();
    let mut text = outcome(history);
    if let Some((time_s, impact)) = &impacts.first {
        let _ = writeln!(text, "  first impact at {time_s:.4} s: {}", landing(impact));
    }
    if let Some((time_s, impact)) = &impacts.hardest
        && impacts.hardest != impacts.first
    {
        let _ = writeln!(
            text,
            "  largest loss in one impact at {time_s:.4} s: {}",
            landing(impact)
        );
    }
    if let Some(row) = &history.row
        && history.outcome != Outcome::NeverMoved
    {
        let rocking = row
            .half_cycles
            .iter()
            .filter(|cycle| cycle.peak_rad > STRAIGHT_RAD);
        let cycles: Vec<_> = rocking.take(FIRST).map(cycle).collect();
        if !cycles.is_empty() {
            let cycles = cycles.join(", ");
            let _ = writeln!(text, "  peaks of the first half cycles in rad: {cycles}");
        }
        let (peak, peaks) = (history.largest_rotation_rad(), &history.peak_rotations_rad);
        if peak <= STRAIGHT_RAD {
            text += "  slides without rocking\n";
        } else if let Some(block) = peaks.iter().rposition(|other| *other == peak) {
            let _ = writeln!(
                text,
                "  largest rotation {peak:.6} rad, of block {} of {}",
                block + 1,
                peaks.len()
            );
        }
        if let Some(peak) = history.peak_potential_over_barrier {
            let _ = match history.outcome {
                // It may have overturned by another mechanism, and fallen on since.
                Outcome::Overturned(_) => {
                    writeln!(text, "  passed the barrier beyond which it overturns")
                }
                _ => {
                    // Rounded down, so that what was not reached is not said to be.
                    let percent = (1e3 * peak).floor() / 10.0;
                    writeln!(
                        text,
                        "  reached {percent:.1} % of the potential energy at which its first mechanism overturns"
                    )
                }
            };
        }
        let _ = writeln!(
            text,
            "  energy defect {:.1e} of weight times size, {} steps, {} iterations",
            history.energy_defect_ratio, history.cost.steps, history.cost.evaluations
        );
        if row.energy_error > DOUBTFUL_ENERGY_ERROR {
            let _ = writeln!(
                text,
                "  that is {:.2} % of the largest energy of the motion: a smaller longest_step_s in [free_hinges] makes it less",
                1e2 * row.energy_error
            );
        }
    }
    text += &incipient(scenario, model, ground, history);
    text += &cut_short(scenario, ground, history);
    if let Some(sliding) = history.row.as_ref().and_then(|row| row.sliding.as_ref()) {
        text += &slips(model, sliding, history.outcome);
    } else if let Some(thrust) = &history.thrust {
        let friction = thrust.largest_friction;
        let _ = writeln!(
            text,
            "  friction coefficient needed to prevent sliding: {:.3} (at {:.4} s)",
            friction.value, friction.time_s
        );
    }
    match spread {
        Some(Ok(spread)) if history.outcome != Outcome::NeverMoved => text += &sure(spread),
        Some(Err(reason)) => {
            let _ = writeln!(
                text,
                "  how far it depends on its steps is not known: {reason}"
            );
        }
        _ => {}
    }
    text
}

/// Slips below this part of the thickness of a joint are not worth a word.
const LEAST_SLIP_RATIO: f64 = 1e-6;
/// Joints that the words tell of.
const SLIPPED: usize = 4;

/// Which joints slipped, what is left of it, and what friction took.
fn slips(model: &FreeHinges, sliding: &Sliding, outcome: Outcome) -> String {
    let joints = model.row().joints().iter().zip(&sliding.largest_offsets_m);
    let mut slipped: Vec<(usize, f64, f64)> = joints
        .zip(&sliding.offsets_m)
        .enumerate()
        .filter(|(_, ((joint, largest_m), _))| **largest_m > LEAST_SLIP_RATIO * joint.thickness_m())
        .map(|(index, ((_, largest_m), end_m))| (index, *largest_m, *end_m))
        .collect();
    slipped.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut text =
        match &slipped[..] {
            [] => "  no joint slipped".to_owned(),
            [..] => {
                let named = slipped.iter().take(SLIPPED).map(|(joint, largest_m, end_m)| {
                let (largest_mm, end_mm) = (1e3 * largest_m, 1e3 * end_m.abs());
                if outcome == Outcome::Rest && (largest_mm - end_mm).abs() > 0.05 * largest_mm {
                    format!("joint {joint} slipped {largest_mm:.3} mm, {end_mm:.3} mm in the end")
                } else {
                    format!("joint {joint} slipped {largest_mm:.3} mm")
                }
            });
                let mut text = format!("  {}", named.collect::<Vec<_>>().join("; "));
                if slipped.len() > SLIPPED {
                    let _ = write!(text, "; {} more slipped less", slipped.len() - SLIPPED);
                }
                text
            }
        };
    let _ = write!(text, "; friction took {:.3} J", sliding.friction_j);
    if outcome == Outcome::Rest
        && let Some(most_m) = slipped
            .iter()
            .map(|(_, _, end_m)| end_m.abs())
            .max_by(f64::total_cmp)
    {
        let _ = write!(
            text,
            "\n  at rest, but not as it stood: joints are up to {:.3} mm off",
            1e3 * most_m
        );
    }
    if sliding.unconverged > 0 {
        let _ = write!(
            text,
            "\n  friction did not converge in {} steps: bounds off by up to {:.1e}; take shorter steps",
            sliding.unconverged, sliding.bound_error
        );
    }
    text.push('\n');
    text
}

/// What an impact did.
fn landing(impact: &Impact) -> String {
    let mut text = String::new();
    for (hinges, one, many) in [
        (&impact.closed, "closes", "close"),
        (&impact.opened, "opens", "open"),
    ] {
        let named = joints(hinges);
        let _ = match hinges.len() {
            0 => Ok(()),
            1 => write!(text, "joint {named} {one}, "),
            _ => write!(text, "joints {named} {many}, "),
        };
    }
    let _ = write!(text, "energy after/before {:.4}", impact.restitution);
    text
}

/// Numbers of the joints that hinges are at; neighbours as `3-7`.
fn joints(hinges: &[Hinge]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for hinge in hinges {
        if let Hinge::Joint { joint, .. } = *hinge {
            match runs.last_mut() {
                Some((_, last)) if *last + 1 == joint => *last = joint,
                _ => runs.push((joint, joint)),
            }
        }
    }
    let names = runs.into_iter().map(|(first, last)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first}-{last}"),
    });
    names.collect::<Vec<_>>().join(", ")
}

fn cycle(cycle: &HalfCycle) -> String {
    format!("{} {:.6}", cycle.sway.name(), cycle.peak_rad)
}

/// What the repetitions leave as it is.
fn sure(spread: &Spread) -> String {
    let repeated = spread.repeated.join("; ");
    let mut text = if spread.same_outcome() {
        format!("  repeated ({repeated}): the same outcome")
    } else {
        let others: Vec<String> = spread.outcomes[1..]
            .iter()
            .map(|other| ending(*other))
            .collect();
        let others = others.join(" and ");
        format!("  repeated ({repeated}): ANOTHER OUTCOME, {others}")
    };
    let mut peaks = spread.half_cycles.iter();
    if peaks.all(|peak| peak.max_rad <= STRAIGHT_RAD) {
        text.push('\n');
        return text;
    }
    let percent = 100.0 * SAME_PEAK_RATIO;
    let same = spread.same_until_half_cycle;
    let _ = match (same, spread.parts_at_s) {
        (0, None) => Ok(()),
        (1, None) => write!(text, ", peak of the only half cycle within {percent} %"),
        (_, None) => write!(text, ", peaks of all {same} half cycles within {percent} %"),
        (0, Some(_)) => write!(text, "; the first half cycles differ already"),
        (1, Some(time_s)) => write!(
            text,
            ", peak of the first half cycle within {percent} %;\n    from {time_s:.4} s on they differ"
        ),
        (_, Some(time_s)) => write!(
            text,
            ", peaks of the first {same} half cycles within {percent} %;\n    from {time_s:.4} s on they differ"
        ),
    };
    if let Some(peak) = spread.half_cycles.get(same) {
        let (min_rad, max_rad) = (peak.min_rad, peak.max_rad);
        let _ = write!(
            text,
            ": half cycle {} peaks at {min_rad:.6} to {max_rad:.6} rad",
            same + 1
        );
    }
    if let Some(largest) = spread.largest {
        let (min_rad, max_rad) = (largest.min_rad, largest.max_rad);
        let _ = if largest.is_same() {
            write!(text, "\n    largest rotation within {percent} %")
        } else {
            write!(
                text,
                "\n    LARGEST ROTATION {min_rad:.6} to {max_rad:.6} rad"
            )
        };
    }
    text.push('\n');
    text
}

fn ending(outcome: Outcome) -> String {
    match outcome {
        Outcome::NeverMoved => "never moved".to_owned(),
        Outcome::Rest => "rest".to_owned(),
        Outcome::Overturned(sway) => format!("overturned to the {}", sway.name()),
        Outcome::StillRocking => "still rocking".to_owned(),
    }
}
