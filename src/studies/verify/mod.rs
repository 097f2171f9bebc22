//! A check of local mechanisms by the Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018.
//!
//! The mechanism that starts to one side is a chain of rigid bodies ([`CheckedMechanism`]). Its load multiplier, participating mass and capacity curve
//! are compared with a spectrum ([`Spectrum`]) at each limit state. The [`VerifySummary`] has every number and verdict; words, notes and the printed
//! page are templates that read the summary. Where the text of the Circolare leaves a choice, the notes state the decision.

mod geometry;
mod histories;
mod mechanism;
mod no_curve;
mod picture;
mod report;
mod side;
mod spectrum;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::PI;

use askama::Template;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::Sway;
use crate::bisection::{Width, bisect};
use crate::dynamics::demand::{Hazard, PeriodOutOfRange};
use crate::dynamics::{GroundSpectrum, Site};
use crate::mechanics::Capacity;
use crate::scenario::{
    CheckedSides, Demand, FreeStanding, InputFile, Language, LimitState, Scenario, StateRule,
    Varied, Verify, sha256,
};
use crate::studies::report::Warnings;
pub use geometry::{FillGeometry, Geometry, LoadAt, PlacedBlock, RingGeometry};
pub use histories::{ComparedPeak, Histories, HistorySide, MeanSpectrum, RecordPeak, RecordPeaks};
pub use mechanism::{
    CapacityCurves, CheckedMechanism, HeldTie, MechanismBody, PlacedHinge, Position, Slide,
};
pub use no_curve::NoCurve;
pub use report::{FILES, SidePictures, VerifyPage, page_of, report, words};
pub use side::{
    ActivationCheck, CheckVerdict, DisplacementCheck, GoverningSide, Margin, Method, SideCheck,
    SimplifiedCheck, SlidingCheck,
};
use side::{SideOutcome, equal_numbers};
pub use spectrum::{FloorMode, FloorOrdinates, Spectrum, SpectrumGround};

/// Friction coefficient that the Circolare gives for walls (C8.7.1.2.1.2).
pub const FRICTION: f64 = 0.577;

/// Errors of scenarios that cannot be checked.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// There is no demand.
    #[error(
        "the scenario has no [demand]: give it a table, such as\n\n[demand]\nsoil = \"B\"\ntopography = \"T1\"\n\n\
         [demand.slv]\nag_g = 0.25\nf0 = 2.40\ntc_star_s = 0.35"
    )]
    NoDemand,
    /// The restitution of the wall behind a column is neither given nor known, for this reason.
    #[error("{0}")]
    NoRestitution(String),
    /// There is no mechanism to one side, for this reason.
    #[error("there is no mechanism to check: {0}")]
    NoMechanism(String),
    /// There is no capacity curve, for this reason: only the simplified check is possible, and it was not requested.
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
    /// A spectrum of points ends at too small a period.
    #[error("[demand.{}] {error}", .state.name())]
    PeriodOutOfRange {
        /// The limit state.
        state: LimitState,
        /// The period that is needed.
        error: PeriodOutOfRange,
    },
}

/// The check of a limit state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StateCheck {
    /// The verdict.
    pub verdict: CheckVerdict,
    /// The governing result; `None` if the state cannot be checked, or joints slide first to a side.
    pub zeta_e: Option<f64>,
    /// The governing side.
    pub side: Option<GoverningSide>,
    /// The governing method.
    pub method: Option<Method>,
    /// The spectrum.
    pub demand: Spectrum,
    /// The rule of the limit state; `None` for SLD.
    pub rule: Option<StateRule>,
    /// The check by histories, if there are records.
    pub histories: Option<Histories>,
    /// The checks to each side.
    #[serde(flatten)]
    pub sides: BTreeMap<Sway, SideCheck>,
}

named! {
    /// The highest point of a structure.
    pub enum HighestPoint {
        /// The crown of an arch.
        Crown = "crown",
        /// The top of a structure on one support.
        Top = "top",
    }
}

/// A decision where the text of the Circolare leaves a choice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decision {
    /// Name of the decision on the page.
    pub name: String,
    /// Text of the decision.
    pub text: String,
}

