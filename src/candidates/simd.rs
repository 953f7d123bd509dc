//! The loops that must run at the full width of the processor, compiled for several instruction sets.
//!
//! Which of them the processor has is found out at run time (crate `pulp`), so that a binary built for any machine of
//! its architecture is fast. The loops are written in blocks that the compiler turns into vector instructions; nothing
//! but speed depends on that: they compute the same numbers with any instruction set, since Rust fuses no products and
//! sums by itself. `tests/vectors.sh` looks into the binary for the instructions.

use std::ops::Range;

use glam::DVec2;
use pulp::{Arch, WithSimd};

use super::places::{Places, VERTICES};
use super::slopes::{BLOCK, Extent, MASK, Slopes, Wrapping};
use super::{List, Query};

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

    /// The square of the greatest distance from the pivot of points `from` to `to` of a window.
    #[inline]
    pub fn farthest(self, slopes: &Slopes, from: usize, to: usize) -> f64 {
        self.greatest(&slopes.squared[from..=to])
    }

    /// Adds the numbers of the vertices of `list` inside the triangle of `query`, of the first `count` or a few more,
    /// to `found`.
    #[inline]
    pub fn sweep(self, list: &List, query: &Query, count: usize, found: &mut Vec<u32>) {
        self.sweep_some(list, query, 0..count, found);
    }
}

/// Makes a method of [`Simd`] out of a function that must be inlined into it: the function is compiled once for each
/// instruction set. (A closure will not do: it is a function of its own, for the baseline.)
macro_rules! wide {
    ($(#[$doc:meta])* $vis:vis $name:ident as $op:ident($($arg:ident: $ty:ty),*) -> $out:ty = $body:ident) => {
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
            $vis fn $name<'a>(self, $($arg: $ty),*) -> $out {
                self.arch.dispatch($op { $($arg,)* of: std::marker::PhantomData })
            }
        }
    };
}

wide! {
    /// Writes the slopes and squared distances of `points` from entry 1 of `slopes` on, as long as they lie before the
    /// pivot with a slope of at most `steepest`; entry 0 is there. Returns how many they are and the extent of all from
    /// entry 0 on.
    pub(super) fold as FoldOp(
        o: DVec2, axis: DVec2, steepest: f64, points: &'a [DVec2], slopes: &'a mut Slopes
    ) -> (usize, Extent) = fold_points
}

