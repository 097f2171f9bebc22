//! Mechanisms and limit analysis as JSON.

use serde_json::{Value, json};

use crate::mechanics::chain::Chain;
use crate::mechanics::mechanism::{FourLink, Sway};
use crate::mechanics::ring::Ring;

/// The hinges of a mechanism as `[{angle_deg, edge}]`, from the left springing.
#[must_use]
pub fn hinges(mechanism: &FourLink, ring: &Ring, sway: Sway) -> Value {
    mechanism
        .hinges_from_left(ring, sway)
        .map(
            |(angle_rad, edge)| json!({ "angle_deg": angle_rad.to_degrees(), "edge": edge.name() }),
        )
        .to_vec()
        .into()
}

/// Result of `limit`: incipient acceleration and mechanism on both sides.
#[must_use]
pub fn limit(chain: &Chain) -> Value {
    let incipient = chain.incipient();
    let both =
        |of: &dyn Fn(Sway) -> Value| json!({ "right": of(Sway::Right), "left": of(Sway::Left) });
    json!({
        "incipient_acceleration_g": both(&|_| incipient.acceleration_g.into()),
        "mechanism": both(&|sway| hinges(&incipient.mechanism, chain.ring(), sway)),
    })
}
