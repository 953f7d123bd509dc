//! Settling a trace: checking its steps against the walls, and deciding on which side it passes the wall ends that it
//! touches.
//!
//! A trace may stand exactly on a vertex, pass exactly through one, or slide along walls from end to end. It then
//! counts as passing a hair off the walls, on the side that it comes from and goes on to; where both sides would do, on
//! the left. Settled traces need no further thought: their points carry their [`Hair`].

use glam::DVec2;

use super::corner::Corner;
use super::slide::{Stay, choose_sides, incoming, outgoing};
use super::{SettledTrace, Trace, Violation, ViolationKind};
use crate::geometry::{Hair, between, check_point, opposite, orient, same_side};
use crate::scene::Model;

/// How many steps share one look into the index. Traces move in small steps, so neighbours see the same few walls.
const STEPS_PER_LOOK: usize = 16;

/// Checks `trace` against the model's walls and settles on which side it passes the vertices that it touches.
///
/// O(points + walls near them), through the model's index.
///
/// # Panics
///
/// If the trace has no point or more than 2^31, or one that [`check_point`] refuses. What [`read_traces`] gives is sound.
///
/// [`read_traces`]: super::read_traces
pub fn settle(model: &Model, trace: &Trace) -> SettledTrace {
    assert!(!trace.points.is_empty() && trace.points.len() < 1 << 31, "a trace has 1 to 2^31 points");
    let faulty = trace.points.iter().find_map(|&p| check_point(p).err());
    assert!(faulty.is_none(), "trace {}: {}", trace.id, faulty.map_or(String::new(), |f| f.to_string()));
    let mut settler = Settler::new(model, trace);
    settler.walk();
    settler.pluck();
    settler.settled
}

struct Settler<'a> {
    model: &'a Model,
    trace: &'a Trace,
    settled: SettledTrace,
    /// Indices of the settled points that stand on vertices, ascending.
    touching: Vec<u32>,
}

impl<'a> Settler<'a> {
    fn new(model: &'a Model, trace: &'a Trace) -> Self {
        let settled = SettledTrace {
            id: trace.id,
            points: Vec::with_capacity(trace.points.len() + 1),
            added: Vec::new(),
            hairs: Vec::new(),
            violation: None,
        };
        Settler { model, trace, settled, touching: Vec::new() }
    }

    fn violate(&mut self, step: usize, kind: ViolationKind, wall: u32) {
        let from = if step == 0 { self.model.anchor() } else { self.trace.points[step - 1] };
        let to = self.trace.points[step];
        let ends = self.model.scene().ends(wall as usize);
        let found = Violation { trace: self.trace.id, step, kind, wall: wall as usize, ends, from, to };
        if self.settled.violation.is_none_or(|v| (found.step, found.wall) < (v.step, v.wall)) {
            self.settled.violation = Some(found);
        }
    }

    fn add(&mut self, at: DVec2, ends_step: bool, touches: bool) {
        let i = self.settled.points.len() as u32;
        self.settled.points.push(at);
        if !ends_step {
            self.settled.added.push(i);
        }
        if touches {
            self.touching.push(i);
        }
    }

    /// Lays out the settled points: step after step, with the vertices that each passes through.
    fn walk(&mut self) {
        let (anchor, points) = (self.model.anchor(), &self.trace.points);
        if points[0] != anchor {
            self.add(anchor, false, self.model.vertex_at(anchor).is_some());
        }
        let mut walls = Vec::new();
        for first in (0..points.len()).step_by(STEPS_PER_LOOK) {
            let last = points.len().min(first + STEPS_PER_LOOK);
            let start = if first == 0 { anchor } else { points[first - 1] };
            let (low, high) = (points[first..last].iter()).fold((start, start), |(l, h), &p| (l.min(p), h.max(p)));
            walls.clear();
            walls.extend(self.model.index().near(low, high));
            walls.sort_unstable();
            let mut from = start;
            for (step, &to) in (first..last).zip(&points[first..last]) {
                self.step(step, from, to, &walls);
                from = to;
            }
        }
    }

    /// Adds the points of one step, given all walls near it in ascending order.
    fn step(&mut self, step: usize, a: DVec2, b: DVec2, walls: &[u32]) {
        let (low, high) = (a.min(b), a.max(b));
        let mut near = false;
        let mut passed: Vec<DVec2> = Vec::new();
        for &wall in walls {
            let [u, v] = self.model.scene().ends(wall as usize);
            if u.min(v).cmpgt(high).any() || u.max(v).cmplt(low).any() {
                continue;
            }
            near = true;
            let (from_a, from_b) = (orient(u, v, a), orient(u, v, b));
            if from_b == 0.0 && between(u, v, b) && self.model.vertex_at(b).is_none() {
                self.violate(step, ViolationKind::EndsInside, wall);
            }
            if a == b || same_side(from_a, from_b) {
                continue;
            }
            let (to_u, to_v) = (orient(a, b, u), orient(a, b, v));
            if opposite(from_a, from_b) && opposite(to_u, to_v) {
                self.violate(step, ViolationKind::Crosses, wall);
            }
            passed
                .extend([(to_u, u), (to_v, v)].into_iter().filter(|&(s, w)| s == 0.0 && between(a, b, w)).map(|p| p.1));
        }
        passed.sort_by(|p, q| {
            let ahead = |p: DVec2| if a.x < b.x || (a.x == b.x && a.y < b.y) { p } else { -p };
            let (p, q) = (ahead(*p), ahead(*q));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
        });
        passed.dedup();
        for p in passed {
            self.add(p, false, true);
        }
        self.add(b, true, near && self.model.vertex_at(b).is_some());
    }

    /// Gives every touching point its hair.
    fn pluck(&mut self) {
        if self.touching.is_empty() {
            return;
        }
        let stays = self.stays();
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
            self.pluck_run(&stays, s, e, &mut chosen);
            s = e;
        }
        self.insert(&stays, chosen);
    }

    /// The settled points with repeats of the same place taken together, from one point before the first touching one
    /// on; only stays that touch, and those beside them, matter.
    fn stays(&self) -> Vec<Stay> {
        let points = &self.settled.points;
        let mut stays: Vec<Stay> = Vec::new();
        let mut touching = self.touching.iter().peekable();
        for (i, &at) in points.iter().enumerate() {
            let touches = touching.next_if(|&&t| t as usize == i).is_some();
            match stays.last_mut() {
                Some(stay) if stay.at == at => stay.end = i + 1,
                _ => {
                    let corner = touches.then(|| Corner::new(self.model, at));
                    stays.push(Stay { at, first: i, end: i + 1, corner });
                }
            }
        }
        stays
    }

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
            if !corner.connects(from, to) {
                let at = stays[i].at;
                let walls = self.model.index().near(at, at);
                let wall = walls.filter(|&w| self.model.scene().ends(w as usize).contains(&at)).min();
                // The step that goes on to the wrong side.
                let step = self.settled.step(stays[i].end);
                self.violate(step, ViolationKind::SlipsThrough, wall.expect("a corner has walls"));
            }
            chosen.push((i as u32, corner.hairs(from, to)));
        }
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
