//! Reports a run in words: what happened, when, and how it compares.

use std::fmt::Write as _;

use super::Shown;
use super::feet::FeetApart;
use super::verdict::{Evidence, no_verdict};
use crate::argument::fixed;
use crate::dynamics::free_hinges::DOUBTFUL_ENERGY_ERROR;
use crate::dynamics::history::{
    ElasticSummary, Event, Impact, Outcome, Sliding, Stress, Summary, TieSummary,
};
use crate::dynamics::model::{MechanismModel, Model};
use crate::dynamics::peak::Peak;
use crate::dynamics::repeatability::{
    Repeatability, RepeatedHalfCycle, RepeatedValue, SAME_PEAK_RATIO, Verdict,
};
use crate::dynamics::thrust::{EXCESS_LEVELS, ThrustRecord};
use crate::dynamics::variation::Varied;
use crate::mechanics::blocks::Row;
use crate::mechanics::chain::Hinge;
use crate::mechanics::sway::Sway;
use crate::output::mechanisms::by_body;
use crate::output::range_ends;
use crate::scenario::{Hinges, Scenario, Series, Structure};

/// The heading of the words for the runs of a scenario: its title, and the records that shake it, one line each.
#[must_use]
pub fn heading(scenario: &Scenario) -> String {
    let title = scenario.title();
    let mut text = title.map_or(String::new(), |title| format!("{title}\n"));
    text.extend(scenario.series().map(|series: &Series| {
        let (file, sampling) = (series.name(), series.sampling());
        let peak_g = series.peak_g(scenario.gravity_m_s2());
        format!("  {file}: {sampling}, peak {peak_g:.4} g as scaled\n")
    }));
    text
}

/// The report of a run: the verdict, what happened, how that compares, how sure it is, and how it was computed.
pub(super) fn words(
    evidence: &Evidence<'_>,
    model: &dyn Model,
    shown: &Shown,
    beside: &[Hinges],
) -> String {
    let Evidence {
        scenario,
        history,
        spread,
        varied,
    } = *evidence;
    let impacts = &shown.notable;
    let row = history.row();
    let sliding = row.and_then(|row| row.sliding.as_ref());
    let mut text = evidence.in_words();
    text += &outcome(history);
    if let Some(model) = model.as_mechanisms() {
        text += &of_mechanisms(model, history, impacts);
    } else {
        text += &of_row(history, impacts);
    }
    text += &shown.points.words();
    if let (Some(row), Some(sliding)) = (model.row(), sliding) {
        text += &slips(row, sliding, history.outcome);
    }
    text += &incipient(scenario, model, history);
    text += &feet(scenario, history);
    if sliding.is_none() {
        text += &trusted(scenario, model, history, beside);
    }
    if let Some(elastic) = history.elastic() {
        text += &of_elastic_joints(scenario, elastic);
    }
    text += &row.map_or(String::new(), |row| of_ties(&row.ties));
    match spread {
        Some(Ok(spread)) if !is_unmoved(history) => text += &sure(spread),
        Some(Err(reason)) => {
            let _ = writeln!(
                text,
                "  how far it depends on its steps is not known: {reason}"
            );
        }
        _ => {}
    }
    text += &variations(history, varied);
    let compared = beside.contains(&Hinges::Elastic);
    if scenario.motion().hinges() == Hinges::Free && !compared {
        text += "  rigid joints, while those of stone give way: compare with --hinges elastic\n";
    }
    text += &computed(scenario, model, history);
    text
}

/// How far the model can be trusted, and the friction that it presupposes.
fn trusted(scenario: &Scenario, model: &dyn Model, history: &Summary, beside: &[Hinges]) -> String {
    let Some(thrust) = &history.thrust else {
        return String::new();
    };
    let trust = match model.as_mechanisms() {
        Some(_) => {
            // No advice to do what is already done.
            let compared = beside.contains(&Hinges::Free);
            let advice = (!compared).then_some("compare with --hinges both");
            trust(thrust, scenario.structure(), advice)
        }
        None => Some(String::new()),
    };
    let Some(trust) = trust else {
        return String::new();
    };
    let Peak { value, time_s } = thrust.largest_friction;
    let [low, high] = STONE_FRICTION;
    let compared = if value > low {
        let slip = match scenario.motion().hinges() {
            Hinges::Four => "[free_hinges] with `friction_coefficient` lets",
            Hinges::Free => "`friction_coefficient` in [free_hinges] lets",
            Hinges::Elastic => "`friction_coefficient` in [elastic_joints] lets",
        };
        format!(";\n    stone has {low} to {high}: {slip} joints slip")
    } else {
        String::new()
    };
    format!(
        "{trust}  friction coefficient needed to prevent sliding: {} (at {time_s:.4} s){compared}\n",
        friction(value, 3)
    )
}

