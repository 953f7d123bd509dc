//! Where walls cross at a point that f64 names exactly.

use std::collections::HashSet;
use std::ops::ControlFlow::{Break, Continue};

use glam::DVec2;

use crate::geometry::{check_point, higher, lower, opposite, orient};
use crate::scene::Model;

/// How many pairs of walls are looked at for each wall, on average, before the rest is left as it is.
const LOOKS: usize = 64;

/// The points, none of them a vertex, in which two of `walls` cross and that lie exactly on both: split there, the
/// walls can be triangulated. Each once; at most 16 a wall, so that scenes of many crossings stay small.
pub(super) fn crossings(model: &Model, walls: &[u32]) -> Vec<DVec2> {
    // Walls that lie on each other, or have all the same place, would be looked at in all their pairs.
    let (mut looks, room) = (LOOKS * walls.len(), 16 * walls.len());
    let mut known = HashSet::new();
    let mut points = Vec::new();
    for &wall in walls {
        let [a, b] = model.scene().ends(wall as usize);
        let full = model.index().visit(lower(a, b), higher(a, b), |other, [c, d]| {
            if other >= wall {
                return Continue(());
            }
            if looks == 0 || points.len() == room {
                return Break(());
            }
            looks -= 1;
            let (to_c, to_d) = (orient(a, b, c), orient(a, b, d));
            if !opposite(to_c, to_d) || !opposite(orient(c, d, a), orient(c, d, b)) {
                return Continue(());
            }
            // Rounded, and kept only if nothing was lost. Adding zero turns a negative zero into the positive one.
            let p = c + (d - c) * (to_c / (to_c - to_d)) + DVec2::ZERO;
            // The areas are used as sizes for a guess only; whether it is right, their signs say.
            let is_exact = check_point(p).is_ok() && orient(a, b, p) == 0.0 && orient(c, d, p) == 0.0;
            if is_exact
                && p != model.anchor()
                && model.vertex_at(p).is_none()
                && known.insert(p.to_array().map(f64::to_bits))
            {
                points.push(p);
            }
            Continue(())
        });
        if full.is_break() {
            break;
        }
    }
    points
}
