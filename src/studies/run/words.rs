//! The words of a run: templates that read its [`RunSummary`] alone.

use std::path::PathBuf;

use askama::Template;
use nalgebra::Vector2;
use serde::Deserialize as _;
use serde_json::Value;

use super::caveats::{Caveat, coefficient, largest_coefficient};
use super::impacts::NotableImpact;
use super::points::format_point;
use super::summary::{
    FourLinkQuality, FrictionDemand, PointPeaks, RunSummary, STRAIGHT_RAD, VariationOutcome,
};
use super::{FILM, OVERLAY, ROTATIONS};
use crate::dynamics::repeatability::{
    FIRST_REPETITIONS, LEAST_SLIP_M, RepeatedHalfCycle, RepeatedValue, SAME_PEAK_RATIO,
};
use crate::dynamics::{DOUBTFUL_ENERGY_ERROR, ElasticSummary, HalfCycle, OutcomeKind, Sliding};
use crate::mechanics::Sides;
use crate::output::mechanisms::by_body;
use crate::output::{filters, range_ends, render};
use crate::scenario::{ELASTIC_JOINTS, FREE_HINGES, ModelKind, Scaling, Scenario, Series};
use crate::studies::comparison::Comparison;
use crate::studies::quotable::STONE_FRICTION;
use crate::{Outcome, Verdict};

/// Returns the records of a scenario, one line each.
pub(super) fn records_in_words(scenario: &Scenario) -> String {
    let in_words = |series: &Series| {
        let (file, sampling) = (series.label(), series.sampling());
        let peak_g = series.peak_g(scenario.gravity_m_s2());
        let scaled = match series.scaling {
            Scaling::Factor(1.0) => "",
            _ => " as scaled",
        };
        let corrections = series.corrections();
        format!("  {file}: {sampling}, peak {peak_g:.4} g{scaled}{corrections}\n")
    };
    scenario.series().map(in_words).collect()
}

/// The verdict: the outcome, its certainty, and the properties that may change it.
#[derive(Template)]
#[template(path = "studies/run/words/verdict.txt")]
pub(super) struct VerdictLine<'a> {
    pub summary: &'a RunSummary,
}

/// The main numbers: onset, ground, largest motion and end.
#[derive(Template)]
#[template(path = "studies/run/words/numbers.txt")]
struct NumbersLine<'a> {
    summary: &'a RunSummary,
}

/// The lines after the verdict.
#[derive(Template)]
#[template(path = "studies/run/words/words.txt")]
pub(super) struct Words<'a> {
    pub summary: &'a RunSummary,
}

/// The printed words of runs of one structure, each with its files, and of their comparison.
#[derive(Template)]
#[template(path = "studies/run/words/printed.txt")]
pub(super) struct Printed<'a> {
    pub comparison: Option<&'a Comparison<RunSummary>>,
    /// The answer of the comparison; `None` on a page, which begins with it.
    pub quote: Option<&'a str>,
    pub runs: Vec<(&'a RunSummary, Option<&'a WrittenFiles>)>,
}

/// The files of a run in a folder.
#[derive(Debug)]
pub(super) struct WrittenFiles {
    pub folder: PathBuf,
    pub names: Vec<&'static str>,
    /// Number of rows of the rotations.
    pub rows: usize,
    pub film_pictures: Option<usize>,
    /// Times of snapshots before the start and after the end of the history, in seconds, which show its first and its last instant.
    pub outside_times_s: [Vec<f64>; 2],
}

/// Words of a run, or of a comparison of several models, from its JSON. The lines about files are missing.
///
/// # Errors
/// When the JSON is not a summary of a run.
pub fn words_of(json: &Value) -> serde_json::Result<String> {
    let comparison: Option<Comparison<RunSummary>> = match json.get("program") {
        Some(_) => None,
        None => Some(Comparison::deserialize(json)?),
    };
    let runs = match &comparison {
        Some(comparison) => comparison.models().cloned().collect(),
        None => vec![RunSummary::deserialize(json)?],
    };
    Ok(super::super::results::words_of(&Printed {
        comparison: comparison.as_ref(),
        quote: comparison.as_ref().and_then(|one| one.to_quote.as_deref()),
        runs: runs.iter().map(|summary| (summary, None)).collect(),
    }))
}

/// Largest number of half cycles that are described.
const MAX_HALF_CYCLES: usize = 3;
/// Largest number of joints whose slips are reported.
const MAX_SLIPS: usize = 4;
/// Distance of the thrust from the middle, in thicknesses of a joint, from which the thrust of a row at rest is reported as close to the edge.
const NEAR_EDGE_RATIO: f64 = 0.4;

