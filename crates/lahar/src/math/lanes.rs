//! Vector registers: sixteen `f32` or eight `f64`, on the instruction set that the token `S` stands
//! for. The widths are the same on all instruction sets, so that the order of operations, and with it
//! the result, does not depend on the machine.

use super::real::{Mask, Real, Register, Scalar};
use core::ops::{Add, Mul};
use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, f32x16, f64x4, f64x8, i32x16, mask32x16, mask64x8};

/// A scalar, with its vector register on each instruction set.
pub trait Lanes: Scalar {
    /// The register on the instruction set `S`.
    type Of<S: Simd>: Register<Scalar = Self>;
    /// The number of lanes of a register.
    const WIDTH: usize;
    /// Loads the first `WIDTH` numbers of `slice`.
    fn load<S: Simd>(simd: S, slice: &[Self]) -> Self::Of<S>;
    /// Stores a register to the first `WIDTH` numbers of `slice`.
    fn store<S: Simd>(value: Self::Of<S>, slice: &mut [Self]);
    /// Returns a register with `value` in every lane.
    fn broadcast<S: Simd>(simd: S, value: Self) -> Self::Of<S>;
    /// Stores `WIDTH` quads: `[a, b, c, d]` of lane 0, then of lane 1, ...
    fn store_quads<S: Simd>(quads: [Self::Of<S>; 4], slice: &mut [Self]);
    /// Loads what [`Lanes::store_quads`] stores.
    fn load_quads<S: Simd>(simd: S, slice: &[Self]) -> [Self::Of<S>; 4];

    /// Stores the whole parts of the numbers to the first `WIDTH` entries of `slice`; 0 for NaN.
    fn store_whole<S: Simd>(value: Self::Of<S>, slice: &mut [i32]);

    /// Four quads side by side: a row of four nodes of a stencil.
    type Row<S: Simd>: Row<S, Self>;

    /// Adds `part` to `sum`, number by number. The lengths are whole quads.
    fn add_quads<S: Simd>(simd: S, sum: &mut [Self], part: &[Self]);
    /// Copies `from` to `to`. The lengths are whole quads. It is for rows that are too short for a call
    /// of the system's copy to pay off.
    fn copy_quads<S: Simd>(simd: S, to: &mut [Self], from: &[Self]);
}

/// Four nodes of four numbers each, in the layout of a tile.
pub trait Row<S: Simd, T>: Copy + Add<Output = Self> + Mul<Output = Self> {
    /// Loads the first sixteen numbers of `slice`.
    fn load(simd: S, slice: &[T]) -> Self;
    /// Stores the row to the first sixteen numbers of `slice`.
    fn store(self, slice: &mut [T]);
    /// Returns a row with `value` everywhere.
    fn splat(simd: S, value: T) -> Self;
    /// Returns the quad at the start of `slice` for each of the four nodes.
    fn repeat(simd: S, slice: &[T]) -> Self;
    /// Returns the first four numbers of `slice`: number k in all of node k.
    fn spread(simd: S, slice: &[T]) -> Self;
    /// Returns `self * a + b`, fused on every instruction set but the portable one.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// Adds `weight * self` to the first `nodes` nodes of `slice`, one node at a time or, if `by_pairs`,
    /// two; fused on every instruction set but the portable one. Fewer of these accesses straddle two
    /// cache lines than accesses of a whole row would, and a node that was just written can be read
    /// again without waiting.
    fn add_scaled(self, simd: S, weight: T, slice: &mut [T], nodes: usize, by_pairs: bool);
    /// True if there are enough registers for the rows of four particles at once.
    const ROOM_FOR_FOUR: bool;
    /// Stores the sum over the four nodes to the first four numbers of `slice`.
    fn fold(self, slice: &mut [T]);
    /// Stores the sums of each of four rows to the first sixteen numbers of `slice`.
    fn fold_four(rows: [Self; 4], slice: &mut [T]);
}

/// Evaluates an expression for each number of a register.
macro_rules! each_number {
    ($register:expr, $x:ident => $of_number:expr) => {{
        let mut result = $register;
        for number in result.as_mut_slice() {
            let $x = *number;
            *number = $of_number;
        }
        result
    }};
}

