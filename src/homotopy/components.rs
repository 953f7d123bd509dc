//! What hangs together: walls that have an end in common, touch each other or cross.

use std::convert::Infallible;
use std::ops::ControlFlow::Continue;

use glam::DVec2;

use crate::geometry::{higher, lower, orient, same_side};
use crate::scene::{Model, roots};

/// For each wall end the lowest number among those that hang together with it by walls that have an end in common,
/// touch or cross, by exact signs. O(n log n + pairs of walls whose boxes meet).
pub(super) fn components(model: &Model) -> Vec<u32> {
    let scene = model.scene();
    let mut parents = roots(scene);
    for (wall, &[u, _]) in scene.walls().iter().enumerate() {
        let [a, b] = scene.ends(wall);
        let _: std::ops::ControlFlow<Infallible> = model.index().visit(lower(a, b), higher(a, b), |other, [c, d]| {
            if other as usize > wall && meet([a, b], [c, d]) {
                let other = scene.walls()[other as usize][0];
                let (one, other) = (root(&mut parents, u), root(&mut parents, other));
                parents[one.max(other) as usize] = one.min(other);
            }
            Continue(())
        });
    }
    (0..parents.len() as u32).map(|v| root(&mut parents, v)).collect()
}

fn root(parents: &mut [u32], mut v: u32) -> u32 {
    while parents[v as usize] != v {
        parents[v as usize] = parents[parents[v as usize] as usize];
        v = parents[v as usize];
    }
    v
}

/// Whether two walls have a point in common.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let apart = |p: DVec2, q: DVec2, r: DVec2, s: DVec2| same_side(orient(p, q, r), orient(p, q, s));
    // All four on one line: their boxes meet, so they do.
    let boxes = lower(a, b).cmple(higher(c, d)).all() && lower(c, d).cmple(higher(a, b)).all();
    boxes && !apart(a, b, c, d) && !apart(c, d, a, b)
}
