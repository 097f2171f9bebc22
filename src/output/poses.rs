//! `poses.csv`: where every body is.

use std::io::Write;

use super::OutputError;
use super::rotations::columns;
use super::table::{Table, table};
use crate::dynamics::history::Sample;

/// Writes a row per sample: `time_s`, then for each body `x_..._m`, `y_..._m`, `rotation_..._rad`.
///
/// The body's point that is at the origin when undeformed is at `(x, y)`, relative to the ground; the origin is the centre
/// of a circular arch, the middle of a column's base. A corner that was at `c` is at `(x, y) + R c`, where `R` turns
/// anticlockwise by the rotation.
pub struct PosesWriter<W: Write> {
    csv: Table<W>,
}

impl<W: Write> PosesWriter<W> {
    const WHAT: &str = "cannot write the poses";

    /// Starts with the header for bodies of these names.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn new(writer: W, bodies: &[String]) -> Result<Self, OutputError> {
        let mut csv = table(writer);
        let by_body = bodies.iter().flat_map(|body| {
            let body = std::slice::from_ref(body);
            [("x", "m"), ("y", "m"), ("rotation", "rad")]
                .into_iter()
                .flat_map(move |(quantity, unit)| columns(body, quantity, unit))
        });
        let header = std::iter::once("time_s".to_owned()).chain(by_body);
        csv.write_record(header)
            .map_err(OutputError::csv(Self::WHAT))?;
        Ok(Self { csv })
    }

    /// Writes a row.
    ///
    /// # Errors
    /// When the system refuses, or a value is not finite.
    pub fn write(&mut self, sample: &Sample) -> Result<(), OutputError> {
        let poses = sample.poses.iter();
        let values: Vec<f64> = poses
            .flat_map(|pose| [pose.translation.x, pose.translation.y, pose.rotation_rad()])
            .collect();
        self.csv
            .serialize((sample.time_s, values))
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
