//! Hairs: on which side a settled trace passes the walls where it touches them.

use std::collections::HashMap;
use std::rc::Rc;

use glam::DVec2;

use super::corner::Corner;
use super::settled::violation;
use super::slide::{Stay, choose_sides, incoming, outgoing};
use super::{SettledTrace, ViolationKind};
use crate::geometry::Hair;
use crate::scene::Model;

/// Gives every point of `settled` that touches a wall its hair, and adds points where two are needed. `touching` are
/// their indices, ascending.
pub(super) fn pluck(model: &Model, settled: &mut SettledTrace, touching: &[u32]) {
    pluck_stays(model, settled, &stays(model, &settled.points, touching));
}

/// The same, given the stays.
pub(super) fn pluck_stays(model: &Model, settled: &mut SettledTrace, stays: &[Stay]) {
    let mut plucker = Plucker { model, settled };
    let mut chosen: Vec<(u32, Vec<Hair>)> = Vec::new();
    let mut s = 0;
    while s < stays.len() {
        let Some(_) = stays[s].corner else {
            s += 1;
            continue;
        };
        // The run of corners s..e that slides along walls link.
        let mut e = s + 1;
        while e < stays.len() && stays[e].corner.is_some() && stays[e - 1].slides_to(&stays[e]) {
            e += 1;
        }
        plucker.pluck_run(stays, s, e, &mut chosen);
        s = e;
    }
    plucker.insert(stays, chosen);
    settled.broken.sort();
}

/// The stays that touch, in order, and those right before and after them; what else a trace does is of no matter.
fn stays(model: &Model, points: &[DVec2], touching: &[u32]) -> Vec<Stay> {
    let mut stays: Vec<Stay> = Vec::new();
    // One for each place, however often it is touched: thousands of walls may meet there.
    let mut corners: HashMap<[u64; 2], Rc<Corner>> = HashMap::new();
    let beside = |i: usize| Stay { at: points[i], first: i, end: i + 1, corner: None };
    let mut rest = touching;
    while let Some(&first) = rest.first() {
        let first = first as usize;
        let at = points[first];
        // Whoever stays at a place touches it all the while.
        let length = points[first..].iter().take_while(|&&p| p == at).count();
        let end = first + length;
        if first > 0 && stays.last().is_none_or(|last| last.end < first) {
            stays.push(beside(first - 1));
        }
        let corner = corners.entry(at.to_array().map(f64::to_bits)).or_insert_with(|| Rc::new(Corner::new(model, at)));
        stays.push(Stay { at, first, end, corner: Some(Rc::clone(corner)) });
        rest = &rest[length..];
        if end < points.len() && rest.first().is_none_or(|&next| next as usize > end) {
            stays.push(beside(end));
        }
    }
    stays
}

struct Plucker<'a> {
    model: &'a Model,
    settled: &'a mut SettledTrace,
}

impl Plucker<'_> {
    /// Chooses the sides of the slides in `stays[s..e]` and from them the hairs.
    fn pluck_run(&mut self, stays: &[Stay], s: usize, e: usize, chosen: &mut Vec<(u32, Vec<Hair>)>) {
        let before = (s > 0).then(|| &stays[s - 1]);
        let after = stays.get(e);
        let sides = choose_sides(&stays[s..e], before, after);
        for i in s..e {
            let corner = stays[i].corner.as_ref().expect("a run is made of corners");
            let from = (i > 0).then(|| corner.way(stays[i - 1].at, incoming(&sides, i - s)));
            let to = stays.get(i + 1).map(|next| corner.way(next.at, outgoing(&sides, i - s)));
            let (from, to) = match (from, to) {
                (Some(from), Some(to)) => (from, to),
                (Some(way), None) | (None, Some(way)) => (way, way),
                // The trace never leaves this point: any side will do.
                (None, None) => (corner.any_way(), corner.any_way()),
            };
            let at = stays[i].at;
            // Only a trace's start can be in a solid that it has not entered before.
            if i == 0 && corner.is_solid(from) && stays.len() > 1 {
                self.breaks(ViolationKind::EntersSolid, at, stays[i].end);
            } else if !corner.connects(from, to) {
                let is_end = self.model.vertex_at(at).is_some();
                let kind = if is_end { ViolationKind::SlipsThrough } else { ViolationKind::Crosses };
                self.breaks(kind, at, stays[i].end);
            }
            chosen.push((i as u32, corner.hairs(from, to)));
        }
    }

    /// Notes that the step which goes on from `at` to point `next` does so on the wrong side of the walls there.
    fn breaks(&mut self, kind: ViolationKind, at: DVec2, next: usize) {
        let wall = self.model.wall_at(at).expect("a corner has walls");
        let settled = &mut *self.settled;
        let step = settled.step(next);
        let to = (next..settled.points.len()).find(|&i| settled.ends_step(i)).unwrap_or(next);
        let from = (0..to).rev().find(|&i| settled.ends_step(i)).filter(|_| step > 0);
        let from = from.map_or(self.model.anchor(), |i| settled.points[i]);
        let found = violation(self.model, settled.id, step, kind, wall, [from, settled.points[to]]);
        settled.broken.note(found);
    }

    /// Writes the hairs down, adding a point where a stay needs two.
    fn insert(&mut self, stays: &[Stay], chosen: Vec<(u32, Vec<Hair>)>) {
        // The points before which another is added at the same place: it takes the first hair, they the second.
        let mut doubled: Vec<usize> = Vec::new();
        for (stay, hairs) in chosen {
            let stay = &stays[stay as usize];
            let shift = doubled.len();
            self.settled.hairs.extend((stay.first..stay.end).map(|i| ((i + shift) as u32, hairs[0])));
            if let Some(&second) = hairs.get(1) {
                self.settled.hairs.push(((stay.end + shift) as u32, second));
                doubled.push(stay.end - 1);
            }
        }
        if doubled.is_empty() {
            return;
        }
        let shifted = |i: usize| (i + doubled.partition_point(|&d| d <= i)) as u32;
        let mut added: Vec<u32> = self.settled.added.iter().map(|&a| shifted(a as usize)).collect();
        added.extend(doubled.iter().map(|&d| shifted(d) - 1));
        added.sort_unstable();
        self.settled.added = added;
        let copies = |i: usize| 1 + usize::from(doubled.binary_search(&i).is_ok());
        let old = std::mem::take(&mut self.settled.points);
        self.settled.points =
            old.into_iter().enumerate().flat_map(|(i, p)| std::iter::repeat_n(p, copies(i))).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    /// Where thousands of walls meet, a corner for every stay would take a trace's memory times thousands.
    #[test]
    fn stays_at_one_vertex_share_its_corner() {
        let [hub, tip] = [DVec2::ZERO, DVec2::new(1.0, 0.0)];
        let model = Model::new(Scene::new([[hub, tip]]).unwrap(), Some(DVec2::ONE)).unwrap();
        let stays = stays(&model, &[DVec2::ONE, hub, tip, hub, DVec2::ONE, hub], &[1, 2, 3, 5]);
        let corners: Vec<_> = stays.iter().filter_map(|stay| stay.corner.as_ref()).collect();
        assert!(Rc::ptr_eq(corners[0], corners[2]) && Rc::ptr_eq(corners[0], corners[3]));
        assert!(!Rc::ptr_eq(corners[0], corners[1]));
    }
}
