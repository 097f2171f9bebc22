//! Step length: up to the first landing, or a step with merged landings if impacts are too frequent.

use super::{LandingStep, LandingStepper};
use crate::dynamics::RowMotionError;
use crate::mechanics::joints::SHUT_RATIO;

/// Maximum number of iterations to find the step that ends at a landing.
const LANDING_PASSES: usize = 30;
/// Relative width of the bracket around the landing that ends the search.
const BRACKET_RATIO: f64 = 1e-12;
/// Number of rounds of landings in a merged step before all corners that may land are constrained at once.
const LANDING_ROUNDS: usize = 8;
/// Relative tolerance between the step length and the landing.
const LANDING_TOLERANCE: f64 = 1e-6;

/// Corner that closes.
#[derive(Clone, Copy, Debug)]
struct ClosingCorner {
    joint: usize,
    edge: usize,
    gap_m: f64,
    /// Rate of the gap in m/s, below zero.
    rate_m_s: f64,
}

impl ClosingCorner {
    fn duration_s(&self) -> f64 {
        self.gap_m / -self.rate_m_s
    }
}

impl LandingStepper<'_> {
    /// Solves the step that ends at the first landing, or the longest step without a landing. The step length affects the kick and therefore the
    /// landing.
    pub(super) fn solve_to_landing(&mut self, longest: f64) -> Result<LandingStep, RowMotionError> {
        let floor = if self.has_impact_cluster() {
            self.observer.input.settings.shortest_step_s.min(longest)
        } else {
            0.0
        };
        let duration_s =
            |fall: Option<ClosingCorner>| fall.map_or(f64::INFINITY, |fall| fall.duration_s());
        let mut step = duration_s(self.first_landing()).clamp(floor, longest);
        // No corner lands within `safe`; some corner lands within `late`.
        let (mut safe, mut late) = (0.0, f64::INFINITY);
        // The initial rates correspond to a step of negative length whose kick ends at the end of the last kick.
        let mut earlier = 2.0 * (self.kicked_s - self.observer.time);
        for pass in 1.. {
            self.note_rates();
            self.solve_step(step)?;
            let fall = self.first_landing();
            let lands = duration_s(fall);
            let met = (lands - step).abs() <= LANDING_TOLERANCE * step;
            // With rounding errors a step may seem too long although it was safe before.
            if met || (lands > step && step == longest) || step == safe {
                return Ok(LandingStep {
                    expected_s: step,
                    length_s: if met { lands } else { step },
                    merged: false,
                });
            }
            if lands > step {
                safe = step;
            } else if step > floor {
                late = step;
            } else {
                break;
            }
            // There may be no landing to find if the mechanism changes with the step length.
            if pass >= LANDING_PASSES || late - safe <= BRACKET_RATIO * late {
                if safe == 0.0 {
                    break;
                }
                step = safe;
                continue;
            }
            let expected = fall.map_or(f64::INFINITY, |fall| self.landing(&fall, step, earlier));
            earlier = step;
            step = if safe < expected && expected < late {
                expected
            } else {
                0.5 * (safe + late)
            }
            .clamp(floor, longest);
        }
        let length_s = self.observer.input.settings.shortest_step_s.min(longest);
        self.merge(length_s)?;
        Ok(LandingStep {
            expected_s: length_s,
            length_s,
            merged: true,
        })
    }

    /// Step length at whose end a corner lands, by a linear model of its rate. The model uses the rates of the last two solved steps.
    fn landing(&self, fall: &ClosingCorner, step: f64, earlier: f64) -> f64 {
        let change = fall.rate_m_s - self.earlier_rates[fall.joint][fall.edge];
        let acceleration = change / (step - earlier);
        let rate = fall.rate_m_s - acceleration * step;
        let root = (rate * rate - 4.0 * acceleration * fall.gap_m).sqrt();
        2.0 * fall.gap_m / (root - rate)
    }

    /// Stores the rates of the last solution for comparison with the next ones.
    pub(super) fn note_rates(&mut self) {
        for (joint, rates) in self.program.open_joints() {
            self.earlier_rates[joint] = rates;
        }
    }

    /// Open corner that lands first at the rates of the last solution; `None` if none closes.
    fn first_landing(&self) -> Option<ClosingCorner> {
        let mut first: Option<ClosingCorner> = None;
        for (joint, rates) in self.program.open_joints() {
            let gaps = self.placement.gaps_m[joint];
            for edge in 0..2 {
                let fall = ClosingCorner {
                    joint,
                    edge,
                    gap_m: gaps[edge],
                    rate_m_s: rates[edge],
                };
                let falls = !self.load.touching[joint][edge] && fall.rate_m_s < 0.0;
                if falls && first.is_none_or(|first| fall.duration_s() < first.duration_s()) {
                    first = Some(fall);
                }
            }
        }
        first
    }

    /// Solves a step of fixed length in which all landing corners come into contact.
    fn merge(&mut self, step: f64) -> Result<(), RowMotionError> {
        if self.kicked_s < self.observer.time {
            self.complete_kick()?;
            self.adopt_pieces();
            self.kicked_s = self.observer.time;
        }
        self.cluster.impacts = 0;
        self.solve_step(step)?;
        let without = self.kinetic_of_solution() - self.work_of_right_support(0.0);
        for round in 0.. {
            self.landed.clear();
            for (joint, rates) in self.program.open_joints() {
                let gaps = self.placement.gaps_m[joint];
                for edge in 0..2 {
                    let rate = rates[edge] + self.landing[joint][edge];
                    let thickness = self.placement.frames[joint].thickness_m;
                    let lands = gaps[edge] + step * rate < -SHUT_RATIO * thickness;
                    if !self.load.touching[joint][edge] && lands {
                        self.landed.push((joint, edge));
                    }
                }
            }
            if self.landed.is_empty() {
                break;
            }
            // Landings propagate along the row. If they do not end, constrain all corners that may land.
            if round >= LANDING_ROUNDS {
                let rates = self.program.open_joints().flat_map(|(_, rates)| rates);
                let fastest = rates.fold(0.0_f64, |most, rate| most.max(rate.abs()));
                for (touching, gaps) in self.load.touching.iter_mut().zip(&self.placement.gaps_m) {
                    for edge in 0..2 {
                        touching[edge] |= gaps[edge] < step * fastest;
                    }
                }
            }
            for (joint, edge) in &self.landed {
                self.load.touching[*joint][*edge] = true;
                self.program.press(*joint, *edge);
            }
            for (joint, touching) in self.load.touching.iter().enumerate() {
                let rates = self.placement.gaps_m[joint].map(|gap| -gap / step);
                self.landing[joint] = match touching {
                    [true, true] => rates,
                    [true, false] => [rates[0]; 2],
                    [false, true] => [rates[1]; 2],
                    [false, false] => [0.0; 2],
                };
            }
            self.solve_step(step)?;
        }
        let with = self.kinetic_of_solution() - self.work_of_right_support(0.0);
        self.observer.row_summary.energy_taken_j += without - with;
        Ok(())
    }
}
