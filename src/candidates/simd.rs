//! The loops that must run at the full width of the processor, compiled for several instruction sets.
//!
//! Which of them the processor has is found out at run time (crate `pulp`), so that a binary built for any machine of its
//! architecture is fast. The loops are written in blocks that the compiler turns into vector instructions; nothing but
//! speed depends on that: they compute the same numbers with any instruction set, since Rust fuses no products and sums
//! by itself. `tests/vectors.sh` looks into the binary for the instructions.

use glam::DVec2;
use pulp::{Arch, WithSimd};

use super::window::Wrapping;
use super::{List, Query, Slopes};

/// How many points the loops over points take at once.
pub(super) const BLOCK: usize = 8;

/// How many points fit into the bits of a mask.
const MASK: usize = 64;

/// How many legs a mask holds: those between its points.
pub const LEGS: usize = MASK - 1;

/// How many vertices the loops over vertices take at once.
pub(super) const VERTICES: usize = 16;

/// The instruction set to use.
#[derive(Debug, Clone, Copy)]
pub struct Simd {
    arch: Arch,
}

impl Simd {
    /// The widest that this processor has.
    pub fn detected() -> Self {
        Simd { arch: Arch::new() }
    }

    /// What every processor of this architecture has.
    pub fn baseline() -> Self {
        Simd { arch: Arch::Scalar }
    }
}

/// Makes a method of [`Simd`] out of a function that must be inlined into it: the function is compiled once for each
/// instruction set. (A closure will not do: it is a function of its own, for the baseline.)
macro_rules! wide {
    ($(#[$doc:meta])* $name:ident as $op:ident($($arg:ident: $ty:ty),*) -> $out:ty = $body:ident) => {
        struct $op<'a> {
            $($arg: $ty,)*
            of: std::marker::PhantomData<&'a ()>,
        }

        impl<'a> WithSimd for $op<'a> {
            type Output = $out;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) -> $out {
                $body($(self.$arg),*)
            }
        }

        impl Simd {
            $(#[$doc])*
            #[inline]
            pub(crate) fn $name<'a>(self, $($arg: $ty),*) -> $out {
                self.arch.dispatch($op { $($arg,)* of: std::marker::PhantomData })
            }
        }
    };
}

wide! {
    /// Writes the slopes and squared distances of `points` from entry 1 of `slopes` on, as long as they lie before the pivot
    /// with a slope of at most `steepest`; entry 0 is there. Returns how many they are and the extent of all from entry 0 on.
    fold as FoldOp(o: DVec2, axis: DVec2, steepest: f64, points: &'a [DVec2], slopes: &'a mut Slopes) -> (usize, Extent)
        = fold_points
}

