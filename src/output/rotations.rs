//! `rotations.csv`: the time series of rotations.

use std::io::Write;

use super::OutputError;
use super::table::{Table, table};
use crate::dynamics::history::Sample;
use crate::dynamics::model::MechanismModel;
use crate::mechanics::sway::Sway;

/// Column of a quantity of a body: `rotation_left_rad`, or `rotation_rad` where there is only one body.
fn column(quantity: &str, body: &str, unit: &str) -> String {
    if body.is_empty() {
        format!("{quantity}_{unit}")
    } else {
        format!("{quantity}_{body}_{unit}")
    }
}

/// Names of the columns for each body.
pub(crate) fn columns(bodies: &[String], quantity: &str, unit: &str) -> Vec<String> {
    bodies
        .iter()
        .map(|body| column(quantity, body, unit))
        .collect()
}

/// What makes a history dimensionless, as papers plot it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// `p`, that of the equivalent block at the unstable equilibrium (see
    /// [`crate::mechanics::equivalent`]); a column's own.
    pub frequency_rad_s: f64,
    /// `g A_L`, the acceleration that starts the structure.
    pub incipient_m_s2: f64,
}

impl Scales {
    /// The scales of a model under gravity; `None` if it has no unstable equilibrium.
    #[must_use]
    pub fn new(model: &dyn MechanismModel, gravity_m_s2: f64) -> Option<Self> {
        Some(Self {
            frequency_rad_s: model.equivalent(gravity_m_s2)?.at_critical?.frequency_rad_s,
            incipient_m_s2: model.incipient_acceleration_g(Sway::Right)? * gravity_m_s2,
        })
    }
}

/// Writes samples as rows of CSV.
///
/// With scales, three columns follow the others: `p_t` (time times `p`), `acceleration_over_incipient`
/// (ground acceleration over `g A_L`) and `rotation_over_critical` (see
/// [`Sample::rotation_over_critical`]).
pub struct RotationsWriter<W: Write> {
    csv: Table<W>,
    scales: Option<Scales>,
    rows: u64,
    /// Whether the bodies are the blocks of a row with free hinges.
    of_row: bool,
    /// Whether there is a column for the vertical acceleration.
    vertical: bool,
}

impl<W: Write> RotationsWriter<W> {
    /// Starts with the header for bodies of these names. Where the ground moves vertically too,
    /// its vertical acceleration is a further column after all others.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn new(
        writer: W,
        bodies: &[String],
        vertical: bool,
        scales: Option<Scales>,
    ) -> Result<Self, OutputError> {
        Self::start(writer, bodies, vertical, scales, false)
    }

    /// The same for a row of blocks with free hinges: instead of the excess of the thrust line, which stays inside,
    /// there is the number of `open_joints`.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn of_row(writer: W, blocks: &[String], vertical: bool) -> Result<Self, OutputError> {
        Self::start(writer, blocks, vertical, None, true)
    }

    fn start(
        writer: W,
        bodies: &[String],
        vertical: bool,
        scales: Option<Scales>,
        of_row: bool,
    ) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let mut header: Vec<String> = ["time_s", "ground_acceleration_m_s2", "phase", "state"]
            .map(str::to_owned)
            .to_vec();
        header.extend(columns(bodies, "rotation", "rad"));
        header.extend(columns(bodies, "rate", "rad_s"));
        let asked = if of_row {
            "open_joints"
        } else {
            "thrust_excess_ratio"
        };
        header.extend([asked, "friction_demand"].map(str::to_owned));
        if vertical {
            header.push("vertical_acceleration_m_s2".to_owned());
        }
        if scales.is_some() {
            let further = [
                "p_t",
                "acceleration_over_incipient",
                "rotation_over_critical",
            ];
            header.extend(further.map(str::to_owned));
        }
        csv.write_record(header).map_err(OutputError::csv(WHAT))?;
        Ok(Self {
            csv,
            scales,
            rows: 0,
            of_row,
            vertical,
        })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write(&mut self, sample: &Sample) -> Result<(), OutputError> {
        let (rotations, rates) = (&sample.rotations_rad[..], &sample.rates_rad_s[..]);
        let vertical = self.vertical.then_some(sample.vertical_acceleration_m_s2);
        let excess = (!self.of_row).then_some(sample.demand.excess_ratio);
        let open_joints = self.of_row.then_some(sample.hinges.len());
        let further = self.scales.map(|scales| {
            [
                sample.time_s * scales.frequency_rad_s,
                sample.ground_acceleration_m_s2 / scales.incipient_m_s2,
                sample.rotation_over_critical.unwrap_or(0.0),
            ]
        });
        let further = further.as_ref().map_or(&[][..], |values| values.as_slice());
        self.rows += 1;
        self.csv
            .serialize((
                sample.time_s,
                sample.ground_acceleration_m_s2,
                sample.phase,
                sample.state.name(),
                rotations,
                rates,
                excess.as_slice(),
                open_joints.as_slice(),
                sample.demand.friction,
                vertical.as_slice(),
                further,
            ))
            .map_err(OutputError::csv(WHAT))
    }

    /// Ends the table and returns the number of its rows.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn finish(mut self) -> Result<u64, OutputError> {
        self.csv.flush().map_err(OutputError::io(WHAT))?;
        Ok(self.rows)
    }
}

const WHAT: &str = "cannot write the rotations";
