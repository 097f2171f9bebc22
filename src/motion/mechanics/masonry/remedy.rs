//! Changes that make an arch stable that falls under its own weight.

use super::{BasketArch, CircularArch, Pier, Piers};
use crate::bisection::{Width, try_bisect};
use crate::mechanics::{Masonry, MasonryShape};

/// Change that makes masonry stable, with the least factor, rounded up to four decimals; `None` if a factor of four is not enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remedy {
    /// Factor on the width of its piers; on rigid ground the arch is stable.
    WiderPiers(Option<f64>),
    /// Factor on the thickness of the arch; without its loads it is stable as it is.
    LessLoad(Option<f64>),
    /// Factor on the thickness of the arch.
    ThickerArch(Option<f64>),
}

impl Masonry {
    /// Change that makes masonry stable that falls under its own weight.
    pub fn remedy(&self) -> Remedy {
        let arch_stands = || self.is_stable_with(self.shape.clone(), Piers::default());
        if !self.piers.are_none() && arch_stands() == Some(true) {
            return Remedy::WiderPiers(least_factor(|factor| {
                self.is_stable_with(self.shape.clone(), self.piers.widened(factor))
            }));
        }
        let factor = least_factor(|factor| {
            self.is_stable_with(self.shape.thickened(factor)?, Piers::default())
        });
        let (shape, piers) = (self.shape.clone(), self.piers);
        let unloaded = Self::new(shape, piers, self.fill, Vec::new()).map(|it| it.stands());
        match unloaded {
            Ok(Ok(true)) if !self.loads.is_empty() => Remedy::LessLoad(factor),
            _ => Remedy::ThickerArch(factor),
        }
    }

    fn is_stable_with(&self, shape: MasonryShape, piers: Piers) -> Option<bool> {
        // Loads on piers are neglected for an arch on rigid ground.
        let loads = self
            .loads
            .iter()
            .copied()
            .filter(|load| load.pier.is_none() || !piers.are_none());
        let masonry = Self::new(shape, piers, self.fill, loads.collect()).ok()?;
        let gravity_m_s2 = self.row.gravity_m_s2;
        masonry.with_constant_forces(gravity_m_s2).stands().ok()
    }
}

impl Piers {
    fn widened(&self, factor: f64) -> Self {
        let wider = |pier: Pier| Pier {
            width_m: pier.width_m * factor,
            ..pier
        };
        Self {
            left: self.left.map(wider),
            right: self.right.map(wider),
        }
    }
}

impl MasonryShape {
    /// Shape with the thickness of the arch multiplied by a factor; `None` for blocks, whose thickness is given.
    fn thickened(&self, factor: f64) -> Option<Self> {
        let mut thicker = self.clone();
        match &mut thicker {
            Self::PointedArch(dimensions)
            | Self::EllipticArch(dimensions)
            | Self::BasketArch(BasketArch { dimensions, .. }) => dimensions.thickness_m *= factor,
            Self::Circular(CircularArch { arch, .. }) => {
                let ratio = arch.thickness_ratio * factor;
                *arch = arch.clone().with_thickness_ratio(ratio).ok()?;
            }
            Self::Blocks(_) => return None,
        }
        Some(thicker)
    }
}

/// Least factor for which the masonry is stable, rounded up to four decimals; `None` if it is above four.
fn least_factor(stands: impl Fn(f64) -> Option<bool>) -> Option<f64> {
    let mut factors = [1.25, 1.5, 2.0, 3.0, 4.0].into_iter();
    let high = factors.find(|factor| stands(*factor) == Some(true))?;
    let holds = |factor| stands(factor).ok_or(());
    let (_, least) = try_bisect(1.0, high, Width::Absolute(1e-5), holds).ok()?;
    Some((least * 1e4).ceil() / 1e4)
}
