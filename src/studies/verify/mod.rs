//! A check of local mechanisms by the Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018.
//!
//! The mechanism that starts to one side is a chain of rigid bodies ([`Mechanism`]). Its load multiplier, participating mass and
//! capacity curve are compared with a spectrum ([`Spectrum`]) at each limit state. This study has its own reports: [`to_json`] has
//! every number, [`words()`] the result, and [`page()`] everything that another engineer needs to redo the check by hand. Where the
//! text of the Circolare leaves a choice, the page prints the [decision](notes) that was taken.

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
pub use page::{FILES, page, tell};
pub use summary::to_json;
pub use words::words;

/// Why a scenario cannot be checked.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoCheck {
    /// There is no demand to compare with.
    #[error(
        "the scenario has no [demand]: give it a table, such as\n\n[demand]\nsoil = \"B\"\ntopography = \"T1\"\n\n\
         [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35"
    )]
    NoDemand,
    /// There is no mechanism to one side.
    #[error("there is no mechanism to check: {0}")]
    NoMechanism(String),
    /// Sliding has a smaller multiplier than the mechanism without sliding.
    #[error(
        "no check is possible to the {}: with a friction coefficient of {coefficient} joints slide at {at_g:.4} g at most (associated \
         bound), before a mechanism without sliding forms at {alpha0:.4} g, and the least multiplier counts. Check the other \
         side alone with `sides`, or another structure",
        .sway.name()
    )]
    Slides {
        /// The side.
        sway: Sway,
        /// The friction coefficient.
        coefficient: f64,
        /// The acceleration at which joints slide, in g.
        at_g: f64,
        /// Load multiplier of the mechanism without sliding.
        alpha0: f64,
    },
    /// Without a capacity curve only the simplified check is possible.
    #[error(
        "no check is possible: {0}. Without a capacity curve there are the damage limit state and the simplified check of SLV \
         with q (C8.7.1.2.1.7), from the parameters of NTC 2018: give [demand.sld] and [demand.slv]"
    )]
    NoCurve(String),
    /// Histories cannot be computed.
    #[error("the histories of {}_records are not possible: {why}", .state.name())]
    Histories {
        /// The limit state.
        state: LimitState,
        /// The reason.
        why: String,
    },
    /// A spectrum of points ends too early.
    #[error("[demand.{}] {beyond}", .state.name())]
    Beyond {
        /// The limit state.
        state: LimitState,
        /// The period at which it is needed.
        beyond: Beyond,
    },
}

/// The spectrum at the place of the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Spectrum {
    /// By NTC 2018, on the ground.
    Ground(GroundSpectrum),
    /// The same at a height in a building.
    Floor(GroundSpectrum, FloorSpectrum),
    /// Given by points.
    Points(PointDemand),
}

impl Spectrum {
    /// The spectrum of a limit state; `None` if the demand does not include that state.
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

    /// The spectrum of the code on the ground.
    #[must_use]
    pub const fn ground(&self) -> Option<&GroundSpectrum> {
        match self {
            Self::Ground(ground) | Self::Floor(ground, _) => Some(ground),
            Self::Points(_) => None,
        }
    }

    /// Acceleration of the hazard, `a_g`; for points, their peak, if they begin at period zero. In g.
    #[must_use]
    pub fn ag_g(&self) -> Option<f64> {
        match self {
            Self::Ground(ground) | Self::Floor(ground, _) => Some(ground.hazard.ag_g),
            Self::Points(demand) => demand.points.peak_g().ok(),
        }
    }

    /// Peak acceleration of the ground, or of the floor that carries the mechanism, in g.
    ///
    /// # Errors
    /// When the points do not include it.
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

    /// Displacement demand on a mechanism whose period has lengthened to `period_s`, in metres; for points, the largest from the period `from_s` on.
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

/// The ratio of capacity to demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// The ground acceleration that the structure can bear, as `a_g`, in g; `None` if a spectrum of points has no peak.
    pub ag_capacity_g: Option<f64>,
    /// The ground acceleration demanded, in g.
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

    /// Whether the capacity reaches the demand.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.zeta_e >= 1.0
    }
}

/// The check of the onset of motion (SLD).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activation {
    /// Spectral acceleration at which motion starts, divided by FC, in g.
    pub capacity_g: f64,
    /// Spectral acceleration demanded, in g.
    pub demand_g: f64,
    /// The ratio of the two.
    pub margin: Margin,
}

/// The simplified check of SLV, by the behaviour factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simplified {
    /// The activation acceleration that is multiplied, as `a_g`, in g.
    pub activation_ag_g: f64,
    /// The behaviour factor.
    pub behaviour_factor: f64,
    /// The result.
    pub margin: Margin,
}

