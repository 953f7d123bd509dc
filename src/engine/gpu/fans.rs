//! Fans on the device: which ropes turn about what, and where each ray goes on.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::dragged::Shared;
use crate::candidates::{Fan, NO_VERTEX};
use crate::gpu::{DragPass, Ray, UNKNOWN};
use crate::scene::{Model, Pivot};

/// A fan as the device has it, and what it says of fans that are there.
struct Brought {
    pivot: Pivot,
    ways: Vec<[f32; 2]>,
    rays: Vec<Ray>,
    /// Where rays of other pivots go on in this fan: the pivot, the ray, [`Ray::goes_on`].
    met: Vec<(Pivot, usize, u32)>,
}

/// Brings the fans of those of `pivots` that are not on the device; false if there was no room for all. They are made
/// on all threads.
pub(super) fn bring_fans(pass: &mut DragPass, shared: &Shared<'_>, pivots: BTreeSet<Pivot>) -> bool {
    let heads = pass.heads();
    let has = |pivot: Pivot| heads[pivot.index()].has_fan();
    let new: Vec<Pivot> = pivots.into_iter().filter(|&pivot| !has(pivot)).collect();
    let brought: Vec<_> = new.par_iter().filter_map(|&pivot| Brought::new(shared, pivot, &new, has)).collect();
    for Brought { pivot, ways, rays, met } in brought {
        if !pass.bring_fan(pivot.index(), &ways, &rays) {
            return false;
        }
        met.into_iter().for_each(|(pivot, ray, goes_on)| pass.set_goes_on(pivot.index(), ray, goes_on));
    }
    true
}

impl Brought {
    /// The fan of `pivot`, to be brought with those of the other `new` ones, which are sorted; `None` if it has none.
    fn new(shared: &Shared<'_>, pivot: Pivot, new: &[Pivot], has: impl Fn(Pivot) -> bool) -> Option<Self> {
        let model = shared.lists.model();
        let at = model.position(pivot);
        let list = shared.lists.of(pivot, f64::INFINITY)?;
        let fan = list.fan(model, at)?;
        let to = |i: usize| (fan.vertex(i) != NO_VERTEX).then(|| Pivot::at_vertex(fan.vertex(i)));
        let goes_on_from = |i: usize| {
            let to = to(i).filter(|to| has(*to) || new.binary_search(to).is_ok())?;
            let list = shared.lists.of(to, f64::INFINITY)?;
            Some(goes_on(model, list.fan(model, model.position(to))?, pivot, to))
        };
        let ray = |i: usize| Ray { vertex: fan.vertex(i), goes_on: goes_on_from(i).unwrap_or(UNKNOWN) };
        let ray_from = |from: Pivot| {
            let from_at = model.position(from);
            let list = shared.lists.of(from, f64::INFINITY)?;
            let ray = list.fan(model, from_at)?.ray_along(at - from_at)?;
            Some((from, ray, goes_on(model, fan, from, pivot)))
        };
        // No fan has a ray that leads to the anchor.
        let others = (0..fan.rays()).filter_map(to).chain([model.pivot(None)]);
        Some(Brought {
            pivot,
            ways: shared.grid.fan(fan),
            rays: (0..fan.rays()).map(ray).collect(),
            met: others.filter(|&other| has(other)).filter_map(ray_from).collect(),
        })
    }
}

/// Where the ray of `to` from `from` goes on in the fan of `to`, as [`Ray::goes_on`] has it.
fn goes_on(model: &Model, fan: &Fan, from: Pivot, to: Pivot) -> u32 {
    let (last, on_it) = fan.goes_on(model, model.position(from), model.position(to));
    2 * last as u32 + u32::from(on_it)
}
