//! A list of vertices to be tried.

use super::simd::{Simd, VERTICES};
use super::{Frame, Query};
use crate::scene::Model;

/// The vertices that one pivot's queries try: their numbers, and their coordinates in the frame.
#[derive(Debug)]
pub struct List {
    pub(super) numbers: Box<[u32]>,
    /// Coordinates in the frame, filled up with NaN, which lies in no triangle, to a multiple of what is tried at once.
    pub(super) x: Box<[f32]>,
    pub(super) y: Box<[f32]>,
}

impl List {
    /// The vertices of these numbers.
    pub fn new(model: &Model, frame: &Frame, numbers: &[u32]) -> Self {
        let size = numbers.len().next_multiple_of(VERTICES);
        let (mut x, mut y) = (Vec::with_capacity(size), Vec::with_capacity(size));
        for &v in numbers {
            let p = frame.place(model.vertices()[v as usize]).as_vec2();
            x.push(p.x);
            y.push(p.y);
        }
        x.resize(size, f32::NAN);
        y.resize(size, f32::NAN);
        List { numbers: numbers.into(), x: x.into(), y: y.into() }
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
        size_of::<Self>() + size_of_val(&*self.numbers) + size_of_val(&*self.x) + size_of_val(&*self.y)
    }

    /// Adds the numbers of all vertices inside the triangle of `query` to `found`. The twin of `shaders/sweep.wgsl`.
    #[inline]
    pub fn sweep(&self, simd: Simd, query: &Query, found: &mut Vec<u32>) {
        simd.sweep(self, query, found);
    }
}
