//! Lanes: one number, or several that go through the same operations in lock-step.
//!
//! Code that is generic over [`Lane`] gives the same bits on `f64` and on every [`Pack`]: each operation is the one
//! IEEE 754 operation, none is fused with another or reordered, and a branch is a select.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::Simd;

/// A number, or several in lock-step. Comparisons with NaN are false, as for `f64`.
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// What it takes to make a lane from a plain number.
    type Token: Copy;

    /// The same number in every lane.
    fn splat(token: Self::Token, value: f64) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// Where `self < other`: `then`, elsewhere `otherwise`.
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self;

    /// The same number in every lane, made from a lane that is at hand.
    fn same(self, value: f64) -> Self;

    /// The lesser; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.if_less(other, self, other)
    }

    /// The greater; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        other.if_less(self, self, other)
    }

    /// `self` held between `-limit` and `limit`.
    #[inline(always)]
    fn clip(self, limit: Self) -> Self {
        self.min(limit).max(-limit)
    }

    /// `magnitude` with the sign of `self`; zero has the positive sign.
    #[inline(always)]
    fn sign_times(self, magnitude: Self) -> Self {
        self.if_less(self.same(0.0), -magnitude, magnitude)
    }
}

impl Lane for f64 {
    type Token = ();

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self < other { then } else { otherwise }
    }

    #[inline(always)]
    fn same(self, value: f64) -> Self {
        value
    }
}

/// `N` vector registers of the instruction set `S`, side by side: enough independent work to hide latencies.
#[derive(Debug, Clone, Copy)]
pub struct Pack<S: Simd, const N: usize> {
    simd: S,
    registers: [S::f64s; N],
}

impl<S: Simd, const N: usize> Pack<S, N> {
    /// The number of lanes.
    pub const LANES: usize = N * S::F64_LANES;

    /// The lanes of a slice; lanes beyond its end repeat its last number.
    ///
    /// # Panics
    /// When the slice is empty.
    #[inline(always)]
    pub fn load(simd: S, values: &[f64]) -> Self {
        let last = values[values.len() - 1];
        let registers = std::array::from_fn(|register| {
            // No instruction set has more than eight double-precision lanes.
            let padded: [f64; 8] =
                std::array::from_fn(|lane| values.get(register * S::F64_LANES + lane).copied().unwrap_or(last));
            simd.partial_load_f64s(&padded[..S::F64_LANES])
        });
        Self { simd, registers }
    }

    /// Writes the lanes to a slice; lanes beyond its end are dropped.
    #[inline(always)]
    pub fn store(self, values: &mut [f64]) {
        for (chunk, register) in values.chunks_mut(S::F64_LANES).zip(self.registers) {
            self.simd.partial_store_f64s(chunk, register);
        }
    }

    #[inline(always)]
    fn map(self, f: impl Fn(S, S::f64s) -> S::f64s) -> Self {
        Self { simd: self.simd, registers: std::array::from_fn(|i| f(self.simd, self.registers[i])) }
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(S, S::f64s, S::f64s) -> S::f64s) -> Self {
        let registers = std::array::from_fn(|i| f(self.simd, self.registers[i], other.registers[i]));
        Self { simd: self.simd, registers }
    }
}

impl<S: Simd, const N: usize> Lane for Pack<S, N> {
    type Token = S;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Self { simd, registers: [simd.splat_f64s(value); N] }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(|simd, a| simd.abs_f64s(a))
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        let simd = self.simd;
        let registers = std::array::from_fn(|i| {
            let mask = simd.less_than_f64s(self.registers[i], other.registers[i]);
            simd.select_f64s(mask, then.registers[i], otherwise.registers[i])
        });
        Self { simd, registers }
    }

    #[inline(always)]
    fn same(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }
}

impl<S: Simd, const N: usize> Neg for Pack<S, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|simd, a| simd.neg_f64s(a))
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $instruction:ident) => {
        impl<S: Simd, const N: usize> $operator for Pack<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |simd, a, b| simd.$instruction(a, b))
            }
        }

        impl<S: Simd, const N: usize> $operator<f64> for Pack<S, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.zip(self.same(other), |simd, a, b| simd.$instruction(a, b))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

#[cfg(test)]
mod tests {
    use pulp::{Arch, WithSimd};

    use super::*;

    /// Every operation once, on numbers with signed zeros, NaN and infinities among them.
    fn mixture<L: Lane>(a: L, b: L) -> L {
        let sum = a + b * 3.0 - a / (b + 0.1);
        let selected = sum.abs().min(a.max(b)).clip(b.same(2.0));
        (-selected) + a.sign_times(b) * a.if_less(b, a.same(1.0), b.same(-1.0)) / 7.0 + 1.0 - 0.3
    }

    struct Mixture<'a> {
        a: &'a [f64],
        b: &'a [f64],
        out: &'a mut [f64],
    }

    impl WithSimd for Mixture<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) {
            mixture(Pack::<S, 3>::load(simd, self.a), Pack::<S, 3>::load(simd, self.b)).store(self.out);
        }
    }

    #[test]
    fn parity_every_lane_gives_the_bits_of_the_plain_number() {
        let special = [0.0, -0.0, 1.0, -1.0, 1e-300, f64::INFINITY, f64::NAN, 2.5, -3.25, 1e300, 0.1];
        for n in 1..=12 {
            let a: Vec<f64> = (0..n).map(|i| special[i % special.len()]).collect();
            let b: Vec<f64> = (0..n).map(|i| special[(7 * i + 3) % special.len()]).collect();
            let mut out = vec![f64::NAN; n];
            Arch::new().dispatch(Mixture { a: &a, b: &b, out: &mut out });
            for i in 0..n {
                let plain = mixture(a[i], b[i]);
                let same = out[i].to_bits() == plain.to_bits() || (out[i].is_nan() && plain.is_nan());
                assert!(same, "lane {i} of {n}: {} is not {plain}", out[i]);
            }
        }
    }
}
