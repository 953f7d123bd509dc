//! Steps that are normally distributed in x and y.

use glam::DVec2;

use super::stride::Stride;
use crate::study::random::Random;

pub(super) struct Gaussian {
    /// The standard deviation in x and in y.
    pub(super) step: f64,
}

impl Stride for Gaussian {
    fn length(&self) -> f64 {
        self.step
    }

    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        self.step * random.normal()
    }
}
