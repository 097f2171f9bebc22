//! A check of local mechanisms by the Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018.
//!
//! The mechanism that starts to a side is a chain of rigid bodies ([`Mechanism`]): its load multiplier, participating mass and
//! capacity curve are compared with a spectrum ([`Spectrum`]) at each limit state. This study tells itself: [`to_json`] has every
//! number, [`words()`] the result, and [`page()`] what another engineer needs to redo it by hand. Where the text of the Circolare
//! leaves room, what is done is among the [decisions](notes) that the page prints.

pub mod histories;
mod mechanism;
pub mod notes;
mod page;
mod picture;
mod summary;
mod words;

use std::f64::consts::PI;

use thiserror::Error;

use crate::bisection::{Width, bisect};
use crate::dynamics::demand::floor::FloorSpectrum;
use crate::dynamics::demand::ground::{GroundSpectrum, Site};
use crate::dynamics::demand::points::Beyond;
use crate::mechanics::capacity::Capacity;
use crate::mechanics::sway::Sway;
use crate::scenario::{Demand, LimitState, PointDemand, Scenario, Sides, StateRule, Verify};
pub use histories::{Histories, HistorySide};
pub use mechanism::{Mechanism, PlacedHinge, Way};
pub use page::{page, tell};
pub use summary::to_json;
pub use words::words;

/// Why a scenario cannot be checked.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoCheck {
    /// There is nothing to compare with.
    #[error(
        "the scenario has no [demand]: give it a table, such as\n\n[demand]\nsoil = \"B\"\ntopography = \"T1\"\n\n\
         [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35"
    )]
    NoDemand,
    /// There is no mechanism to a side.
    #[error("there is no mechanism to check: {0}")]
    NoMechanism(String),
    /// Sliding has a smaller multiplier than the mechanism without it.
    #[error(
        "no check is possible to the {}: with a friction coefficient of {} joints slide at {at_g:.4} g at most (associated \
         bound), before a mechanism without sliding forms at {alpha0:.4} g, and the least multiplier counts. Check the other \
         side alone with `sides`, or another structure",
        .sway.name(), notes::FRICTION
    )]
    Slides {
        /// To which side.
        sway: Sway,
        /// The push at which joints slide, in g.
        at_g: f64,
        /// Load multiplier of the mechanism without sliding.
        alpha0: f64,
    },
    /// Without a curve there is only the simplified check.
    #[error(
        "no check is possible: {0}. Without a capacity curve there are the damage limit state and the simplified check of SLV \
         with q (C8.7.1.2.1.7), from the parameters of NTC 2018: give [demand.sld] and [demand.slv]"
    )]
    NoCurve(String),
    /// Histories cannot be computed.
    #[error("the histories of {}_records are not possible: {why}", .state.name())]
    Histories {
        /// Of which state.
        state: LimitState,
        /// Why.
        why: String,
    },
    /// A spectrum of points ends too early.
    #[error("[demand.{}] {beyond}", .state.name())]
    Beyond {
        /// Of which state.
        state: LimitState,
        /// Where it is needed.
        beyond: Beyond,
    },
}

/// The spectrum where the mechanism stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// Of NTC 2018, on the ground.
    Ground(GroundSpectrum),
    /// The same at a height in a building.
    Floor(GroundSpectrum, FloorSpectrum),
    /// By points.
    Points(PointDemand),
}

impl Spectrum {
    /// The one of a limit state; `None` if that is not asked for.
    fn of(demand: &Demand, state: LimitState) -> Option<Self> {
        let code = match demand {
            Demand::Points(points) => return points.get(state).cloned().map(Self::Points),
            Demand::Code(code) => code,
        };
        let site = Site {
            soil: code.soil,
            topographic_factor: code.relief.factor(),
        };
        let ground = GroundSpectrum::new(*code.hazards.get(state)?, site)
            .expect("the hazards of a scenario are within the ranges of the code");
        let height = code.height.as_ref();
        let floor = height.and_then(|height| FloorSpectrum::new(ground, height.at(state)));
        Some(match floor {
            Some(floor) => Self::Floor(ground, floor),
            None => Self::Ground(ground),
        })
    }

