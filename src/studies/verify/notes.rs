//! The decisions and assumptions of a check, and what it leaves out, in the words of its page.

use super::histories::{FOR_THE_MEAN, SPECTRUM_MARGIN};
use super::{Check, Spectrum, StateCheck};
use crate::scenario::{CONFIDENCE_FACTOR, Scenario, Sides};
use crate::studies::remarks::no_verdict;

/// Friction coefficient that the Circolare gives for walls (C8.7.1.2.1.2).
pub const FRICTION: f64 = 0.577;
/// Gravity of the codes, in m/s2.
const GRAVITY_M_S2: f64 = 9.81;
/// A smaller damping is probably a fraction instead of per cent.
const LEAST_DAMPING_PERCENT: f64 = 1.0;

/// The decisions where the text leaves a choice, each with its name.
#[must_use]
pub fn decisions(check: &Check) -> Vec<(&'static str, String)> {
    let settings = &check.settings;
    let has_curve = check.mechanisms.iter().any(|one| one.way.is_ok());
    let mut notes = vec![(
        "D1",
        "The blocks of the formulas are the rigid bodies of the mechanism, each lumped at its centre of gravity with what it \
         carries. Voussoirs lumped one by one would give a smaller e* and larger capacities."
            .to_owned(),
    )];
    if has_curve {
        notes.push((
            "D2",
            format!(
                "The control point is the common centre of the masses that move, so that d = d_C/e*. The ratio with the {} as control \
                 point is printed beside.",
                check.top
            ),
        ));
    }
    if !check.by_the_code() {
        notes.push((
            "S",
            "The spectra and what makes the limit states are the engineer's: no clause is named. The largest spectral displacement \
             up to the period counts; accelerations are divided as each state says, and displacements after the period is known."
                .to_owned(),
        ));
    }
    if check.by_the_code() && has_curve {
        notes.push((
            "D3",
            "The ground acceleration that is borne is a_g d/S_D(T): the spectrum keeps its shape. Where S_S and T_D follow a_g \
             (on the ground), the result is printed beside."
                .to_owned(),
        ));
    }
    if check
        .states
        .iter()
        .any(|one| matches!(one.spectrum, Spectrum::Floor(..)))
    {
        notes.push((
            "D4",
            "In the factor f of [C7.2.6] the damping of the building is a fraction; in per cent f would be below 1. The term 0.0004 \
             xi\u{b2} of [C7.2.7] takes per cent."
                .to_owned(),
        ));
        notes.push((
            "D5",
            "At a height the damage limit state takes a_Z of [C7.2.8]. In addition to the text, on the safe side, a_Z is at least \
             a_g S and S_eZ at least S_e at every period."
                .to_owned(),
        ));
    }
    if check.by_the_code() {
        notes.push((
            "D6",
            format!(
                "The simplified check of SLV takes q = {} times a_g,SLD as found with the spectrum of SLD.",
                settings.behaviour_factor
            ),
        ));
    }
    notes.push((
        "D7",
        "On rigid ground the bodies begin to move at alpha_0 g (A_L), which is less than a_0 = alpha_0 g/e*; both are printed. FC \
         1.35 covers e* above 0.74."
            .to_owned(),
    ));
    notes.push((
        "D8",
        match settings.sides {
            Sides::Both => "Both sides are checked, and the worse counts.".to_owned(),
            side => format!(
                "Only the side asked for is checked, {}: the engineer states that the other is held.",
                side.name()
            ),
        },
    ));
    if check.states.iter().any(|one| one.histories.is_some()) {
        notes.push(("D9", of_histories(check)));
    }
    if settings.confidence_factor != CONFIDENCE_FACTOR {
        notes.push((
            "FC",
            format!(
                "FC = {} is the engineer's. Where alpha_0 takes no account of the compressive strength the Circolare has that of \
                 LC1, 1.35, whatever is known.",
                settings.confidence_factor
            ),
        ));
    }
    if let Some(t0_s) = check.t0_s {
        notes.push((
            "T0",
            format!("Free to vibrate before it moves, with T_0 = {t0_s:.4} s and 5 % damping; SLD takes a_0/FC for a_y/FC."),
        ));
    } else {
        notes.push((
            "T0",
            "Rigid until it moves: held all along. For a wall or parapet free to vibrate give free_standing.".to_owned(),
        ));
    }
    notes
}

fn of_histories(check: &Check) -> String {
    let (clause, more) = if check.by_the_code() {
        (
            " (\u{a7} 7.3.5)",
            " C8.7.1.2.1.9 asks for more records than that, natural ones that match the spectrum and hold long periods: the engineer \
             answers for them.",
        )
    } else {
        ("", "")
    };
    format!(
        "Histories are of four-link mechanisms, one degree of freedom at a time, with losses at impacts only. That model is not on the \
         safe side: with joints that open and close at any time an arch may fall at weaker motions. Every record acts in either \
         direction, and the larger peak counts; after many impacts a peak may hang on the last digit of its record. Their displacement is the sum of m u over M*, that of the common centre over e* while \
         the first mechanism moves, and is compared with what that mechanism allows, though later ones reach farther. Where FC enters is not said: histories pass where they do with d and d_0 divided by FC; both are \
         printed. From {FOR_THE_MEAN} records on the mean of the peaks counts, with its 95 % interval, of fewer the largest{clause}.{more} They stand beside \
         the check by displacement, which is in bold: which one decides is the engineer's."
    )
}

