//! The tables of a run: `rotations.csv`, `poses.csv`, `joints.csv`, `events.csv` and `impacts.csv`. Meanings of the columns: `output/columns.txt`.

use crate::output::mechanisms::columns;
use crate::output::{Cell, Column, column, fields, list, numbers, row_number, several};
use crate::{Event, GroundMotion, Hinge, Impact, MechanismModel, Model, Sample, Sway};

use super::Scales;
use crate::dynamics::TieSample;
use crate::mechanics::Edge;

/// Returns the columns of `rotations.csv`, one row per sample; three more with scales. The columns of observed points come last.
pub(super) fn rotations(
    model: &dyn Model,
    ground: &GroundMotion,
    scales: Option<Scales>,
) -> Vec<Column<'static, Sample>> {
    let bodies = model.bodies();
    let rates = columns(&bodies, "rate", "rad_s");
    let sampled = fields!(|sample: &Sample| sample => time_s, ground_acceleration_m_s2, phase);
    let mut all = Vec::from(sampled);
    all.extend([
        column("state", |sample: &Sample| sample.state.name()),
        numbers(columns(&bodies, "rotation", "rad"), |sample: &Sample| {
            &sample.rotations_rad
        }),
        numbers(rates, |sample: &Sample| &sample.rates_rad_s),
        match model.row() {
            Some(_) => column("open_joints", |sample: &Sample| sample.hinges.len()),
            None => column("thrust_excess_ratio", |sample: &Sample| {
                sample.demand.excess_ratio
            }),
        },
        column("friction_demand", |sample: &Sample| sample.demand.friction),
    ]);
    if ground.has_vertical() {
        all.extend(fields!(|sample: &Sample| sample => vertical_acceleration_m_s2));
    }
    if ground.right_foot().is_some() {
        let names = ["x", "y"].map(|axis| format!("right_foot_{axis}_m"));
        all.push(numbers(names, |sample: &Sample| {
            sample.feet_apart_m.as_slice()
        }));
    }
    if let Some(scales) = scales {
        all.extend([
            column("p_t", move |sample: &Sample| {
                sample.time_s * scales.frequency_rad_s
            }),
            column("acceleration_over_incipient", move |sample: &Sample| {
                // Ground that accelerates to the right pushes to the left.
                let ground_m_s2 = sample.ground_acceleration_m_s2;
                ground_m_s2 / scales.incipient_m_s2[usize::from(ground_m_s2 > 0.0)]
            }),
            column("rotation_over_critical", |sample: &Sample| {
                sample.rotation_over_critical.unwrap_or(0.0)
            }),
        ]);
    }
    all
}

/// Returns the columns of `poses.csv`, one row per sample. The origin is the centre of a circular arch, or the middle of the base of a column.
pub(super) fn poses(bodies: &[String]) -> Vec<Column<'static, Sample>> {
    let names = bodies.iter().flat_map(|body| {
        let body = std::slice::from_ref(body);
        [("x", "m"), ("y", "m"), ("rotation", "rad")]
            .into_iter()
            .flat_map(move |(quantity, unit)| columns(body, quantity, unit))
    });
    vec![
        column("time_s", |sample: &Sample| sample.time_s),
        several(names, |sample: &Sample, cells| {
            let poses = sample.poses.iter();
            let values = poses
                .flat_map(|pose| [pose.translation.x, pose.translation.y, pose.rotation_rad()]);
            cells.push(Cell::Numbers(values.collect()));
        }),
    ]
}

/// Returns the columns of `joints.csv`, one row per sample.
pub(super) fn joints(model: &dyn Model) -> Vec<Column<'static, Sample>> {
    let (joints, ties) = model
        .row()
        .map_or((0, 0), |row| (row.joints.len(), row.bars().len()));
    let joints_if = |reported: bool| 0..if reported { joints } else { 0 };
    let gaps = (0..joints)
        .flat_map(|joint| ["intrados", "extrados"].map(|edge| format!("gap_{joint}_{edge}_m")));
    let pressures = joints_if(model.has_pressures()).flat_map(|joint| {
        let of_joint = [
            ("normal", "n"),
            ("shear", "n"),
            ("eccentricity", "ratio"),
            ("contact", "ratio"),
            ("stress", "intrados_pa"),
            ("stress", "extrados_pa"),
        ];
        of_joint.map(|(quantity, unit)| format!("{quantity}_{joint}_{unit}"))
    });
    let ties = (1..=ties)
        .flat_map(|tie| ["force_n", "elongation_m"].map(|what| format!("tie_{tie}_{what}")));
    let slips = joints_if(model.slips()).map(|joint| format!("slip_{joint}_m"));
    vec![
        column("time_s", |sample: &Sample| sample.time_s),
        numbers(gaps, |sample: &Sample| sample.gaps_m.as_flattened()),
        numbers(slips, |sample: &Sample| &sample.offsets_m),
        several(pressures, |sample: &Sample, cells| {
            for joint in &sample.pressures {
                cells.extend([joint.normal_n, joint.shear_n].map(Cell::from));
                cells.push(joint.eccentricity_ratio.into());
                cells.push(joint.contact_ratio.into());
                cells.extend(joint.edge_stresses_pa.map(Cell::from));
            }
        }),
        several(ties, |sample: &Sample, cells| {
            let ties = sample.ties.iter();
            let cells_of = |tie: &TieSample| [tie.force_n, tie.elongation_m].map(Cell::from);
            cells.extend(ties.flat_map(cells_of));
        }),
    ]
}

