//! Files and words of capacity curves.

use askama::Template;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::held_row;
use crate::mechanics::{Capacity, CurvePoint, Parts as _, Sides, TieEventDisplacements};
use crate::output::{
    CURVES, Chart, Figure, Mark, Named, OutputError, column, csv, fields, filters,
};
use crate::studies::results::Results;
use crate::{Scenario, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 3] = ["capacity.svg", "capacity.csv", "capacity.json"];

/// Summary of the capacity curves of a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/capacity/words.txt")]
pub struct Summary {
    /// The curves to the right and to the left, without their points; null to the side of a wall behind a column, towards which it cannot move.
    pub capacity: Sides<Option<CapacitySide>>,
    /// Parts of the structure whose centres carry the masses, in words.
    pub masses: String,
    /// Warnings about unlikely numbers of the scenario.
    pub warnings: Vec<String>,
    /// The scenario with all defaults.
    pub scenario: Value,
}

/// Summary of the capacity curve to one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CapacitySide {
    /// The control point in the undeformed structure, in metres.
    pub control_point_m: Vector2<f64>,
    /// Acceleration at the onset of motion, `a(0) = A_L`, in units of gravity.
    pub acceleration_g: f64,
    /// Displacement of the control point at the unstable equilibrium, in metres.
    pub ultimate_displacement_m: f64,
    /// The equivalent oscillator.
    pub oscillator: Oscillator,
    /// Displacements at which ties yield or break; absent without ties.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ties: Vec<TieEventDisplacements>,
}

/// The equivalent oscillator of a capacity curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Oscillator {
    /// Participating mass `M*`, in kg.
    pub participating_mass_kg: f64,
    /// Participating mass as a fraction of the moving mass, `e*`.
    pub mass_fraction: f64,
    /// Acceleration at the onset of motion, `a0*`, in units of gravity.
    pub acceleration_g: f64,
    /// Ultimate displacement, `d0*`, in metres.
    pub ultimate_displacement_m: f64,
    /// Secant periods at fractions of `d0*` (0.2, 0.4, 0.6 and 0.8), in seconds; null if no resistance is left.
    pub secant_period_s_at_part_of_ultimate: Named<Option<f64>>,
}

impl Summary {
    /// Returns the curves of the sides to which the structure moves.
    fn sides(&self) -> Vec<(Sway, &CapacitySide)> {
        let sides = self.capacity.iter();
        let moving = sides.filter_map(|(sway, side)| Some((sway, side.as_ref()?)));
        moving.collect()
    }
}

impl CapacitySide {
    fn of(side: &Capacity, gravity_m_s2: f64) -> Self {
        let (start, end) = (side.start(), side.end());
        let period_s = |part| side.secant_period_s(part, gravity_m_s2);
        let periods_s = [0.2, 0.4, 0.6, 0.8].map(|part| (part.to_string(), period_s(part)));
        Self {
            control_point_m: side.control.at_m,
            acceleration_g: start.acceleration_g,
            ultimate_displacement_m: end.displacement_m,
            oscillator: Oscillator {
                participating_mass_kg: side.participating_mass_kg,
                mass_fraction: side.mass_fraction,
                acceleration_g: start.oscillator_acceleration_g,
                ultimate_displacement_m: end.oscillator_displacement_m,
                secant_period_s_at_part_of_ultimate: Named(periods_s.into()),
            },
            ties: side.ties.clone(),
        }
    }
}

/// Makes files and words of the capacity curves of a scenario.
///
/// # Errors
/// When a value is not finite.
pub fn report(
    scenario: &Scenario,
    sides: &Sides<Option<Capacity>>,
    figure: Figure,
) -> Result<Results, OutputError> {
    let masses = match held_row(&scenario.structure) {
        Ok(Some(row)) => row.parts_in_words(),
        _ => scenario.structure.as_parts().parts_in_words(),
    };
    let summary = Summary {
        capacity: sides.map(|side| {
            let side = side.as_ref();
            side.map(|side| CapacitySide::of(side, scenario.gravity_m_s2()))
        }),
        masses,
        warnings: scenario.unlikely(),
        scenario: scenario.to_json(),
    };
    let title = scenario.title.as_deref().unwrap_or("Capacity");
    let picture = chart(sides, figure).draw(figure, title);
    let others = [picture.into_bytes(), table(sides)?];
    Results::new(&FILES, &summary, others)
}

/// Makes the chart of acceleration against displacement of the control point, for both sides.
fn chart(sides: &Sides<Option<Capacity>>, figure: Figure) -> Chart {
    let curves = sides.iter().zip(CURVES);
    let curves = curves.filter_map(|((sway, side), stroke)| {
        let points = side.as_ref()?.curve.iter();
        let points = points.map(|point| (point.displacement_m, point.acceleration_g));
        let name = format!("to the {}", sway.name());
        Some(Mark::curve(name, stroke, points))
    });
    let labels = ["displacement of the control point (m)", "a (g)"];
    Chart::around(figure, 330.0, labels, curves.collect())
}

/// Makes the table of the points of the curves, to the right first. The secant period is empty at the unstable equilibrium.
fn table(sides: &Sides<Option<Capacity>>) -> Result<Vec<u8>, OutputError> {
    type Row<'a> = (Sway, &'a CurvePoint);
    let rows = sides.iter().flat_map(|(sway, side)| {
        let points = side.iter().flat_map(|side| &side.curve);
        points.map(move |point| (sway, point))
    });
    let rows: Vec<Row<'_>> = rows.collect();
    let mut columns = vec![column("sway", |row: &Row<'_>| row.0.name())];
    columns.extend(fields!(
        |row: &Row<'_>| row.1 => q_rad, displacement_m, acceleration_g, oscillator_displacement_m,
        oscillator_acceleration_g, secant_period_s
    ));
    csv(columns, &rows)
}
