//! Options of the computation of motion: `[simulation]`.

use super::prelude::*;
use crate::Request;
use crate::dynamics::Directions;

/// Options of the computation of motion.
///
/// The output has 1 to 1e7 steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Longest time to simulate in s, from 1e-6 to 1e6; `None` for the default of [`Simulation::end_s`], which depends on the ground motion.
    pub duration_s: Option<f64>,
    /// Time between rows of the output in s, at least 1e-6 and at most the time to simulate.
    pub output_step_s: f64,
    /// Tolerance of the integrator, relative to the state, from 1e-13 to 1e-3.
    pub relative_tolerance: f64,
    /// Fraction of the energy barrier below which the structure is at rest, from 1e-16 to 0.1.
    pub rest_energy_ratio: f64,
    /// Acceleration of gravity in m/s2, from 0.001 to 1000.
    pub gravity_m_s2: f64,
    /// Directions of the ground motion in which motions are computed.
    pub direction: Directions,
}

impl Simulation {
    pub(super) fn read(table: &mut Table<'_>) -> ReadResult<Self> {
        let default = Request::default();
        let time_s = within(&Request::TIME_S);
        let duration_s = table.optional("duration_s", &time_s);
        let output_step_s = table.or(OUTPUT_STEP_S, &time_s, default.output_step_s);
        if let (Ok(()), Some(duration_s)) = (table.check_faultless(), duration_s)
            && let Some(wrong) = rows_fault(duration_s, output_step_s)
        {
            // A given step is easier to change than the duration.
            let key = ["duration_s", OUTPUT_STEP_S][usize::from(table.has_key(OUTPUT_STEP_S))];
            table.reject(key, wrong);
        }
        let [tolerance, rest_ratio] = [Request::RELATIVE_TOLERANCE, Request::REST_ENERGY_RATIO];
        let mut or = |key, range, default| table.or(key, &within(&range), default);
        Ok(Self {
            duration_s,
            output_step_s,
            relative_tolerance: or("relative_tolerance", tolerance, default.relative_tolerance),
            rest_energy_ratio: or("rest_energy_ratio", rest_ratio, default.rest_energy_ratio),
            gravity_m_s2: or("gravity_m_s2", Request::GRAVITY_M_S2, default.gravity_m_s2),
            direction: table.or("direction", &one_of(Directions::ALL), Directions::default()),
        })
    }

    /// Latest end of a history, in seconds: `duration_s`. The default is the end of the ground motion plus the larger of 10 s and 20
    /// times the square root of size over gravity, at most ten million output steps. In that time a surviving structure comes to rest, or nearly
    /// so. `size_m` is that of [`Structure::size_m`](super::Structure::size_m).
    pub fn end_s(&self, ground_end_s: f64, size_m: f64) -> f64 {
        let after_s = AFTER_RATIO * (size_m / self.gravity_m_s2).sqrt();
        let default_s = ground_end_s + after_s.max(AFTER_S);
        let most_s = Request::MOST_SAMPLES * self.output_step_s;
        let most_s = most_s.min(*Request::TIME_S.end());
        self.duration_s.unwrap_or(default_s.min(most_s))
    }

    /// Latest end of a history without an outcome at its default end `end_s`: 64 times as long after the ground motion; `None` if
    /// `duration_s` is given.
    pub(super) fn outcome_by_s(&self, ground_end_s: f64, end_s: f64) -> Option<f64> {
        let latest_s = ground_end_s + LATEST_RATIO * (end_s - ground_end_s);
        let latest_s = latest_s.min(*Request::TIME_S.end());
        self.duration_s.is_none().then_some(latest_s)
    }

    /// Checks that the output of a history with default end has at least one step and fits on a disk.
    pub(super) fn check_default_end(&self, table: &mut Table<'_>, end_s: f64) -> ReadResult<()> {
        let is_default = self.duration_s.is_none();
        let fault = rows_fault(end_s, self.output_step_s).filter(|_| is_default);
        let Some(wrong) = fault else {
            return Ok(());
        };
        if table.has_key_in("simulation", OUTPUT_STEP_S) {
            return Err(table.reject_in(&["simulation"], OUTPUT_STEP_S, wrong));
        }
        Err(table.fault_of_table(format!(
            "{wrong}; give `duration_s` or `output_step_s` in [simulation]"
        )))
    }
}

const OUTPUT_STEP_S: &str = "output_step_s";
/// Default time of a history after the ground motion, in seconds.
const AFTER_S: f64 = 10.0;
/// Default time of a history after the ground motion, over the square root of size over gravity; the longer default counts.
const AFTER_RATIO: f64 = 20.0;
/// Longest time of a history without an outcome after the ground motion, over the default time: six doublings. Slender stacks lose less than a per cent
/// of their energy in an impact, and take so long until a quarter of the barrier is left.
const LATEST_RATIO: f64 = 64.0;

/// Reason why the output of a history is too short or too long; `None` if it is neither.
fn rows_fault(duration_s: f64, step_s: f64) -> Option<String> {
    let rows = duration_s / step_s;
    let (step, run, most) = (plain(step_s), plain(duration_s), Request::MOST_SAMPLES);
    match rows {
        ..1.0 => Some(format!(
            "makes the output step of {step} s longer than the run of {run} s; the step must not exceed the run"
        )),
        rows if rows > most => Some(format!(
            "makes {rows:.0} rows of output, every {step} s for {run} s; at most {most:.0} are allowed"
        )),
        _ => None,
    }
}
