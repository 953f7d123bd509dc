//! The candidate pass: which vertices can the rope's last leg meet while it sweeps a triangle?
//!
//! A pass is conservative: it may name a vertex too many, never one too few. It works in f32; the exact update then
//! decides among the few vertices that it names.

mod blocks;
mod fan;
mod frame;
mod grid;
mod list;
mod lists;
mod numbers;
mod places;
mod query;
mod simd;
mod slopes;
mod window;

use bytemuck::{Pod, Zeroable};

pub use blocks::{BLOCK, BLOCKS, Blocks};
pub use fan::{Fan, NO_VERTEX, certain_turn};
pub use frame::Frame;
pub use grid::Grid;
pub use list::List;
pub use lists::{LISTS_BUDGET, Lists};
pub use numbers::{DevicePlace, ListKey, Rank};
pub use query::{ARITHMETIC, LONGEST_NORMAL, MARGIN, Query};
pub use simd::Simd;
pub use slopes::{LEGS, Line, Slopes, Wrapping};
pub use window::Window;

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
    /// The first [`ROOM`] of them.
    pub places: [DevicePlace; ROOM],
}

impl Found {
    /// The places of the vertices inside, or `None` if there were more than a query has room for.
    pub fn places(&self) -> Option<&[DevicePlace]> {
        self.places.get(..self.count as usize)
    }
}
