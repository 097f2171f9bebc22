//! The checks of a limit state to one side, by method, and the verdict that governs.

use serde::{Deserialize, Serialize};

use super::FloorOrdinates;

/// The ratio of capacity to demand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Margin {
    /// The ground acceleration that the structure resists, as `a_g`, in g; `None` if a spectrum of points has no peak.
    pub ag_capacity_g: Option<f64>,
    /// The ground acceleration demanded, in g; `None` if a spectrum of points has no peak.
    pub ag_g: Option<f64>,
    /// The ratio of capacity to demand.
    pub zeta_e: f64,
    /// True if the capacity reaches the demand.
    pub passed: bool,
}

impl Margin {
    pub(super) fn new(zeta_e: f64, ag_g: Option<f64>) -> Self {
        Self {
            ag_capacity_g: ag_g.map(|ag_g| ag_g * zeta_e),
            ag_g,
            zeta_e,
            passed: zeta_e >= 1.0,
        }
    }
}

/// The check of the onset of motion (SLD).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActivationCheck {
    /// Spectral acceleration at which motion starts, divided by FC, in g.
    pub capacity_g: f64,
    /// Spectral acceleration demanded, in g.
    pub demand_g: f64,
    /// The ratio of capacity to demand.
    #[serde(flatten)]
    pub margin: Margin,
}

/// The simplified check of SLV, by the behaviour factor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimplifiedCheck {
    /// The activation acceleration that is multiplied by q, as `a_g`, in g.
    pub activation_ag_g: f64,
    /// The behaviour factor.
    pub q: f64,
    /// The ratio of capacity to demand.
    #[serde(flatten)]
    pub margin: Margin,
}

/// The check by displacements (SLV, SLC).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplacementCheck {
    /// The fraction of the ultimate displacement that the limit state allows, in metres.
    pub reached_m: f64,
    /// Displacement of the oscillator that is allowed, in metres: `reached_m`, divided.
    pub capacity_m: f64,
    /// Acceleration at displacement `reached_m`, divided, in g.
    pub acceleration_g: f64,
    /// Period at displacement `reached_m`, in seconds.
    pub period_s: f64,
    /// Displacement demand, in metres.
    pub demand_m: f64,
    /// Period of the demand, in seconds; absent unless the spectrum is given by points, whose largest displacement up to `period_s` counts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub demand_period_s: Option<f64>,
    /// Lower bound of the demand, in metres; `None` unless the period exceeds that of resonance with a building.
    pub resonance_m: Option<f64>,
    /// Spectral acceleration at `period_s`, in g.
    pub demand_acceleration_g: f64,
    /// The ground acceleration that the structure resists by displacements, as `a_g`, in g; `None` if a spectrum of points has no peak.
    pub by_displacement_ag_g: Option<f64>,
    /// True if motion starts only at a larger ground acceleration, which then governs.
    pub activation_governs: bool,
    /// The capacity `a_g` with a spectrum whose shape varies with `a_g`, in g; `None` if the mechanism is not on the ground, or the capacity is
    /// beyond the range of the code.
    pub ag_capacity_following_g: Option<f64>,
    /// `zeta_E` with the crown as control point; `None` if the crown does not move.
    pub zeta_e_crown: Option<f64>,
    /// Divided acceleration at the allowed displacement with the crown as control point, in g; `None` if the crown does not move.
    pub acceleration_crown_g: Option<f64>,
    /// Period there, in seconds.
    pub period_crown_s: Option<f64>,
    /// The governing result: the ratio of displacements, or the activation if motion starts later.
    #[serde(flatten)]
    pub margin: Margin,
    /// The activation acceleration, as `a_g` in g; absent unless it governs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub activation_ag_g: Option<f64>,
}

impl DisplacementCheck {
    /// Ratio of displacement capacity to demand.
    pub fn zeta_e_by_displacement(&self) -> f64 {
        self.capacity_m / self.demand_m
    }
}

/// The comparison of the demand with the acceleration at which joints slide, if they slide before a mechanism without sliding forms.
///
/// Associated limit analysis gives an upper bound of that acceleration, because stone joints do not open as they slip. A demand above the bound
/// is not passed. A smaller demand has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlidingCheck {
    /// Upper bound of the acceleration at which joints slide, in g.
    pub bound_g: f64,
    /// Acceleration demanded, in g: that of the check of the onset of motion, with the spectrum of the limit state.
    pub demand_g: f64,
    /// `not_passed` if the demand exceeds the bound, `no_answer` otherwise.
    pub verdict: CheckVerdict,
}

impl SlidingCheck {
    pub(super) fn new(bound_g: f64, demand_g: f64) -> Self {
        Self {
            bound_g,
            demand_g,
            verdict: match demand_g > bound_g {
                true => CheckVerdict::NotPassed,
                false => CheckVerdict::NoAnswer,
            },
        }
    }
}