    /// That of the ground by the code.
    #[must_use]
    pub const fn ground(&self) -> Option<&GroundSpectrum> {
        match self {
            Self::Ground(ground) | Self::Floor(ground, _) => Some(ground),
            Self::Points(_) => None,
        }
    }

    /// Acceleration of the hazard `a_g`; of points, the peak, if they begin at the period zero. In g.
    #[must_use]
    pub fn ag_g(&self) -> Option<f64> {
        match self {
            Self::Ground(ground) | Self::Floor(ground, _) => Some(ground.hazard.ag_g),
            Self::Points(demand) => demand.points.peak_g().ok(),
        }
    }

    /// Peak acceleration of the structure that carries the mechanism, in g.
    ///
    /// # Errors
    /// When it is not among the points.
    pub fn peak_g(&self) -> Result<f64, Beyond> {
        match self {
            Self::Ground(ground) => Ok(ground.peak_g()),
            Self::Floor(_, floor) => Ok(floor.peak_g()),
            Self::Points(demand) => demand.points.peak_g(),
        }
    }

    /// Spectral acceleration at a period and a damping, in g.
    ///
    /// # Errors
    /// When the period is beyond the points.
    pub fn acceleration_g(&self, period_s: f64, damping_percent: f64) -> Result<f64, Beyond> {
        match self {
            Self::Ground(ground) => Ok(ground.acceleration_g(period_s, damping_percent)),
            Self::Floor(_, floor) => Ok(floor.acceleration_g(period_s, damping_percent)),
            Self::Points(demand) => demand.points.acceleration_g(period_s, damping_percent),
        }
    }

    /// Displacement that is demanded of what has softened to a period, in metres; of points, from the period `from_s` on.
    ///
    /// # Errors
    /// When a period is beyond the points.
    pub fn displacement_m(
        &self,
        period_s: f64,
        from_s: Option<f64>,
        damping_percent: f64,
        gravity_m_s2: f64,
    ) -> Result<f64, Beyond> {
        Ok(match self {
            Self::Ground(ground) => {
                ground.largest_displacement_m(period_s, damping_percent, gravity_m_s2)
            }
            Self::Floor(_, floor) => floor.displacement_m(period_s, damping_percent, gravity_m_s2),
            Self::Points(demand) => {
                let points = &demand.points;
                let from_s = from_s.unwrap_or(points.range_s()[0]).min(period_s);
                let periods_s = [from_s, period_s];
                points
                    .largest_displacement(periods_s, damping_percent, gravity_m_s2)?
                    .0
            }
        })
    }
}

/// What is borne over what is demanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// The ground acceleration, as `a_g`, that is borne, in g; `None` where a spectrum of points has no peak.
    pub ag_capacity_g: Option<f64>,
    /// That which is demanded, in g.
    pub ag_g: Option<f64>,
    /// The first over the second.
    pub zeta_e: f64,
}

impl Margin {
    fn new(zeta_e: f64, ag_g: Option<f64>) -> Self {
        Self {
            ag_capacity_g: ag_g.map(|ag_g| ag_g * zeta_e),
            ag_g,
            zeta_e,
        }
    }

    /// Whether as much is borne as is demanded.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.zeta_e >= 1.0
    }
}

/// The beginning of the motion (SLD).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activation {
    /// Spectral acceleration at which it starts, over FC, in g.
    pub capacity_g: f64,
    /// That which is demanded, in g.
    pub demand_g: f64,
    /// One over the other.
    pub margin: Margin,
}

/// The simplified check of SLV, by the behaviour factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simplified {
    /// Activation that it is a multiple of, as `a_g`, in g.
    pub activation_ag_g: f64,
    /// The behaviour factor.
    pub behaviour_factor: f64,
    /// What is borne.
    pub margin: Margin,
}