/// Coefficients of friction of stone on stone: the smallest and the largest that can be relied on.
const STONE_FRICTION: [f64; 2] = [0.5, 0.8];

/// A coefficient of friction with so many decimals. One that nothing has stands for a joint that hardly presses.
fn friction(coefficient: f64, decimals: usize) -> String {
    if coefficient > 10.0 {
        "more than 10".to_owned()
    } else {
        format!("{coefficient:.decimals$}")
    }
}

/// The friction that a motion without sliding needs, if stone may not have it.
pub(super) fn needs(scenario: &Scenario, history: &Summary) -> Option<String> {
    let slips = scenario.motion().friction_coefficient().is_some();
    let needed = history
        .thrust
        .as_ref()
        .filter(|_| !slips)?
        .largest_friction
        .value;
    let [low, high] = STONE_FRICTION;
    if needed > high {
        return Some(format!(
            "would slide: needs a friction of {}, and stone has {low} to {high}",
            friction(needed, 2)
        ));
    }
    (needed > low).then(|| format!("needs a friction of {needed:.2}"))
}

/// A fraction in percent, rounded down, so that a limit that was not reached does not read as reached.
pub(super) fn in_percent(part: f64) -> String {
    match (100.0 * part).floor() {
        percent if percent < 1.0 => "below 1 %".to_owned(),
        percent => format!("{percent} %"),
    }
}

/// How accurately the motion was computed, and in how many steps.
fn computed(scenario: &Scenario, model: &dyn Model, history: &Summary) -> String {
    if is_unmoved(history) {
        return String::new();
    }
    let (defect, steps) = (history.energy_defect_ratio, history.cost.steps);
    let evaluations = history.cost.evaluations;
    let row = match (history.row(), model.as_mechanisms()) {
        (Some(row), None) => row,
        _ => {
            return format!(
                "  energy defect {defect:.1e} of the first mechanism's barrier, {steps} steps, {evaluations} evaluations\n"
            );
        }
    };
    let mut text = format!("  energy defect {defect:.1e} of weight times size, {steps} steps");
    if history.elastic().is_none() {
        let _ = write!(text, ", {evaluations} iterations");
    }
    if row.halvings > 0 {
        let times = if row.halvings > 1 {
            format!("{} times", row.halvings)
        } else {
            "once".to_owned()
        };
        let _ = write!(text, ", halved {times} where the energy balance needed it");
    }
    text.push('\n');
    if row.energy_error > DOUBTFUL_ENERGY_ERROR {
        let _ = writeln!(
            text,
            "  that is {:.2} % of the largest energy of the motion: a smaller longest_step_s in [{}] reduces it",
            1e2 * row.energy_error,
            scenario.motion().table_name()
        );
    }
    text
}

/// How the motion ends with other properties.
fn variations(own: &Summary, varied: &[Varied]) -> String {
    let mut text = String::new();
    for Varied { name, result } in varied {
        let _ = match result {
            Ok(other) => {
                let other_verdict = Verdict::from(other.outcome) != Verdict::from(own.outcome);
                let but = if other_verdict { "BUT " } else { "" };
                writeln!(text, "  {but}with {name}: {}", ended(other))
            }
            Err(reason) => writeln!(text, "  with {name}: {reason}"),
        };
    }
    text
}

/// How a motion ended, and its largest rotation.
fn ended(history: &Summary) -> String {
    let ends = match history.outcome {
        Outcome::Overturned(sway) => {
            let time_s = history.outcome_time_s;
            return format!("overturns to the {} at {time_s:.4} s", sway.name());
        }
        Outcome::NeverMoved => return "never moves".to_owned(),
        Outcome::Vibrates => return "vibrates without opening".to_owned(),
        Outcome::Incomplete => "has no verdict, because the run ends too early",
        Outcome::Rest | Outcome::StillRocking => "survives",
    };
    match history.largest_rotation_rad() {
        peak_rad if peak_rad > STRAIGHT_RAD => {
            format!("{ends}, largest rotation {peak_rad:.6} rad")
        }
        _ => ends.to_owned(),
    }
}

