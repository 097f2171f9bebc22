//! Overturning without impact: in the first fall from rest, before the hinges ever close.
//!
//! The impact model has no influence, so this boundary can be compared with other programs and closed forms. Along
//! the amplitude of a pulse with one lobe it has one edge. A pulse with side lobes can overturn within narrow
//! windows of the amplitude, in which one lobe just carries the structure over and the next one does not catch it.
//! So the edge is searched in small strides and then bisected.

use nalgebra::Vector2;

use crate::bisection::{Width, try_bisect};
use crate::dynamics::ground::{GroundMotion, PulseShape};
use crate::dynamics::model::{MechanismModel, Request, SimulationError};
use crate::mechanics::sway::Sway;
use crate::scenario::{MAX_ACCELERATION_G, PulseGround};

/// Ratio of successive amplitudes in the search for the edge of a pulse with lobes to both sides: a window narrower
/// than that may be missed. The narrowest found, under Ricker, Gabor and windowed pulses, were some 1.5 % wide.
const STRIDE: f64 = 1.005;

/// The same for pulses to one side. A larger amplitude pushes harder at every instant, so there is only one
/// edge, and the strides can be long.
const ONE_SIDED_STRIDE: f64 = 1.5;

/// Relative width to which the edge is bisected: integration at the default tolerance is not more accurate.
const RESOLUTION: f64 = 1e-9;

/// A pulse of variable amplitude; everything else stays as it is.
#[derive(Clone, Debug)]
pub struct ScalablePulse {
    pulse: PulseGround,
    shape: PulseShape,
    gravity_m_s2: f64,
}

impl ScalablePulse {
    /// The pulse with this gravity. The sign of its own amplitude gives the side to which it pushes.
    #[must_use]
    pub fn new(pulse: PulseGround, gravity_m_s2: f64) -> Self {
        Self {
            shape: pulse.shape(),
            pulse,
            gravity_m_s2,
        }
    }

    /// The ground motion for an amplitude, positive to the right.
    #[must_use]
    pub fn motion(&self, amplitude_g: f64) -> GroundMotion {
        let amplitude_g = Vector2::new(amplitude_g, self.pulse.vertical_amplitude_g);
        let motion = self.shape.motion(amplitude_g * self.gravity_m_s2);
        motion.expect("the amplitudes of a scenario are those of a ground motion")
    }

    /// The ground motion for an amplitude to the pulse's own side.
    #[must_use]
    pub fn motion_of_magnitude(&self, magnitude_g: f64) -> GroundMotion {
        self.motion(magnitude_g.copysign(self.pulse.amplitude_g))
    }

    /// The smallest amplitude, as a magnitude in g, that overturns the structure without impact, and the side to
    /// which the structure falls; `None` if no allowed amplitude does. The search goes in strides. Where windows may
    /// lie between the strides, it also tries `tried_g`.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn minimum_without_impact(
        &self,
        model: &dyn MechanismModel,
        request: &Request,
        tried_g: &[f64],
    ) -> Result<Option<(f64, Sway)>, SimulationError> {
        let overturns = |magnitude_g: f64| {
            let ground = self.motion_of_magnitude(magnitude_g);
            model.overturns_without_impact(&ground, request)
        };
        let one_sided = self.pulse.kind.is_one_sided();
        let side = Sway::pushed_by(self.pulse.amplitude_g);
        let Some(incipient_g) = model.incipient_acceleration_g(side) else {
            return Ok(None);
        };
        // Ground that accelerates downwards makes the structure lighter.
        let from_g = incipient_g * (1.0 - self.pulse.vertical_amplitude_g.abs().min(0.99));
        let tried_g: &[f64] = if one_sided { &[] } else { tried_g };
        let mut ascending_g: Vec<f64> = strides(one_sided, from_g, MAX_ACCELERATION_G)
            .chain(tried_g.iter().copied())
            .filter(|amplitude_g| *amplitude_g <= MAX_ACCELERATION_G)
            .collect();
        ascending_g.sort_by(f64::total_cmp);
        let least_g = minimum_amplitude(ascending_g, |amplitude_g| {
            overturns(amplitude_g).map(|sway| sway.is_some())
        })?;
        let Some(least_g) = least_g else {
            return Ok(None);
        };
        Ok(overturns(least_g)?.map(|sway| (least_g, sway)))
    }
}

/// Amplitudes from `from` to `to`, in strides that do not miss an edge: of 0.5 % if there can be windows.
fn strides(one_sided: bool, from: f64, to: f64) -> impl Iterator<Item = f64> {
    let stride = if one_sided { ONE_SIDED_STRIDE } else { STRIDE };
    std::iter::successors(Some(from), move |last| {
        (*last < to).then(|| (last * stride).min(to))
    })
}

/// The smallest amplitude that overturns without impact. `overturns` tells whether an amplitude does. The first of the
/// ascending ones that does is bisected against the one before, to a relative width of `1e-9`. `None` if none does.
///
/// # Errors
/// Those of the function.
fn minimum_amplitude<E>(
    ascending: impl IntoIterator<Item = f64>,
    overturns: impl Fn(f64) -> Result<bool, E>,
) -> Result<Option<f64>, E> {
    let mut below = None;
    for amplitude in ascending {
        if overturns(amplitude)? {
            let low = below.unwrap_or(amplitude);
            let (_, high) = try_bisect(low, amplitude, Width::Relative(RESOLUTION), overturns)?;
            return Ok(Some(high));
        }
        below = Some(amplitude);
    }
    Ok(None)
}