macro_rules! lanes {
    ($scalar:ident, $vector:ident, $mask:ident, $width:literal, $row:ident, $quad:ident, $whole:path) => {
        impl<S: Simd> Mask for $mask<S> {
            #[inline(always)]
            fn any(self) -> bool {
                self.any_true()
            }
            #[inline(always)]
            fn all(self) -> bool {
                self.all_true()
            }
        }

        impl<S: Simd> Real for $vector<S> {
            type Mask = $mask<S>;
            const EPSILON: f64 = <$scalar as Real>::EPSILON;
            const LARGEST: f64 = <$scalar as Real>::LARGEST;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                SimdBase::splat(self.token(), value as $scalar)
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                SimdFloat::mul_add(self, a, b)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                SimdBase::max(self, other)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                SimdBase::min(self, other)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                SimdFloat::copysign(self, sign)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                Select::select(mask, if_true, if_false)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                each_number!(self, x => Real::exp(x))
            }
            #[inline(always)]
            fn ln(self) -> Self {
                each_number!(self, x => Real::ln(x))
            }
            #[inline(always)]
            fn power_by_number(self, exponent: f64) -> Self {
                each_number!(self, x => x.power_by_number(exponent))
            }
            #[inline(always)]
            fn ln_1p_by_number(self) -> Self {
                each_number!(self, x => x.ln_1p_by_number())
            }
            #[inline(always)]
            fn minus_ln_1p_by_number(self) -> Self {
                each_number!(self, x => x.minus_ln_1p_by_number())
            }
            #[inline(always)]
            fn power_minus_one_by_number(self, exponent: f64) -> Self {
                each_number!(self, x => x.power_minus_one_by_number(exponent))
            }
            #[inline(always)]
            fn minus_power_by_number(self, exponent: f64) -> Self {
                each_number!(self, x => x.minus_power_by_number(exponent))
            }
        }

        impl<S: Simd> Register for $vector<S> {
            type Scalar = $scalar;
            const LANES: usize = $width;
            #[inline(always)]
            fn splat(self, value: $scalar) -> Self {
                SimdBase::splat(self.token(), value)
            }
            #[inline(always)]
            fn lane(self, index: usize) -> $scalar {
                self.as_slice()[index]
            }
        }

        impl Lanes for $scalar {
            type Of<S: Simd> = $vector<S>;
            const WIDTH: usize = $width;
            #[inline(always)]
            fn load<S: Simd>(simd: S, slice: &[Self]) -> Self::Of<S> {
                $vector::from_slice(simd, &slice[..$width])
            }
            #[inline(always)]
            fn store<S: Simd>(value: Self::Of<S>, slice: &mut [Self]) {
                value.store_slice(&mut slice[..$width]);
            }
            #[inline(always)]
            fn broadcast<S: Simd>(simd: S, value: Self) -> Self::Of<S> {
                SimdBase::splat(simd, value)
            }
            #[inline(always)]
            fn store_quads<S: Simd>(quads: [Self::Of<S>; 4], slice: &mut [Self]) {
                let [a, b, c, d] = quads;
                let ((ac, ac_high), (bd, bd_high)) = (a.interleave(c), b.interleave(d));
                let ((q0, q1), (q2, q3)) = (ac.interleave(bd), ac_high.interleave(bd_high));
                for (k, q) in [q0, q1, q2, q3].into_iter().enumerate() {
                    q.store_slice(&mut slice[k * $width..][..$width]);
                }
            }
            #[inline(always)]
            fn load_quads<S: Simd>(simd: S, slice: &[Self]) -> [Self::Of<S>; 4] {
                let part = |k: usize| $vector::from_slice(simd, &slice[k * $width..][..$width]);
                let ((ac, bd), (ac_high, bd_high)) =
                    (part(0).deinterleave(part(1)), part(2).deinterleave(part(3)));
                let ((a, c), (b, d)) = (ac.deinterleave(ac_high), bd.deinterleave(bd_high));
                [a, b, c, d]
            }
            #[inline(always)]
            fn store_whole<S: Simd>(value: Self::Of<S>, slice: &mut [i32]) {
                $whole(value, slice);
            }
            type Row<S: Simd> = $row<S>;
            #[inline(always)]
            fn add_quads<S: Simd>(simd: S, sum: &mut [Self], part: &[Self]) {
                let (rows, quads) = sum.as_chunks_mut::<16>();
                let (row_parts, quad_parts) = part.as_chunks::<16>();
                for (sum, part) in rows.iter_mut().zip(row_parts) {
                    (Self::Row::load(simd, sum) + Self::Row::load(simd, part)).store(sum);
                }
                let quads = quads.as_chunks_mut::<4>().0.iter_mut();
                for (sum, part) in quads.zip(quad_parts.as_chunks::<4>().0) {
                    ($quad::from_slice(simd, sum) + $quad::from_slice(simd, part)).store_slice(sum);
                }
            }
            #[inline(always)]
            fn copy_quads<S: Simd>(simd: S, to: &mut [Self], from: &[Self]) {
                let (rows, quads) = to.as_chunks_mut::<16>();
                let (from_rows, from_quads) = from.as_chunks::<16>();
                for (to, from) in rows.iter_mut().zip(from_rows) {
                    Self::Row::load(simd, from).store(to);
                }
                let quads = quads.as_chunks_mut::<4>().0.iter_mut();
                for (to, from) in quads.zip(from_quads.as_chunks::<4>().0) {
                    $quad::from_slice(simd, from).store_slice(to);
                }
            }
        }
    };
}