/// Peak of the first half cycle that rocks.
pub(super) fn first_peak_rad(history: &Summary) -> Option<f64> {
    let cycles = history.half_cycles().into_iter();
    let mut peaks = cycles.map(|cycle| cycle.peak_rad);
    peaks.find(|peak_rad| *peak_rad > STRAIGHT_RAD)
}

/// The report on the motion of mechanisms.
fn of_mechanisms(model: &dyn MechanismModel, history: &Summary, impacts: &Notable) -> String {
    let mut text = String::new();
    if let [Some((time_s, impact)), _] = impacts.of(history) {
        let _ = writeln!(
            text,
            "  first impact at {time_s:.4} s, restitution (energy after/before) {}",
            kept(impact.restitution),
        );
    }
    if is_unmoved(history) {
        return text;
    }
    let _ = writeln!(
        text,
        "  peak rotation in rad: {}",
        by_body(&model.bodies(), &history.peak_rotations_rad),
    );
    if let Some(peak) = history.peak_over_critical() {
        text += &reached(
            history.outcome,
            peak,
            "passed the unstable rotation of the mechanism that moved",
            "the unstable rotation of the mechanism that moved",
        );
    }
    text
}

/// Whether nothing moved, as far as the run went.
pub(super) fn is_unmoved(history: &Summary) -> bool {
    match history.outcome {
        Outcome::NeverMoved => true,
        Outcome::Incomplete => history.largest_rotation_rad() == 0.0 && !has_slipped(history),
        _ => false,
    }
}

/// Whether a joint slipped.
fn has_slipped(history: &Summary) -> bool {
    let sliding = history.row().and_then(|row| row.sliding.as_ref());
    sliding.is_some_and(|sliding| sliding.largest_offsets_m.iter().any(|slip_m| *slip_m > 0.0))
}

/// How far the motion went: it `passed` the point from which gravity alone overturns the structure, or reached a part of the way.
fn reached(outcome: Outcome, peak: f64, passed: &str, of: &str) -> String {
    match outcome {
        // How far it fell before the run ended means nothing; it may have overturned by another mechanism.
        Outcome::Overturned(_) => format!("  {passed}\n"),
        _ => {
            // Rounded down, so that a limit that was not reached does not read as reached.
            let percent = (1e3 * peak).floor() / 10.0;
            format!("  reached {percent:.1} % of {of}\n")
        }
    }
}

/// The report on the motion of a row.
fn of_row(history: &Summary, impacts: &Notable) -> String {
    let mut text = String::new();
    let [first, hardest] = impacts.of(history);
    if let Some((time_s, impact)) = first {
        let _ = writeln!(text, "  first impact at {time_s:.4} s: {}", landing(impact));
    }
    if let Some((time_s, impact)) = hardest.filter(|_| hardest != first) {
        let _ = writeln!(
            text,
            "  largest loss in one impact at {time_s:.4} s: {}",
            landing(impact)
        );
    }
    if is_unmoved(history) {
        return text;
    }
    let cycles = history.half_cycles();
    let cycles: Vec<_> = largest(&cycles, |cycle| cycle.peak_rad)
        .map(|cycle| {
            let (side, peak_rad) = (cycle.sway.name(), cycle.peak_rad);
            format!("{side} {peak_rad:.6} (at {:.4} s)", cycle.peak_time_s)
        })
        .collect();
    if !cycles.is_empty() {
        let cycles = cycles.join(", ");
        let _ = writeln!(text, "  largest half cycles in rad: {cycles}");
    }
    let peak = history.largest_rotation_rad();
    if peak <= STRAIGHT_RAD && has_slipped(history) {
        text += "  slides without rocking\n";
    } else if peak <= STRAIGHT_RAD {
        text += "  rotates by less than 0.000001 rad\n";
    } else {
        let _ = writeln!(
            text,
            "  largest rotation {peak:.6} rad, of block {} of {}",
            history.largest_body() + 1,
            history.peak_rotations_rad.len()
        );
    }
    if let Some(peak) = history.peak_potential_over_barrier() {
        text += &reached(
            history.outcome,
            peak,
            "passed the barrier beyond which it overturns",
            match history.elastic() {
                None => "the potential energy at which its first mechanism overturns",
                Some(_) => {
                    "the potential energy at which its first mechanism overturns with rigid joints"
                }
            },
        );
    }
    text
}

