//! The loops that must run at the full width of the processor, compiled for several instruction sets.
//!
//! Which of them the processor has is found out at run time (crate `pulp`), so that a binary built for any machine of its
//! architecture is fast. The loops are written in blocks that the compiler turns into vector instructions; nothing but
//! speed depends on that: they compute the same numbers with any instruction set, since Rust fuses no products and sums
//! by itself. `tests/vectors.sh` looks into the binary for the instructions.

use glam::DVec2;
use pulp::{Arch, WithSimd};

use super::{List, Query, Slopes};

/// How many points the loops over points take at once.
pub const BLOCK: usize = 8;

/// How many vertices the loops over vertices take at once.
pub(super) const VERTICES: usize = 32;

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
    /// Writes the slopes and squared distances of `points` from entry 1 of `slopes` on, and returns how many of them, from
    /// the first, lie before the pivot with a slope of at most `steepest`.
    slopes as SlopesOp(o: DVec2, axis: DVec2, steepest: f64, points: &'a [DVec2], slopes: &'a mut Slopes) -> usize
        = fill_slopes
}

wide! {
    /// The least and the greatest of `values`, which are not empty.
    extent as ExtentOp(values: &'a [f64]) -> (f64, f64) = least_and_greatest
}

wide! {
    /// The greatest of `values`, which are not empty.
    greatest as GreatestOp(values: &'a [f64]) -> f64 = greatest_of
}

wide! {
    /// How many of `values`, from the first on, are greater than `bound`.
    above as AboveOp(values: &'a [f64], bound: f64) -> usize = run_above
}

wide! {
    /// How many of `values`, from the first on, are less than `bound`.
    below as BelowOp(values: &'a [f64], bound: f64) -> usize = run_below
}

wide! {
    /// Adds the numbers of all vertices of `list` inside the triangle of `query` to `found`.
    sweep as SweepOp(list: &'a List, query: &'a Query, found: &'a mut Vec<u32>) -> () = sweep_list
}

#[inline(always)]
fn fill_slopes(o: DVec2, axis: DVec2, steepest: f64, points: &[DVec2], slopes: &mut Slopes) -> usize {
    let (slope, squared) = (&mut slopes.slope[1..], &mut slopes.squared[1..]);
    let (slope, _) = slope.as_chunks_mut::<BLOCK>();
    let (squared, _) = squared.as_chunks_mut::<BLOCK>();
    let (blocks, rest) = points.as_chunks::<BLOCK>();
    for (i, block) in blocks.iter().enumerate() {
        let good = slope_block(o, axis, steepest, block, &mut slope[i], &mut squared[i]);
        if good < BLOCK {
            return i * BLOCK + good;
        }
    }
    let done = blocks.len();
    let Some(&last) = rest.last() else { return done * BLOCK };
    let mut block = [last; BLOCK];
    block[..rest.len()].copy_from_slice(rest);
    let good = slope_block(o, axis, steepest, &block, &mut slope[done], &mut squared[done]);
    done * BLOCK + good.min(rest.len())
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
fn least_and_greatest(values: &[f64]) -> (f64, f64) {
    let (mut low, mut high) = ([values[0]; BLOCK], [values[0]; BLOCK]);
    let (blocks, rest) = values.as_chunks::<BLOCK>();
    for block in blocks {
        for i in 0..BLOCK {
            (low[i], high[i]) = (lesser(low[i], block[i]), greater(high[i], block[i]));
        }
    }
    let (low, high) = (low.into_iter().fold(low[0], lesser), high.into_iter().fold(high[0], greater));
    rest.iter().fold((low, high), |(low, high), &v| (lesser(low, v), greater(high, v)))
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
fn run_above(values: &[f64], bound: f64) -> usize {
    run(values, |v| v > bound)
}

#[inline(always)]
fn run_below(values: &[f64], bound: f64) -> usize {
    run(values, |v| v < bound)
}

#[inline(always)]
fn run(values: &[f64], holds: impl Fn(f64) -> bool) -> usize {
    let (blocks, rest) = values.as_chunks::<BLOCK>();
    for (i, block) in blocks.iter().enumerate() {
        let mut failed = [0u64; BLOCK];
        for (j, &value) in block.iter().enumerate() {
            failed[j] = u64::from(!holds(value)) << j;
        }
        let failed = failed.into_iter().fold(0, |all, one| all | one);
        if failed != 0 {
            return i * BLOCK + failed.trailing_zeros() as usize;
        }
    }
    blocks.len() * BLOCK + rest.iter().take_while(|&&value| holds(value)).count()
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
