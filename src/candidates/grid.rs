//! Whole numbers for points, of which a device can take differences exactly.

use glam::DVec2;

use super::{Fan, Frame, NO_VERTEX};

/// How many units of the grid are one of the frame: 2^28.
const UNITS: f64 = (1u64 << 28) as f64;

/// How far the grid goes, in the frame's unit: differences of its points fit into an i32.
const REACH: f64 = 4.0;

/// How long the way along a ray without a vertex is, in units of the grid: 2^40, beyond all points.
const ENDLESS: f64 = (1u64 << 40) as f64;

/// The frame, divided into whole numbers.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    frame: Frame,
}

impl Grid {
    /// The grid of a frame.
    pub fn new(frame: Frame) -> Self {
        Grid { frame }
    }

    /// The point of the grid next to `p`; it means nothing where the grid does not [`hold`](Self::holds) `p`.
    #[inline]
    pub fn place(&self, p: DVec2) -> [i32; 2] {
        // 1.5 x 2^52, added, rounds to whole numbers, and leaves them in the low bits.
        const ROUND: f64 = (3u64 << 51) as f64;
        (self.frame.place(p) * UNITS + ROUND).to_array().map(|x| x.to_bits() as u32 as i32)
    }

    /// Whether the grid holds all points of the box from `low` to `high`.
    pub fn holds(&self, (low, high): (DVec2, DVec2)) -> bool {
        let is_held = |p: DVec2| self.frame.place(p).abs().max_element() <= REACH;
        is_held(low) && is_held(high)
    }

    /// A way in the scene's unit in units of the grid, rounded.
    #[inline]
    pub fn way(&self, way: DVec2) -> [f32; 2] {
        (self.frame.way(DVec2::ZERO, way) * UNITS).as_vec2().to_array()
    }

    /// Whether the grid tells all vertices of a fan from its pivot.
    #[inline]
    pub fn tells(&self, fan: &Fan) -> bool {
        self.frame.scaled(fan.nearest()) * UNITS >= 2.0
    }

    /// The ways of a fan that the grid [`tells`](Self::tells).
    pub fn fan(&self, fan: &Fan) -> Vec<[f32; 2]> {
        let way = |i: usize| match fan.vertex(i) {
            NO_VERTEX => (fan.way(i) * ENDLESS).as_vec2().to_array(),
            _ => self.way(fan.way(i)),
        };
        (0..fan.rays()).map(way).collect()
    }

    /// A length in the scene's unit that is no less than the true distance, from the square of a distance between
    /// points of the grid that a device computed.
    pub fn at_most(&self, squared: f32) -> f64 {
        // Each point is off by at most 0.71 units, the square by less than 2^-20 of it.
        let units = f64::from(squared).sqrt() * (1.0 + 1.0 / (1 << 19) as f64) + 1.5;
        self.frame.unscaled(units / UNITS)
    }
}
