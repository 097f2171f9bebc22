//! Active-set search by the dual method of Goldfarb and Idnani, one corner at a time.

use super::answer::CornerImpulse;
use super::{ContactError, ContactProgram, DEPENDENCE, Effort, RATE_TOLERANCE, pivot_exceeds};
use crate::mechanics::Corners;

/// Loosest tolerance of closing rates; beyond it a program counts as unsolved.
const LARGEST_RATE_TOLERANCE: f64 = 1e-7;
/// Smallest decrease of a corner impulse per unit impulse elsewhere that is no rounding error.
const LEAST_SLOPE: f64 = 1e-12;

impl ContactProgram {
    /// Releases corners that pull, and activates closing corners one by one. Returns false after too many iterations, or if a closing corner depends
    /// on active ones and none of these can be released: its closing rate is then a rounding error.
    fn exchange_singly(
        &mut self,
        touching: &[Corners],
        tolerance: f64,
        iterations: &mut usize,
    ) -> bool {
        let cap = *iterations + 60 + 2 * self.active.len();
        self.jammed = None;
        while *iterations <= cap {
            if self.release() {
                self.factor.update(&self.active);
                self.answer.take_load(&self.factor, None);
                *iterations += 1;
                continue;
            }
            let Some((pin, edge)) = self.fastest_closing(touching, tolerance) else {
                return true;
            };
            if !self.activate(pin, edge, iterations, cap) {
                self.factor.update(&self.active);
                self.answer.take_load(&self.factor, None);
                *iterations += 1;
                return false;
            }
        }
        false
    }

    /// Runs the dual method, and relaxes the tolerance tenfold each time it does not converge.
    pub(super) fn exchange_tolerantly(
        &mut self,
        touching: &[Corners],
        largest_rate: f64,
        effort: &mut Effort,
    ) -> Result<(), ContactError> {
        let mut tolerance = RATE_TOLERANCE;
        let iterations = &mut effort.iterations;
        while !self.exchange_singly(touching, tolerance * largest_rate, iterations) {
            tolerance *= 10.0;
            effort.relaxed += 1;
            if tolerance > LARGEST_RATE_TOLERANCE {
                let iterations = *iterations;
                return Err(match self.jammed {
                    Some(joint) => ContactError::Jammed(joint),
                    None => ContactError::Unsolved(iterations),
                });
            }
        }
        Ok(())
    }

    /// Releases the worst corner of each run of neighbours that pull. Returns false if none pulls.
    fn release(&mut self) -> bool {
        let limit = self.pull_limit();
        self.wrong.clear();
        for edge in 0..2 {
            self.find_pulling(edge, limit);
        }
        self.keep_worst(false);
        self.flip_wrong();
        !self.wrong.is_empty()
    }

    /// Pin and edge of the corner that closes fastest; `None` if all closing rates are within the tolerance.
    fn fastest_closing(&self, touching: &[Corners], tolerance: f64) -> Option<(usize, usize)> {
        let mut fastest = None;
        let mut least = -tolerance;
        for (index, (pin, rates)) in self.factor.pins.iter().zip(&self.answer.rates).enumerate() {
            for (edge, rate) in rates.iter().enumerate() {
                let free = touching[pin.joint][edge] && !self.active[pin.joint][edge];
                if free && *rate < least {
                    least = *rate;
                    fastest = Some((index, edge));
                }
            }
        }
        fastest
    }

    /// Adds a closing corner to the active set, and releases those that would pull as its impulse grows. Returns false if no corner can be released.
    fn activate(
        &mut self,
        mut pin: usize,
        edge: usize,
        iterations: &mut usize,
        cap: usize,
    ) -> bool {
        let joint = self.factor.pins[pin].joint;
        let mut impulse = 0.0;
        loop {
            self.response.take_unit(&self.factor, pin, edge);
            *iterations += 1;
            let compliance = self.response.rates[pin][edge];
            let free =
                self.factor.bodies[pin].inverse_mass + self.factor.bodies[pin + 1].inverse_mass;
            let yields = compliance > DEPENDENCE * free;
            let stops = (-self.answer.rates[pin][edge] / compliance).max(0.0);
            let full = if yields { stops } else { f64::INFINITY };
            let (partial, blocking) = self.first_to_pull();
            if full <= partial && full < f64::INFINITY {
                self.active[joint][edge] = true;
                if pivot_exceeds(self.factor.update(&self.active), DEPENDENCE) {
                    self.answer.take_load(&self.factor, None);
                    *iterations += 1;
                    return true;
                }
                // The corner depends on the active ones.
                self.active[joint][edge] = false;
                self.factor.update(&self.active);
            }
            let Some((blocked, blocked_edge)) = blocking else {
                self.jammed = Some(joint);
                return false;
            };
            impulse += partial;
            self.active[blocked][blocked_edge] = false;
            self.factor.update(&self.active);
            let mut pins = self.factor.pins.iter();
            let Some(found) = pins.position(|pin| pin.joint == joint) else {
                return false;
            };
            pin = found;
            let press = CornerImpulse { pin, edge, impulse };
            self.answer.take_load(&self.factor, Some(press));
            *iterations += 1;
            if *iterations > cap {
                return true;
            }
        }
    }

    /// Impulse at which the first active corner becomes tensile, and that corner.
    fn first_to_pull(&self) -> (f64, Option<(usize, usize)>) {
        let mut first = (f64::INFINITY, None);
        for (joint, active) in self.active.iter().enumerate() {
            for (edge, active) in active.iter().enumerate() {
                let slope = self.response.corners[joint][edge];
                if *active && slope < -LEAST_SLOPE {
                    let impulse = (self.answer.corners[joint][edge] / -slope).max(0.0);
                    if impulse < first.0 {
                        first = (impulse, Some((joint, edge)));
                    }
                }
            }
        }
        first
    }
}
