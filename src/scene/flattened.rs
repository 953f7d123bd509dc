//! What the curves of a drawing have become.

use glam::DVec2;

use super::{Inside, Object, Wall};
use crate::geometry::{between, number, orient};

/// Objects and walls of a drawing.
pub(super) struct Flattened {
    pub(super) objects: Vec<Object>,
    pub(super) walls: Vec<Wall>,
    /// How many curves there are, and within what distance of them their walls lie.
    pub(super) curves: usize,
    pub(super) tolerance: f64,
}

impl Flattened {
    /// A sentence about the curves, if there are any.
    pub(super) fn note(&self) -> Option<String> {
        let Flattened { curves, tolerance, .. } = self;
        (*curves > 0).then(|| {
            format!(
                "walls lie within {} of the curves that they stand for (--flatten), and contacts there depend on it; \
                 curves: {curves}",
                number(*tolerance)
            )
        })
    }

    /// Makes free what holds the anchor within it: a room that is drawn as a filled shape is no solid. O(walls).
    pub(super) fn free_round(&mut self, anchor: DVec2) {
        // How often the walls of each object go round the anchor, and how many of them a ray to the right crosses.
        let mut round = vec![(0i64, 0u64); self.objects.len()];
        let mut touched = vec![false; self.objects.len()];
        for &Wall { ends: [u, v], object, reversed } in &self.walls {
            let (object, [u, v]) = (object as usize, if reversed { [v, u] } else { [u, v] });
            let side = orient(u, v, anchor);
            touched[object] |= side == 0.0 && (between(u, v, anchor) || anchor == u || anchor == v);
            let upwards = u.y <= anchor.y && anchor.y < v.y;
            let downwards = v.y <= anchor.y && anchor.y < u.y;
            if (upwards && side > 0.0) || (downwards && side < 0.0) {
                round[object].0 += if upwards { 1 } else { -1 };
                round[object].1 += 1;
            }
        }
        for ((object, (turns, crossed)), touched) in self.objects.iter_mut().zip(round).zip(touched) {
            let holds = match object.inside {
                Inside::EvenOdd => crossed % 2 == 1,
                Inside::NonZero => turns != 0,
                Inside::Free | Inside::Right => false,
            };
            if holds && !touched {
                object.inside = Inside::Free;
            }
        }
    }
}