#[inline(always)]
fn whole_f32<S: Simd>(value: f32x16<S>, slice: &mut [i32]) {
    i32x16::truncate_from_precise(value).store_slice(&mut slice[..16]);
}

/// Converts number by number: few instruction sets convert eight at a time.
#[inline(always)]
fn whole_f64<S: Simd>(value: f64x8<S>, slice: &mut [i32]) {
    for (whole, &x) in slice[..8].iter_mut().zip(value.as_slice()) {
        *whole = x as i32;
    }
}

lanes!(f32, f32x16, mask32x16, 16, f32x16, f32x4, whole_f32);
lanes!(f64, f64x8, mask64x8, 8, F64Row, f64x4, whole_f64);

impl<S: Simd> Row<S, f32> for f32x16<S> {
    #[inline(always)]
    fn load(simd: S, slice: &[f32]) -> Self {
        f32x16::from_slice(simd, &slice[..16])
    }
    #[inline(always)]
    fn store(self, slice: &mut [f32]) {
        self.store_slice(&mut slice[..16]);
    }
    #[inline(always)]
    fn splat(simd: S, value: f32) -> Self {
        SimdBase::splat(simd, value)
    }
    #[inline(always)]
    fn repeat(simd: S, slice: &[f32]) -> Self {
        f32x16::block_splat(f32x4::from_slice(simd, &slice[..4]))
    }
    #[inline(always)]
    fn spread(simd: S, slice: &[f32]) -> Self {
        // abcd abcd .. → aabb ccdd .. → aaaa bbbb cccc dddd
        let repeated = Self::repeat(simd, slice);
        let twice = repeated.zip_low(repeated);
        twice.zip_low(twice)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        SimdFloat::mul_add(self, a, b)
    }
    #[inline(always)]
    fn add_scaled(self, simd: S, weight: f32, slice: &mut [f32], nodes: usize, by_pairs: bool) {
        let (n01, n23) = self.split();
        let ((n0, n1), (n2, n3)) = (n01.split(), n23.split());
        if by_pairs && nodes >= 2 {
            add_pair(simd, weight, n01, slice);
        } else {
            add_node(simd, weight, n0, slice);
            if nodes >= 2 {
                add_node(simd, weight, n1, &mut slice[4..]);
            }
        }
        if by_pairs && nodes >= 4 {
            add_pair(simd, weight, n23, &mut slice[8..]);
            return;
        }
        if nodes >= 3 {
            add_node(simd, weight, n2, &mut slice[8..]);
        }
        if nodes >= 4 {
            add_node(simd, weight, n3, &mut slice[12..]);
        }
    }
    const ROOM_FOR_FOUR: bool = S::f32s::LEN >= 16;
    #[inline(always)]
    fn fold(self, slice: &mut [f32]) {
        let (low, high) = self.split();
        let (a, b) = (low + high).split();
        (a + b).store_slice(&mut slice[..4]);
    }
    #[inline(always)]
    fn fold_four([a, b, c, d]: [Self; 4], slice: &mut [f32]) {
        let ((ab_even, ab_odd), (cd_even, cd_odd)) = (even_odd(a, b), even_odd(c, d));
        (ab_even.combine(cd_even) + ab_odd.combine(cd_odd)).store_slice(&mut slice[..16]);
    }
}

