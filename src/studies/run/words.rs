//! The words of a run, from its summary and its history: outcome, times, comparisons and repeatability.

use askama::Template;
use nalgebra::Vector2;

use super::caveats::{self, STONE_FRICTION, STRAIGHT_RAD};
use super::comparison::{changed_outcome, without_verdict};
use super::points::place;
use super::summary::{ComputedRun, Summary};
use super::tables::energy_loss_j;
use crate::dynamics::free_hinges::DOUBTFUL_ENERGY_ERROR;
use crate::dynamics::repeatability::{
    FIRST_REPETITIONS, LEAST_SLIP_M, RepeatedHalfCycle, RepeatedValue, SAME_PEAK_RATIO,
};
use crate::dynamics::{HalfCycle, Repeatability, Sliding};
use crate::mechanics::Sides;
use crate::output::mechanisms::by_body;
use crate::output::{filters, range_ends};
use crate::scenario::{ELASTIC_JOINTS, FREE_HINGES, ModelKind, Scenario, Series};
use crate::{Event, Hinge, Impact, Outcome, Summary as History, Sway, Verdict};

/// Returns the heading of the words for the runs of scenarios that differ in their models: title, one line per record, and a note about an
/// ignored table.
pub fn heading(scenarios: &[Scenario]) -> String {
    let scenario = &scenarios[0];
    let title = scenario.title.as_deref();
    let mut text = title.map_or(String::new(), |title| format!("{title}\n"));
    text.extend(scenario.series().map(|series: &Series| {
        let (file, sampling) = (series.name(), series.sampling());
        let peak_g = series.peak_g(scenario.gravity_m_s2());
        format!("  {file}: {sampling}, peak {peak_g:.4} g as scaled\n")
    }));
    let ignored = scenarios.iter().find_map(Scenario::ignored);
    text.extend(ignored.map(|ignored| format!("  {ignored}\n")));
    text
}

/// The verdict: the outcome, its certainty, and the properties that may change it.
#[derive(Template)]
#[template(path = "studies/run/words/verdict.txt")]
pub(super) struct VerdictLine<'a>(pub ComputedRun<'a>);

impl VerdictLine<'_> {
    /// Returns the certainty of a verdict, in words that follow it.
    fn certainty(&self, all: &Repeatability) -> String {
        let (count, others) = (&all.count, all.other_outcomes());
        let other_side = others.iter().find_map(|(other, names)| {
            let side = other.overturning_sway()?.name();
            Some(format!(", and to the {side} with {names}"))
        });
        let agreement = if all.repeated.len() > FIRST_REPETITIONS {
            let path = ["; the path does not repeat", ""][usize::from(count.path_repeats)];
            let (of, without) = (count.of, count.without_verdict());
            format!(", agrees in {of} of {of} repetitions{without}{path}")
        } else if others.is_empty() {
            ", the same with other steps".to_owned()
        } else if other_side.is_none() {
            ", and survives with other steps".to_owned()
        } else {
            String::new()
        };
        other_side.unwrap_or_default() + &agreement
    }

    /// Returns the conditions of the outcome: friction that stone may not have, and properties that change the outcome.
    fn conditions(&self) -> Vec<String> {
        let (history, varied) = (self.0.history, self.0.varied);
        let needed = caveats::friction_condition(self.0.scenario, history).into_iter();
        let others = [changed_outcome(history, varied), without_verdict(varied)];
        let conditions = needed.chain(others.into_iter().flatten());
        let decided = |_: &String| history.outcome != Outcome::Incomplete;
        conditions.filter(decided).collect()
    }
}

/// The lines after the verdict.
#[derive(Template)]
#[template(path = "studies/run/words/words.txt")]
pub(super) struct Words<'a> {
    pub computed: ComputedRun<'a>,
    pub summary: &'a Summary<'a>,
    pub impacts: &'a NotableImpacts,
    /// The models of motion of all runs whose words are printed together.
    pub all_models: &'a [&'static ModelKind],
}

/// Largest number of half cycles that are described.
const MAX_HALF_CYCLES: usize = 3;
/// Slips below this fraction of the thickness of a joint are not reported.
const LEAST_SLIP_RATIO: f64 = 1e-6;
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

impl<'a> Words<'a> {
    /// Returns true if no block moved until the end of the run.
    fn is_unmoved(&self) -> bool {
        let history = self.computed.history;
        match history.outcome {
            Outcome::NeverMoved => true,
            Outcome::Incomplete => history.largest_rotation_rad() == 0.0 && !self.has_slipped(),
            _ => false,
        }
    }

    /// Returns the time since which elastic joints that still move at the end only vibrate, in s; `None` for other outcomes.
    fn vibrates_since_s(&self) -> Option<f64> {
        caveats::vibrates_since_s(self.computed.history)
    }

