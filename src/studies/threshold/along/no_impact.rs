//! Overturning without impact: in the first fall from rest, before the hinges ever close.
//!
//! The impact model has no influence, so this factor can be compared with other programs and closed forms. Under a pulse with one lobe
//! it is the only edge. A motion with lobes to both sides can overturn within narrow windows of the factor, in which one lobe just
//! carries the structure over and the next one does not catch it. So the edge is searched in small strides and then bisected.

use crate::bisection::{Width, try_bisect};
use crate::scenario::{Ground, Scenario};
use crate::studies::threshold::factors::Factors;

/// Ratio of successive factors in the search under motions to both sides: a window narrower than that may be missed. The narrowest
/// found, under Ricker, Gabor and windowed pulses, were some 1.5 % wide.
const STRIDE: f64 = 1.005;

/// Ratio of successive factors under pulses to one side. A larger factor pushes harder at every instant, so there is only one edge,
/// and the strides can be long.
const ONE_SIDED_STRIDE: f64 = 1.5;

/// Relative width to which the edge is bisected: integration at the default tolerance is not more accurate.
const RESOLUTION: f64 = 1e-9;

/// The least of these factors on the ground motion of a scenario that overturns a mechanism without impact; `None` if none does.
pub(super) fn least_without_impact(
    scenario: &Scenario,
    factors: &Factors,
) -> Result<Option<f64>, String> {
    let model = scenario.mechanisms().map_err(|error| error.to_string())?;
    let request = scenario.request_from_rest();
    let overturns = |factor: f64| {
        let ground = scenario.ground_motion().scaled(factor);
        let ground = ground.map_err(|error| error.to_string())?;
        let sway = model.overturns_without_impact(&ground, &request);
        sway.map(|sway| sway.is_some())
            .map_err(|error| error.to_string())
    };
    let one_sided =
        matches!(scenario.ground.as_ref(), Some(Ground::Pulse(pulse)) if pulse.kind.is_one_sided());
    let stride = if one_sided { ONE_SIDED_STRIDE } else { STRIDE };
    let last = factors.to;
    let ascending = std::iter::successors(Some(factors.from), |factor| {
        (*factor < last).then(|| (factor * stride).min(last))
    });
    let mut below = None;
    for factor in ascending {
        if overturns(factor)? {
            let low = below.unwrap_or(factor);
            let (_, least) = try_bisect(low, factor, Width::Relative(RESOLUTION), overturns)?;
            return Ok(Some(least));
        }
        below = Some(factor);
    }
    Ok(None)
}
