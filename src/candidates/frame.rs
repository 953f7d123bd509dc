//! The frame in which the candidate pass works: the scene moved to the origin and scaled to unit size.

use glam::DVec2;

use crate::scene::Model;

/// Takes the scene's coordinates into the square [-1, 1]^2, where f32 serves best.
///
/// The scale is a power of two, so only the subtraction of the centre rounds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    centre: DVec2,
    scale: f64,
}

impl Frame {
    /// The frame of all vertices and the anchor.
    pub fn new(model: &Model) -> Self {
        let (low, high) = model.bounds();
        // Halved first: the sum and the difference of the largest coordinates stay finite.
        let centre = low / 2.0 + high / 2.0;
        let half = (high - centre).abs().max((low - centre).abs()).max_element();
        // The power of two above `half`, so that half * scale < 1. Bounded, so that a trace 2^500 away from a tiny
        // scene is still at a finite place.
        let exponent = if half > 0.0 { (half.log2().floor() as i32 + 1).max(-500) } else { 0 };
        Frame { centre, scale: 2f64.powi(-exponent) }
    }

    /// Where `p` lies in the frame: for vertices and the anchor in [-1, 1]^2, for other points anywhere.
    #[inline]
    pub fn place(&self, p: DVec2) -> DVec2 {
        (p - self.centre) * self.scale
    }

    /// The way from `o` to `p` in the frame's unit: their difference is rounded once, then scaled exactly.
    #[inline]
    pub fn way(&self, o: DVec2, p: DVec2) -> DVec2 {
        (p - o) * self.scale
    }

    /// A length in the frame's unit.
    #[inline]
    pub fn scaled(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// The length in the scene's unit of one in the frame's.
    #[inline]
    pub fn unscaled(&self, length: f64) -> f64 {
        length / self.scale
    }
}