/// The check of a scenario by the Circolare 7/2019.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Template)]
#[template(source = "{{ self.words() }}", ext = "txt")]
pub struct VerifySummary {
    /// Name of the program.
    pub program: Cow<'static, str>,
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// Title of the scenario.
    pub title: Option<String>,
    /// The source of the formulas; `None` for spectra and limits given by the engineer.
    pub formulas: Option<Cow<'static, str>>,
    /// SHA-256 of the scenario with every default written out, as `archrock check` prints it.
    pub scenario_sha256: String,
    /// Files from which the scenario was read.
    pub files: Vec<InputFile>,
    /// The smallest `zeta_E` of the limit states with a result; `None` if joints slide first to a side.
    pub zeta_e: Option<f64>,
    /// The reason why there is no `zeta_E`; absent if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_zeta_e_because: Option<String>,
    /// The verdict on each limit state of the demand.
    pub verdict: BTreeMap<LimitState, CheckVerdict>,
    /// Confidence factor FC, by which accelerations are divided.
    pub confidence_factor: f64,
    /// Behaviour factor q of the simplified check.
    pub behaviour_factor: f64,
    /// The sides that are checked.
    pub sides: CheckedSides,
    /// Side of the wall behind a column, towards which it cannot move; absent without a wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wall_behind: Option<Sway>,
    /// Period of the elastic vibration before motion, in seconds; `None` if walls hold the structure up to the mechanism.
    pub t0_s: Option<f64>,
    /// Gravity, in m/s2.
    pub gravity_m_s2: f64,
    /// Largest friction coefficient that joints may need: that of the Circolare, or that of the scenario if it is smaller.
    pub allowed_friction: f64,
    /// The mechanism to each side.
    pub mechanisms: BTreeMap<Sway, CheckedMechanism>,
    /// The limit states of the demand.
    pub states: BTreeMap<LimitState, StateCheck>,
    /// The warnings.
    #[serde(flatten)]
    pub warnings: Warnings,
    /// Decisions where the text leaves a choice.
    pub decisions: Vec<Decision>,
    /// Assumptions of the check.
    pub assumptions: Vec<String>,
    /// Effects that the check leaves out.
    pub not_covered: Vec<String>,
    /// The scenario with all defaults.
    pub scenario: Value,
    /// The frame of reference and the place of each tie, in words; absent without ties.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tie_places: Vec<String>,
    /// True if the left side is the mirror image of the right one, including all numbers.
    pub is_symmetric: bool,
    /// The highest point, a second control point of the capacity curve.
    pub top: HighestPoint,
    /// The structure in numbers.
    pub geometry: Geometry,
    /// The input of the elastic vibration before motion; absent if walls hold the structure up to the mechanism.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_standing: Option<FreeStanding>,
    /// Language of words and page; absent in English.
    #[serde(default, skip_serializing_if = "Language::is_english")]
    pub language: Language,
}

/// The input of a check: its scenario, options and demand.
struct CheckInput<'a> {
    scenario: &'a Scenario,
    settings: Verify,
    demand: Demand,
    gravity_m_s2: f64,
    t0_s: Option<f64>,
    allowed_friction: f64,
}

