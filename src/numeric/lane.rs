//! Lanes: one number, or several that go through the same operations in lock-step.
//!
//! Code that is generic over [`Lane`] gives the same bits on `f64` and on every [`Register`] and [`Both`]: each operation is the one
//! IEEE 754 operation, none is fused with another or reordered, and a branch is a select.

use std::ops::{Add, Div, Mul, Neg, Range, Sub};

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
    /// The square root, rounded correctly.
    fn sqrt(self) -> Self;
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
    fn sqrt(self) -> Self {
        Self::sqrt(self)
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

/// A lane that is filled from slices and emptied into them.
pub trait Lanes: Lane {
    /// The number of numbers in lock-step.
    const COUNT: usize;

    /// The numbers of a slice; lanes beyond its end repeat its last one, or `0` when it is empty.
    fn load(token: Self::Token, values: &[f64]) -> Self;

    /// Writes the numbers to a slice; lanes beyond its end are dropped.
    fn store(self, values: &mut [f64]);
}

/// One vector register of the instruction set `S`.
#[derive(Debug, Clone, Copy)]
pub struct Register<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lane for Register<S> {
    type Token = S;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self { values: self.simd.abs_f64s(self.values), ..self }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self { values: self.simd.sqrt_f64s(self.values), ..self }
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        let mask = self.simd.less_than_f64s(self.values, other.values);
        Self { values: self.simd.select_f64s(mask, then.values, otherwise.values), ..self }
    }

    #[inline(always)]
    fn same(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }
}

impl<S: Simd> Lanes for Register<S> {
    const COUNT: usize = S::F64_LANES;

    #[inline(always)]
    fn load(simd: S, values: &[f64]) -> Self {
        let last = values.last().copied().unwrap_or(0.0);
        // No instruction set has more than eight double-precision lanes.
        let mut padded = [last; 8];
        let filled = values.len().min(Self::COUNT);
        padded[..filled].copy_from_slice(&values[..filled]);
        Self { simd, values: simd.partial_load_f64s(&padded[..Self::COUNT]) }
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let end = values.len().min(Self::COUNT);
        self.simd.partial_store_f64s(&mut values[..end], self.values);
    }
}

impl<S: Simd> Neg for Register<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { values: self.simd.neg_f64s(self.values), ..self }
    }
}

/// Two lanes side by side: independent work that hides latencies. Nested for more; pairs rather than an array, for a
/// compiler need not unroll what has no loop.
#[derive(Debug, Clone, Copy)]
pub struct Both<A, B>(A, B);

impl<A: Lane, B: Lane<Token = A::Token>> Lane for Both<A, B> {
    type Token = A::Token;

    #[inline(always)]
    fn splat(token: Self::Token, value: f64) -> Self {
        Self(A::splat(token, value), B::splat(token, value))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        Self(self.0.if_less(other.0, then.0, otherwise.0), self.1.if_less(other.1, then.1, otherwise.1))
    }

    #[inline(always)]
    fn same(self, value: f64) -> Self {
        Self(self.0.same(value), self.1.same(value))
    }
}

impl<A: Lanes, B: Lanes<Token = A::Token>> Lanes for Both<A, B> {
    const COUNT: usize = A::COUNT + B::COUNT;

    #[inline(always)]
    fn load(token: Self::Token, values: &[f64]) -> Self {
        // The second half repeats the last number too when the first takes all.
        let second =
            values.get(A::COUNT..).filter(|rest| !rest.is_empty()).unwrap_or(&values[values.len().max(1) - 1..]);
        Self(A::load(token, values), B::load(token, second))
    }

    #[inline(always)]
    fn store(self, values: &mut [f64]) {
        let (first, second) = values.split_at_mut(values.len().min(A::COUNT));
        self.0.store(first);
        self.1.store(second);
    }
}

impl<A: Lane, B: Lane> Neg for Both<A, B> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

/// The most registers side by side: 40 numbers in five registers of eight. More would not stay in the processor.
const REGISTERS_MAX: usize = 5;

/// The most numbers that one lane holds on any instruction set.
pub const NUMBERS_MAX: usize = 8 * REGISTERS_MAX;

/// Two registers side by side.
type Two<S> = Both<Register<S>, Register<S>>;

/// Something that is done with many numbers in lock-step.
pub trait LaneWork {
    /// Does it with the numbers of these places, at most as many as a lane holds.
    fn run<L: Lanes>(&mut self, token: L::Token, places: Range<usize>);
}

/// Does a work with `count` numbers, as many at once as fill the registers side by side: that hides latencies, and more registers than
/// the numbers fill would be wasted.
#[inline(always)]
pub fn in_registers<S: Simd>(simd: S, count: usize, work: &mut impl LaneWork) {
    let mut from = 0;
    while from < count {
        let registers = (count - from).div_ceil(S::F64_LANES).min(REGISTERS_MAX);
        let places = from..(from + registers * S::F64_LANES).min(count);
        from = places.end;
        match registers {
            1 => work.run::<Register<S>>(simd, places),
            2 => work.run::<Two<S>>(simd, places),
            3 => work.run::<Both<Register<S>, Two<S>>>(simd, places),
            4 => work.run::<Both<Two<S>, Two<S>>>(simd, places),
            _ => work.run::<Both<Register<S>, Both<Two<S>, Two<S>>>>(simd, places),
        }
    }
}

/// Four numbers in lock-step, whatever the instruction set: side by side in one register, or as pairs of plain numbers.
pub trait Four: Lane {
    /// The four numbers as a lane.
    fn of(token: Self::Token, numbers: [f64; 4]) -> Self;

    /// The lane's numbers.
    fn numbers(self) -> [f64; 4];
}

/// Four plain numbers.
pub type Plain = Both<Both<f64, f64>, Both<f64, f64>>;

impl Four for Plain {
    #[inline(always)]
    fn of((): (), [a, b, c, d]: [f64; 4]) -> Self {
        Self(Both(a, b), Both(c, d))
    }

    #[inline(always)]
    fn numbers(self) -> [f64; 4] {
        [self.0.0, self.0.1, self.1.0, self.1.1]
    }
}

#[cfg(target_arch = "x86_64")]
impl Four for Register<pulp::x86::V3> {
    #[inline(always)]
    fn of(simd: pulp::x86::V3, [a, b, c, d]: [f64; 4]) -> Self {
        Self { simd, values: pulp::f64x4(a, b, c, d) }
    }

    #[inline(always)]
    fn numbers(self) -> [f64; 4] {
        let pulp::f64x4(a, b, c, d) = self.values;
        [a, b, c, d]
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $instruction:ident) => {
        impl<S: Simd> $operator for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { values: self.simd.$instruction(self.values, other.values), ..self }
            }
        }

        impl<S: Simd> $operator<f64> for Register<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self { values: self.simd.$instruction(self.values, self.simd.splat_f64s(other)), ..self }
            }
        }

        impl<A: Lane, B: Lane> $operator for Both<A, B> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }

        impl<A: Lane, B: Lane> $operator<f64> for Both<A, B> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self(self.0.$method(other), self.1.$method(other))
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
        (-selected) + a.sqrt() + a.sign_times(b) * a.if_less(b, a.same(1.0), b.same(-1.0)) / 7.0 + 1.0 - 0.3
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
            type Three<S> = Both<Register<S>, Both<Register<S>, Register<S>>>;
            mixture(Three::load(simd, self.a), Three::load(simd, self.b)).store(self.out);
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
