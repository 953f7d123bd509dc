//! Random numbers that are the same on every machine.

use glam::DVec2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Uniform numbers. Streams of one seed are independent of each other.
pub(crate) struct Draws(ChaCha8Rng);

impl Draws {
    /// The stream in which scenes are drawn: none that a trace has, since traces take their own number.
    pub(crate) const SCENE: u64 = u64::MAX;

    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(stream);
        Draws(rng)
    }

    /// From 0 up to 1, 1 left out.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From `-size` to `size`.
    pub(crate) fn within(&mut self, size: f64) -> f64 {
        (2.0 * self.unit() - 1.0) * size
    }

    /// From `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number from `low` to `high`, both included. Numbers as small as a scene's are all as likely, but for the
    /// last of 53 bits.
    pub(crate) fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + (self.unit() * (high - low + 1) as f64) as i64
    }

    /// A direction, as a vector one long. Made without angles: sines and cosines are not the same on every machine.
    pub(crate) fn direction(&mut self) -> DVec2 {
        loop {
            let way = self.point(1.0);
            if (0.01..=1.0).contains(&way.length_squared()) {
                return way / way.length();
            }
        }
    }

    /// A point of the square from (-`size`, -`size`) to (`size`, `size`).
    pub(crate) fn point(&mut self, size: f64) -> DVec2 {
        let x = self.within(size);
        DVec2::new(x, self.within(size))
    }
}
