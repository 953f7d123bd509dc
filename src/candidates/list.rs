//! A list of vertices to be tried.

use glam::DVec2;

use super::simd::{Simd, VERTICES};
use super::{Frame, Query};
use crate::scene::Model;

/// The vertices that one pivot's queries try, the nearest first: their numbers, and their coordinates in the frame.
#[derive(Debug)]
pub struct List {
    pub(super) numbers: Box<[u32]>,
    /// The squares of their distances from the pivot, in the scene's unit; 0 where the list is for any pivot.
    squared: Box<[f64]>,
    /// Coordinates in the frame, filled up with NaN, which lies in no triangle, to a multiple of what is tried at once.
    pub(super) x: Box<[f32]>,
    pub(super) y: Box<[f32]>,
}

impl List {
    /// The vertices of these numbers, for queries about `pivot`. O(vertices log vertices).
    pub fn about(model: &Model, frame: &Frame, pivot: DVec2, numbers: &[u32]) -> Self {
        let squared = |&v: &u32| (model.vertices()[v as usize].distance_squared(pivot), v);
        let mut near: Vec<(f64, u32)> = numbers.iter().map(squared).collect();
        near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Self::new(model, frame, near)
    }

    /// All vertices of the model, for queries about any pivot.
    pub fn all(model: &Model, frame: &Frame) -> Self {
        Self::new(model, frame, (0..model.vertices().len() as u32).map(|v| (0.0, v)).collect())
    }

    fn new(model: &Model, frame: &Frame, vertices: Vec<(f64, u32)>) -> Self {
        let size = vertices.len().next_multiple_of(VERTICES);
        let (mut x, mut y) = (Vec::with_capacity(size), Vec::with_capacity(size));
        for &(_, v) in &vertices {
            let p = frame.place(model.vertices()[v as usize]).as_vec2();
            x.push(p.x);
            y.push(p.y);
        }
        x.resize(size, f32::NAN);
        y.resize(size, f32::NAN);
        let (squared, numbers): (Vec<f64>, Vec<u32>) = vertices.into_iter().unzip();
        List { numbers: numbers.into(), squared: squared.into(), x: x.into(), y: y.into() }
    }

    /// How many vertices, from the first on, a query must try whose points are all no further from the pivot than the
    /// square root of `squared`, in the scene's unit. O(log vertices).
    #[inline]
    pub fn within(&self, squared: f64) -> usize {
        // Both are rounded: to 4 units in the last place each.
        let squared = squared * (1.0 + 16.0 * f64::EPSILON);
        self.squared.partition_point(|&s| s <= squared)
    }

    /// The numbers of the vertices.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Their coordinates in the frame, one after the other.
    pub fn coordinates(&self) -> impl Iterator<Item = [f32; 2]> {
        self.x.iter().zip(&self.y).take(self.numbers.len()).map(|(&x, &y)| [x, y])
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&*self.numbers)
            + size_of_val(&*self.squared)
            + size_of_val(&*self.x)
            + size_of_val(&*self.y)
    }

    /// Adds the numbers of the vertices inside the triangle of `query`, of the first `count` or a few more, to `found`. The
    /// twin of `shaders/sweep.wgsl`.
    #[inline]
    pub fn sweep(&self, simd: Simd, query: &Query, count: usize, found: &mut Vec<u32>) {
        simd.sweep(self, query, count, found);
    }
}
