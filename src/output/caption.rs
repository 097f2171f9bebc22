//! A line with the input of a picture: structure, ground motion and model of motion.

use crate::ImpactModel;
use crate::dynamics::Direction;
use crate::scenario::{
    Axis, Ground, Quantity, Record, RightFoot, Scaling, Scenario, Series, Structure,
};

/// Returns true if an axis of the picture varies this key. The table of a pulse is named `pulse`.
type Varies<'a> = &'a dyn Fn(&str) -> bool;

/// Returns the caption without the values that vary along the axes.
pub fn caption(scenario: &Scenario, axes: &[&Axis]) -> String {
    let others = caption_without_model(scenario, axes);
    format!("{others}; {}", model(scenario, &varied_in(axes)))
}

/// Returns the caption without the model of motion.
pub fn caption_without_model(scenario: &Scenario, axes: &[&Axis]) -> String {
    let varies = varied_in(axes);
    let structure = structure(&scenario.structure, &varies);
    let ground = ground(scenario, &varies);
    let parts = [structure].into_iter().chain(ground);
    parts.collect::<Vec<_>>().join("; ")
}

/// Returns a function that is true for keys that vary along the axes.
fn varied_in(axes: &[&Axis]) -> impl Fn(&str) -> bool {
    let varied: Vec<String> = axes.iter().map(|axis| varied_key(axis)).collect();
    move |key| varied.iter().any(|varied| varied == key)
}

/// Returns the key that an axis varies.
fn varied_key(axis: &Axis) -> String {
    let name = axis.quantity.name();
    match axis.quantity {
        Quantity::Other => axis.key.clone(),
        Quantity::MeanRadius | Quantity::ThicknessRatio | Quantity::Embrace => {
            format!("arch.{name}")
        }
        Quantity::Restitution => format!("impact.{name}"),
        Quantity::Frequency | Quantity::VelocityRatio => "ground.pulse.duration_s".to_owned(),
        Quantity::Duration | Quantity::Amplitude => format!("ground.pulse.{name}"),
        Quantity::Scale | Quantity::PeakG => "ground.record.scale".to_owned(),
    }
}

/// Returns the structure in words, with its constant values.
fn structure(structure: &Structure, varies: Varies<'_>) -> String {
    let shape = |name: &str, values: &[(&str, &str, f64, &str)]| -> Vec<String> {
        let constant = values
            .iter()
            .filter(|(key, ..)| !varies(&format!("{name}.{key}")));
        let words = |(_, before, value, after): &(&str, &str, f64, &str)| {
            format!("{before}{}{after}", four_digits(*value))
        };
        constant.map(words).collect()
    };
    match structure {
        Structure::Arch(arch) => {
            let mut values = shape(
                "arch",
                &[
                    ("mean_radius_m", "R ", arch.mean_radius_m, " m"),
                    ("thickness_ratio", "t/R ", arch.thickness_ratio, ""),
                    ("embrace_deg", "", arch.embrace_deg, " degrees"),
                ],
            );
            let measures = ["span_m", "rise_m", "thickness_m"];
            let is_constant = |key: &&str| !varies(&format!("arch.{key}"));
            if let Some(line) = arch.measured_at
                && values.len() == 3
                && measures.iter().all(is_constant)
            {
                let [span_m, rise_m] = arch.span_and_rise_m(line).map(four_digits);
                let thick_m = four_digits(arch.mean_radius_m * arch.thickness_ratio);
                let at = line.in_words();
                values = vec![format!(
                    "span {span_m} m, rise {rise_m} m {at}, {thick_m} m thick"
                )];
            }
            if !varies("arch.voussoirs") {
                let voussoirs = arch.voussoirs.map(|count| format!("{count} voussoirs"));
                values.push(voussoirs.unwrap_or_else(|| "no joints given".to_owned()));
            }
            format!("arch: {}", values.join(", "))
        }
        Structure::Column(column) => match column.given {
            Some(body) => {
                let values = [
                    ("mass_kg", "", body.mass_kg, " kg"),
                    ("inertia_kg_m2", "", body.inertia_kg_m2, " kg m2"),
                ];
                format!("body: {}", shape("body", &values).join(", "))
            }
            None => {
                let values = [
                    ("height_m", "", column.height_m, " m high"),
                    ("width_m", "", column.width_m, " m wide"),
                ];
                format!("column: {}", shape("column", &values).join(", "))
            }
        },
        Structure::Masonry(_) => "blocks".to_owned(),
    }
}

