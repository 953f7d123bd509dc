//! The candidate pass: which vertices can the rope's last leg meet while it sweeps a triangle?
//!
//! A pass is conservative: it may name a vertex too many, never one too few. It works in f32; the exact update then
//! decides among the few vertices that it names.

mod cpu;
mod frame;
mod query;

use bytemuck::{Pod, Zeroable};

use crate::scene::Model;

pub use cpu::CpuPass;
pub use frame::Frame;
pub use query::{Query, Swept, swept};

/// How many vertices a query can name before it overflows.
///
/// Windows adapt so that most queries name none to four; 15 and the count fill one cache line of 64 bytes.
pub const ROOM: usize = 15;

/// What a query found; the shader's `Found`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Found {
    /// How many vertices lie inside, named or not.
    pub count: u32,
    /// The numbers of the first [`ROOM`] of them.
    pub vertices: [u32; ROOM],
}

impl Found {
    /// The vertices inside, or `None` if there were more than a query has room for.
    pub fn candidates(&self) -> Option<&[u32]> {
        self.vertices.get(..self.count as usize)
    }
}

/// Something that runs queries over all vertices of one scene.
pub trait CandidatePass {
    /// What can go wrong.
    type Error;

    /// The model whose vertices it tries.
    fn model(&self) -> &Model;

    /// The frame in which its queries are.
    fn frame(&self) -> &Frame;

    /// How many queries one run can take.
    fn capacity(&self) -> usize;

    /// Runs all `queries`, at most [`capacity`](Self::capacity) of them, and writes what each found into `found`, which
    /// is as long.
    ///
    /// # Errors
    ///
    /// Whatever can go wrong with the pass's device.
    fn run(&mut self, queries: &[Query], found: &mut [Found]) -> Result<(), Self::Error>;
}