/// The slip of a joint: the largest and the final value.
struct Slip {
    joint: usize,
    largest_mm: f64,
    end_mm: f64,
}

/// Half cycles of a motion, each with its counterparts in the repetitions.
type RepeatedHalfCycles<'s> = Vec<(&'s HalfCycle, &'s RepeatedHalfCycle)>;

impl RunSummary {
    /// Verdict in words, as a run prints it.
    pub fn verdict_line(&self) -> String {
        render(&VerdictLine { summary: self })
    }

    /// The main numbers, in a line.
    pub(super) fn numbers_line(&self) -> String {
        super::super::results::words_of(&NumbersLine { summary: self })
    }

    /// True if no block moved until the end of the run.
    fn is_unmoved(&self) -> bool {
        match self.outcome.outcome {
            OutcomeKind::NeverMoved => true,
            OutcomeKind::Incomplete => self.largest_peak_rotation_rad == 0.0 && !self.has_slipped(),
            _ => false,
        }
    }

    /// Time since which elastic joints that still move at the end only vibrate, in s; `None` for other outcomes.
    pub(super) fn vibrates_since_s(&self) -> Option<f64> {
        let moves = self.outcome.outcome == OutcomeKind::StillRocking;
        self.elastic_summary()?.vibrates_since_s.filter(|_| moves)
    }

    /// True if the runs of several models are printed together, and this one is among them.
    pub(super) fn is_compared_with(&self, model: &'static ModelKind) -> bool {
        self.compared_models.contains(&model)
    }

    fn elastic_summary(&self) -> Option<ElasticSummary> {
        self.row.as_ref()?.elastic
    }

    fn sliding(&self) -> Option<&Sliding> {
        self.row.as_ref()?.row.sliding.as_ref()
    }

    fn has_slipped(&self) -> bool {
        self.sliding()
            .is_some_and(|sliding| sliding.largest_offsets_m.iter().any(|slip_m| *slip_m > 0.0))
    }

    /// Coulomb's coefficient of friction; `None` if joints cannot slip.
    pub(super) fn friction_coefficient(&self) -> Option<f64> {
        self.row.as_ref()?.friction_coefficient
    }

    fn peak_potential_over_barrier(&self) -> Option<f64> {
        self.row.as_ref()?.row.peak_potential_over_barrier
    }

    /// Remaining energy over the barrier that it cannot pass any more; `None` if the verdict does not depend on it.
    fn remaining_over_barrier(&self) -> Option<f64> {
        self.mechanisms.as_ref()?.remaining_energy_over_barrier
    }

    fn peak_over_critical(&self) -> Option<f64> {
        self.mechanisms.as_ref()?.peak_rotation_over_critical
    }

    pub(super) fn four_links(&self) -> Option<FourLinkQuality> {
        self.mechanisms.as_ref()?.thrust?.four_links
    }

    /// Half cycles with the largest peaks that are printed as nonzero, in order of time.
    fn half_cycles(&self) -> Vec<&HalfCycle> {
        let cycles = self.row.iter().flat_map(|row| &row.half_cycles);
        select_largest(cycles.collect(), |one| one.peak_rad)
    }

    /// Comparisons of these half cycles with the repetitions: first the certain ones, then the others.
    fn repeated_half_cycles(&self) -> [RepeatedHalfCycles<'_>; 2] {
        let repeated = self
            .repeatability
            .iter()
            .flat_map(|all| &all.repeatability.half_cycles);
        let cycles = || self.row.iter().flat_map(|row| &row.half_cycles);
        let pairs = repeated.filter_map(|repeated| {
            let own = cycles().find(|own| own.peak_time_s == repeated.peak_time_s)?;
            Some((own, repeated))
        });
        let described = select_largest(pairs.collect(), |(own, _)| own.peak_rad).into_iter();
        let (same, differ) = described.partition(|(_, repeated)| repeated.is_certain());
        [same, differ]
    }

    /// Number of the body with the largest rotation, the last one of several.
    fn largest_body(&self) -> usize {
        let mut peaks_rad = self.peak_rotations_rad.0.iter();
        let last = peaks_rad.rposition(|(_, peak)| *peak == self.largest_peak_rotation_rad);
        last.unwrap_or(0) + 1
    }

    fn peaks_by_body(&self) -> String {
        let named = self.peak_rotations_rad.0.iter().map(|(key, peak_rad)| {
            let body = key
                .trim_start_matches("peak_rotation")
                .trim_end_matches("rad");
            (body.trim_matches('_').to_owned(), *peak_rad)
        });
        let (bodies, peaks_rad): (Vec<String>, Vec<f64>) = named.unzip();
        by_body(&bodies, &peaks_rad)
    }