/// The checks of a limit state to one side.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SideCheck {
    /// The governing result; `None` if the state cannot be checked, or joints slide first.
    pub zeta_e: Option<f64>,
    /// The comparison with the slide of joints; absent unless they slide first. There is no other check then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sliding: Option<SlidingCheck>,
    /// The onset of motion, for SLD.
    pub activation: Option<ActivationCheck>,
    /// The simplified check, for SLV.
    pub simplified: Option<SimplifiedCheck>,
    /// The check by displacements, for SLV and SLC.
    pub displacement: Option<DisplacementCheck>,
    /// Ordinates of the spectrum at a height, mode by mode, at the periods of the check; absent on the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub floor: Vec<FloorOrdinates>,
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
        /// The demand is compared with the acceleration at which joints slide.
        Sliding = "sliding",
    }
}

/// The result of a method, with capacity and demand in a unit.
pub(super) type MethodResult = (Method, Margin, Option<([f64; 2], &'static str)>);

impl SideCheck {
    /// Results, the governing one first: by displacements if there is a curve, or the activation if it governs, before the
    /// displacements.
    pub(super) fn results(&self) -> impl Iterator<Item = MethodResult> {
        let displacement = self.displacement.map(|one| {
            let margin = Margin::new(one.zeta_e_by_displacement(), one.margin.ag_g);
            let compared = ([one.capacity_m, one.demand_m], "m");
            (Method::Displacement, margin, Some(compared))
        });
        let start = self.displacement.and_then(|one| {
            let compared = (one.activation_ag_g?, one.margin.ag_g?).into();
            Some((Method::Activation, one.margin, Some((compared, "g"))))
        });
        let simplified = self
            .simplified
            .map(|one| (Method::Simplified, one.margin, None));
        let activation = self.activation.map(|one| {
            let compared = ([one.capacity_g, one.demand_g], "g");
            (Method::Activation, one.margin, Some(compared))
        });
        let results = [start, displacement, simplified, activation];
        results.into_iter().flatten()
    }

    /// Governing method and result; `None` if the side cannot be checked, or joints slide first.
    pub fn governing_result(&self) -> Option<(Method, Margin)> {
        let (method, margin, _) = self.results().next()?;
        Some((method, margin))
    }

    /// Verdict to this side.
    pub fn verdict(&self) -> CheckVerdict {
        self.outcome()
            .map_or(CheckVerdict::NotChecked, |outcome| outcome.verdict)
    }

    /// Governing method with its verdict; `None` if the side cannot be checked.
    pub(super) fn outcome(&self) -> Option<SideOutcome> {
        if let Some(sliding) = self.sliding {
            return Some(SideOutcome {
                method: Method::Sliding,
                verdict: sliding.verdict,
                ratio: sliding.bound_g / sliding.demand_g,
            });
        }
        let (method, margin) = self.governing_result()?;
        Some(SideOutcome {
            method,
            verdict: match margin.passed {
                true => CheckVerdict::Passed,
                false => CheckVerdict::NotPassed,
            },
            ratio: margin.zeta_e,
        })
    }
}

/// The governing method of a side with its verdict.
#[derive(Clone, Copy)]
pub(super) struct SideOutcome {
    pub(super) method: Method,
    pub(super) verdict: CheckVerdict,
    /// The ratio of capacity to demand; an upper bound if joints slide first.
    pub(super) ratio: f64,
}

impl SideOutcome {
    /// True if this side decides rather than another: a side that fails, then a side without an answer, then the smaller ratio.
    pub(super) fn is_worse_than(&self, other: &Self) -> bool {
        let severity = |verdict| match verdict {
            CheckVerdict::NotPassed => 3,
            CheckVerdict::NoAnswer => 2,
            CheckVerdict::NotChecked => 1,
            CheckVerdict::Passed => 0,
        };
        let [own, others] = [self, other].map(|one| severity(one.verdict));
        let is_smaller = self.ratio < other.ratio && !equal_numbers(self.ratio, other.ratio);
        own > others || (own == others && is_smaller)
    }
}

named! {
    /// The verdict on a limit state.
    #[non_exhaustive]
    pub enum CheckVerdict {
        /// The capacity reaches the demand.
        Passed = "passed",
        /// The capacity is less than the demand.
        NotPassed = "not_passed",
        /// Joints slide first, and only an upper bound of the capacity is known, which the demand does not exceed.
        NoAnswer = "no_answer",
        /// There is no capacity curve.
        NotChecked = "not_checked",
    }
}

named! {
    /// The side whose result governs a limit state.
    pub enum GoverningSide {
        /// The right one.
        Right = "right",
        /// The left one.
        Left = "left",
        /// Both sides have the same method and result.
        Either = "either",
    }
}

/// True if two numbers of mirrored sides differ by rounding errors only.
pub(super) fn equal_numbers(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (a.abs() + b.abs()).max(1e-6)
}
