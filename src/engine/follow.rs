//! The rope along one leg, exactly, by trying what its pivots see.

use glam::DVec2;

use crate::candidates::Lists;
use crate::geometry::TracePoint;
use crate::rope::{EventKind, Leg, Rope, Side, Sweep};
use crate::scene::Model;
use crate::trace::{Trace, settle};

/// Applies all events of `leg`, which touches no wall, to `rope` and gives them to `each`, in order. O(vertices that
/// the pivot sees within reach of the leg) for each event and once more; `lists` are to have one for each pivot at
/// once.
pub(crate) fn follow(lists: &Lists, rope: &mut Rope, leg: &Leg, mut each: impl FnMut(EventKind, u32, Side)) {
    let mut sweep = Sweep::Start;
    while let Some((kind, vertex, side)) = next(lists, rope, &mut sweep, leg) {
        each(kind, vertex, side);
    }
}

/// The next event of the leg.
fn next(lists: &Lists, rope: &mut Rope, sweep: &mut Sweep, leg: &Leg) -> Option<(EventKind, u32, Side)> {
    let vertices = lists.model().vertices();
    let o = rope.pivot();
    let pivot = lists.model().pivot(rope.contacts().last().map(|c| c.vertex));
    let squared = o.distance_squared(leg.a0.at).max(o.distance_squared(leg.a1.at));
    match lists.of(pivot, squared) {
        Some(list) => {
            let near = list.numbers().take(list.within(squared));
            sweep.next(rope, leg, vertices, near)
        }
        None => sweep.next(rope, leg, vertices, 0..vertices.len() as u32),
    }
}

/// The point from which a leg that touches no wall leads to `to`: where it leaves a wall, on which the anchor is, a
/// hair tells on which side.
pub(crate) fn leaves(model: &Model, from: DVec2, to: DVec2) -> TracePoint {
    match from == model.anchor() && model.is_on_wall(from) {
        true => settle(model, &Trace { id: 0, points: vec![from, to] }).point(0),
        false => TracePoint::from(from),
    }
}
