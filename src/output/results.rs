//! `events.csv`, `impacts.csv` and `summary.json` of a run.

use std::io::Write;

use serde_json::{Value, json};

use super::rotations::{Scales, columns};
use super::table::{Table, table};
use super::{OutputError, finite};
use crate::dynamics::ground::GroundMotion;
use crate::dynamics::history::{Event, Outcome, Summary, impacts};
use crate::dynamics::model::MechanismModel;
use crate::mechanics::chain::Hinge;
use crate::mechanics::geometry::ring::Edge;
use crate::mechanics::sway::Sway;
use crate::scenario::{Ground, Scenario};

/// Writes events, a row per transition.
///
/// | column | |
/// |---|---|
/// | `time_s` | instant |
/// | `phase` | the phase that begins, as in `rotations.csv`; phase 0 begins with the run, without a row |
/// | `kind` | `uplift`, `impact`, `rest` or `overturned` |
/// | `sway` | `right` or `left`, from here on; empty at rest |
/// | `mechanism` | index in the chain: impacts since the last uplift or release; empty at rest, and of free hinges |
/// | `rotation_..._rad`, `rate_..._rad_s` | of each body, just after |
/// | `energy_j` | kinetic and potential, just after |
/// | `hinge_a_deg`, `hinge_a_edge` ... | of the mechanism from here on, see [`write_impacts`]; empty at rest |
/// | `joints_open`, `edges_open` | of a row of blocks: joints that are open or open now, and the edge about which each turns (`both`: it parts), with spaces between |
///
/// A column has no columns for hinges. A structure that is released starts in the first mechanism
/// without a row: its hinges are in `impacts.csv`, as those that close first.
///
/// Rows of blocks have thousands of impacts, and bodies by the hundred: without names of bodies their columns are left
/// out.
pub struct EventsWriter<W: Write> {
    csv: Table<W>,
    rows: usize,
    /// Whether there are columns of open joints, and none by body.
    of_row: bool,
    /// Hinges that have columns.
    sections: usize,
}

impl<W: Write> EventsWriter<W> {
    const WHAT: &str = "cannot write the events";

    /// Starts with the header for a model of mechanisms.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn of_mechanisms(writer: W, model: &dyn MechanismModel) -> Result<Self, OutputError> {
        Self::new(writer, Some(&model.bodies()), sections(model))
    }

    /// Starts with the header for a row of blocks.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn of_row(writer: W) -> Result<Self, OutputError> {
        Self::new(writer, None, 0)
    }

    /// Without names of bodies, of a row.
    fn new(writer: W, bodies: Option<&[String]>, sections: usize) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let mut header: Vec<String> = ["time_s", "phase", "kind", "sway", "mechanism"]
            .map(str::to_owned)
            .to_vec();
        for (quantity, unit) in [("rotation", "rad"), ("rate", "rad_s")] {
            header.extend(columns(bodies.unwrap_or_default(), quantity, unit));
        }
        header.push("energy_j".to_owned());
        header.extend(hinge_columns("hinge", sections));
        if bodies.is_none() {
            header.extend(["joints_open", "edges_open"].map(str::to_owned));
        }
        csv.write_record(header)
            .map_err(OutputError::csv(Self::WHAT))?;
        Ok(Self {
            csv,
            rows: 0,
            of_row: bodies.is_none(),
            sections,
        })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write(&mut self, event: &Event) -> Result<(), OutputError> {
        let (rotations, rates) = if self.of_row {
            (&[][..], &[][..])
        } else {
            (&event.rotations_rad[..], &event.rates_rad_s[..])
        };
        let open = self
            .of_row
            .then(|| [joints(&event.hinges), edges(&event.hinges)]);
        self.rows += 1;
        self.csv
            .serialize((
                event.time_s,
                self.rows,
                event.kind.name(),
                event.state.sway().map(Sway::name),
                event.mechanism,
                rotations,
                rates,
                event.energy_j,
                hinge_cells(&event.hinges, self.sections),
                open.as_slice(),
            ))
            .map_err(OutputError::csv(Self::WHAT))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.csv.flush().map_err(OutputError::io(Self::WHAT))
    }
}