wide! {
    /// The greatest of `values`, which are not empty.
    greatest as GreatestOp(values: &'a [f64]) -> f64 = greatest_of
}

wide! {
    /// For each line the legs, of the `legs` from `leg` on but at most [`LEGS`], on which something can happen: as bits,
    /// lowest first. Bits of further legs mean nothing.
    meet as MeetOp(lines: &'a mut [Wrapping], slopes: &'a Slopes, leg: usize, legs: usize) -> () = meet_lines
}

wide! {
    /// Adds the numbers of all vertices of `list` inside the triangle of `query` to `found`.
    sweep as SweepOp(list: &'a List, query: &'a Query, found: &'a mut Vec<u32>) -> () = sweep_list
}

/// The least and the greatest slope and the greatest squared distance of some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    pub low: f64,
    pub high: f64,
    pub squared: f64,
}

#[inline(always)]
fn fold_points(o: DVec2, axis: DVec2, steepest: f64, points: &[DVec2], slopes: &mut Slopes) -> (usize, Extent) {
    let (mut low, mut high) = ([slopes.slope[0]; BLOCK], [slopes.slope[0]; BLOCK]);
    let mut far = [slopes.squared[0]; BLOCK];
    let (slope, _) = slopes.slope[1..].as_chunks_mut::<BLOCK>();
    let (squared, _) = slopes.squared[1..].as_chunks_mut::<BLOCK>();
    let mut legs = 0;
    for (i, points) in points.chunks(BLOCK).enumerate() {
        let (slope, squared) = (&mut slope[i], &mut squared[i]);
        let mut block = [points[points.len() - 1]; BLOCK];
        block[..points.len()].copy_from_slice(points);
        let good = slope_block(o, axis, steepest, &block, slope, squared).min(points.len());
        legs += good;
        if good < BLOCK {
            // A last good point takes the places of those that are not.
            for j in 0..good {
                (low[j], high[j]) = (lesser(low[j], slope[j]), greater(high[j], slope[j]));
                far[j] = greater(far[j], squared[j]);
            }
            break;
        }
        for j in 0..BLOCK {
            (low[j], high[j]) = (lesser(low[j], slope[j]), greater(high[j], slope[j]));
            far[j] = greater(far[j], squared[j]);
        }
    }
    let low = low.into_iter().fold(low[0], lesser);
    let high = high.into_iter().fold(high[0], greater);
    (legs, Extent { low, high, squared: far.into_iter().fold(far[0], greater) })
}

/// One block of points: how many of them, from the first, are good.
#[inline(always)]
fn slope_block(
    o: DVec2,
    axis: DVec2,
    steepest: f64,
    points: &[DVec2; BLOCK],
    slope: &mut [f64; BLOCK],
    squared: &mut [f64; BLOCK],
) -> usize {
    let mut bad = [0u64; BLOCK];
    for i in 0..BLOCK {
        let (x, y) = (points[i].x - o.x, points[i].y - o.y);
        let (along, across) = (axis.x * x + axis.y * y, axis.x * y - axis.y * x);
        slope[i] = across / along;
        squared[i] = x * x + y * y;
        bad[i] = u64::from(!((along > 0.0) & (across.abs() <= steepest * along))) << i;
    }
    let bad = bad.into_iter().fold(0, |all, one| all | one);
    (bad.trailing_zeros() as usize).min(BLOCK)
}

#[inline(always)]
fn greatest_of(values: &[f64]) -> f64 {
    let mut high = [values[0]; BLOCK];
    let (blocks, rest) = values.as_chunks::<BLOCK>();
    for block in blocks {
        for i in 0..BLOCK {
            high[i] = greater(high[i], block[i]);
        }
    }
    rest.iter().fold(high.into_iter().fold(high[0], greater), |high, &v| greater(high, v))
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[inline(always)]
fn meet_lines(lines: &mut [Wrapping], slopes: &Slopes, leg: usize, legs: usize) {
    let points = (legs + 1).min(MASK).next_multiple_of(BLOCK);
    let (slope, squared) = (&slopes.slope[leg..leg + points], &slopes.squared[leg..leg + points]);
    let ((slope, _), (squared, _)) = (slope.as_chunks::<BLOCK>(), squared.as_chunks::<BLOCK>());
    for Wrapping { line, met, .. } in lines {
        // Bit i: point i lies surely above the line, surely below it, surely nearer than what the line begins at.
        let (mut above, mut below, mut near) = (0u64, 0u64, 0u64);
        for (i, (slope, squared)) in slope.iter().zip(squared).enumerate() {
            let mut bits = [0u64; BLOCK];
            for j in 0..BLOCK {
                let at = |bit: bool, place: usize| u64::from(bit) << (place * BLOCK + j);
                bits[j] = at(slope[j] > line.high, 0) | at(slope[j] < line.low, 1) | at(squared[j] < line.beyond, 2);
            }
            let bits = bits.into_iter().fold(0, |all, one| all | one);
            let take = |place: usize| u64::from((bits >> (place * BLOCK)) as u8) << (i * BLOCK);
            (above, below, near) = (above | take(0), below | take(1), near | take(2));
        }
        // On a leg with both ends above, both below or both near, nothing happens.
        let quiet = |ends: u64| ends & (ends >> 1);
        *met = !(quiet(above) | quiet(below) | quiet(near));
    }
}

#[inline(always)]
fn sweep_list(list: &List, query: &Query, found: &mut Vec<u32>) {
    let (x, _) = list.x.as_chunks::<VERTICES>();
    let (y, _) = list.y.as_chunks::<VERTICES>();
    for (block, (x, y)) in x.iter().zip(y).enumerate() {
        let mut inside = inside_block(query, x, y);
        while inside != 0 {
            found.push(list.numbers[block * VERTICES + inside.trailing_zeros() as usize]);
            inside &= inside - 1;
        }
    }
}

/// One block of vertices: bit i is set if vertex i is inside.
#[inline(always)]
fn inside_block(query: &Query, x: &[f32; VERTICES], y: &[f32; VERTICES]) -> u32 {
    let mut inside = [0; VERTICES];
    for i in 0..VERTICES {
        let side = |h: &[f32; 3]| h[0] * x[i] + h[1] * y[i] + h[2];
        let hit = (side(&query.right) >= 0.0) & (side(&query.left) >= 0.0) & (side(&query.far) >= 0.0);
        inside[i] = u32::from(hit) << i;
    }
    inside.into_iter().fold(0, |all, one| all | one)
}