    /// Slips of the joints that slipped, the largest slip first.
    fn slips(&self) -> Vec<Slip> {
        let joints = self.row.iter().flat_map(|row| &row.slipped_joints);
        let slip = |joint: &usize| {
            let sliding = self.sliding()?;
            Some(Slip {
                joint: *joint,
                largest_mm: 1e3 * sliding.largest_offsets_m.get(*joint)?,
                end_mm: 1e3 * sliding.offsets_m.get(*joint)?.abs(),
            })
        };
        joints.filter_map(slip).collect()
    }

    /// Feet whose records end before the ground stops, with the times.
    fn ended_records(&self) -> Vec<(&'static str, f64)> {
        let feet = self.row.as_ref().and_then(|row| row.feet);
        let ends_s = feet
            .and_then(|feet| feet.records_end_s)
            .into_iter()
            .flatten();
        let feet = ["left", "right"].into_iter().zip(ends_s);
        feet.filter(|(_, at_s)| *at_s < self.ground.end_s).collect()
    }

    /// Whether no push starts the structure to either side.
    fn no_push_starts_it(&self) -> bool {
        let Sides { right, left } = self.incipient_acceleration_g;
        right.or(left).is_none()
    }

    /// Acceleration that starts the structure; `None` if it differs between the sides.
    fn common_start_g(&self) -> Option<f64> {
        let Sides { right, left } = self.incipient_acceleration_g;
        right.filter(|right| left.is_some_and(|left| (right - left).abs() <= 1e-9 * right))
    }

    /// Friction that prevents sliding; `None` if joints slip, and for mechanisms that did not rock.
    fn reported_friction(&self) -> Option<FrictionDemand> {
        let is_reported = match &self.mechanisms {
            None => self.sliding().is_none(),
            Some(own) => own
                .thrust
                .is_some_and(|thrust| thrust.rocking_share_thrust_excess_below_0_05.is_some()),
        };
        self.friction.filter(|_| is_reported)
    }

    /// Conditions of the outcome: friction that stone may not have, and properties that change the outcome.
    fn conditions(&self) -> Vec<Caveat<'_>> {
        let conditions = [
            self.friction_condition(),
            self.changed_outcome(),
            self.without_verdict(),
        ];
        let decided = |_: &Caveat<'_>| self.outcome.outcome != OutcomeKind::Incomplete;
        conditions.into_iter().flatten().filter(decided).collect()
    }
}

/// Smallest and the largest value in all repetitions.
fn range(value: &RepeatedValue) -> String {
    range_ends([value.min, value.max], 6).join(" to ")
}

/// Largest final slip of joints, in mm.
fn largest_end_mm(slips: &[Slip]) -> f64 {
    slips.iter().map(|slip| slip.end_mm).fold(0.0, f64::max)
}

/// Position of a point in the format of `--point`.
fn place_of(point: &PointPeaks) -> String {
    format_point(Vector2::new(point.x_m, point.y_m))
}

/// Ratio of a push to the push that starts the structure, in words; empty if the structure starts at zero push.
fn times(push_g: &f64, starts_g: &f64) -> String {
    match push_g / starts_g {
        times if times.is_finite() => format!(", {times:.2} times as much"),
        _ => String::new(),
    }
}

impl NotableImpact {
    /// Joints that closed and opened, each with the verb.
    fn moved_joints(&self) -> [(&[usize], &'static str); 2] {
        [
            (&self.closed_joints, "close"),
            (&self.opened_joints, "open"),
        ]
    }

    /// True if four digits of the fraction of the energy that it keeps would be "1.0000", although it takes energy.
    fn takes_little(&self) -> bool {
        self.restitution < 1.0 && format!("{:.4}", self.restitution) == "1.0000"
    }
}

/// Numbers of joints; consecutive joints as `3-7`.
fn joint_numbers(joints: &[usize]) -> String {
    let runs = joints.chunk_by(|one, next| one + 1 == *next);
    let names = runs.map(|run| match run {
        [joint] => joint.to_string(),
        [first, last] => format!("{first}, {last}"),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    });
    names.collect::<Vec<_>>().join(", ")
}

/// Values with the largest peaks that are printed as nonzero, in their order.
fn select_largest<T: Copy>(cycles: Vec<T>, peak_rad: impl Fn(T) -> f64) -> Vec<T> {
    let mut rocking: Vec<usize> = (0..cycles.len())
        .filter(|index| peak_rad(cycles[*index]) > STRAIGHT_RAD)
        .collect();
    rocking.sort_by(|a, b| peak_rad(cycles[*b]).total_cmp(&peak_rad(cycles[*a])));
    rocking.truncate(MAX_HALF_CYCLES);
    rocking.sort_unstable();
    rocking.into_iter().map(|index| cycles[index]).collect()
}
