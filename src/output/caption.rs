//! One line with the input of a picture: the structure, the ground and the model of motion.

use crate::mechanics::four_link::impact::ImpactModel;
use crate::scenario::{Axis, Ground, Quantity, RightFoot, Scaling, Scenario, Series, four_digits};

/// The caption. It leaves out what varies along the axes.
#[must_use]
pub fn caption(scenario: &Scenario, axes: &[&Axis]) -> String {
    let varies = |quantities: &[Quantity], key: &str| {
        axes.iter()
            .any(|axis| quantities.contains(&axis.quantity) || axis.key == key)
    };
    let mut parts = vec![scenario.structure().caption(&varies)];
    parts.extend(ground(scenario, &varies));
    parts.push(model(scenario, &varies));
    parts.join("; ")
}

/// How the ground moves: the pulse, or the record with its scale; and how the right foot moves.
#[must_use]
pub fn ground_in_words(scenario: &Scenario) -> String {
    let words = ground(scenario, &|_, _| false);
    words.unwrap_or_else(|| "the ground stays still".to_owned())
}

fn ground(scenario: &Scenario, varies: &dyn Fn(&[Quantity], &str) -> bool) -> Option<String> {
    let left = of_left_foot(scenario, varies)?;
    let varies = |key: &str| varies(&[], &format!("ground.right.{key}"));
    let right = match scenario.right_foot() {
        None => return Some(left),
        Some(RightFoot::Late(delay_s)) if !varies("delay_s") => {
            let when = if *delay_s < 0.0 { "earlier" } else { "later" };
            format!("right foot {} s {when}", four_digits(delay_s.abs()))
        }
        Some(RightFoot::Wave(velocity_m_s)) if !varies("apparent_velocity_m_s") => {
            let speed_m_s = four_digits(velocity_m_s.abs());
            let side = if *velocity_m_s < 0.0 {
                " to the left"
            } else {
                ""
            };
            format!("right foot by a wave of {speed_m_s} m/s{side}")
        }
        Some(RightFoot::Late(_) | RightFoot::Wave(_)) => "right foot later".to_owned(),
        Some(RightFoot::Record(record)) => {
            let files: Vec<_> = record.series().map(Series::name).collect();
            format!("right foot by {}", files.join(" and "))
        }
    };
    Some(format!("{left}, {right}"))
}

fn of_left_foot(scenario: &Scenario, varies: &dyn Fn(&[Quantity], &str) -> bool) -> Option<String> {
    match scenario.ground()? {
        Ground::Pulse(pulse) => {
            let kind = pulse.kind.name();
            let mut part = format!("{} pulse", kind.replace('_', " "));
            let durations = [Quantity::Duration, Quantity::Frequency];
            if !varies(&durations, &format!("ground.{kind}.duration_s")) {
                part += &format!(" of {} s", pulse.duration_s);
            }
            let key = format!("ground.{kind}.amplitude_g");
            if !varies(&[Quantity::Amplitude], &key) {
                part += &format!(", {} g", pulse.amplitude_g);
            }
            Some(part)
        }
        Ground::Record(record) => {
            let files: Vec<_> = record.series().map(Series::name).collect();
            let name = format!("record {}", files.join(" and "));
            let varied = varies(&[Quantity::Scale, Quantity::PeakG], "ground.record.scale");
            Some(match record.main.scaling {
                _ if varied => name,
                Scaling::Factor(1.0) => name,
                Scaling::Factor(factor) => format!("{name} times {}", four_digits(factor)),
                Scaling::PeakG(peak_g) => format!("{name} scaled to {} g", four_digits(peak_g)),
            })
        }
    }
}

fn model(scenario: &Scenario, varies: &dyn Fn(&[Quantity], &str) -> bool) -> String {
    if scenario.motion().hinges().has_joints() {
        return scenario.motion().words().to_owned();
    }
    let name = match scenario.structure().thrusts() {
        true => scenario.motion().words(),
        false => "Housner's block",
    };
    match scenario.motion().impact().model {
        ImpactModel::Prescribed { .. }
            if varies(&[Quantity::Restitution], "impact.restitution") =>
        {
            format!("{name}, restitution prescribed")
        }
        ImpactModel::Prescribed { restitution } => format!("{name}, restitution {restitution}"),
        model => format!("{name}, impact {}", model.name().replace('_', " ")),
    }
}