/// At this distance from the middle, in thicknesses of a joint, the thrust of a row at rest is close to the edge.
const NEAR_EDGE_RATIO: f64 = 0.4;

/// The report on elastic joints.
fn of_elastic_joints(scenario: &Scenario, elastic: &ElasticSummary) -> String {
    let Stress {
        stress_pa,
        joint,
        time_s,
    } = elastic.largest_stress;
    let mut text = format!(
        "  largest elastic compressive stress {:.3} MPa, at joint {joint} (at {time_s:.4} s)",
        1e-6 * stress_pa
    );
    if let Some(strength_mpa) = scenario.motion().compressive_strength_mpa() {
        let _ = write!(
            text,
            "; the strength is {strength_mpa:?} MPa, which caps it together with the stress of damping"
        );
    }
    let _ = writeln!(
        text,
        "\n  damping took {:.3} J, friction {:.3} J, crushing {:.3} J",
        elastic.damped_j, elastic.friction_j, elastic.crushed_j
    );
    let ratio = elastic.rest_eccentricity_ratio;
    if ratio > NEAR_EDGE_RATIO {
        let joint = elastic.rest_eccentricity_joint;
        let _ = writeln!(
            text,
            "  at rest the thrust lies {ratio:.3} t from the middle of joint {joint}: everything depends on how stiff the joints are"
        );
    }
    text
}

/// What is said of ties.
fn of_ties(ties: &[TieSummary]) -> String {
    let mut text = String::new();
    for (number, tie) in (1..).zip(ties) {
        let _ = write!(
            text,
            "  tie {number} pulled with {:.3} kN at most (at {:.4} s)",
            1e-3 * tie.peak_force_n,
            tie.peak_force_time_s
        );
        if let Some(time_s) = tie.yielded_s {
            let _ = write!(
                text,
                "; it yielded from {time_s:.4} s on, by {:.3} mm in all",
                1e3 * tie.yielded_m
            );
        }
        if let Some(time_s) = tie.broken_s {
            let _ = write!(text, "; it broke at {time_s:.4} s");
        }
        if tie.taken_j > 0.0 {
            let _ = write!(text, "; that took {:.3} J", tie.taken_j);
        }
        text.push('\n');
    }
    text
}

/// Number of half cycles that are described.
const DESCRIBED: usize = 3;

/// The half cycles with the largest peaks that are not zero in print, in order of time.
fn largest<T>(cycles: &[T], peak_rad: impl Fn(&T) -> f64) -> impl Iterator<Item = &T> {
    let mut rocking: Vec<usize> = (0..cycles.len())
        .filter(|index| peak_rad(&cycles[*index]) > STRAIGHT_RAD)
        .collect();
    rocking.sort_by(|a, b| peak_rad(&cycles[*b]).total_cmp(&peak_rad(&cycles[*a])));
    rocking.truncate(DESCRIBED);
    rocking.sort_unstable();
    rocking.into_iter().map(|index| &cycles[index])
}

/// A block that rotates by no more than this slides straight on: in print, the rotation is zero.
const STRAIGHT_RAD: f64 = 5e-7;

/// Impacts that are described, with their times: the first, and then each that takes more energy than all before.
#[derive(Default)]
pub(super) struct Notable(Vec<(f64, Impact)>);

impl Notable {
    pub(super) fn note(&mut self, event: &Event) {
        let (time_s, Some(impact)) = (event.time_s, &event.impact) else {
            return;
        };
        let hardest = self.0.last();
        if hardest.is_none_or(|(_, hardest)| taken_j(impact) > taken_j(hardest)) {
            self.0.push((time_s, impact.clone()));
        }
    }

    /// The first impact, and the one that takes the most energy; those after overturning do not count.
    fn of(&self, history: &Summary) -> [Option<&(f64, Impact)>; 2] {
        let until_s = history.overturned_s().unwrap_or(f64::INFINITY);
        let before = || self.0.iter().filter(|(time_s, _)| *time_s <= until_s);
        [before().next(), before().next_back()]
    }
}

/// Energy lost in an impact, in J.
pub(super) fn taken_j(impact: &Impact) -> f64 {
    impact.energy_before_j - impact.energy_after_j
}