/// Checks the local mechanisms of a scenario.
///
/// # Errors
/// When there is no demand, no mechanism or no possible check, or a spectrum of points ends at too small a period.
pub fn verify(scenario: &Scenario) -> Result<VerifySummary, VerifyError> {
    let demand = scenario.demand.clone().ok_or(VerifyError::NoDemand)?;
    let known = scenario.check_restitution();
    known.map_err(VerifyError::NoRestitution)?;
    let structure = &scenario.structure;
    let settings = Verify {
        sides: checked_sides(scenario)?,
        ..scenario.verify.clone().unwrap_or_default()
    };
    let own_friction = scenario.motion.options.friction_coefficient();
    let (_, density_kg_m3) = structure.depth_and_density();
    let free = settings.free_standing.as_ref();
    let input = CheckInput {
        scenario,
        t0_s: free.map(|free| free.period_s(density_kg_m3)),
        settings,
        demand,
        gravity_m_s2: scenario.gravity_m_s2(),
        allowed_friction: own_friction.map_or(FRICTION, |own| own.min(FRICTION)),
    };
    let mechanisms = mechanism::mechanisms(&input)?;
    let mut states = BTreeMap::new();
    for state in input.demand.limit_states() {
        let sld = states.get(&LimitState::Sld);
        let one = input.state(state, &mechanisms, sld)?;
        states.insert(state, one);
    }
    let mut ultimate = states.range(LimitState::Slv..);
    if ultimate.all(|(_, one)| one.verdict == CheckVerdict::NotChecked) {
        let why = mechanisms.values().find_map(|one| one.no_curve.clone());
        return Err(VerifyError::NoCurve(
            why.map_or_else(String::new, String::from),
        ));
    }
    let is_stack = structure.stands_on_one_support();
    let by_the_code = matches!(input.demand, Demand::Code(_));
    let formulas = "Circolare 7/2019, C8.7.1.2.1, with the spectra of NTC 2018";
    let results = states.values().filter_map(|one| one.zeta_e);
    let verdicts = states.iter().map(|(state, one)| (*state, one.verdict));
    let mut summary = VerifySummary {
        program: env!("CARGO_PKG_NAME").into(),
        version: env!("CARGO_PKG_VERSION").into(),
        title: scenario.title.as_deref().map(str::to_owned),
        formulas: by_the_code.then(|| formulas.into()),
        scenario_sha256: sha256(scenario.to_resolved_toml().as_bytes()),
        files: scenario.files().to_vec(),
        zeta_e: results.reduce(f64::min),
        no_zeta_e_because: None,
        verdict: verdicts.collect(),
        confidence_factor: input.settings.confidence_factor,
        behaviour_factor: input.settings.behaviour_factor,
        sides: input.settings.sides,
        wall_behind: structure.wall_behind(),
        t0_s: input.t0_s,
        gravity_m_s2: input.gravity_m_s2,
        allowed_friction: input.allowed_friction,
        is_symmetric: report::are_mirrored(is_stack, &mechanisms, &states),
        mechanisms,
        states,
        warnings: Warnings::new(scenario.unlikely_in(&Varied::default()), []),
        decisions: Vec::new(),
        assumptions: Vec::new(),
        not_covered: Vec::new(),
        scenario: scenario.to_json(),
        tie_places: structure.tie_places(),
        top: match is_stack {
            true => HighestPoint::Top,
            false => HighestPoint::Crown,
        },
        geometry: Geometry::of(scenario),
        free_standing: input.settings.free_standing,
        language: input.settings.language,
    };
    let unused = match summary.zeta_e {
        Some(_) => Vec::new(),
        None => input.settings.records.keys(),
    };
    report::add_notes(&mut summary, &unused);
    Ok(summary)
}

/// Sides that are checked: those of the scenario to which the structure can move.
///
/// # Errors
/// When the scenario chooses the side of a wall behind a column.
fn checked_sides(scenario: &Scenario) -> Result<CheckedSides, VerifyError> {
    let chosen = scenario
        .verify
        .as_ref()
        .map_or(CheckedSides::Both, |verify| verify.sides);
    let Some(wall) = scenario.structure.wall_behind() else {
        return Ok(chosen);
    };
    let [held, free] = match wall {
        Sway::Right => [CheckedSides::Right, CheckedSides::Left],
        Sway::Left => [CheckedSides::Left, CheckedSides::Right],
    };
    if chosen == held {
        let (held, free) = (held.name(), free.name());
        let why = format!(
            "a wall stands on the {held}, towards which it cannot move; check sides = {free:?}"
        );
        return Err(VerifyError::NoMechanism(why));
    }
    Ok(free)
}

