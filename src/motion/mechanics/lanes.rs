//! Parallel numbers, so that the same code computes one motion, several motions in parallel, or derivatives.
//!
//! Code for any [`Real`] never branches on a value: it selects. Each lane of [`Lanes`] therefore has exactly the result of a single computation, for
//! any values in the other lanes.

use std::array;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Pair of an expression with 0 and with 1 in place of the name. The code is written out, because the compiler does not inline `map` in functions as
/// large as a step.
macro_rules! both {
    ($index:ident: $value:expr) => {
        [
            {
                let $index = 0;
                $value
            },
            {
                let $index = 1;
                $value
            },
        ]
    };
}
pub(crate) use both;

/// Number type of the mechanics of elastic joints.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// Constant.
    fn of(value: f64) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// `yes` if this is above another number, else `no`. It compares and does not subtract, because the difference of two infinities is NaN.
    fn above(self, other: Self, yes: Self, no: Self) -> Self;

    /// `yes` if this is positive, else `no`.
    #[inline(always)]
    fn positive(self, yes: Self, no: Self) -> Self {
        self.above(Self::of(0.0), yes, no)
    }

    /// Larger one of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.above(other, self, other)
    }

    /// Smaller one of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        other.above(self, self, other)
    }

    /// Absolute value.
    #[inline(always)]
    fn abs(self) -> Self {
        self.positive(self, -self)
    }
}

/// `L` parallel numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<const L: usize>(pub [f64; L]);

/// Applies an expression lane by lane, in a loop and not a closure, so that the compiler vectorises it everywhere.
macro_rules! by_lane {
    ($lane:ident: $value:expr) => {{
        let mut lanes = [0.0; L];
        let mut $lane = 0;
        while $lane < L {
            lanes[$lane] = $value;
            $lane += 1;
        }
        Self(lanes)
    }};
}

/// Implements operators of two numbers lane by lane.
macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),+) => {$(
        impl<const L: usize> $trait for Lanes<L> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                by_lane!(lane: self.0[lane] $operator other.0[lane])
            }
        }
    )+};
}
operators!(Add add +, Sub sub -, Mul mul *, Div div /);

/// Implements the assignment operators by the corresponding operators.
macro_rules! assigning {
    ($($number:ident),+) => {$(
        impl<const N: usize> AddAssign for $number<N> {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl<const N: usize> SubAssign for $number<N> {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
    )+};
}
assigning!(Lanes, Dual);

impl<const L: usize> Mul<f64> for Lanes<L> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        by_lane!(lane: self.0[lane] * other)
    }
}

impl<const L: usize> Neg for Lanes<L> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        by_lane!(lane: -self.0[lane])
    }
}

impl<const L: usize> Real for Lanes<L> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self([value; L])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        by_lane!(lane: self.0[lane].sqrt())
    }

    #[inline(always)]
    fn above(self, other: Self, yes: Self, no: Self) -> Self {
        by_lane!(lane: if self.0[lane] > other.0[lane] { yes.0[lane] } else { no.0[lane] })
    }
}

/// Implements access to single lanes of a struct. Its arguments are fields, after a semicolon fields that are pairs, and after another semicolon
/// fields that are such structs themselves.
macro_rules! remembered {
    ($type:ident { $($field:ident),* $(; $($pair:ident),+ $(; $($part:ident: $of:ident),+)?)? }) => {
        impl<R: Real> $type<R> {
            /// Initial state, with all values zero.
            pub fn none() -> Self {
                let zero = R::of(0.0);
                Self { $($field: zero,)* $($($pair: [zero; 2],)+ $($($part: $of::none(),)+)?)? }
            }
        }

        #[allow(dead_code, reason = "some are only set, others only read")]
        impl<const L: usize> $type<Lanes<L>> {
            /// Sets one lane.
            pub fn set(&mut self, lane: usize, alone: &$type<Lanes<1>>) {
                $(self.$field.0[lane] = alone.$field.0[0];)*
                $($(for (part, from) in self.$pair.iter_mut().zip(&alone.$pair) {
                    part.0[lane] = from.0[0];
                })+ $($(self.$part.set(lane, &alone.$part);)+)?)?
            }

            /// One lane.
            pub(crate) fn lane(&self, lane: usize) -> $type<Lanes<1>> {
                $type {
                    $($field: Lanes([self.$field.0[lane]]),)*
                    $($($pair: self.$pair.map(|part| Lanes([part.0[lane]])),)+ $($($part: self.$part.lane(lane),)+)?)?
                }
            }
        }
    };
}
pub(crate) use remembered;

/// Number with its derivatives with respect to `D` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const D: usize> {
    /// The number.
    pub value: f64,
    /// Derivatives of the number.
    pub slope: [f64; D],
}

impl<const D: usize> Dual<D> {
    /// Variable with this index.
    pub(crate) fn variable(value: f64, index: usize) -> Self {
        Self::with(value, |other| if other == index { 1.0 } else { 0.0 })
    }

    /// Function of this number, given by its value and derivative.
    pub(crate) fn chained(self, value: f64, derivative: f64) -> Self {
        Self::with(value, |i| self.slope[i] * derivative)
    }

    fn with(value: f64, slope: impl FnMut(usize) -> f64) -> Self {
        let slope = array::from_fn(slope);
        Self { value, slope }
    }
}

impl<const D: usize> Add for Dual<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::with(self.value + other.value, |i| self.slope[i] + other.slope[i])
    }
}

impl<const D: usize> Sub for Dual<D> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::with(self.value - other.value, |i| self.slope[i] - other.slope[i])
    }
}

impl<const D: usize> Mul for Dual<D> {
    type Output = Self;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "the rule of derivatives")]
    fn mul(self, other: Self) -> Self {
        Self::with(self.value * other.value, |i| {
            self.slope[i] * other.value + self.value * other.slope[i]
        })
    }
}

impl<const D: usize> Div for Dual<D> {
    type Output = Self;

    #[expect(clippy::suspicious_arithmetic_impl, reason = "the rule of derivatives")]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::with(value, |i| {
            (self.slope[i] - value * other.slope[i]) / other.value
        })
    }
}

impl<const D: usize> Mul<f64> for Dual<D> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        self.chained(self.value * factor, factor)
    }
}

impl<const D: usize> Neg for Dual<D> {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<const D: usize> Real for Dual<D> {
    fn of(value: f64) -> Self {
        Self::with(value, |_| 0.0)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chained(root, 0.5 / root)
    }

    fn above(self, other: Self, yes: Self, no: Self) -> Self {
        if self.value > other.value { yes } else { no }
    }
}