/// Writes one row per impact.
///
/// The mechanism after is the one that the impact leads to, with the energy that it would keep, also where
/// that is so little that the structure comes to rest. Where no mechanism can follow the hinges are left
/// empty. A column has no columns for hinges.
///
/// `hinge_a_deg` to `hinge_d_deg` are the hinges of the mechanism after from the left, in degrees from the left
/// springing, and `hinge_a_edge` ... where they are in the section, `intrados` or `extrados`; `closed_a_deg` and
/// `closed_a_edge` ... the same of the mechanism before, in the first row the first of all.
///
/// The impulses at its hinges act on the part towards the crown, in the frame of the ground; they are empty
/// where the restitution coefficient is prescribed.
///
/// # Errors
/// When the system refuses, or a value is not finite.
pub fn write_impacts(
    writer: impl Write,
    model: &dyn MechanismModel,
    events: &[Event],
) -> Result<(), OutputError> {
    const WHAT: &str = "cannot write the impacts";
    let mut csv = table(writer);
    let mut header: Vec<String> = [
        "impact",
        "time_s",
        "sway_before",
        "sway_after",
        "restitution",
        "energy_before_j",
        "energy_after_j",
    ]
    .map(str::to_owned)
    .to_vec();
    for moment in ["before", "after"] {
        let unit = format!("{moment}_rad_s");
        header.extend(columns(&model.bodies(), "rate", &unit));
    }
    let sections = sections(model);
    let hinges = HINGES.iter().take(sections);
    header.extend(hinges.clone().map(|hinge| format!("hinge_{hinge}_deg")));
    header.extend(
        hinges.clone().flat_map(|hinge| {
            ["x", "y"].map(|component| format!("impulse_{hinge}_{component}_n_s"))
        }),
    );
    header.extend(hinges.map(|hinge| format!("hinge_{hinge}_edge")));
    header.extend(hinge_columns("closed", sections));
    csv.write_record(header).map_err(OutputError::csv(WHAT))?;

    for (index, (time_s, impact)) in impacts(events).enumerate() {
        let opened = hinge_cells(&impact.opened, sections);
        let hinges_deg: Vec<_> = opened.iter().map(|(angle_deg, _)| *angle_deg).collect();
        let edges: Vec<_> = opened.iter().map(|(_, edge)| *edge).collect();
        let impulses = impact.impulses_n_s.iter();
        let impulses_n_s: Vec<f64> = impulses.flat_map(|i| [i.x, i.y]).collect();
        let mut impulses_n_s: Vec<Option<f64>> = impulses_n_s.into_iter().map(Some).collect();
        impulses_n_s.resize(2 * sections, None);
        let energies = [impact.energy_before_j, impact.energy_after_j];
        csv.serialize((
            index + 1,
            time_s,
            impact.sway_before.name(),
            impact.sway_after().name(),
            impact.restitution,
            energies,
            &impact.rates_before_rad_s,
            &impact.rates_after_rad_s,
            hinges_deg,
            impulses_n_s,
            edges,
            hinge_cells(&impact.closed, sections),
        ))
        .map_err(OutputError::csv(WHAT))?;
    }
    csv.flush().map_err(OutputError::io(WHAT))
}

/// Hinges of a mechanism in the names of columns, from the left.
const HINGES: [&str; 4] = ["a", "b", "c", "d"];

/// How many hinges of the mechanisms of a model are at sections.
fn sections(model: &dyn MechanismModel) -> usize {
    hinge_cells(&model.hinges_after(0, Sway::Right), 0).len()
}

/// Columns of so many hinges, place and edge.
fn hinge_columns(what: &str, sections: usize) -> impl Iterator<Item = String> {
    let hinges = HINGES.iter().take(sections);
    hinges.flat_map(move |hinge| ["deg", "edge"].map(|part| format!("{what}_{hinge}_{part}")))
}

/// Angles, in degrees from the left springing, and edges of the hinges that are at sections of an arch; filled up with
/// empty cells to so many.
fn hinge_cells(hinges: &[Hinge], least: usize) -> Vec<(Option<f64>, Option<&'static str>)> {
    let sections = hinges.iter().filter_map(|hinge| match hinge {
        Hinge::Section { angle_rad, edge } => {
            Some((Some(angle_rad.to_degrees()), Some(edge.name())))
        }
        Hinge::Toe(_) | Hinge::Joint { .. } => None,
    });
    let mut cells: Vec<_> = sections.collect();
    cells.resize(cells.len().max(least), (None, None));
    cells
}

/// Numbers of the joints that hinges are at, with spaces between.
pub(super) fn joints(hinges: &[Hinge]) -> String {
    let numbers = hinges.iter().filter_map(|hinge| match hinge {
        Hinge::Joint { joint, .. } => Some(joint.to_string()),
        Hinge::Section { .. } | Hinge::Toe(_) => None,
    });
    numbers.collect::<Vec<_>>().join(" ")
}