    /// Returns true if the model moves a row of blocks, false for mechanisms.
    fn is_row(&self) -> bool {
        self.computed.model.row().is_some()
    }

    fn sliding(&self) -> Option<&'a Sliding> {
        self.computed.history.row()?.sliding.as_ref()
    }

    fn has_slipped(&self) -> bool {
        self.sliding()
            .is_some_and(|sliding| sliding.largest_offsets_m.iter().any(|slip_m| *slip_m > 0.0))
    }

    /// Returns true if a history has another verdict.
    fn differs(&self, other: &History) -> bool {
        Verdict::from(other.outcome) != Verdict::from(self.computed.history.outcome)
    }

    /// Returns the half cycles with the largest peaks that are printed as nonzero, in order of time.
    fn half_cycles(&self) -> Vec<&'a HalfCycle> {
        let row = self.summary.row.as_ref();
        row.map_or_else(Vec::new, |row| {
            largest(&row.half_cycles, |one| one.peak_rad)
        })
    }

    /// Returns the comparisons of these half cycles with the repetitions: first the certain ones, then the others.
    fn repeated<'r>(&self, all: &'r Repeatability) -> [Vec<&'r RepeatedHalfCycle>; 2] {
        let described = largest(&all.half_cycles, |cycle| cycle.own.peak_rad).into_iter();
        let (same, differ) = described.partition(|cycle| cycle.is_certain());
        [same, differ]
    }

    /// Returns the smallest and the largest value in all repetitions.
    fn range(&self, value: &RepeatedValue) -> String {
        range_ends([value.min, value.max], 6).join(" to ")
    }

    /// Returns the first impact, and the impact of a row that takes the most energy. Impacts after overturning do not count.
    fn notable(&self) -> [Option<&'a (f64, Impact)>; 2] {
        let until_s = self.computed.history.overturned_s();
        let until_s = until_s.unwrap_or(f64::INFINITY);
        let NotableImpacts(impacts) = self.impacts;
        let before = || impacts.iter().filter(|(time_s, _)| *time_s <= until_s);
        let hardest = before().next_back().filter(|_| before().count() > 1);
        let hardest = hardest.filter(|_| self.is_row());
        [before().next(), hardest]
    }

    /// Returns the fraction of the energy that an impact keeps. "1.0000" appears only if the impact takes no energy.
    fn restitution_text(&self, impact: &Impact) -> String {
        match format!("{:.4}", impact.restitution) {
            all if impact.restitution < 1.0 && all == "1.0000" => "above 0.9999".to_owned(),
            kept => kept,
        }
    }

    /// Returns the numbers of the joints of these hinges, as the subject of a verb; consecutive joints as `3-7`.
    fn joints(&self, hinges: &[Hinge], verb: &str) -> String {
        let mut runs: Vec<[usize; 2]> = Vec::new();
        for hinge in hinges {
            if let Hinge::Joint { joint, .. } = *hinge {
                match runs.last_mut() {
                    Some([_, last]) if *last + 1 == joint => *last = joint,
                    _ => runs.push([joint, joint]),
                }
            }
        }
        let names = runs.into_iter().map(|[first, last]| match last - first {
            0 => first.to_string(),
            1 => format!("{first}, {last}"),
            _ => format!("{first}-{last}"),
        });
        let names = names.collect::<Vec<_>>().join(", ");
        match hinges.len() {
            0 => String::new(),
            1 => format!("joint {names} {verb}s, "),
            _ => format!("joints {names} {verb}, "),
        }
    }

    fn peaks_by_body(&self) -> String {
        let ComputedRun { model, history, .. } = self.computed;
        by_body(&model.bodies(), &history.peak_rotations_rad)
    }

    /// Returns the joints that slipped, the largest slip first.
    fn slips(&self) -> Vec<Slip> {
        let row = self.computed.model.row();
        let joints = row.zip(self.sliding()).into_iter();
        let joints = joints.flat_map(|(row, sliding)| {
            let slips = sliding.largest_offsets_m.iter().zip(&sliding.offsets_m);
            row.joints.iter().zip(slips).enumerate()
        });
        let slipped = joints.filter(|(_, (joint, (largest_m, _)))| {
            **largest_m > LEAST_SLIP_RATIO * joint.thickness_m()
        });
        let mut slips: Vec<Slip> = slipped
            .map(|(joint, (_, (largest_m, end_m)))| Slip {
                joint,
                largest_mm: 1e3 * largest_m,
                end_mm: 1e3 * end_m.abs(),
            })
            .collect();
        slips.sort_by(|a, b| b.largest_mm.total_cmp(&a.largest_mm));
        slips
    }

    /// Returns the largest final slip of these joints, in mm.
    fn largest_final_slip_mm(&self, slips: &[Slip]) -> f64 {
        slips.iter().map(|slip| slip.end_mm).fold(0.0, f64::max)
    }

    /// Returns the acceleration that starts the structure; `None` if it differs between the sides.
    fn common_start_g(&self) -> Option<f64> {
        let Sides { right, left } = self.summary.incipient_acceleration_g;
        right.filter(|right| left.is_some_and(|left| (right - left).abs() <= 1e-9 * right))
    }

    fn in_g(&self, acceleration_m_s2: f64) -> f64 {
        acceleration_m_s2 / self.computed.scenario.gravity_m_s2()
    }

    /// Returns the largest horizontal and vertical acceleration of the ground until a time, in units of gravity.
    fn peaks_g(&self, until_s: &f64) -> Vector2<f64> {
        let ground = self.computed.scenario.ground_motion();
        ground.peaks_m_s2(*until_s).map(|peak| self.in_g(peak))
    }

    /// Returns each side to which the ground pushes, the largest push, and the push that starts the structure to that side, in units of gravity.
    fn pushes_g(&self) -> Vec<(Sway, f64, Option<f64>)> {
        let ground = self.computed.scenario.ground_motion();
        let [right, left] = ground.pushes_m_s2(self.computed.history.end_s);
        let starts_g = self.summary.incipient_acceleration_g;
        let sides = [
            (Sway::Right, self.in_g(right), starts_g.right),
            (Sway::Left, self.in_g(left), starts_g.left),
        ];
        let pushed = sides.into_iter().filter(|(_, push_g, _)| *push_g > 0.0);
        pushed.collect()
    }

    /// Returns the ratio of a push to the push that starts the structure, in words; empty if the structure starts at zero push.
    fn times(&self, push_g: &f64, starts_g: &f64) -> String {
        match push_g / starts_g {
            times if times.is_finite() => format!(", {times:.2} times as much"),
            _ => String::new(),
        }
    }

    /// Returns true if the right foot has a record.
    fn is_recorded(&self) -> bool {
        let right = self.computed.scenario.right_foot.as_ref();
        right.is_some_and(|right| right.record().is_some())
    }

    /// Returns the feet whose records end before the ground stops, with the times.
    fn ended_records(&self) -> Vec<(&'static str, f64)> {
        let ground = self.computed.scenario.ground_motion();
        let feet = ["left", "right"].into_iter().zip(ground.ends_s());
        feet.filter(|(_, at_s)| *at_s < ground.end_s()).collect()
    }

    /// Returns true for free hinges without a comparison with elastic joints.
    fn lacks_elastic_joints(&self) -> bool {
        self.computed.scenario.motion.kind == &FREE_HINGES
            && !self.all_models.contains(&&ELASTIC_JOINTS)
    }

    /// Returns the limits of four links, or of a column on its toe, in parts of a sentence; `None` if no friction is reported.
    fn limits(&self) -> Option<Vec<String>> {
        let (scenario, history) = (self.computed.scenario, self.computed.history);
        if self.is_row() {
            return self.sliding().is_none().then(Vec::new);
        }
        // Advises to compare with free hinges only if the comparison was not requested.
        let compared = self.all_models.contains(&&FREE_HINGES);
        let advice = (!compared).then_some("compare with --hinges both");
        caveats::four_link_limits(history, &scenario.structure, advice)
    }

    fn coefficient(&self, friction: &f64) -> String {
        caveats::coefficient(*friction, 3)
    }

    fn place(&self, x_m: &f64, y_m: &f64) -> String {
        place(Vector2::new(*x_m, *y_m))
    }
}

/// Returns the values with the largest peaks that are printed as nonzero, in their order.
fn largest<T>(cycles: &[T], peak_rad: impl Fn(&T) -> f64) -> Vec<&T> {
    let mut rocking: Vec<usize> = (0..cycles.len())
        .filter(|index| peak_rad(&cycles[*index]) > STRAIGHT_RAD)
        .collect();
    rocking.sort_by(|a, b| peak_rad(&cycles[*b]).total_cmp(&peak_rad(&cycles[*a])));
    rocking.truncate(MAX_HALF_CYCLES);
    rocking.sort_unstable();
    rocking.into_iter().map(|index| &cycles[index]).collect()
}

/// Impacts that may be described, with their times: the first impact, and each impact that takes more energy than all before.
#[derive(Default)]
pub(super) struct NotableImpacts(Vec<(f64, Impact)>);

impl NotableImpacts {
    pub(super) fn note(&mut self, event: &Event) {
        let (time_s, Some(impact)) = (event.time_s, &event.impact) else {
            return;
        };
        let hardest = self.0.last();
        if hardest.is_none_or(|(_, hardest)| energy_loss_j(impact) > energy_loss_j(hardest)) {
            self.0.push((time_s, impact.clone()));
        }
    }
}
