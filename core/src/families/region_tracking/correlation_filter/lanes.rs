//! Lanes of numbers that are computed as one, so that a transform of them is a transform of each.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Rem, Sub};

use rustfft::num_traits::{FromPrimitive, Num, One, Signed, Zero};

/// Number of lanes: as many as a register of any processor holds.
pub const LANES: usize = 4;

/// Lanes of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn all(value: f32) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(from_fn(|k| f(self.0[k], other.0[k])))
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }
}

macro_rules! operators {
    ($($trait:ident $name:ident $operator:tt),*) => {
        $(impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(other, |a, b| a $operator b)
            }
        })*
    };
}
operators!(Add add +, Sub sub -, Mul mul *, Div div /, Rem rem %);

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

// The following traits are required by the transforms.

impl Zero for Lanes {
    #[inline(always)]
    fn zero() -> Self {
        Self::all(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl One for Lanes {
    #[inline(always)]
    fn one() -> Self {
        Self::all(1.0)
    }
}

impl Num for Lanes {
    type FromStrRadixErr = <f32 as Num>::FromStrRadixErr;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f32::from_str_radix(text, radix).map(Self::all)
    }
}

impl Signed for Lanes {
    fn abs(&self) -> Self {
        self.map(f32::abs)
    }

    fn abs_sub(&self, other: &Self) -> Self {
        self.with(*other, |a, b| (a - b).max(0.0))
    }

    fn signum(&self) -> Self {
        self.map(f32::signum)
    }

    fn is_positive(&self) -> bool {
        self.0.iter().all(|a| *a > 0.0)
    }

    fn is_negative(&self) -> bool {
        self.0.iter().all(|a| *a < 0.0)
    }
}

impl FromPrimitive for Lanes {
    fn from_i64(value: i64) -> Option<Self> {
        f32::from_i64(value).map(Self::all)
    }

    fn from_u64(value: u64) -> Option<Self> {
        f32::from_u64(value).map(Self::all)
    }

    fn from_f64(value: f64) -> Option<Self> {
        f32::from_f64(value).map(Self::all)
    }
}