/// Edges of these joints, with spaces between.
pub(super) fn edges(hinges: &[Hinge]) -> String {
    let names = hinges.iter().filter_map(|hinge| match hinge {
        Hinge::Joint { edge, .. } => Some(edge.map_or("both", Edge::name)),
        Hinge::Section { .. } | Hinge::Toe(_) => None,
    });
    names.collect::<Vec<_>>().join(" ")
}

/// The summary of a run as JSON.
///
/// `peak_rotation_over_critical` is the largest rotation over that at the unstable equilibrium of the mechanism
/// that moved. `dimensionless` has `p_rad_s` (see [`Scales`]), `p_t_p` (times the duration of the pulse) and
/// `peak_acceleration_over_incipient` (of the ground, over `g A_L`).
///
/// # Errors
/// When a value is not finite.
pub fn summary(
    scenario: &Scenario,
    model: &dyn MechanismModel,
    ground: &GroundMotion,
    history: &Summary,
) -> Result<Value, OutputError> {
    let mut summary = beginning(scenario, history, &model.bodies())?;
    let incipient_g = |sway| model.incipient_acceleration_g(sway);
    let more = summary.as_object_mut().expect("the summary is an object");
    finite(
        "peak_rotation_over_critical",
        history.peak_over_critical.as_slice(),
    )?;
    more.insert(
        "peak_rotation_over_critical".to_owned(),
        json!(history.peak_over_critical),
    );
    more.insert(
        "incipient_acceleration_g".to_owned(),
        json!({ "right": incipient_g(Sway::Right), "left": incipient_g(Sway::Left) }),
    );
    let gravity_m_s2 = scenario.gravity_m_s2();
    if let Some(scales) = Scales::new(model, gravity_m_s2) {
        let p_rad_s = scales.frequency_rad_s;
        let p_t_p = match scenario.ground() {
            Some(Ground::Pulse(pulse)) => Some(pulse.duration_s * p_rad_s),
            Some(Ground::Record(_)) | None => None,
        };
        let peaks_m_s2 = ground.peaks_m_s2(history.end_s);
        let peak = peaks_m_s2.x / scales.incipient_m_s2;
        finite("dimensionless", &[p_rad_s, p_t_p.unwrap_or(0.0), peak])?;
        more.insert(
            "dimensionless".to_owned(),
            json!({
                "p_rad_s": p_rad_s,
                "p_t_p": p_t_p,
                "peak_acceleration_over_incipient": peak,
            }),
        );
    }
    more.insert(
        "energy_defect_ratio".to_owned(),
        json!(history.energy_defect_ratio),
    );
    if let Some(thrust) = &history.thrust {
        let shares = thrust.shares_within();
        let share = |level: usize| shares.map_or(Value::Null, |shares| json!(shares[level]));
        for (name, value) in [
            (
                "largest_thrust_excess_ratio",
                json!(thrust.largest_excess.value),
            ),
            (
                "largest_thrust_excess_time_s",
                json!(thrust.largest_excess.time_s),
            ),
            (
                "largest_friction_demand",
                json!(thrust.largest_friction.value),
            ),
            (
                "largest_friction_demand_time_s",
                json!(thrust.largest_friction.time_s),
            ),
            ("rocking_share_thrust_excess_below_0_01", share(0)),
            ("rocking_share_thrust_excess_below_0_05", share(1)),
        ] {
            more.insert(name.to_owned(), value);
        }
    }
    more.insert("evaluations".to_owned(), json!(history.cost.evaluations));
    more.insert("steps".to_owned(), json!(history.cost.steps));
    Ok(summary)
}

/// What the summaries of all models of motion begin with, an object.
pub(super) fn beginning(
    scenario: &Scenario,
    history: &Summary,
    bodies: &[String],
) -> Result<Value, OutputError> {
    let peaks = &history.peak_rotations_rad[..];
    finite("peak_rotation", peaks)?;
    finite("energy_defect_ratio", &[history.energy_defect_ratio])?;
    finite("outcome_time_s", &[history.outcome_time_s])?;
    let mut summary = json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "scenario": scenario.to_json(),
        "outcome": history.outcome.name(),
        "outcome_time_s": history.outcome_time_s,
        "overturning_sway": match history.outcome {
            Outcome::Overturned(sway) => Some(sway.name()),
            _ => None,
        },
        "impacts": history.impacts,
    });
    let more = summary.as_object_mut().expect("the summary is an object");
    let keys = columns(bodies, "peak_rotation", "rad");
    more.extend(keys.into_iter().zip(peaks.iter().map(|peak| json!(peak))));
    Ok(summary)
}