/// How the history ended.
fn outcome(history: &Summary) -> String {
    let time_s = history.outcome_time_s;
    let elastic = history.elastic();
    let impacts = match history.impacts {
        // Elastic joints have no impacts.
        _ if elastic.is_some() => String::new(),
        0 => " without impact".to_owned(),
        1 => " after 1 impact".to_owned(),
        count => format!(" after {count} impacts"),
    };
    match history.outcome {
        Outcome::NeverMoved => "  never moved\n".to_owned(),
        Outcome::Vibrates => "  vibrated, and no joint opened\n".to_owned(),
        Outcome::Incomplete if is_unmoved(history) => {
            format!("  nothing moved until {time_s:.4} s\n")
        }
        Outcome::Incomplete => format!("  incomplete: the run ended at {time_s:.4} s{impacts}\n"),
        Outcome::Rest => format!("  came to rest at {time_s:.4} s{impacts}\n"),
        Outcome::Overturned(sway) => {
            let sway = sway.name();
            format!("  overturned to the {sway} at {time_s:.4} s{impacts}\n")
        }
        Outcome::StillRocking => format!("  still rocking at {time_s:.4} s{impacts}\n"),
    }
}

/// The acceleration that starts the structure to either side, compared with that of the ground.
fn incipient(scenario: &Scenario, model: &dyn Model, history: &Summary) -> String {
    let sides = [Sway::Right, Sway::Left];
    let incipient_g = sides.map(|sway| model.incipient_acceleration_g(sway));
    let incipient = match scenario.motion().friction_coefficient() {
        None => "incipient acceleration A_L",
        Some(_) => "incipient acceleration with friction",
    };
    let ground = scenario.ground_motion();
    let of_gravity = |acceleration_m_s2: f64| acceleration_m_s2 / scenario.gravity_m_s2();
    let peaks_g = ground.peaks_m_s2(history.end_s).map(of_gravity);
    let whole_g = of_gravity(ground.peaks_m_s2(f64::INFINITY).x);
    // A record may continue after the motion ends.
    let until = match history.outcome {
        _ if peaks_g.x >= whole_g => "",
        Outcome::Overturned(_) => " until it overturned",
        _ => " until the end of the run",
    };
    let (starts, compared) = match incipient_g {
        [Some(right), Some(left)] if (right - left).abs() <= 1e-9 * right => {
            (format!("{right:.4} g"), times(peaks_g.x, right))
        }
        [None, None] => ("none, no push starts it".to_owned(), String::new()),
        _ => {
            let named = sides.iter().zip(incipient_g).map(|(sway, starts_g)| {
                let to = sway.name();
                starts_g.map_or(format!("none to the {to}"), |starts_g| {
                    format!("{starts_g:.4} g to the {to}")
                })
            });
            let pushes_g = ground.pushes_m_s2(history.end_s).map(of_gravity);
            let pushes = sides.iter().zip(pushes_g.into_iter().zip(incipient_g));
            let pushes = pushes.filter(|(_, (push_g, _))| *push_g > 0.0);
            let pushes = pushes.map(|(sway, (push_g, starts_g))| {
                let times = starts_g.map_or(String::new(), |starts_g| times(push_g, starts_g));
                format!(", pushes to the {} with {push_g:.4} g{times}", sway.name())
            });
            let named = named.collect::<Vec<_>>().join(", ");
            (named, pushes.collect())
        }
    };
    let mut reaches = if peaks_g.x > 0.0 {
        format!("reaches {:.4} g{until}{compared}", peaks_g.x)
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
    format!("  {incipient} {starts}; the ground {reaches}\n")
}

/// How many times as strong a push is as the one that starts the structure. Any push starts a structure on hinges that ties hold.
fn times(push_g: f64, incipient_g: f64) -> String {
    let times = push_g / incipient_g;
    if times.is_finite() {
        format!(", {times:.2} times as much")
    } else {
        String::new()
    }
}

/// How far the right foot goes from the left one.
fn feet(scenario: &Scenario, history: &Summary) -> String {
    let Some(apart) = FeetApart::of(scenario, history) else {
        return String::new();
    };
    let FeetApart {
        farthest_m,
        farthest_s,
        last_m,
    } = apart;
    let [right_m, up_m] = [last_m.x, last_m.y].map(|m| fixed(m, 5));
    let mut text = format!(
        "  the right foot goes {:.5} m away from where it was beside the left one (at {farthest_s:.4} s), and ends {} m to the right and {} m \
         above it",
        farthest_m.norm(),
        right_m,
        up_m
    );
    let ground = scenario.ground_motion();
    if ground.start_s() < 0.0 {
        let _ = write!(
            text,
            ";\n    the right foot moves first: the history begins at {:.4} s, before time 0 of the left foot",
            ground.start_s()
        );
    }
    if scenario
        .right_foot()
        .is_some_and(|right| right.record().is_some())
    {
        text += ":\n    that is what the records say, with no baseline corrected";
        for (foot, at_s) in ["left", "right"].into_iter().zip(ground.ends_s()) {
            if at_s < ground.end_s() {
                let _ = write!(
                    text,
                    ";\n    the record of the {foot} foot ends at {at_s:.4} s, the other at {:.4} s: from there on that foot stays where it is",
                    ground.end_s()
                );
            }
        }
    }
    if let Some(row) = history.row() {
        let _ = write!(
            text,
            "\n  beside the left foot, the shaken ground worked {:.3} J, and the right foot {:.3} J",
            row.ground_j, row.right_foot_j
        );
    }
    text.push('\n');
    text
}

/// Warnings about a run: unlikely numbers of its scenario, and what limits the trust in its history. Programs and the Python package issue
/// them, so they name no options.
#[must_use]
pub fn warnings(scenario: &Scenario, model: &dyn Model, history: &Summary) -> Vec<String> {
    let mut warnings = scenario.unlikely_of(model);
    let structure = scenario.structure();
    // The ground cannot hold a column down; an arch is four links as long as its line of thrust stays almost inside.
    let most = if structure.thrusts() {
        EXCESS_LEVELS[1]
    } else {
        0.0
    };
    let thrust = history
        .thrust
        .as_ref()
        .filter(|_| model.as_mechanisms().is_some());
    let leaves = thrust.filter(|thrust| thrust.largest_excess.value > most);
    let caveats = [
        (history.outcome == Outcome::Incomplete).then(|| no_verdict(scenario, history)),
        leaves.and_then(|thrust| trust(thrust, structure, Some("compare with free hinges"))),
        needs(scenario, history),
    ];
    // Words of the report, whose lines are indented.
    let caveats = caveats.into_iter().flatten();
    let caveats = caveats.map(|caveat| caveat.split_whitespace().collect::<Vec<_>>().join(" "));
    warnings.extend(caveats.filter(|caveat| !caveat.is_empty()));
    warnings
}

/// How far the motion can be trusted to be that of four links, or of a column on its toe, with advice where four links are not enough; `None`
/// if it did not rock.
fn trust(thrust: &ThrustRecord, structure: &Structure, advice: Option<&str>) -> Option<String> {
    let [_, near] = thrust.shares_within()?;
    let Peak { value, time_s } = thrust.largest_excess;
    let [close, most] = EXCESS_LEVELS;
    if !structure.thrusts() {
        let flies = format!(
            "  the ground would have to hold the column down (at {time_s:.4} s): it flies off\n"
        );
        return Some(if value > 0.0 { flies } else { String::new() });
    }
    if value <= close {
        return Some(format!(
            "  four links suffice: the thrust line leaves the arch by {value:.4} t at most\n"
        ));
    }
    let grade = if value <= most {
        "four links are close"
    } else {
        "four links are a rough guide, not on the safe side"
    };
    let give = match structure.circular() {
        Some(arch) if arch.voussoirs.is_none() => "give `voussoirs` and ",
        _ => "",
    };
    let compare = advice.map_or(String::new(), |advice| format!("; {give}{advice}"));
    Some(format!(
        "  {grade}: the thrust line leaves the arch by up to {value:.3} t (at {time_s:.4} s),\n    and stays within {most} t \
         for {:.1} % of the rocking time{compare}\n",
        100.0 * near
    ))
}

/// Slips below this fraction of the thickness of a joint are not reported.
const LEAST_SLIP_RATIO: f64 = 1e-6;
/// Number of joints whose slips are reported.
const SLIPPED: usize = 4;

/// Which joints slipped, the slip that remains, and the energy lost in friction.
fn slips(row: &Row, sliding: &Sliding, outcome: Outcome) -> String {
    let joints = row.joints.iter().zip(&sliding.largest_offsets_m);
    let mut slipped: Vec<(usize, f64, f64)> = joints
        .zip(&sliding.offsets_m)
        .enumerate()
        .filter(|(_, ((joint, largest_m), _))| **largest_m > LEAST_SLIP_RATIO * joint.thickness_m())
        .map(|(index, ((_, largest_m), end_m))| (index, *largest_m, *end_m))
        .collect();
    slipped.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut text =
        match &slipped[..] {
            [] if matches!(outcome, Outcome::Overturned(_)) => {
                "  no joint slipped before it overturned".to_owned()
            }
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
    if let Outcome::Overturned(_) = outcome {
        text += " with the fall";
    }
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

/// The joints that close and open at an impact.
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
    text += "energy after/before ";
    text + &kept(impact.restitution)
}

/// The part of the energy that an impact keeps. One that takes energy does not read as if it took none.
fn kept(ratio: f64) -> String {
    match format!("{ratio:.4}") {
        all if ratio < 1.0 && all == "1.0000" => "above 0.9999".to_owned(),
        kept => kept,
    }
}

/// Numbers of the joints of these hinges; neighbours as `3-7`.
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

/// Which results the repetitions confirm.
fn sure(spread: &Repeatability) -> String {
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
    let percent = 100.0 * SAME_PEAK_RATIO;
    let described = largest(&spread.half_cycles, |cycle| cycle.own.peak_rad);
    let (same, differ): (Vec<_>, Vec<_>) = described.partition(|cycle| cycle.is_certain());
    let count = same.len() + differ.len();
    if count == 0 {
        text.push('\n');
        return text;
    }
    let (one, of) = (same.len() == 1, count == 1);
    let _ = match (same.len(), differ.len()) {
        (0, _) => Ok(()),
        (_, 0) if of => write!(text, ", peak of the largest half cycle within {percent} %"),
        (all, 0) => write!(
            text,
            ", peaks of the {all} largest half cycles within {percent} %"
        ),
        (some, _) => write!(
            text,
            ", peak{} of {some} of the {count} largest half cycles within {percent} %",
            if one { "" } else { "s" }
        ),
    };
    if let Some(time_s) = spread.parts_at_s {
        let which = if differ.is_empty() {
            "smaller ones differ"
        } else {
            "they differ"
        };
        let _ = write!(text, ";\n    from {time_s:.4} s on {which}");
    }
    let differ: Vec<String> = differ
        .iter()
        .map(|cycle: &&RepeatedHalfCycle| {
            let (side, time_s) = (cycle.own.sway.name(), cycle.own.peak_time_s);
            match cycle.peak_rad {
                Some(peak) => format!("{side} {} rad (at {time_s:.4} s)", ends(&peak)),
                None => format!("{side} only in some (at {time_s:.4} s)"),
            }
        })
        .collect();
    if !differ.is_empty() {
        let _ = write!(text, ":\n    {}", differ.join(", "));
    }
    if let Some(largest) = spread.largest_rad {
        let _ = if largest.is_certain() {
            write!(text, "\n    largest rotation within {percent} %")
        } else {
            write!(text, "\n    LARGEST ROTATION {} rad", ends(&largest))
        };
    }
    if let Some(joint) = spread.uncertain_slip() {
        let [min_mm, max_mm] =
            [spread.slips_m[joint].min, spread.slips_m[joint].max].map(|m| 1e3 * m);
        let _ = write!(
            text,
            "\n    FINAL SLIP of joint {joint} {min_mm:.3} to {max_mm:.3} mm"
        );
    } else if spread.has_slipped() {
        let _ = write!(text, "\n    final slips within {percent} % of the largest");
    }
    text.push('\n');
    text
}

/// The least and the largest of a peak in all motions.
fn ends(peak: &RepeatedValue) -> String {
    let [min, max] = range_ends([peak.min, peak.max], 6);
    format!("{min} to {max}")
}

fn ending(outcome: Outcome) -> String {
    match outcome {
        Outcome::NeverMoved => "never moved".to_owned(),
        Outcome::Vibrates => "vibrated without opening".to_owned(),
        Outcome::Incomplete => "incomplete".to_owned(),
        Outcome::Rest => "rest".to_owned(),
        Outcome::Overturned(sway) => format!("overturned to the {}", sway.name()),
        Outcome::StillRocking => "still rocking".to_owned(),
    }
}
