//! The candidate pass on the CPU: the twin of `shaders/sweep.wgsl`, on threads.

use std::convert::Infallible;

use rayon::prelude::*;

use super::{CandidatePass, Found, Frame, Query};
use crate::scene::Model;

/// How many vertices are tried before the hits among them are looked for: the inner loop then has no branch.
const LANES: usize = 64;

/// Runs queries on all cores, in f32.
pub struct CpuPass<'m> {
    model: &'m Model,
    frame: Frame,
    /// The vertices' coordinates in the frame.
    x: Vec<f32>,
    y: Vec<f32>,
    capacity: usize,
}

impl<'m> CpuPass<'m> {
    /// A pass over the model's vertices that takes `capacity` queries at once, at least 1.
    pub fn new(model: &'m Model, capacity: usize) -> Self {
        let frame = Frame::new(model);
        let (x, y) = frame.vertices(model).into_iter().map(|p| (p.x, p.y)).unzip();
        CpuPass { model, frame, x, y, capacity: capacity.max(1) }
    }

    fn sweep(&self, query: &Query) -> Found {
        let mut found = Found::default();
        for (first, (x, y)) in (0u32..).step_by(LANES).zip(self.x.chunks(LANES).zip(self.y.chunks(LANES))) {
            let mut inside = [false; LANES];
            let mut any = false;
            for ((hit, &x), &y) in inside.iter_mut().zip(x).zip(y) {
                *hit = is_inside(query, x, y);
                any |= *hit;
            }
            if any {
                for vertex in (first..).zip(inside).filter(|&(_, hit)| hit).map(|(v, _)| v) {
                    if let Some(room) = found.vertices.get_mut(found.count as usize) {
                        *room = vertex;
                    }
                    found.count += 1;
                }
            }
        }
        found
    }
}

#[inline(always)]
fn is_inside(query: &Query, x: f32, y: f32) -> bool {
    let side = |h: &[f32; 4]| h[0] * x + h[1] * y + h[2];
    (side(&query.right) >= 0.0) & (side(&query.left) >= 0.0) & (side(&query.far) >= 0.0)
}

impl CandidatePass for CpuPass<'_> {
    type Error = Infallible;

    fn model(&self) -> &Model {
        self.model
    }

    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn capacity(&self) -> usize {
        self.capacity
    }

    fn run(&mut self, queries: &[Query], found: &mut [Found]) -> Result<(), Infallible> {
        let this = &*self;
        queries.par_iter().zip(found).with_min_len(16).for_each(|(query, found)| *found = this.sweep(query));
        Ok(())
    }
}
