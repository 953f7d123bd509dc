//! Where the free end may go: within the scene's bounding box, off the walls.

use std::sync::Arc;

use glam::DVec2;

use crate::geometry::{higher, lower};
use crate::scene::Model;

pub(super) struct Room {
    pub(super) model: Arc<Model>,
    /// The corners of the scene's bounding box.
    pub(super) low: DVec2,
    pub(super) high: DVec2,
}

impl Room {
    pub(super) fn new(model: Arc<Model>) -> Self {
        let (low, high) = model.bounds();
        Room { model, low, high }
    }

    /// Whether `p` lies in the box, its border included.
    #[inline]
    pub(super) fn holds(&self, p: DVec2) -> bool {
        (p.x >= self.low.x) & (p.x <= self.high.x) & (p.y >= self.low.y) & (p.y <= self.high.y)
    }

    /// Whether the free end can be dragged from `a`, a point of the room, straight to `b` without touching a wall or
    /// leaving the box.
    #[inline]
    pub(super) fn is_open(&self, a: DVec2, b: DVec2) -> bool {
        self.holds(b) && self.model.is_clear(a, b)
    }
}

/// A box around the free end that no wall meets, while there is one: every step within it is open, which is seen at
/// once.
pub(super) struct Clearing {
    low: DVec2,
    high: DVec2,
    /// How far the next box that is tried reaches on either side, in steps: twice as far as the last one that was free,
    /// half as far as the last that was not.
    reach: f64,
    /// How many steps are looked at one by one before another box is tried.
    pause: u32,
}

/// How far a clearing reaches on either side, in steps: nearer ones are left too soon to be of use.
const NEAREST: f64 = 2.0;

/// Further ones are not much longer stayed in, and seldom free.
const FURTHEST: f64 = 32.0;

/// How many steps are looked at one by one once the nearest box was not free.
const PAUSE: u32 = 8;

impl Default for Clearing {
    fn default() -> Self {
        // A box that holds nothing.
        Clearing { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY, reach: 4.0 * NEAREST, pause: 0 }
    }
}

impl Clearing {
    #[inline]
    pub(super) fn holds(&self, p: DVec2) -> bool {
        (p.x >= self.low.x) & (p.x <= self.high.x) & (p.y >= self.low.y) & (p.y <= self.high.y)
    }

    /// Another clearing, around `here`, since a step of about that length left the last one.
    pub(super) fn move_to(&mut self, room: &Room, here: DVec2, step: f64) {
        if self.pause > 0 {
            self.pause -= 1;
            return;
        }
        let far = self.reach * step;
        let (low, high) = (higher(here - far, room.low), lower(here + far, room.high));
        if room.model.index().is_free(low, high) {
            *self = Clearing { low, high, reach: (2.0 * self.reach).min(FURTHEST), pause: 0 };
        } else if self.reach > NEAREST {
            *self = Clearing { reach: 0.5 * self.reach, ..Clearing::default() };
        } else {
            *self = Clearing { reach: NEAREST, pause: PAUSE, ..Clearing::default() };
        }
    }
}