impl CheckInput<'_> {
    /// Rule of a limit state; `None` for SLD.
    fn rule(&self, state: LimitState) -> Option<StateRule> {
        match &self.demand {
            Demand::Points(points) => points.get(&state)?.state,
            Demand::Code(_) => StateRule::circolare(state, self.settings.confidence_factor),
        }
    }

    /// Fractions of the ultimate displacement that the limit states allow.
    fn parts_of_d0(&self) -> impl Iterator<Item = f64> {
        let rules = self
            .demand
            .limit_states()
            .filter_map(|state| self.rule(state));
        rules.map(|rule| rule.part_of_d0)
    }

    /// Checks a limit state. `sld` is the check of SLD, if there is one.
    fn state(
        &self,
        state: LimitState,
        mechanisms: &BTreeMap<Sway, CheckedMechanism>,
        sld: Option<&StateCheck>,
    ) -> Result<StateCheck, VerifyError> {
        let rule = self.rule(state);
        let spectrum = Spectrum::of(&self.demand, state, rule.as_ref(), self.gravity_m_s2)
            .expect("the demand has this state");
        let sides = mechanisms
            .iter()
            .map(|(sway, mechanism)| {
                if let Some(sliding) = mechanism.sliding {
                    let demand_g = self.onset_demand_g(&spectrum)?;
                    let side = SideCheck {
                        sliding: Some(SlidingCheck::new(sliding.bound_g, demand_g)),
                        ..SideCheck::default()
                    };
                    return Ok((*sway, side));
                }
                let start_ag_g =
                    sld.and_then(|sld| sld.sides[sway].activation?.margin.ag_capacity_g);
                let activation = match state {
                    LimitState::Sld => Some(self.activation(mechanism, &spectrum)?),
                    LimitState::Slv | LimitState::Slc => None,
                };
                let displacement = match (&mechanism.curves, &rule) {
                    (Some(curves), Some(rule)) => {
                        Some(self.check_displacement(curves, start_ag_g, &spectrum, rule)?)
                    }
                    _ => None,
                };
                let both_g = match (state, &self.demand) {
                    (LimitState::Slv, Demand::Code(_)) => start_ag_g.zip(spectrum.ag_g()),
                    _ => None,
                };
                let mut side = SideCheck {
                    zeta_e: None,
                    sliding: None,
                    floor: self.floor(&spectrum, displacement.as_ref(), rule.as_ref()),
                    activation,
                    simplified: both_g.map(|(start_g, ag_g)| self.check_simplified(start_g, ag_g)),
                    displacement,
                };
                side.zeta_e = side.governing_result().map(|(_, margin)| margin.zeta_e);
                Ok((*sway, side))
            })
            .collect::<Result<BTreeMap<Sway, SideCheck>, PeriodOutOfRange>>()
            .map_err(|error| VerifyError::PeriodOutOfRange { state, error })?;
        let histories = match &rule {
            Some(rule) => histories::histories(self, (state, rule, &spectrum), mechanisms, &sides)?,
            None => None,
        };
        let governing = find_governing_side(&sides);
        let slides = sides.values().any(|side| side.sliding.is_some());
        let outcome = governing.map(|(_, outcome)| outcome);
        Ok(StateCheck {
            verdict: outcome.map_or(CheckVerdict::NotChecked, |outcome| outcome.verdict),
            zeta_e: outcome.filter(|_| !slides).map(|outcome| outcome.ratio),
            side: governing.map(|(side, _)| side),
            method: outcome.map(|outcome| outcome.method),
            demand: spectrum,
            rule,
            histories,
            sides,
        })
    }

    /// Ordinates of the spectrum at a height that a check uses: at the period of the mechanism, and at that of the building beyond
    /// resonance; for SLD of a structure that is free to vibrate, at its period.
    fn floor(
        &self,
        spectrum: &Spectrum,
        displacement: Option<&DisplacementCheck>,
        rule: Option<&StateRule>,
    ) -> Vec<FloorOrdinates> {
        let resonance = displacement.and_then(|one| one.resonance_m.and(spectrum.first_period_s()));
        let own_s = match rule {
            Some(_) => displacement.map(|one| one.period_s),
            None => self.t0_s,
        };
        let percent = rule.map_or(5.0, |rule| rule.damping_percent);
        let periods_s = [own_s, resonance].into_iter().flatten();
        let ordinates = periods_s.filter_map(|period_s| spectrum.ordinates(period_s, percent));
        ordinates.collect()
    }

    /// Checks the onset of motion by C8.7.1.2.1.5: with [C8.7.1.8] if walls hold the structure, with [C8.7.1.9] if it is free to vibrate.
    fn activation(
        &self,
        mechanism: &CheckedMechanism,
        spectrum: &Spectrum,
    ) -> Result<ActivationCheck, PeriodOutOfRange> {
        let capacity_g = mechanism.a0_over_fc_g;
        let demand_g = self.onset_demand_g(spectrum)?;
        Ok(ActivationCheck {
            capacity_g,
            demand_g,
            margin: Margin::new(capacity_g / demand_g, spectrum.ag_g()),
        })
    }

    /// Acceleration with which the onset of motion is compared, in g: the peak if walls hold the structure, and the spectral
    /// acceleration at its period if it is free to vibrate.
    fn onset_demand_g(&self, spectrum: &Spectrum) -> Result<f64, PeriodOutOfRange> {
        match self.t0_s {
            None => spectrum.peak_g(),
            Some(t0_s) => spectrum.acceleration_g(t0_s, 5.0),
        }
    }

    /// Checks SLV by C8.7.1.2.1.7, from activation and demand as `a_g`, in g.
    fn check_simplified(&self, activation_ag_g: f64, ag_g: f64) -> SimplifiedCheck {
        let q = self.settings.behaviour_factor;
        SimplifiedCheck {
            activation_ag_g,
            q,
            margin: Margin::new(q * activation_ag_g / ag_g, Some(ag_g)),
        }
    }

    /// Checks a limit state by C8.7.1.2.1.8, with the activation as `a_g`, in g.
    fn check_displacement(
        &self,
        curves: &CapacityCurves,
        start_ag_g: Option<f64>,
        spectrum: &Spectrum,
        rule: &StateRule,
    ) -> Result<DisplacementCheck, PeriodOutOfRange> {
        let reached = |curve: &Capacity| self.allowed_displacement(curve, spectrum, rule);
        let (capacity_m, acceleration_g, period_s, demand_m) = reached(&curves.centre)?;
        let by_displacement = Margin::new(capacity_m / demand_m, spectrum.ag_g());
        let later = start_ag_g.zip(by_displacement.ag_capacity_g);
        let activation_ag_g = later.filter(|(start, end)| start > end).map(|both| both.0);
        let margin = match (activation_ag_g, by_displacement.ag_g) {
            (Some(start_g), Some(ag_g)) => Margin::new(start_g / ag_g, Some(ag_g)),
            _ => by_displacement,
        };
        let crown = curves.crown.as_ref().map(reached).transpose()?;
        let (damping_percent, gravity_m_s2) = (rule.damping_percent, self.gravity_m_s2);
        Ok(DisplacementCheck {
            reached_m: rule.part_of_d0 * curves.centre.end().oscillator_displacement_m,
            capacity_m,
            acceleration_g,
            period_s,
            demand_m,
            demand_period_s: spectrum.demand_period_s(
                period_s,
                self.t0_s,
                damping_percent,
                gravity_m_s2,
            ),
            resonance_m: spectrum.resonance_m(period_s, damping_percent, gravity_m_s2),
            demand_acceleration_g: spectrum.acceleration_g(period_s, damping_percent)?,
            by_displacement_ag_g: by_displacement.ag_capacity_g,
            activation_governs: activation_ag_g.is_some(),
            ag_capacity_following_g: match spectrum {
                Spectrum::Ground(SpectrumGround { spectrum, .. }) => {
                    following_g(spectrum, |ground| {
                        ground.largest_displacement_m(period_s, damping_percent, gravity_m_s2)
                            >= capacity_m
                    })
                }
                Spectrum::Floor { .. } | Spectrum::Points { .. } => None,
            },
            zeta_e_crown: crown.map(|(capacity_m, .., demand_m)| capacity_m / demand_m),
            acceleration_crown_g: crown.map(|(_, acceleration_g, ..)| acceleration_g),
            period_crown_s: crown.map(|(_, _, period_s, _)| period_s),
            margin,
            activation_ag_g,
        })
    }

    /// Allowed displacement on a curve, in metres; the divided acceleration there, in g; the period, in s; and the displacement
    /// demand, in metres.
    fn allowed_displacement(
        &self,
        curve: &Capacity,
        spectrum: &Spectrum,
        rule: &StateRule,
    ) -> Result<(f64, f64, f64, f64), PeriodOutOfRange> {
        let displacement_m = rule.part_of_d0 * curve.end().oscillator_displacement_m;
        let part = displacement_m / curve.end().oscillator_displacement_m;
        let rigid_g = curve.oscillator_acceleration_g(part) / rule.divide_acceleration;
        // The curve of a structure that is free to vibrate starts with the elastic branch [C8.7.1.6].
        let elastic_g = self.elastic_g(displacement_m).unwrap_or(f64::INFINITY);
        let acceleration_g = elastic_g.min(rigid_g);
        let ratio_s2 = displacement_m / (acceleration_g * self.gravity_m_s2);
        let period_s = rule.period_factor * PI * ratio_s2.sqrt();
        let (t0_s, percent, gravity_m_s2) = (self.t0_s, rule.damping_percent, self.gravity_m_s2);
        let demand_m = spectrum.displacement_m(period_s, t0_s, percent, gravity_m_s2)?;
        let capacity_m = displacement_m / rule.divide_displacement;
        Ok((capacity_m, acceleration_g, period_s, demand_m))
    }

    /// Acceleration of the elastic branch, in g; `None` if walls hold the structure.
    fn elastic_g(&self, displacement_m: f64) -> Option<f64> {
        let circular = self.t0_s? / (2.0 * PI);
        Some(displacement_m / (circular * circular * self.gravity_m_s2))
    }

    /// Finds the point at which the elastic branch meets the divided curve, in metres and g; `None` if walls hold the structure.
    fn find_yield_point(&self, curves: &CapacityCurves) -> Option<(f64, f64)> {
        let divided = self.settings.confidence_factor;
        let end_m = curves.centre.end().oscillator_displacement_m;
        let rigid_g = |d_m: f64| curves.centre.oscillator_acceleration_g(d_m / end_m) / divided;
        self.t0_s?;
        let (_, d_m) = bisect(0.0, end_m, Width::Rounding, |d_m| {
            self.elastic_g(d_m)
                .is_some_and(|elastic_g| elastic_g >= rigid_g(d_m))
        });
        Some((d_m, rigid_g(d_m)))
    }
}