/// Rounds a value to four digits, which identify it in a caption.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Returns the ground motion in words: the pulse, or the record with its scale; and the motion of the right foot.
pub fn ground_in_words(scenario: &Scenario) -> String {
    let words = ground(scenario, &|_| false);
    words.unwrap_or_else(|| "the ground stays still".to_owned())
}

fn ground(scenario: &Scenario, varies: Varies<'_>) -> Option<String> {
    let as_given = ground_as_given(scenario, varies)?;
    Some(match scenario.simulation.direction.first() {
        Direction::AsGiven => as_given,
        Direction::Mirrored => format!("{as_given}, mirrored"),
    })
}

fn ground_as_given(scenario: &Scenario, varies: Varies<'_>) -> Option<String> {
    let left = of_left_foot(scenario, varies)?;
    let right = match &scenario.right_foot {
        None => return Some(left),
        Some(RightFoot::Late(delay_s)) if !varies("ground.right.delay_s") => {
            let when = if *delay_s < 0.0 { "earlier" } else { "later" };
            format!("right foot {} s {when}", four_digits(delay_s.abs()))
        }
        Some(RightFoot::Wave(velocity_m_s)) if !varies("ground.right.apparent_velocity_m_s") => {
            let speed_m_s = four_digits(velocity_m_s.abs());
            let to_left = *velocity_m_s < 0.0;
            let side = if to_left { " to the left" } else { "" };
            format!("right foot by a wave of {speed_m_s} m/s{side}")
        }
        Some(RightFoot::Late(_) | RightFoot::Wave(_)) => "right foot later".to_owned(),
        Some(RightFoot::Record(record)) => format!("right foot by {}", files(record)),
    };
    Some(format!("{left}, {right}"))
}

fn of_left_foot(scenario: &Scenario, varies: Varies<'_>) -> Option<String> {
    match scenario.ground.as_ref()? {
        Ground::Pulse(pulse) => {
            let kind = pulse.kind.name();
            let varies = |key: &str| {
                let varies = |table: &str| varies(&format!("ground.{table}.{key}"));
                varies("pulse") || varies(kind)
            };
            let duration = format!(" of {} s", pulse.duration_s);
            let amplitude = format!(", {} g", pulse.amplitude_g);
            let parts = [("duration_s", duration), ("amplitude_g", amplitude)].into_iter();
            let parts = parts
                .filter(|(key, _)| !varies(key))
                .map(|(_, words)| words);
            let name = format!("{} pulse", kind.replace('_', " "));
            Some([name].into_iter().chain(parts).collect())
        }
        Ground::Record(record) => {
            let name = format!("record {}", files(record));
            Some(match record.main.scaling {
                _ if varies("ground.record.scale") => name,
                Scaling::Factor(1.0) => name,
                Scaling::Factor(factor) => format!("{name} times {}", four_digits(factor)),
                Scaling::PeakG(peak_g) => format!("{name} scaled to {} g", four_digits(peak_g)),
            })
        }
    }
}

fn files(record: &Record) -> String {
    let files: Vec<_> = record.series().map(Series::name).collect();
    files.join(" and ")
}

fn model(scenario: &Scenario, varies: Varies<'_>) -> String {
    if !scenario.motion.kind.has_mechanism {
        return scenario.motion.kind.label.to_owned();
    }
    let name = match scenario.structure.has_horizontal_thrust() {
        true => scenario.motion.kind.label,
        false => "Housner's block",
    };
    match scenario.motion.impact().model {
        ImpactModel::Prescribed { .. } if varies("impact.restitution") => {
            format!("{name}, restitution prescribed")
        }
        ImpactModel::Prescribed { restitution } => format!("{name}, restitution {restitution}"),
        ImpactModel::MaxRestitution if !scenario.structure.has_horizontal_thrust() => {
            name.to_owned()
        }
        ImpactModel::MaxRestitution => format!("{name}, largest restitution"),
        model => format!("{name}, impact {}", model.name().replace('_', " ")),
    }
}