/// Returns the columns of `events.csv`, one row per event; phase 0 begins with the run, without a row.
///
/// The table of a free-standing column has no hinges. A structure that is released starts in the first mechanism without a row; the first row of
/// `impacts.csv` has the hinges of that mechanism as closed hinges.
///
/// Rows of blocks have thousands of impacts and hundreds of bodies, so their table has no columns of bodies.
pub(super) fn events(model: &dyn Model) -> Vec<Column<'static, Event>> {
    let mut all = vec![
        column("time_s", |event: &Event| event.time_s),
        row_number("phase"),
        column("kind", |event: &Event| event.kind.name()),
        column("sway", |event: &Event| event.state.sway().map(Sway::name)),
        column("mechanism", |event: &Event| event.mechanism),
    ];
    let energy = column("energy_j", |event: &Event| event.energy_j);
    if model.row().is_some_and(|row| !row.bars().is_empty()) {
        all.push(column("tie", |event: &Event| event.tie.map(|tie| tie + 1)));
    }
    match model.as_mechanisms() {
        Some(model) => {
            let (bodies, sections) = (model.bodies(), sections(model));
            let rotations = columns(&bodies, "rotation", "rad");
            let rates = columns(&bodies, "rate", "rad_s");
            all.extend([
                numbers(rotations, |event: &Event| &event.rotations_rad),
                numbers(rates, |event: &Event| &event.rates_rad_s),
                energy,
                hinges("hinge", sections, |event| &event.hinges),
            ]);
        }
        None => all.extend([
            energy,
            column("joints_open", |event: &Event| joint_numbers(&event.hinges)),
            column("edges_open", |event: &Event| joint_edges(&event.hinges)),
        ]),
    }
    all
}

/// Columns of `impacts.csv` for mechanisms, one row per impact.
///
/// The mechanism after the impact is written with the energy that it would keep, even if this energy is so small that the structure comes to
/// rest. Hinges are empty if no mechanism can follow.
pub(super) fn impacts(model: &dyn MechanismModel) -> Vec<Column<'static, Event>> {
    let (bodies, sections) = (model.bodies(), sections(model));
    let rates = |moment: &str| columns(&bodies, "rate", &format!("{moment}_rad_s"));
    let impulses = hinge_columns(sections, "impulse", ["x_n_s", "y_n_s"]);
    vec![
        row_number("impact"),
        column("time_s", |event: &Event| event.time_s),
        impact_column("sway_before", |impact| impact.sway_before.name()),
        impact_column("sway_after", |impact| impact.sway_after().name()),
        impact_column("restitution", |impact| impact.restitution),
        impact_column("energy_before_j", |impact| impact.energy_before_j),
        impact_column("energy_after_j", |impact| impact.energy_after_j),
        numbers(rates("before"), |event: &Event| {
            impact(event).map_or(&[][..], |impact| &impact.rates_before_rad_s)
        }),
        numbers(rates("after"), |event: &Event| {
            impact(event).map_or(&[][..], |impact| &impact.rates_after_rad_s)
        }),
        list(
            hinge_columns(sections, "hinge", ["deg"]),
            move |event: &Event| {
                let opened = hinge_cells(opened_hinges(event), sections).into_iter();
                opened.map(|(angle_deg, _)| angle_deg)
            },
        ),
        list(impulses, move |event: &Event| {
            let impulses = impact(event).map_or(&[][..], |impact| &impact.impulses_n_s);
            let known = impulses.iter().flat_map(|one| [Some(one.x), Some(one.y)]);
            let all = known.chain(std::iter::repeat(None));
            all.take(2 * sections).collect::<Vec<_>>()
        }),
        list(
            hinge_columns(sections, "hinge", ["edge"]),
            move |event: &Event| {
                let opened = hinge_cells(opened_hinges(event), sections).into_iter();
                opened.map(|(_, edge)| edge)
            },
        ),
        hinges("closed", sections, |event| {
            impact(event).map_or(&[], |impact| &impact.closed)
        }),
    ]
}

