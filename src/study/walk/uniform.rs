//! Steps of one length in any direction.

use glam::DVec2;

use super::stride::Stride;
use crate::study::random::Random;

pub(super) struct Uniform {
    pub(super) step: f64,
}

impl Stride for Uniform {
    fn length(&self) -> f64 {
        self.step
    }

    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        self.step * random.direction()
    }
}