/// The check by displacements (SLV, SLC).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByDisplacement {
    /// Part of the ultimate displacement that the state is at, in metres.
    pub reached_m: f64,
    /// The same divided: displacement of the oscillator that may be reached, in metres.
    pub capacity_m: f64,
    /// Acceleration there, divided, in g.
    pub acceleration_g: f64,
    /// Period there, in seconds.
    pub period_s: f64,
    /// Spectral acceleration at that period, in g.
    pub demand_g: f64,
    /// Displacement that is demanded, in metres.
    pub demand_m: f64,
    /// What it is at least, in metres, beyond the resonance with a building.
    pub resonance_m: Option<f64>,
    /// One over the other, and what counts of it: if it starts later than that, the activation.
    pub displacement: Margin,
    /// The activation, as `a_g` in g, where that is larger.
    pub activation_ag_g: Option<f64>,
    /// What is borne.
    pub margin: Margin,
    /// The `a_g` that is borne where the shape of the spectrum follows it, in g; `None` if it is not on the ground, or beyond
    /// the range of the code.
    pub ag_following_g: Option<f64>,
    /// `zeta_E` where the control point is the crown; `None` where that does not move.
    pub zeta_e_crown: Option<f64>,
}

/// The checks of a limit state to a side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideCheck {
    /// The side.
    pub sway: Sway,
    /// Of SLD.
    pub activation: Option<Activation>,
    /// Of SLV.
    pub simplified: Option<Simplified>,
    /// Of SLV and SLC.
    pub displacement: Option<ByDisplacement>,
}

named! {
    /// How a limit state is checked.
    pub enum Method {
        /// The motion does not begin (C8.7.1.2.1.5).
        Activation = "activation",
        /// A multiple of that (C8.7.1.2.1.7).
        Simplified = "simplified",
        /// By displacements (C8.7.1.2.1.8).
        Displacement = "displacement",
    }
}

impl SideCheck {
    /// The check that counts: by displacements, if there is a curve.
    #[must_use]
    pub fn governing(&self) -> Option<(Method, Margin)> {
        let displacement = self
            .displacement
            .map(|one| (Method::Displacement, one.margin));
        let simplified = self.simplified.map(|one| (Method::Simplified, one.margin));
        let activation = self.activation.map(|one| (Method::Activation, one.margin));
        displacement.or(simplified).or(activation)
    }
}

/// A limit state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateCheck {
    /// Which.
    pub state: LimitState,
    /// What is demanded.
    pub spectrum: Spectrum,
    /// What is allowed; `None` of SLD.
    pub rule: Option<StateRule>,
    /// To each side that is checked.
    pub sides: Vec<SideCheck>,
    /// By histories, where there are records.
    pub histories: Option<Histories>,
}

impl StateCheck {
    /// The side that counts, how it is checked and what comes of it; `None` if the state cannot be checked.
    #[must_use]
    pub fn governing(&self) -> Option<(Sway, Method, Margin)> {
        let sides = self.sides.iter();
        let checked: Option<Vec<(Sway, Method, Margin)>> = sides
            .map(|side| {
                let (method, margin) = side.governing()?;
                Some((side.sway, method, margin))
            })
            .collect();
        let worst = |a: &(_, _, Margin), b: &(_, _, Margin)| a.2.zeta_e.total_cmp(&b.2.zeta_e);
        checked?.into_iter().min_by(worst)
    }
}

/// The check of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// How it is checked.
    pub settings: Verify,
    /// What is demanded.
    pub demand: Demand,
    /// Gravity, in m/s2.
    pub gravity_m_s2: f64,
    /// Period of the elastic vibration before it moves, in seconds; `None`: held by walls all along.
    pub t0_s: Option<f64>,
    /// The mechanism to each side that is checked.
    pub mechanisms: Vec<Mechanism>,
    /// The limit states that are asked for.
    pub states: Vec<StateCheck>,
}