/// Returns the columns of `impacts.csv` for rows, one row per impact.
pub(super) fn landings(model: &dyn Model) -> Vec<Column<'static, Event>> {
    let mut all = vec![
        row_number("impact"),
        column("time_s", |event: &Event| event.time_s),
        impact_column("joints_shut", |impact| joint_numbers(&impact.closed)),
        impact_column("edges_shut", |impact| joint_edges(&impact.closed)),
        impact_column("joints_opened", |impact| joint_numbers(&impact.opened)),
        impact_column("edges_opened", |impact| joint_edges(&impact.opened)),
        impact_column("energy_before_j", |impact| impact.energy_before_j),
        impact_column("energy_after_j", |impact| impact.energy_after_j),
        impact_column("energy_taken_j", energy_loss_j),
    ];
    if model.slips() {
        all.push(impact_column("friction_j", |impact| impact.friction_j));
    }
    all
}

/// Energy lost in an impact, in J.
pub(super) fn energy_loss_j(impact: &Impact) -> f64 {
    impact.energy_before_j - impact.energy_after_j
}

fn impact(event: &Event) -> Option<&Impact> {
    event.impact.as_ref()
}

fn opened_hinges(event: &Event) -> &[Hinge] {
    impact(event).map_or(&[], |impact| &impact.opened)
}

/// Column with a quantity of the impact; empty for other events.
fn impact_column<C: Into<Cell<'static>>>(
    name: &'static str,
    cell: impl Fn(&Impact) -> C + 'static,
) -> Column<'static, Event> {
    column(name, move |event: &Event| impact(event).map(&cell))
}

/// Names of the hinges of a mechanism in columns, from left to right.
const HINGES: [&str; 4] = ["a", "b", "c", "d"];

/// Names of columns: `parts` of each of a number of hinges.
fn hinge_columns<const N: usize>(sections: usize, what: &str, parts: [&str; N]) -> Vec<String> {
    let hinges = HINGES.iter().take(sections);
    let names = hinges.flat_map(|hinge| parts.map(|part| format!("{what}_{hinge}_{part}")));
    names.collect()
}

/// Number of hinges of a mechanism that are at sections of an arch.
fn sections(model: &dyn MechanismModel) -> usize {
    hinge_cells(&model.hinges_after(0, model.first_side()), 0).len()
}

/// Columns with angle and edge of a number of hinges.
fn hinges(
    what: &str,
    sections: usize,
    of: impl Fn(&Event) -> &[Hinge] + 'static,
) -> Column<'static, Event> {
    list(
        hinge_columns(sections, what, ["deg", "edge"]),
        move |event| {
            let cells = hinge_cells(of(event), sections).into_iter();
            cells.flat_map(|(angle_deg, edge)| [Cell::from(angle_deg), Cell::from(edge)])
        },
    )
}

/// Angles, in degrees from the left springing, and the edges of hinges at sections of an arch, with empty cells up to the number
/// `least`.
fn hinge_cells(hinges: &[Hinge], least: usize) -> Vec<(Option<f64>, Option<&'static str>)> {
    let sections = hinges.iter().filter_map(|hinge| match hinge {
        Hinge::Section { angle_rad, edge } => {
            Some((Some(angle_rad.to_degrees()), Some(edge.name())))
        }
        Hinge::Toe(_) | Hinge::Joint { .. } | Hinge::Face { .. } => None,
    });
    let mut cells: Vec<_> = sections.collect();
    cells.resize(cells.len().max(least), (None, None));
    cells
}

/// Numbers of the joints of these hinges, separated by spaces.
fn joint_numbers(hinges: &[Hinge]) -> String {
    joints_in_words(hinges, |words, joint, _| *words += &joint.to_string())
}

/// Edges of these hinges, separated by spaces.
fn joint_edges(hinges: &[Hinge]) -> String {
    joints_in_words(hinges, |words, _, edge| {
        *words += edge.map_or("both", Edge::name);
    })
}

/// A word for each joint, added by a function. There are thousands of impacts, so no word is a text of its own.
fn joints_in_words(hinges: &[Hinge], add: impl Fn(&mut String, usize, Option<Edge>)) -> String {
    let mut words = String::new();
    for hinge in hinges {
        if let Hinge::Joint { joint, edge } = *hinge {
            if !words.is_empty() {
                words.push(' ');
            }
            add(&mut words, joint, edge);
        }
    }
    words
}
