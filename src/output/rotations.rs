//! `rotations.csv`: the time series of rotations.

use std::io::Write;

use super::{OutputError, finite};
use crate::dynamics::history::Sample;
use crate::mechanics::structure::Mechanism;

/// Column of a quantity of a body: `rotation_left_rad`, or `rotation_rad` where there is only one body.
fn column(quantity: &str, body: &str, unit: &str) -> String {
    if body.is_empty() {
        format!("{quantity}_{unit}")
    } else {
        format!("{quantity}_{body}_{unit}")
    }
}

/// Names of the columns for each body of a mechanism.
pub(super) fn columns<M: Mechanism>(quantity: &str, unit: &str) -> Vec<String> {
    M::BODIES
        .iter()
        .map(|body| column(quantity, body, unit))
        .collect()
}

/// Writes samples as rows of CSV.
pub struct RotationsWriter<W: Write> {
    csv: csv::Writer<W>,
    rows: u64,
    /// Whether there is a column for the vertical acceleration.
    vertical: bool,
}

impl<W: Write> RotationsWriter<W> {
    /// Starts with the header for the mechanisms of a structure. Where the ground moves vertically too,
    /// its vertical acceleration is a further column after all others.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn new<M: Mechanism>(writer: W, vertical: bool) -> Result<Self, OutputError> {
        let mut csv = csv::Writer::from_writer(writer);
        let mut header: Vec<String> = ["time_s", "ground_acceleration_m_s2", "phase", "state"]
            .map(str::to_owned)
            .to_vec();
        header.extend(columns::<M>("rotation", "rad"));
        header.extend(columns::<M>("rate", "rad_s"));
        header.extend(["thrust_excess_ratio", "friction_demand"].map(str::to_owned));
        if vertical {
            header.push("vertical_acceleration_m_s2".to_owned());
        }
        csv.write_record(header).map_err(OutputError::csv(WHAT))?;
        Ok(Self {
            csv,
            rows: 0,
            vertical,
        })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write<R: AsRef<[f64]>>(&mut self, sample: &Sample<R>) -> Result<(), OutputError> {
        let (rotations, rates) = (sample.rotations_rad.as_ref(), sample.rates_rad_s.as_ref());
        finite(
            "of a row of rotations.csv",
            &[sample.time_s, sample.ground_acceleration_m_s2],
        )?;
        let vertical = self.vertical.then_some(sample.vertical_acceleration_m_s2);
        finite("of a row of rotations.csv", vertical.as_slice())?;
        finite("of a row of rotations.csv", rotations)?;
        finite("of a row of rotations.csv", rates)?;
        let demand = [sample.demand.excess_ratio, sample.demand.friction];
        finite("of a row of rotations.csv", &demand)?;
        self.rows += 1;
        self.csv
            .serialize((
                sample.time_s,
                sample.ground_acceleration_m_s2,
                sample.phase,
                sample.state,
                rotations,
                rates,
                demand,
                vertical.as_slice(),
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