/// The check by displacements (SLV, SLC).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByDisplacement {
    /// The fraction of the ultimate displacement that belongs to the state, in metres.
    pub reached_m: f64,
    /// The same after division: displacement of the oscillator that may be reached, in metres.
    pub capacity_m: f64,
    /// Acceleration at that displacement, after division, in g.
    pub acceleration_g: f64,
    /// Period at that displacement, in seconds.
    pub period_s: f64,
    /// Spectral acceleration at that period, in g.
    pub demand_g: f64,
    /// Displacement demand, in metres.
    pub demand_m: f64,
    /// Lower bound of the demand, in metres, at periods beyond resonance with a building.
    pub resonance_m: Option<f64>,
    /// The ratio of displacement capacity to demand.
    pub displacement: Margin,
    /// The activation acceleration, as `a_g` in g, if it is larger.
    pub activation_ag_g: Option<f64>,
    /// The result: the ratio of displacements, or the activation if motion starts only later.
    pub margin: Margin,
    /// The capacity `a_g` if the shape of the spectrum varies with `a_g`, in g; `None` if the mechanism is not on the ground, or
    /// beyond the range of the code.
    pub ag_following_g: Option<f64>,
    /// `zeta_E` with the crown as control point; `None` if the crown does not move.
    pub zeta_e_crown: Option<f64>,
}

impl ByDisplacement {
    /// Displacement, or activation if motion starts later than the displacement is reached.
    #[must_use]
    pub const fn method(&self) -> Method {
        match self.activation_ag_g {
            Some(_) => Method::Activation,
            None => Method::Displacement,
        }
    }
}

/// The checks of a limit state to one side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideCheck {
    /// The side.
    pub sway: Sway,
    /// The onset of motion, for SLD.
    pub activation: Option<Activation>,
    /// The simplified check, for SLV.
    pub simplified: Option<Simplified>,
    /// The check by displacements, for SLV and SLC.
    pub displacement: Option<ByDisplacement>,
}

named! {
    /// The method by which a limit state is checked.
    pub enum Method {
        /// The motion must not begin (C8.7.1.2.1.5).
        Activation = "activation",
        /// A multiple of the activation acceleration (C8.7.1.2.1.7).
        Simplified = "simplified",
        /// By displacements (C8.7.1.2.1.8).
        Displacement = "displacement",
    }
}

impl SideCheck {
    /// The check that governs: by displacements, if there is a curve, or the activation if it is later.
    #[must_use]
    pub fn governing(&self) -> Option<(Method, Margin)> {
        let displacement = self.displacement.map(|one| (one.method(), one.margin));
        let simplified = self.simplified.map(|one| (Method::Simplified, one.margin));
        let activation = self.activation.map(|one| (Method::Activation, one.margin));
        displacement.or(simplified).or(activation)
    }
}

/// The check of a limit state.
#[derive(Clone, Debug, PartialEq)]
pub struct StateCheck {
    /// The limit state.
    pub state: LimitState,
    /// The demand.
    pub spectrum: Spectrum,
    /// The rule of the limit state; `None` for SLD.
    pub rule: Option<StateRule>,
    /// The checks to each side.
    pub sides: Vec<SideCheck>,
    /// The check by histories, if there are records.
    pub histories: Option<Histories>,
}

impl StateCheck {
    /// The governing side, its method and its result; `None` if the state cannot be checked.
    #[must_use]
    pub fn governing(&self) -> Option<(Sway, Method, Margin)> {
        let sides = self.sides.iter();
        let checked: Option<Vec<(Sway, Method, Margin)>> = sides
            .map(|side| {
                let (method, margin) = side.governing()?;
                Some((side.sway, method, margin))
            })
            .collect();
        let worse = |worst: (_, _, Margin), one: (_, _, Margin)| {
            let is_worse = one.2.zeta_e < worst.2.zeta_e && !alike(one.2.zeta_e, worst.2.zeta_e);
            if is_worse { one } else { worst }
        };
        checked?.into_iter().reduce(worse)
    }

    /// Name of the governing side: `right`, `left`, or `either` if both sides have the same method and result; `None` if the state
    /// cannot be checked.
    #[must_use]
    pub fn governing_side(&self) -> Option<&'static str> {
        let (sway, method, margin) = self.governing()?;
        let equals = |side: &SideCheck| {
            side.governing()
                .is_some_and(|(own, one)| own == method && alike(one.zeta_e, margin.zeta_e))
        };
        let either = self.sides.len() > 1 && self.sides.iter().all(equals);
        Some(if either { EITHER } else { sway.name() })
    }
}

