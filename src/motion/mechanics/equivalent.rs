//! The equivalent free-standing block of a structure.
//!
//! A structure with one degree of freedom has the kinetic energy `M(q) q'^2 / 2`. In the coordinate
//! `s = int sqrt(M) dq` its mass is one, and in the potential `U = g int S_y dq` it moves by `s'' = -dU/ds`.
//! So a small disturbance of a motion near `q` grows as `exp(n t)` with
//!
//! `n^2 = -d2U/ds2 = -(U'' - U' M' / (2 M)) / M`,
//!
//! where a prime is `d/dq`; `n` does not depend on the choice of the coordinate. For Housner's block of half
//! diagonal `R` and slenderness `alpha`, `n^2 = p^2 cos(alpha - q)` with `p^2 = 3 g / (4 R)`. The equivalent
//! block starts at the same push, `tan(alpha) = A_L`, and has the same `n`
//!
//! - at the unstable equilibrium, where `U' = 0`: `p_c^2 = -U''(q_c) / M(q_c)`, or
//! - at rest: `p_0^2 = n^2(0) / cos(alpha)`.
//!
//! For a column the two agree: they are its own `p` and `alpha`. For an arch they differ: the mechanism
//! stiffens or softens on its way. The first describes overturning and near-overturning, the second small
//! rocking.

use crate::mechanics::{Link, Mechanism, MechanismChain, Sway};
use serde::{Deserialize, Serialize};

/// Free-standing block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HousnerBlock {
    /// Frequency parameter `p = sqrt(3 g / (4 R))`, in rad/s.
    #[serde(rename = "p_rad_s")]
    pub frequency_rad_s: f64,
    /// Half diagonal `R = 3 g / (4 p^2)`, in metres.
    pub half_diagonal_m: f64,
}

/// Blocks equivalent to a structure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Equivalent {
    /// Slenderness `alpha = atan(A_L)` of both blocks, in radians.
    pub slenderness_rad: f64,
    /// Block with the same growth rate of disturbances at rest; `None` if disturbances of the structure do not grow there.
    pub at_rest: Option<HousnerBlock>,
    /// Block with the same growth rate of disturbances at the unstable equilibrium; `None` if they do not grow.
    pub at_critical: Option<HousnerBlock>,
}

/// Blocks equivalent to the first mechanism of `structure` to a side under gravity. `None` without such a mechanism.
pub fn equivalent_towards<C: MechanismChain>(
    structure: &C,
    sway: Sway,
    gravity_m_s2: f64,
) -> Option<Equivalent> {
    let link = structure.link_from(sway, 0)?;
    let slenderness_rad = libm::atan(structure.incipient_towards_g(sway));
    let block = |squared: f64| {
        let per_s2 = squared * gravity_m_s2 / structure.length_m();
        (per_s2 > 0.0).then(|| HousnerBlock {
            frequency_rad_s: per_s2.sqrt(),
            half_diagonal_m: 0.75 * gravity_m_s2 / per_s2,
        })
    };
    Some(Equivalent {
        slenderness_rad,
        at_rest: block(growth_squared(link, 0.0) / libm::cos(slenderness_rad)),
        at_critical: block(growth_squared(link, link.critical_rad)),
    })
}

/// `n^2` for unit gravity and length.
fn growth_squared<M: Mechanism>(link: &Link<M>, q_rad: f64) -> f64 {
    let rise = |q| link.mechanism.coefficients(q).potential_slope();
    // Five-point central difference. The step is a thousandth of the way to q_c: its relative error is of the order of the fourth power of that, as
    // is the rounding error.
    let step = 1e-3 * link.critical_rad;
    let near = rise(q_rad + step) - rise(q_rad - step);
    let far = rise(q_rad + 2.0 * step) - rise(q_rad - 2.0 * step);
    let stiffness = (8.0 * near - far) / (12.0 * step);
    let here = link.mechanism.coefficients(q_rad);
    (0.5 * here.potential_slope() * here.inertia_slope / here.inertia - stiffness) / here.inertia
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::column::{Column, RockingColumn};
    use crate::mechanics::four_link::impact::ImpactModel;

    /// Slender and fat columns. The errors are `step^4 = 1e-12` and rounding by `1e-16 / 1e-3`.
    #[test]
    fn a_column_is_its_own_equivalent_block() {
        for (height_m, width_m) in [(1e3, 1e-3), (4.0, 0.8), (1.0, 1.0), (1.0, 3.0)] {
            let column = Column::new(height_m, width_m).unwrap();
            let model = RockingColumn::new(&column, ImpactModel::MaxRestitution).unwrap();
            let blocks = equivalent_towards(&model, Sway::Right, 1.62).unwrap();
            assert!((blocks.slenderness_rad - column.slenderness_rad()).abs() < 1e-15);
            let half_diagonal_m = 0.5 * (height_m * height_m + width_m * width_m).sqrt();
            for block in [blocks.at_rest.unwrap(), blocks.at_critical.unwrap()] {
                assert!((block.half_diagonal_m / half_diagonal_m - 1.0).abs() < 1e-11);
                let frequency_rad_s = (0.75 * 1.62 / half_diagonal_m).sqrt();
                assert!((block.frequency_rad_s / frequency_rad_s - 1.0).abs() < 1e-11);
            }
        }
    }
}