wide! {
    /// The greatest of `values`, which are not empty.
    greatest as GreatestOp(values: &'a [f64]) -> f64 = greatest_of
}

wide! {
    /// Finds for each line the legs, of the `legs` from `leg` on but at most [`LEGS`](super::LEGS), on which something
    /// can happen: all but those of which it is certain that both ends lie strictly on one side of the line, or that
    /// both are nearer than its vertex. On a first leg that starts on its way, the part before is left out. Bits of
    /// further legs mean nothing.
    pub meet as MeetOp(lines: &'a mut [Wrapping], slopes: &'a Slopes, leg: usize, legs: usize) -> () = meet_lines
}

wide! {
    /// Adds the numbers of the vertices of `list` inside the triangle of `query`, of those with `ranks` or of a few
    /// more, to `found`. Ranks beyond the list have no vertices. The twin of `shaders/sweep.wgsl` and
    /// `shaders/rays.wgsl`.
    pub sweep_some as SweepOp(
        list: &'a List, query: &'a Query, ranks: Range<usize>, found: &'a mut Vec<u32>
    ) -> () = sweep_list
}

#[inline(always)]
fn fold_points(o: DVec2, axis: DVec2, steepest: f64, points: &[DVec2], slopes: &mut Slopes) -> (usize, Extent) {
    let (start, far) = (slopes.slope[0], slopes.squared[0]);
    let mut lanes =
        Lanes { o, axis, steepest, low: [start; BLOCK], high: [start; BLOCK], far: [far; BLOCK], worst: [1.0; BLOCK] };
    let (slope, _) = slopes.slope[1..].as_chunks_mut::<BLOCK>();
    let (squared, _) = slopes.squared[1..].as_chunks_mut::<BLOCK>();
    let (blocks, rest) = points.as_chunks::<BLOCK>();
    for ((block, slope), squared) in blocks.iter().zip(slope.iter_mut()).zip(squared.iter_mut()) {
        lanes.take(block, slope, squared);
    }
    if let Some(&last) = rest.last() {
        let block = [0, 1, 2, 3].map(|j| if j < rest.len() { rest[j] } else { last });
        lanes.take(&block, &mut slope[blocks.len()], &mut squared[blocks.len()]);
    }
    if all(lanes.worst, lesser) > 0.0 {
        let (low, high) = (all(lanes.low, lesser), all(lanes.high, greater));
        return (points.len(), Extent { low, high, squared: all(lanes.far, greater) });
    }
    let is_good = |p: &&DVec2| {
        let way = **p - o;
        steepest * axis.dot(way) - axis.perp_dot(way).abs() > 0.0
    };
    let legs = points.iter().take_while(is_good).count();
    let (slope, squared) = (&slopes.slope[..=legs], &slopes.squared[..=legs]);
    let low = slope.iter().copied().fold(slope[0], lesser);
    let high = slope.iter().copied().fold(slope[0], greater);
    (legs, Extent { low, high, squared: greatest_of(squared) })
}

/// What [`fold_points`] knows of the points that it has taken, lane by lane.
struct Lanes {
    o: DVec2,
    axis: DVec2,
    steepest: f64,
    low: [f64; BLOCK],
    high: [f64; BLOCK],
    far: [f64; BLOCK],
    /// Above 0 as long as all points lie before the pivot and none is too steep.
    worst: [f64; BLOCK],
}

impl Lanes {
    #[inline(always)]
    fn take(&mut self, points: &[DVec2; BLOCK], slope: &mut [f64; BLOCK], squared: &mut [f64; BLOCK]) {
        for j in 0..BLOCK {
            let (x, y) = (points[j].x - self.o.x, points[j].y - self.o.y);
            let (along, across) = (self.axis.x * x + self.axis.y * y, self.axis.x * y - self.axis.y * x);
            (slope[j], squared[j]) = (across / along, x * x + y * y);
            self.worst[j] = lesser(self.worst[j], self.steepest * along - across.abs());
            self.low[j] = lesser(self.low[j], slope[j]);
            self.high[j] = greater(self.high[j], slope[j]);
            self.far[j] = greater(self.far[j], squared[j]);
        }
    }
}

#[inline(always)]
fn greatest_of(values: &[f64]) -> f64 {
    let mut high = [values[0]; BLOCK];
    let (blocks, rest) = values.as_chunks::<BLOCK>();
    for block in blocks {
        for j in 0..BLOCK {
            high[j] = greater(high[j], block[j]);
        }
    }
    rest.iter().fold(all(high, greater), |high, &v| greater(high, v))
}

#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

#[inline(always)]
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// All lanes taken together.
#[inline(always)]
fn all<T: Copy, const N: usize>(lanes: [T; N], both: impl Fn(T, T) -> T) -> T {
    lanes.into_iter().reduce(both).expect("there are lanes")
}

#[inline(always)]
fn meet_lines(lines: &mut [Wrapping], slopes: &Slopes, leg: usize, legs: usize) {
    let points = (legs + 1).min(MASK).next_multiple_of(BLOCK);
    let (slope, squared) = (&slopes.slope[leg..leg + points], &slopes.squared[leg..leg + points]);
    let ((slope, _), (squared, _)) = (slope.as_chunks::<BLOCK>(), squared.as_chunks::<BLOCK>());
    for Wrapping { line, met, .. } in lines {
        // Bit i: point i lies surely above the line, surely below it, surely nearer than what the line begins at. Each
        // lane has the bits of its own points, so that they are put together once only.
        let (mut above, mut below, mut near) = ([0u64; BLOCK], [0u64; BLOCK], [0u64; BLOCK]);
        let mut bit: [u64; BLOCK] = std::array::from_fn(|j| 1 << j);
        for (slope, squared) in slope.iter().zip(squared) {
            for j in 0..BLOCK {
                above[j] |= bit_if(slope[j] > line.high, bit[j]);
                below[j] |= bit_if(slope[j] < line.low, bit[j]);
                near[j] |= bit_if(squared[j] < line.beyond, bit[j]);
                bit[j] <<= BLOCK;
            }
        }
        // On a leg with both ends above, both below or both near, nothing happens.
        let quiet = |ends: [u64; BLOCK]| {
            let ends = all(ends, |a, b| a | b);
            ends & (ends >> 1)
        };
        *met = !(quiet(above) | quiet(below) | quiet(near));
    }
}

#[inline(always)]
fn bit_if(condition: bool, bit: u64) -> u64 {
    u64::from(condition).wrapping_neg() & bit
}

#[inline(always)]
fn sweep_list(list: &List, query: &Query, ranks: Range<usize>, found: &mut Vec<u32>) {
    let (first, end) = (ranks.start / VERTICES, ranks.end.div_ceil(VERTICES));
    for places in list.places.iter().take(end).skip(first) {
        let mut inside = inside_block(query, places);
        while inside != 0 {
            found.push(places.numbers[inside.trailing_zeros() as usize % VERTICES]);
            inside &= inside - 1;
        }
    }
}

/// One block of vertices: bit i is set if vertex i is inside.
#[inline(always)]
fn inside_block(query: &Query, Places { x, y, .. }: &Places) -> u32 {
    const LANES: usize = 2 * BLOCK;
    let (mut inside, mut bit): (_, [u32; LANES]) = ([0; LANES], std::array::from_fn(|j| 1 << j));
    for i in (0..VERTICES).step_by(LANES) {
        for j in 0..LANES {
            let side = |h: &[f32; 3]| h[0] * x[i + j] + h[1] * y[i + j] + h[2];
            let hit = (side(&query.right) >= 0.0) & (side(&query.left) >= 0.0) & (side(&query.far) >= 0.0);
            inside[j] |= u32::from(hit).wrapping_neg() & bit[j];
            bit[j] <<= LANES;
        }
    }
    all(inside, |a, b| a | b)
}