impl Check {
    /// Checks a scenario.
    ///
    /// # Errors
    /// When there is no demand, no mechanism, no check for one, or a spectrum of points ends too early.
    pub fn new(scenario: &Scenario) -> Result<Self, NoCheck> {
        let demand = scenario.demand().cloned().ok_or(NoCheck::NoDemand)?;
        let settings = scenario.verify().cloned().unwrap_or_default();
        let gravity_m_s2 = scenario.gravity_m_s2();
        let sides: &[Sway] = match settings.sides {
            Sides::Both => Sway::ALL,
            Sides::Right => &[Sway::Right],
            Sides::Left => &[Sway::Left],
        };
        let mechanisms = mechanism::mechanisms(scenario.structure(), sides, gravity_m_s2)?;
        let (_, density_kg_m3) = scenario.structure().depth_and_density();
        let free = settings.free_standing.as_ref();
        let t0_s = free.map(|free| free.period_s(density_kg_m3));
        let mut check = Self {
            settings,
            demand,
            gravity_m_s2,
            t0_s,
            mechanisms,
            states: Vec::new(),
        };
        for state in check.demand.states().collect::<Vec<_>>() {
            let one = check.state(scenario, state)?;
            check.states.push(one);
        }
        let ultimate = check
            .states
            .iter()
            .filter(|one| one.state != LimitState::Sld);
        if ultimate.clone().all(|one| one.governing().is_none()) {
            let whys = check
                .mechanisms
                .iter()
                .filter_map(|one| one.way.as_ref().err());
            let why = whys.into_iter().next().cloned().unwrap_or_default();
            return Err(NoCheck::NoCurve(why));
        }
        Ok(check)
    }

    /// Whether spectra are those of NTC 2018, so that clauses of the Circolare are named.
    #[must_use]
    pub const fn by_the_code(&self) -> bool {
        matches!(self.demand, Demand::Code(_))
    }

    /// The least `zeta_E` of the states that are asked for.
    #[must_use]
    pub fn zeta_e(&self) -> f64 {
        let states = self.states.iter().filter_map(StateCheck::governing);
        states
            .map(|(.., margin)| margin.zeta_e)
            .fold(f64::INFINITY, f64::min)
    }

    /// The largest part of the ultimate displacement that any of the states allows.
    #[must_use]
    pub fn furthest_part(&self) -> f64 {
        let rules = self.states.iter().filter_map(|one| one.rule);
        rules.map(|rule| rule.part_of_d0).fold(0.0, f64::max)
    }

    /// The mechanism to a side.
    #[must_use]
    pub fn mechanism(&self, sway: Sway) -> Option<&Mechanism> {
        self.mechanisms.iter().find(|one| one.sway == sway)
    }

    /// `a_0 / FC = alpha0 / (e* FC)`, in g.
    #[must_use]
    pub fn activation_g(&self, mechanism: &Mechanism) -> f64 {
        mechanism.alpha0 / (mechanism.participation.mass_fraction * self.settings.confidence_factor)
    }

    fn state(&self, scenario: &Scenario, state: LimitState) -> Result<StateCheck, NoCheck> {
        let spectrum = Spectrum::of(&self.demand, state).expect("the state is asked for");
        let rule = match &spectrum {
            Spectrum::Points(demand) => demand.state,
            Spectrum::Ground(_) | Spectrum::Floor(..) => {
                StateRule::circolare(state, self.settings.confidence_factor)
            }
        };
        let sides = self.mechanisms.iter().map(|mechanism| {
            let activation = match state {
                LimitState::Sld => Some(self.activation(mechanism, &spectrum)?),
                LimitState::Slv | LimitState::Slc => None,
            };
            let displacement = match (&mechanism.way, &rule) {
                (Ok(way), Some(rule)) => {
                    Some(self.by_displacement(mechanism, way, &spectrum, rule)?)
                }
                _ => None,
            };
            Ok(SideCheck {
                sway: mechanism.sway,
                activation,
                simplified: self.simplified(state, mechanism.sway, &spectrum),
                displacement,
            })
        });
        let sides = sides.collect::<Result<Vec<SideCheck>, Beyond>>();
        let sides = sides.map_err(|beyond| NoCheck::Beyond { state, beyond })?;
        let histories =
            histories::histories(scenario, self, (state, &sides), &spectrum, rule.as_ref())?;
        Ok(StateCheck {
            sides,
            histories,
            state,
            spectrum,
            rule,
        })
    }

