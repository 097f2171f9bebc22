//! Overturning without impact: during the first sway from rest, before the hinges close.
//!
//! The impact model has no influence on this factor, so it can be compared with other programs and closed forms. Under a pulse with one lobe
//! there is only one edge. Under a motion with lobes to both sides, narrow ranges of the factor may overturn the structure: one lobe just
//! overturns it and the next lobe does not stop it. So the search for the edge uses small strides, followed by bisection.

use crate::GroundMotion;
use crate::scenario::{Ground, Scenario};
use crate::studies::threshold::factors::{Factors, SearchedFactors, onset_factor};
use crate::studies::threshold::first_edge::find_lowest_strength;

/// Ratio of successive factors under motions with lobes to both sides; a narrower range may be missed. The narrowest known ranges, under Ricker,
/// Gabor and windowed pulses, were about 1.5 % wide.
const STRIDE: f64 = 1.005;

/// Ratio of successive factors under pulses with one lobe. A larger factor pushes more at every instant, so there is only one edge, and long
/// strides suffice.
const ONE_SIDED_STRIDE: f64 = 1.5;

/// Relative width to which bisection encloses the edge: about the accuracy of the integration at the default tolerance.
const RESOLUTION: f64 = 1e-9;

/// Finds the smallest of these factors on the ground motion of a scenario that overturns a mechanism without impact, in any of its
/// directions; `None` if no factor does.
pub(super) fn least_without_impact(
    scenario: &Scenario,
    factors: &Factors,
) -> Result<Option<f64>, String> {
    let model = scenario
        .mechanisms_without_impacts()
        .map_err(|error| error.to_string())?;
    let request = scenario.request_on(scenario.ground_motion(), &scenario.structure);
    let has_second = scenario.has_second_direction(&*model);
    let overturns = |factor: f64| {
        let ground = scenario
            .ground_motion()
            .scaled(factor)
            .map_err(|error| error.to_string())?;
        let falls = |ground: &GroundMotion| {
            let sway = model.overturns_without_impact(ground, &request);
            sway.map(|sway| sway.is_some())
                .map_err(|error| error.to_string())
        };
        Ok(falls(&ground)? || has_second && falls(&ground.mirrored())?)
    };
    let one_sided =
        matches!(scenario.ground.as_ref(), Some(Ground::Pulse(pulse)) if pulse.kind.is_one_sided());
    let stride = if one_sided { ONE_SIDED_STRIDE } else { STRIDE };
    let moving = (scenario.ground_motion(), &request);
    let onset = onset_factor(&*model, scenario.simulation.direction, moving);
    let SearchedFactors { from, to: last, .. } = factors.factors_to_search(onset)?;
    let ascending = std::iter::successors(Some(from), |factor| {
        (*factor < last).then(|| (factor * stride).min(last))
    });
    let histories = ascending.map(|factor| (factor, overturns(factor)));
    find_lowest_strength(histories, RESOLUTION, overturns)
}