/// Adds `weight * node` to the first four numbers of `slice`.
#[inline(always)]
fn add_node<S: Simd>(simd: S, weight: f32, node: f32x4<S>, slice: &mut [f32]) {
    let slice = &mut slice[..4];
    let sum = f32x4::from_slice(simd, slice);
    SimdFloat::mul_add(f32x4::splat(simd, weight), node, sum).store_slice(slice);
}

/// Adds `weight * pair` to the first eight numbers of `slice`.
#[inline(always)]
fn add_pair<S: Simd>(simd: S, weight: f32, pair: f32x8<S>, slice: &mut [f32]) {
    let slice = &mut slice[..8];
    let sum = f32x8::from_slice(simd, slice);
    SimdFloat::mul_add(f32x8::splat(simd, weight), pair, sum).store_slice(slice);
}

/// Returns the sums of nodes 0 and 2 of two rows, and those of nodes 1 and 3.
#[inline(always)]
fn even_odd<S: Simd>(a: f32x16<S>, b: f32x16<S>) -> (f32x8<S>, f32x8<S>) {
    let ((a_low, a_high), (b_low, b_high)) = (a.split(), b.split());
    let (a, b) = (a_low.combine(b_low) + a_high.combine(b_high)).split();
    let ((a_even, a_odd), (b_even, b_odd)) = (a.split(), b.split());
    (a_even.combine(b_even), a_odd.combine(b_odd))
}

/// A row in `f64`: nodes 0 and 1, then nodes 2 and 3.
#[derive(Clone, Copy, Debug)]
pub struct F64Row<S: Simd>(f64x8<S>, f64x8<S>);

impl<S: Simd> Add for F64Row<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl<S: Simd> Mul for F64Row<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }
}

impl<S: Simd> Row<S, f64> for F64Row<S> {
    #[inline(always)]
    fn load(simd: S, slice: &[f64]) -> Self {
        Self(
            f64x8::from_slice(simd, &slice[..8]),
            f64x8::from_slice(simd, &slice[8..16]),
        )
    }
    #[inline(always)]
    fn store(self, slice: &mut [f64]) {
        self.0.store_slice(&mut slice[..8]);
        self.1.store_slice(&mut slice[8..16]);
    }
    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        let half = SimdBase::splat(simd, value);
        Self(half, half)
    }
    #[inline(always)]
    fn repeat(simd: S, slice: &[f64]) -> Self {
        let quad = f64x4::from_slice(simd, &slice[..4]);
        let half = quad.combine(quad);
        Self(half, half)
    }
    #[inline(always)]
    fn spread(simd: S, slice: &[f64]) -> Self {
        let quad = f64x4::<S>::from_slice(simd, &slice[..4]);
        let [a, b, c, d] = [
            f64x4::<S>::splat(simd, quad[0]),
            f64x4::<S>::splat(simd, quad[1]),
            f64x4::<S>::splat(simd, quad[2]),
            f64x4::<S>::splat(simd, quad[3]),
        ];
        Self(a.combine(b), c.combine(d))
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(
            SimdFloat::mul_add(self.0, a.0, b.0),
            SimdFloat::mul_add(self.1, a.1, b.1),
        )
    }
    #[inline(always)]
    fn add_scaled(self, simd: S, weight: f64, slice: &mut [f64], nodes: usize, _by_pairs: bool) {
        let ((n0, n1), (n2, n3)) = (self.0.split(), self.1.split());
        let weight = f64x4::splat(simd, weight);
        let parts = [n0, n1, n2, n3].into_iter().take(nodes);
        for (part, slice) in parts.zip(slice.chunks_exact_mut(4)) {
            let sum = f64x4::from_slice(simd, slice);
            SimdFloat::mul_add(weight, part, sum).store_slice(slice);
        }
    }
    const ROOM_FOR_FOUR: bool = false;
    #[inline(always)]
    fn fold(self, slice: &mut [f64]) {
        let (a, b) = (self.0 + self.1).split();
        (a + b).store_slice(&mut slice[..4]);
    }
    #[inline(always)]
    fn fold_four(rows: [Self; 4], slice: &mut [f64]) {
        for (row, slice) in rows.into_iter().zip(slice.chunks_exact_mut(4)) {
            row.fold(slice);
        }
    }
}
