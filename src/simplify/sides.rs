//! Which walls meet no other but at their ends, and on which of their sides space may be taken from the rope.

use std::ops::ControlFlow::{Break, Continue};

use glam::DVec2;

use crate::geometry::{forwards, higher, lower, orient, same_side};
use crate::scene::Model;
use crate::visibility::Visibility;

/// Whether no other wall meets wall `wall` but by ending where it ends. O(log walls + walls near it).
pub(super) fn is_clean(model: &Model, wall: u32) -> bool {
    let ends = model.scene().walls()[wall as usize];
    let [a, b] = model.scene().ends(wall as usize);
    let visit = |other: u32, [c, d]: [DVec2; 2]| {
        let others = model.scene().walls()[other as usize];
        let shared = ends.iter().filter(|end| others.contains(end)).count();
        let meets = match shared {
            _ if other == wall => false,
            0 => !same_side(orient(c, d, a), orient(c, d, b)) && !same_side(orient(a, b, c), orient(a, b, d)),
            1 => {
                let (here, there) = if others.contains(&ends[0]) { (a, b) } else { (b, a) };
                let away = if c == here { d } else { c };
                orient(here, there, away) == 0.0 && !forwards(there, here, away)
            }
            _ => true,
        };
        if meets { Break(()) } else { Continue(()) }
    };
    model.index().visit(lower(a, b), higher(a, b), visit).is_continue()
}

/// For each wall that ends where `may_go` says so: whether it may be moved into the space on its left and on its right,
/// for ropes that are tied at any of `anchors`. That is so unless a rope may reach that side and may not reach the
/// other.
///
/// O(anchors * triangles), and the triangles round the vertices that may go.
pub(super) fn yielding(
    visibility: &Visibility,
    anchors: &[DVec2],
    walls: &[[u32; 2]],
    may_go: impl Fn(u32) -> bool,
) -> Vec<[bool; 2]> {
    // Looked up round an end that may go: round one at which many walls meet, there are many triangles.
    let beside = |&[u, v]: &[u32; 2]| match () {
        () if may_go(u) => visibility.beside(u, v),
        () if may_go(v) => visibility.beside(v, u).map(|[right, left]| [left, right]),
        () => None,
    };
    let beside: Vec<Option<[u32; 2]>> = walls.iter().map(beside).collect();
    let mut yielding: Vec<[bool; 2]> = beside.iter().map(|beside| [beside.is_some(); 2]).collect();
    for &anchor in anchors {
        let reach = visibility.reach(anchor);
        for (yielding, beside) in yielding.iter_mut().zip(&beside) {
            let Some([left, right]) = beside.map(|sides| sides.map(|triangle| triangle as usize)) else { continue };
            yielding[0] &= !reach.perhaps[left] || reach.surely[right];
            yielding[1] &= !reach.perhaps[right] || reach.surely[left];
        }
    }
    yielding
}
