//! What one step is like.

use glam::DVec2;

use crate::study::random::Random;

/// How the steps of one kind of walk are drawn.
pub(super) trait Stride {
    /// The next step.
    fn draw(&mut self, random: &mut Random) -> DVec2;

    /// The next step, drawn again because the one drawn last could not be taken.
    fn draw_again(&mut self, random: &mut Random) -> DVec2 {
        self.draw(random)
    }

    /// The step drawn last was taken, or its heading is to be kept though it was not.
    #[inline]
    fn take(&mut self) {}

    /// The step drawn last goes on mirrored at a line; `across` is one long and at right angles to it.
    fn mirror(&mut self, _across: DVec2) {}
}
