//! Steps of one length whose heading turns by a uniform angle in each.

use std::f64::consts::PI;

use glam::DVec2;

use super::stride::Stride;
use crate::study::random::Random;

/// The least by which the heading may turn, in radians, once a step was drawn in vain: one that never turns would stand
/// before a wall for good.
const LEAST: f64 = 0.1;

/// By what the turn widens with each step drawn in vain.
const WIDENS: f64 = 1.5;

pub(super) struct Persistent {
    step: f64,
    /// By how much the heading turns at most, in radians.
    turn: f64,
    /// One long, but for roundings.
    heading: DVec2,
    /// The heading of the step drawn last.
    turned: DVec2,
    /// By how much that one could turn.
    spread: f64,
}

impl Persistent {
    pub(super) fn new(step: f64, turn: f64, random: &mut Random) -> Self {
        let heading = random.direction();
        Persistent { step, turn, heading, turned: heading, spread: turn }
    }

    #[inline]
    fn draw_within(&mut self, spread: f64, random: &mut Random) -> DVec2 {
        self.spread = spread;
        // Not the standard library's, which differ from machine to machine.
        let (sin, cos) = libm::sincos(random.within(spread));
        let turned = DVec2::new(cos, sin).rotate(self.heading);
        // One step of Newton's method for the length of 1, so that roundings do not add up.
        self.turned = turned * (1.5 - 0.5 * turned.length_squared());
        self.step * self.turned
    }
}

impl Stride for Persistent {
    fn length(&self) -> f64 {
        self.step
    }

    #[inline]
    fn draw(&mut self, random: &mut Random) -> DVec2 {
        self.draw_within(self.turn, random)
    }

    fn draw_again(&mut self, random: &mut Random) -> DVec2 {
        self.draw_within((self.spread.max(LEAST) * WIDENS).min(PI), random)
    }

    #[inline]
    fn take(&mut self) {
        self.heading = self.turned;
    }

    fn mirror(&mut self, across: DVec2) {
        self.turned -= 2.0 * self.turned.dot(across) * across;
    }
}
