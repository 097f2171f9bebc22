//! Results to the right and to the left.

use crate::mechanics::Sway;
use serde::{Deserialize, Serialize};

/// Result for both directions of sway.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sides<T> {
    /// Result for a sway to the right.
    pub right: T,
    /// Result for a sway to the left.
    pub left: T,
}

impl<T> Sides<T> {
    /// Computes both sides, the right one first.
    pub fn of(mut side: impl FnMut(Sway) -> T) -> Self {
        Self {
            right: side(Sway::Right),
            left: side(Sway::Left),
        }
    }

    /// Computes both sides, the right one first.
    ///
    /// # Errors
    /// The first error of a side.
    pub fn try_of<E>(mut side: impl FnMut(Sway) -> Result<T, E>) -> Result<Self, E> {
        Ok(Self {
            right: side(Sway::Right)?,
            left: side(Sway::Left)?,
        })
    }

    /// Result for one side.
    pub const fn get(&self, sway: Sway) -> &T {
        match sway {
            Sway::Right => &self.right,
            Sway::Left => &self.left,
        }
    }

    /// Result for one side, as a mutable reference.
    pub const fn to_mut(&mut self, sway: Sway) -> &mut T {
        match sway {
            Sway::Right => &mut self.right,
            Sway::Left => &mut self.left,
        }
    }

    /// Both results with their sides, the right one first.
    pub fn iter(&self) -> impl Iterator<Item = (Sway, &T)> {
        [(Sway::Right, &self.right), (Sway::Left, &self.left)].into_iter()
    }

    /// Computes new results for both sides from these.
    pub fn map<U>(&self, mut result: impl FnMut(&T) -> U) -> Sides<U> {
        Sides::of(|sway| result(self.get(sway)))
    }
}

impl<T> From<Sides<T>> for [T; 2] {
    /// Both results, the right one first.
    fn from(sides: Sides<T>) -> Self {
        [sides.right, sides.left]
    }
}