    /// C8.7.1.2.1.5: held by walls, [C8.7.1.8]; free to vibrate, [C8.7.1.9].
    fn activation(&self, mechanism: &Mechanism, spectrum: &Spectrum) -> Result<Activation, Beyond> {
        let capacity_g = self.activation_g(mechanism);
        let demand_g = match self.t0_s {
            None => spectrum.peak_g()?,
            Some(t0_s) => spectrum.acceleration_g(t0_s, 5.0)?,
        };
        Ok(Activation {
            capacity_g,
            demand_g,
            margin: Margin::new(capacity_g / demand_g, spectrum.ag_g()),
        })
    }

    /// The activation to a side as it was found with the spectrum of SLD, as `a_g` in g; `None` without that state.
    fn activation_ag_g(&self, sway: Sway) -> Option<f64> {
        let sld = self
            .states
            .iter()
            .find(|one| one.state == LimitState::Sld)?;
        let side = sld.sides.iter().find(|side| side.sway == sway)?;
        side.activation?.margin.ag_capacity_g
    }

    /// C8.7.1.2.1.7, for SLV.
    fn simplified(&self, state: LimitState, sway: Sway, spectrum: &Spectrum) -> Option<Simplified> {
        if state != LimitState::Slv || !self.by_the_code() {
            return None;
        }
        let activation_ag_g = self.activation_ag_g(sway)?;
        let behaviour_factor = self.settings.behaviour_factor;
        let ag_g = spectrum.ag_g()?;
        Some(Simplified {
            activation_ag_g,
            behaviour_factor,
            margin: Margin::new(behaviour_factor * activation_ag_g / ag_g, Some(ag_g)),
        })
    }

    /// C8.7.1.2.1.8.
    fn by_displacement(
        &self,
        mechanism: &Mechanism,
        way: &Way,
        spectrum: &Spectrum,
        rule: &StateRule,
    ) -> Result<ByDisplacement, Beyond> {
        let reached = |curve: &Capacity| self.reached(curve, spectrum, rule);
        let (capacity_m, acceleration_g, period_s, demand_m) = reached(&way.centre)?;
        let displacement = Margin::new(capacity_m / demand_m, spectrum.ag_g());
        let activation_ag_g = self.activation_ag_g(mechanism.sway);
        let later = activation_ag_g.zip(displacement.ag_capacity_g);
        let activation_ag_g = later.filter(|(start, end)| start > end).map(|both| both.0);
        let margin = match (activation_ag_g, displacement.ag_g) {
            (Some(start_g), Some(ag_g)) => Margin::new(start_g / ag_g, Some(ag_g)),
            _ => displacement,
        };
        let crown = way.crown.as_ref().map(reached).transpose()?;
        let zeta_e_crown = crown.map(|(capacity_m, .., demand_m)| capacity_m / demand_m);
        let ag_following_g = match spectrum {
            Spectrum::Ground(ground) => {
                let damping_percent = rule.damping_percent;
                following_g(
                    ground,
                    capacity_m,
                    period_s,
                    damping_percent,
                    self.gravity_m_s2,
                )
            }
            Spectrum::Floor(..) | Spectrum::Points(_) => None,
        };
        Ok(ByDisplacement {
            reached_m: rule.part_of_d0 * way.centre.end().oscillator_displacement_m,
            capacity_m,
            acceleration_g,
            period_s,
            demand_g: spectrum.acceleration_g(period_s, rule.damping_percent)?,
            demand_m,
            resonance_m: match spectrum {
                Spectrum::Floor(_, floor) if period_s > floor.resonance_s() => {
                    Some(floor.resonance_m(rule.damping_percent, self.gravity_m_s2))
                }
                _ => None,
            },
            displacement,
            activation_ag_g,
            margin,
            ag_following_g,
            zeta_e_crown,
        })
    }

