//! Files and words of capacity curves.

use askama::Template;
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::held_row;
use crate::argument::{format_fixed, plain};
use crate::mechanics::{Capacity, CurvePoint, Parts as _, Sides, TieEventDisplacements};
use crate::output::page::{Spot, SpotKind};
use crate::output::{
    CURVES, Chart, Figure, Mark, Named, OutputError, Table, column, fields, filters,
};
use crate::scenario::Varied;
use crate::studies::page::{CaseScenario, Page, PageCases};
use crate::studies::report::{Report, Warnings};
use crate::studies::results::Results;
use crate::{Scenario, Sway};

/// Names of the files, the seal last.
pub const FILES: [&str; 4] = [
    "capacity.html",
    "capacity.svg",
    "capacity.csv",
    "capacity.json",
];

/// Summary of the capacity curves of a structure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(path = "studies/capacity/words.txt")]
pub struct CapacitySummary {
    /// The curves to the right and to the left, without their points; null to the side of a wall behind a column, towards which it cannot move.
    pub capacity: Sides<Option<CapacitySide>>,
    /// Parts of the structure whose centres carry the masses, in words.
    pub masses: String,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
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

impl CapacitySummary {
    /// Curves of the sides to which the structure moves.
    fn sides(&self) -> Vec<(Sway, &CapacitySide)> {
        let sides = self.capacity.iter();
        let moving = sides.filter_map(|(sway, side)| Some((sway, side.as_ref()?)));
        moving.collect()
    }
}

impl CapacitySide {
    fn of(side: &Capacity, gravity_m_s2: f64) -> Self {
        let (start, end) = (side.first_point(), side.end());
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
        _ if scenario.structure.held_column().is_some() => "its two bodies".to_owned(),
        _ => scenario.structure.as_parts().parts_in_words(),
    };
    let summary = CapacitySummary {
        capacity: sides.map(|side| {
            let side = side.as_ref();
            side.map(|side| CapacitySide::of(side, scenario.gravity_m_s2()))
        }),
        masses,
        warnings: Warnings::new(
            scenario.unlikely_in(&Varied::default()),
            scenario.default_density_in_words(),
        ),
        scenario: scenario.to_json(),
    };
    let title = scenario.title.as_deref().unwrap_or("Capacity");
    let picture = chart(sides, figure, &[]).draw(figure, title);
    let results = Results::of("capacity.json", &summary)?
        .with_table("capacity.csv", table(sides)?)
        .with_file("capacity.svg", picture);
    let mut cases = PageCases::default();
    let text = CaseScenario::unchanged(cases.add_text(&summary.scenario, false));
    for (sway, point) in points(sides) {
        let (d_m, a_g) = (plain(point.displacement_m), plain(point.acceleration_g));
        let words = format!(
            "to the {}: a {a_g} g at a displacement of {d_m} m",
            sway.name()
        );
        cases.push((SpotKind::Point, false), words, || Some(text.clone()));
    }
    let control_m = sides
        .iter()
        .find_map(|(_, side)| Some(side.as_ref()?.control.at_m))
        .unwrap_or_default();
    let draw = |figure| chart(sides, figure, &cases.spots).draw(figure, title);
    let masses = format!("masses at the centres of {}", summary.masses);
    let what = scenario.structure.describe();
    let mut page = Page::new(title, what, &[STATIC, &masses], &[]);
    page.command = format!(
        "capacity - --point {:?},{:?} --out case",
        control_m.x, control_m.y
    );
    let results = results.with_page("capacity.html", page, &cases, (&draw, &[]));
    Ok(results.in_order(&FILES))
}

impl Report for CapacitySummary {
    const IS_TABLE: bool = true;

    fn verdict(&self) -> String {
        let sides = self.sides().into_iter().map(|(sway, side)| {
            let (start_g, end_m) = (side.acceleration_g, side.ultimate_displacement_m);
            let (sway, start_g, end_m) = (sway.name(), format_fixed(start_g, 4), format_fixed(end_m, 4));
            format!(
                "to the {sway}: {start_g} g starts it, and it would fall at a displacement of {end_m} m"
            )
        });
        sides.collect::<Vec<_>>().join("; ")
    }

    fn warnings(&self) -> &Warnings {
        &self.warnings
    }
}

const STATIC: &str = "the first mechanism, held at each displacement without inertia and without slip; the hinges stay where they open";

/// True if the curves to both sides have equal points within rounding, as for a symmetric structure.
fn are_alike(right: &[CurvePoint], left: &[CurvePoint]) -> bool {
    let is_near = |one: f64, other: f64| (one - other).abs() <= 1e-9 * one.abs().max(1e-3);
    let mut pairs = right.iter().zip(left);
    right.len() == left.len()
        && pairs.all(|(one, other)| {
            is_near(one.displacement_m, other.displacement_m)
                && is_near(one.acceleration_g, other.acceleration_g)
        })
}

/// Points of the curves, to the right first.
fn points(sides: &Sides<Option<Capacity>>) -> impl Iterator<Item = (Sway, &CurvePoint)> {
    sides.iter().flat_map(|(sway, side)| {
        let points = side.iter().flat_map(|side| &side.curve);
        points.map(move |point| (sway, point))
    })
}

/// Makes the chart of acceleration against displacement of the control point, for both sides, with marks for their points on a
/// page.
fn chart(sides: &Sides<Option<Capacity>>, figure: Figure, spots: &[Spot]) -> Chart {
    let [right, left] = [&sides.right, &sides.left].map(Option::as_ref);
    let is_one = right
        .zip(left)
        .is_some_and(|(right, left)| are_alike(&right.curve, &left.curve));
    let shown = sides.iter().zip(CURVES).take(if is_one { 1 } else { 2 });
    let curves = shown.filter_map(|((sway, side), stroke)| {
        let curve = side.as_ref()?.curve.iter();
        let points = curve.map(|point| (point.displacement_m, point.acceleration_g));
        let name = match is_one {
            true => "to either side".to_owned(),
            false => format!("to the {}", sway.name()),
        };
        Some(Mark::curve(name, stroke, points))
    });
    let labels = ["displacement of the control point (m)", "a (g)"];
    let mut chart = Chart::around(figure, 330.0, labels, curves.collect());
    let marks = points(sides)
        .zip(spots)
        .map(|((_, point), spot)| spot.mark((point.displacement_m, point.acceleration_g)));
    chart.marks.extend(marks);
    chart
}

/// Makes the table of the points of the curves, to the right first. The secant period is empty at the unstable equilibrium.
fn table(sides: &Sides<Option<Capacity>>) -> Result<Table, OutputError> {
    type Row<'a> = (Sway, &'a CurvePoint);
    let rows: Vec<Row<'_>> = points(sides).collect();
    let mut columns = vec![column("sway", |row: &Row<'_>| row.0.name())];
    columns.extend(fields!(
        |row: &Row<'_>| row.1 => q_rad, displacement_m, acceleration_g, oscillator_displacement_m,
        oscillator_acceleration_g, secant_period_s
    ));
    Table::new(columns, &rows)
}
