//! The scalar: f64 or f32, with the few functions that kinematics needs.

use crate::{arctangent, sine};
use core::fmt::{Debug, Display, LowerExp};
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real scalar. Implemented for `f64` and `f32`, by the `libm` crate and sines and an arc tangent of our own only, so that every host
/// gives the same bits.
///
/// Generated code calls these as `Float::sin_cos(x)`, never as `x.sin_cos()`, which would be the host's function where
/// the standard library is linked.
pub trait Float:
    Copy
    + PartialOrd
    + Debug
    + Display
    + LowerExp
    + Default
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// 2
    const TWO: Self;
    /// Half a turn.
    const PI: Self;
    /// A turn.
    const TAU: Self;
    /// The distance from 1 to the next number.
    const EPSILON: Self;
    /// The square root of [`Self::EPSILON`]: how far apart two roots are that a rounding error can make of one.
    const SQRT_EPSILON: Self;
    /// Infinity.
    const INFINITY: Self;
    /// Not a number.
    const NAN: Self;

    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;
    /// This number as f64, exactly.
    fn to_f64(self) -> f64;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// [`Float::sin_cos`] of several angles, which takes less time than one after the other.
    fn sin_cos_all<const K: usize>(angles: [Self; K]) -> [(Self, Self); K];
    /// The angle (rad) of the point (`x`, `self`), in \[-pi, pi\].
    fn atan2(self, x: Self) -> Self;
    /// Square root; NaN below 0.
    fn sqrt(self) -> Self;
    /// The length of (`self`, `other`), without overflow on the way.
    fn hypot(self, other: Self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The greatest whole number that isn't greater.
    fn floor(self) -> Self;
    /// The least whole number that isn't smaller.
    fn ceil(self) -> Self;
    /// The nearest whole number, halves away from 0.
    fn round(self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// Not a number.
    fn is_nan(self) -> bool {
        self.partial_cmp(&self).is_none()
    }

    /// The smaller of the two; the other one where one is NaN.
    fn min(self, other: Self) -> Self {
        if other < self || self.is_nan() { other } else { self }
    }

    /// The greater of the two; the other one where one is NaN.
    fn max(self, other: Self) -> Self {
        if other > self || self.is_nan() { other } else { self }
    }

    /// The same angle (rad) in (-pi, pi].
    ///
    /// ```
    /// use dh_core::Float;
    /// assert_eq!(Float::wrap_angle(-core::f64::consts::PI), core::f64::consts::PI);
    /// ```
    fn wrap_angle(self) -> Self {
        wrap(self, Self::TAU)
    }
}

/// The value in (-period/2, period/2] that differs from `value` by a whole number of periods.
#[inline]
pub(crate) fn wrap<S: Float>(value: S, period: S) -> S {
    let half = period / S::TWO;
    if value.abs() < half + period {
        // Sums of two angles are on either side of the ends about as often as between them: a table instead of branches.
        let [above, below] = [value > half, value <= -half].map(usize::from);
        return value - [S::ZERO, period, -period, S::ZERO][(above + 2 * below) & 3];
    }
    wrap_far(value, period)
}

/// [`wrap`], of values that are more than one period off.
#[cold]
#[inline(never)]
fn wrap_far<S: Float>(value: S, period: S) -> S {
    let half = period / S::TWO;
    let wrapped = value - ((value - half) / period).ceil() * period;
    // The quotient is rounded: next to the ends it may be off by one.
    if wrapped <= -half {
        wrapped + period
    } else if wrapped > half {
        wrapped - period
    } else {
        wrapped
    }
}

macro_rules! float {
    ($type:ident, $sqrt_epsilon:expr, $sincos:path, $all:path, $sqrt:ident, $hypot:ident, $fabs:ident, $floor:ident, $ceil:ident, $round:ident) => {
        impl Float for $type {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const PI: Self = core::$type::consts::PI;
            const TAU: Self = core::$type::consts::TAU;
            const EPSILON: Self = $type::EPSILON;
            const SQRT_EPSILON: Self = $sqrt_epsilon;
            const INFINITY: Self = $type::INFINITY;
            const NAN: Self = $type::NAN;

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn sin_cos_all<const K: usize>(angles: [Self; K]) -> [(Self, Self); K] {
                $all(angles)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                arctangent::atan2(f64::from(self), f64::from(x)) as Self
            }
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn hypot(self, other: Self) -> Self {
                libm::$hypot(self, other)
            }
            #[inline]
            fn abs(self) -> Self {
                libm::$fabs(self)
            }
            #[inline]
            fn floor(self) -> Self {
                libm::$floor(self)
            }
            #[inline]
            fn ceil(self) -> Self {
                libm::$ceil(self)
            }
            #[inline]
            fn round(self) -> Self {
                libm::$round(self)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $type::is_finite(self)
            }
        }
    };
}

// 2^-26, and 2^-11.5 to the last bit.
float!(f64, 1.490_116_119_384_765_6e-8, sine::sin_cos, sine::all, sqrt, hypot, fabs, floor, ceil, round);
float!(f32, 3.452_669_8e-4, libm::sincosf, each, sqrtf, hypotf, fabsf, floorf, ceilf, roundf);

/// One after the other.
fn each<const K: usize>(angles: [f32; K]) -> [(f32, f32); K] {
    angles.map(libm::sincosf)
}