    /// Displacement that may be reached on a curve, in metres, the divided acceleration there, in g, the period, in s, and the
    /// displacement that is demanded, in metres.
    fn reached(
        &self,
        curve: &Capacity,
        spectrum: &Spectrum,
        rule: &StateRule,
    ) -> Result<(f64, f64, f64, f64), Beyond> {
        let displacement_m = rule.part_of_d0 * curve.end().oscillator_displacement_m;
        let acceleration_g = self.held_g(curve, displacement_m, rule.divide_acceleration);
        let ratio_s2 = displacement_m / (acceleration_g * self.gravity_m_s2);
        let period_s = rule.period_factor * PI * ratio_s2.sqrt();
        let demand_m = spectrum.displacement_m(
            period_s,
            self.t0_s,
            rule.damping_percent,
            self.gravity_m_s2,
        )?;
        let capacity_m = displacement_m / rule.divide_displacement;
        Ok((capacity_m, acceleration_g, period_s, demand_m))
    }

    /// The divided acceleration of the oscillator at a displacement, in g: on the elastic branch at first, if it is free to
    /// vibrate [C8.7.1.6].
    fn held_g(&self, curve: &Capacity, displacement_m: f64, divide_acceleration: f64) -> f64 {
        let part = displacement_m / curve.end().oscillator_displacement_m;
        let rigid_g = curve.oscillator_acceleration_g(part) / divide_acceleration;
        self.elastic_g(displacement_m)
            .map_or(rigid_g, |elastic_g| elastic_g.min(rigid_g))
    }

    /// Acceleration of the elastic branch, in g.
    fn elastic_g(&self, displacement_m: f64) -> Option<f64> {
        let circular = self.t0_s? / (2.0 * PI);
        Some(displacement_m / (circular * circular * self.gravity_m_s2))
    }

    /// Where the elastic branch meets the divided curve, in metres and g; `None` if it is held by walls.
    #[must_use]
    pub fn yielding(&self, way: &Way) -> Option<(f64, f64)> {
        let divided = self.settings.confidence_factor;
        let end_m = way.centre.end().oscillator_displacement_m;
        let rigid_g = |d_m: f64| way.centre.oscillator_acceleration_g(d_m / end_m) / divided;
        self.t0_s?;
        let (_, d_m) = bisect(0.0, end_m, Width::Rounding, |d_m| {
            self.elastic_g(d_m)
                .is_some_and(|elastic_g| elastic_g >= rigid_g(d_m))
        });
        Some((d_m, rigid_g(d_m)))
    }
}

/// The least `a_g`, in g, at which the displacement that is demanded reaches a capacity, with `S_S` and `T_D` that follow it;
/// `None` beyond the range of the code.
fn following_g(
    ground: &GroundSpectrum,
    capacity_m: f64,
    period_s: f64,
    damping_percent: f64,
    gravity_m_s2: f64,
) -> Option<f64> {
    let reaches = |ag_g: f64| {
        let hazard = crate::dynamics::demand::ground::Hazard {
            ag_g,
            ..ground.hazard
        };
        let spectrum = GroundSpectrum::new(hazard, ground.site).ok()?;
        let demand_m = spectrum.largest_displacement_m(period_s, damping_percent, gravity_m_s2);
        Some(demand_m >= capacity_m)
    };
    // On soil D the demand falls for a while as a_g rises: the first time counts.
    let largest_g = (ground.t_e_s - 1.6) / 4.0;
    let steps = 400;
    let at = |step: i32| largest_g * f64::from(step) / f64::from(steps);
    let first = (1..=steps).find(|step| reaches(at(*step)) == Some(true))?;
    let low = at(first - 1);
    let (_, ag_g) = bisect(low, at(first), Width::Rounding, |ag_g| {
        reaches(ag_g) == Some(true)
    });
    Some(ag_g)
}
