//! How the motion is computed: `[simulation]`.

use serde::Serialize;

use super::table::{Number, Reading, Table};
use crate::argument::plain;
use crate::dynamics::model::Request;

const GRAVITY_M_S2: Number = Number::within(&Request::GRAVITY_M_S2);
const TIME_S: Number = Number::within(&Request::TIME_S);
const RELATIVE_TOLERANCE: Number = Number::within(&Request::RELATIVE_TOLERANCE);
const REST_ENERGY_RATIO: Number = Number::within(&Request::REST_ENERGY_RATIO);

/// How the motion is computed.
///
/// The output has at least one step and at most 1e7 of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Longest time to simulate, in 1e-6 to 1e6.
    pub duration_s: f64,
    /// Time between rows of the output, at least 1e-6 and at most `duration_s`.
    pub output_step_s: f64,
    /// Allowed error of the integrator, relative to the state, in 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// The structure is at rest when its energy falls below this fraction of the energy barrier, in 1e-16 to 0.1.
    pub rest_energy_ratio: f64,
    /// Acceleration of gravity, in 0.001 to 1000.
    pub gravity_m_s2: f64,
}

impl Simulation {
    pub(super) fn read(table: &mut Table<'_>) -> Reading<Self> {
        let default = Request::default();
        let duration_s = table.or("duration_s", &TIME_S, default.end_s);
        let output_step_s = table.or("output_step_s", &TIME_S, default.output_step_s);
        let rows = Self::check_rows(table, duration_s, output_step_s);
        let relative_tolerance = table.or(
            "relative_tolerance",
            &RELATIVE_TOLERANCE,
            default.relative_tolerance,
        );
        let rest_energy_ratio = table.or(
            "rest_energy_ratio",
            &REST_ENERGY_RATIO,
            default.rest_energy_ratio,
        );
        let gravity_m_s2 = table.or("gravity_m_s2", &GRAVITY_M_S2, default.gravity_m_s2);
        rows?;
        Ok(Self {
            duration_s: duration_s?,
            output_step_s: output_step_s?,
            relative_tolerance: relative_tolerance?,
            rest_energy_ratio: rest_energy_ratio?,
            gravity_m_s2: gravity_m_s2?,
        })
    }

    /// Checks that the output has at least one step and fits on a disk.
    fn check_rows(
        table: &mut Table<'_>,
        duration_s: Reading<f64>,
        output_step_s: Reading<f64>,
    ) -> Reading<()> {
        let (duration_s, step_s) = (duration_s?, output_step_s?);
        let rows = duration_s / step_s;
        let wrong = if rows < 1.0 {
            format!(
                "makes the output step of {} s longer than the run of {} s; the step must not exceed the run",
                plain(step_s),
                plain(duration_s)
            )
        } else if rows > Request::MOST_SAMPLES {
            format!(
                "makes {rows:.0} rows of output, every {} s for {} s; at most {:.0} are allowed",
                plain(step_s),
                plain(duration_s),
                Request::MOST_SAMPLES
            )
        } else {
            return Ok(());
        };
        // The defaults agree with each other, so at least one of the two is given; the step is easier to change.
        let culprit = if table.gives("output_step_s") {
            "output_step_s"
        } else {
            "duration_s"
        };
        Err(table.wrong(culprit, wrong))
    }
}