/// Governing side with its outcome. `None` if a side cannot be checked, unless joints slide first to the other side.
fn find_governing_side(sides: &BTreeMap<Sway, SideCheck>) -> Option<(GoverningSide, SideOutcome)> {
    let checked = sides
        .iter()
        .map(|(sway, side)| Some((*sway, side.outcome()?)));
    let checked: Vec<(Sway, SideOutcome)> = match sides.values().any(|side| side.sliding.is_some())
    {
        true => checked.flatten().collect(),
        false => checked.collect::<Option<_>>()?,
    };
    let worse = |worst: (Sway, SideOutcome), one: (Sway, SideOutcome)| match one
        .1
        .is_worse_than(&worst.1)
    {
        true => one,
        false => worst,
    };
    let (sway, outcome) = checked.iter().copied().reduce(worse)?;
    let equals = |(_, one): &(Sway, SideOutcome)| {
        one.method == outcome.method && equal_numbers(one.ratio, outcome.ratio)
    };
    let side = match sway {
        _ if checked.len() > 1 && checked.iter().all(equals) => GoverningSide::Either,
        Sway::Right => GoverningSide::Right,
        Sway::Left => GoverningSide::Left,
    };
    Some((side, outcome))
}

/// Finds the smallest `a_g`, in g, whose spectrum reaches the capacity, with `S_S` and `T_D` as functions of `a_g`; `None` beyond the range of
/// the code.
fn following_g(
    ground: &GroundSpectrum,
    reaches_capacity: impl Fn(&GroundSpectrum) -> bool,
) -> Option<f64> {
    let reaches = |ag_g: f64| {
        let hazard = Hazard {
            ag_g,
            ..ground.hazard
        };
        let site = Site {
            soil: ground.soil,
            topographic_factor: ground.s_t,
        };
        GroundSpectrum::new(hazard, site).is_ok_and(|ground| reaches_capacity(&ground))
    };
    // On soil D the demand falls over a range of rising a_g; the first crossing counts.
    let largest_g = (ground.t_e_s - 1.6) / 4.0;
    let steps = 400;
    let at = |step: i32| largest_g * f64::from(step) / f64::from(steps);
    let first = (1..=steps).find(|step| reaches(at(*step)))?;
    let low = at(first - 1);
    let (_, ag_g) = bisect(low, at(first), Width::Rounding, reaches);
    Some(ag_g)
}