/// The check of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// The options of the check.
    pub settings: Verify,
    /// The demand.
    pub demand: Demand,
    /// Gravity, in m/s2.
    pub gravity_m_s2: f64,
    /// Period of the elastic vibration before motion, in seconds; `None`: walls hold the structure all along.
    pub t0_s: Option<f64>,
    /// The mechanism to each side.
    pub mechanisms: Vec<Mechanism>,
    /// The limit states of the demand.
    pub states: Vec<StateCheck>,
    /// Largest friction coefficient that joints may need: that of the Circolare, or that of the scenario if it is smaller.
    pub allowed_friction: f64,
    /// The frame of reference and the place of each tie, in words; empty without ties.
    pub tie_places: Vec<String>,
    /// Name of the highest point: the crown of an arch, or the top of a structure on one support.
    pub top: &'static str,
    /// Assumptions that do not hold, and input that is unlikely or ignored.
    pub warnings: Vec<String>,
}

/// Name of the governing side if both sides are equal.
const EITHER: &str = "either";

/// Whether two numbers that describe mirrored sides differ by rounding only.
fn alike(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (a.abs() + b.abs()).max(1e-6)
}

impl Check {
    /// Checks a scenario.
    ///
    /// # Errors
    /// When there is no demand, no mechanism or no possible check, or a spectrum of points ends too early.
    pub fn new(scenario: &Scenario) -> Result<Self, NoCheck> {
        let demand = scenario.demand().cloned().ok_or(NoCheck::NoDemand)?;
        let settings = scenario.verify().cloned().unwrap_or_default();
        let gravity_m_s2 = scenario.gravity_m_s2();
        let sides: &[Sway] = match settings.sides {
            Sides::Both => Sway::ALL,
            Sides::Right => &[Sway::Right],
            Sides::Left => &[Sway::Left],
        };
        let mechanisms = mechanism::mechanisms(scenario, sides)?;
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
            allowed_friction: mechanism::allowed_friction(scenario),
            tie_places: scenario.structure().tie_places(),
            top: if scenario.structure().stands_on_one_support() {
                "top"
            } else {
                "crown"
            },
            warnings: Vec::new(),
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
        check.warnings = notes::warnings(scenario, &check);
        Ok(check)
    }

    /// Whether spectra are those of NTC 2018; only then are clauses of the Circolare cited.
    #[must_use]
    pub const fn by_the_code(&self) -> bool {
        matches!(self.demand, Demand::Code(_))
    }

    /// The limit states with a result.
    pub fn checked(&self) -> impl Iterator<Item = LimitState> {
        let checked = self.states.iter().filter(|one| one.governing().is_some());
        checked.map(|one| one.state)
    }

    /// The least `zeta_E` of the limit states with a result.
    #[must_use]
    pub fn zeta_e(&self) -> f64 {
        let states = self.states.iter().filter_map(StateCheck::governing);
        states
            .map(|(.., margin)| margin.zeta_e)
            .fold(f64::INFINITY, f64::min)
    }

    /// The largest fraction of the ultimate displacement that any limit state allows.
    #[must_use]
    pub fn furthest_part(&self) -> f64 {
        let rules = self.states.iter().filter_map(|one| one.rule);
        rules.map(|rule| rule.part_of_d0).fold(0.0, f64::max)
    }

    /// The mechanism to one side.
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

    /// The check of C8.7.1.2.1.5: [C8.7.1.8] if walls hold the structure, [C8.7.1.9] if it is free to vibrate.
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

    /// The activation to one side from the spectrum of SLD, as `a_g` in g; `None` without that state.
    fn activation_ag_g(&self, sway: Sway) -> Option<f64> {
        let sld = self
            .states
            .iter()
            .find(|one| one.state == LimitState::Sld)?;
        let side = sld.sides.iter().find(|side| side.sway == sway)?;
        side.activation?.margin.ag_capacity_g
    }

    /// The check of C8.7.1.2.1.7, for SLV.
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

    /// The check of C8.7.1.2.1.8.
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

    /// The displacement that may be reached on a curve, in metres; the divided acceleration there, in g; the period, in s; and the
    /// displacement demand, in metres.
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

    /// The divided acceleration of the oscillator at a displacement, in g. If the structure is free to vibrate, the elastic branch comes
    /// first [C8.7.1.6].
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

    /// Where the elastic branch meets the divided curve, in metres and g; `None` if walls hold the structure.
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

/// The least `a_g`, in g, at which the displacement demand reaches a capacity, while `S_S` and `T_D` vary with `a_g`;
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
    // On soil D the demand falls for a while as a_g rises; the first crossing counts.
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