/// The assumptions.
#[must_use]
pub fn assumptions(check: &Check) -> Vec<String> {
    let mut lines = vec![
        "The masonry does not disintegrate; the bodies are rigid, without tension between them, of unlimited compressive strength; \
         they move in one plane."
            .to_owned(),
        "The mechanism is the one of the least multiplier among all with hinges at the joints that are given, or anywhere where none \
         are."
            .to_owned(),
    ];
    lines.extend(check.mechanisms.iter().map(|one| {
        let side = one.sway.name();
        match &one.way {
            Ok(way) => {
                let friction = way.friction_up_to(check.furthest_part());
                format!("No joint slides: to the {side} that needs a friction coefficient of {friction:.3}; {}.", allowed(check))
            }
            Err(_) if one.slides_at_g.is_some() => format!("No joint slides: to the {side} that does not hold, see the warning."),
            Err(_) => format!(
                "No joint slides: to the {side} none does with a friction coefficient of {} (associated bound).",
                check.allowed_friction
            ),
        }
    }));
    lines
}

/// Warnings of assumptions that do not hold, and of input that is unlikely or ignored.
#[must_use]
pub fn warnings(scenario: &Scenario, check: &Check) -> Vec<String> {
    let slides = check.mechanisms.iter().filter_map(|one| {
        let friction = one.way.as_ref().ok()?.friction_up_to(check.furthest_part());
        (friction > check.allowed_friction).then(|| {
            format!(
                "To the {} the mechanism needs a friction coefficient of {friction:.3}, and {}: joints may slide before, which is \
                 not checked.",
                one.sway.name(),
                allowed(check)
            )
        })
    });
    let mut warnings: Vec<String> = slides.collect();
    warnings.extend(check.mechanisms.iter().filter_map(|one| {
        let (at_g, side) = (one.slides_at_g?, one.sway.name());
        Some(format!(
            "To the {side} joints slide at {at_g:.4} g at most with a friction coefficient of {} (associated bound), before the mechanism \
             starts at {:.4} g: the check takes them not to slide.",
            check.allowed_friction, one.alpha0
        ))
    }));
    if check.gravity_m_s2 != GRAVITY_M_S2 {
        warnings.push(format!(
            "Gravity is {} m/s2, not the {GRAVITY_M_S2} m/s2 of the codes.",
            check.gravity_m_s2
        ));
    }
    if scenario.uncertain().is_some() {
        warnings
            .push("[uncertain] is ignored: the check is of the scenario as written.".to_owned());
    }
    warnings.extend(check.states.iter().flat_map(small_dampings));
    for one in &check.states {
        let Some(histories) = &one.histories else {
            continue;
        };
        warnings.extend(
            no_verdict(histories.incomplete(), histories.records.len(), "records")
                .map(|words| format!("{}: {words}.", super::words::name(one.state))),
        );
        if let (Some(false), Some([least, largest])) =
            (histories.fits_the_spectrum(), histories.spectrum_ratios)
        {
            let [from_s, to_s] = histories.periods_s;
            let clause = if check.by_the_code() {
                "\u{a7} 3.2.3.6 has"
            } else {
                "it should be"
            };
            warnings.push(format!(
                "{}: the mean spectrum of the records at 5 % is {least:.2} to {largest:.2} times the one demanded, between {from_s:.2} \
                 and {to_s:.2} s; {clause} {} to {} over the periods of interest.",
                super::words::name(one.state),
                SPECTRUM_MARGIN[0],
                SPECTRUM_MARGIN[1]
            ));
        }
    }
    warnings
}

/// The friction coefficient that is allowed, with its source.
fn allowed(check: &Check) -> String {
    if check.allowed_friction < FRICTION {
        format!("the scenario has {}", check.allowed_friction)
    } else {
        format!("the Circolare has {FRICTION} for walls")
    }
}

/// Warnings of dampings of a limit state that are probably fractions instead of per cent.
fn small_dampings(one: &StateCheck) -> Vec<String> {
    let mut given: Vec<(&str, f64)> = match &one.spectrum {
        Spectrum::Ground(_) => Vec::new(),
        Spectrum::Floor(_, floor) => {
            let modes = floor.modes.iter();
            modes
                .map(|mode| ("a mode of the building", mode.damping_percent))
                .collect()
        }
        Spectrum::Points(points) => vec![("the spectrum", points.damping_percent)],
    };
    given.extend(one.rule.map(|rule| ("the mechanism", rule.damping_percent)));
    let small = given
        .into_iter()
        .filter(|(_, percent)| *percent < LEAST_DAMPING_PERCENT);
    small
        .map(|(of, percent)| {
            format!(
                "{}: the damping of {of} is {percent} %, which is unlikely: give it in per cent, 5 for 5 %.",
                super::words::name(one.state)
            )
        })
        .collect()
}

/// What the check does not cover.
#[must_use]
pub fn not_covered(scenario: &Scenario, check: &Check) -> Vec<String> {
    let thrusts = !scenario.structure().stands_on_one_support();
    let vertical = match (check.by_the_code(), thrusts) {
        (false, _) => "Vertical ground motion.",
        (true, false) => "Vertical ground motion: C8.7.1.2.1 has no vertical term.",
        (true, true) => {
            "Vertical ground motion: \u{a7} 7.2.2 asks for it for structures that thrust, where a_g is at least 0.15 g \
             (\u{a7} 3.2.3.1); C8.7.1.2.1 has no vertical term."
        }
    };
    let ties = if scenario.structure().ties().is_empty() {
        "Thrust of fill (its weight counts where it is given), crushing, soil and foundations, torsional hinges."
    } else {
        "The forces of ties beyond those at rest, and their anchorages; thrust of fill (its weight counts where it is \
         given), crushing, soil and foundations, torsional hinges."
    };
    [
        vertical,
        ties,
        "The choice of the mechanism beyond the joints that are given, and the building as a whole.",
    ]
    .map(str::to_owned)
    .to_vec()
}
