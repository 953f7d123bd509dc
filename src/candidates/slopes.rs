//! Windows in numbers, as the loops over points and lines take them.

/// How many points the loops over points take at once: what fits into a vector of AVX2.
pub(super) const BLOCK: usize = 4;

/// How many points fit into the bits of a mask.
pub(super) const MASK: usize = 64;

/// How many legs a mask holds: those between its points.
pub const LEGS: usize = MASK - 1;

/// The slopes of a window's points and the squares of their distances from the pivot, in the scene's unit; entry i is
/// point i of the window. Kept from window to window for its memory.
#[derive(Debug, Default)]
pub struct Slopes {
    pub(super) slope: Vec<f64>,
    pub(super) squared: Vec<f64>,
}

/// The least and the greatest slope and the greatest squared distance of some points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extent {
    pub low: f64,
    pub high: f64,
    pub squared: f64,
}

/// A line through the pivot that the free end must cross for something to happen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Between which bounds its slope surely lies.
    pub(super) low: f64,
    pub(super) high: f64,
    /// Nothing happens on legs whose ends are both nearer to the pivot, squared.
    pub(super) beyond: f64,
}

/// A line and the legs on which something can happen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrapping {
    /// The vertex round which the rope can be wrapped; means nothing for the unwrapping ray.
    pub vertex: u32,
    /// The line that the free end must cross.
    pub line: Line,
    /// The legs, of the [`LEGS`] from some leg on, on which something can happen, as bits, lowest first.
    pub met: u64,
}

impl Wrapping {
    /// A line of which it is not known yet where it can be met.
    #[inline]
    pub fn new(vertex: u32, line: Line) -> Self {
        Wrapping { vertex, line, met: 0 }
    }
}
