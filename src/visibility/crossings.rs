//! Where walls cross at a point that f64 names exactly.

use std::collections::HashSet;

use glam::DVec2;

use crate::geometry::{check_point, opposite, orient};
use crate::scene::Model;

/// How many pairs of walls are looked at for each wall, on average, before the rest is left as it is.
const LOOKS: usize = 64;

/// The points, none of them a vertex, in which two walls cross and that lie exactly on both: split there, the walls can be
/// triangulated. Each once, in the order of the walls; at most 8 a vertex, so that scenes of many crossings stay small.
pub(super) fn crossings(model: &Model) -> Vec<DVec2> {
    let scene = model.scene();
    let room = 8 * model.vertices().len();
    // Walls that lie on each other, or have all the same place, would be looked at in all their pairs.
    let mut looks = LOOKS * scene.walls().len();
    let mut known = HashSet::new();
    let mut points = Vec::new();
    for wall in 0..scene.walls().len() {
        let [a, b] = scene.ends(wall);
        for other in model.index().near(a.min(b), a.max(b)).filter(|&other| (other as usize) < wall) {
            looks -= 1;
            if looks == 0 {
                return points;
            }
            let [c, d] = scene.ends(other as usize);
            let (to_c, to_d) = (orient(a, b, c), orient(a, b, d));
            if !opposite(to_c, to_d) || !opposite(orient(c, d, a), orient(c, d, b)) {
                continue;
            }
            if points.len() == room {
                return points;
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
        }
    }
    points
}
