//! Taking vertices away, the one that moves walls least first.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet};

use glam::DVec2;

use super::near::Near;
use super::sides::{is_clean, yielding};
use crate::geometry::{between, orient};
use crate::scene::Model;
use crate::visibility::Visibility;

/// A wall, or what stands for several.
struct Wall {
    ends: [u32; 2],
    /// Whether it goes against the first of those for which it stands.
    turned: bool,
    /// Whether it may be moved to its left, and to its right.
    yields: [bool; 2],
    /// The vertices that went for it.
    replaced: Vec<u32>,
}

impl Wall {
    /// Its end that is not `v`, and whether it may be moved to its left and to its right, seen from there towards `v`.
    fn towards(&self, v: u32) -> (u32, [bool; 2]) {
        let [left, right] = self.yields;
        if self.ends[1] == v { (self.ends[0], [left, right]) } else { (self.ends[1], [right, left]) }
    }
}

/// A vertex that may go. The least is the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Offer {
    /// The bits of the distance of the furthest vertex that the new wall stands for: of numbers from 0 on, they are in
    /// order.
    distance: u64,
    /// How many they are. Walls that stand for few come first, so that no wall gathers one vertex after the other.
    replaced: u32,
    vertex: u32,
    /// How often its walls had changed.
    change: u32,
}

/// A scene under way.
pub(super) struct Thinning<'a> {
    vertices: &'a [DVec2],
    tolerance: f64,
    walls: Vec<Option<Wall>>,
    /// The two walls at each vertex that may go in principle.
    meeting: Vec<Option<[u32; 2]>>,
    changes: Vec<u32>,
    /// The vertices, lower number first, between which a wall stands or stood.
    joined: HashSet<[u32; 2]>,
    near: Near,
    offers: BinaryHeap<Reverse<Offer>>,
    /// Offers that wait for a vertex to go.
    waiting: HashMap<u32, Vec<Offer>>,
}

impl<'a> Thinning<'a> {
    /// Nothing is taken away yet. O(n log n) for walls that do not meet but at their ends.
    pub(super) fn new(model: &'a Model, visibility: &Visibility, anchors: &[DVec2], tolerance: f64) -> Self {
        let (vertices, walls) = (model.vertices(), model.scene().walls());
        let meeting = candidates(model, anchors);
        let yields = yielding(visibility, anchors, walls, |v| meeting[v as usize].is_some());
        let wall = |(&ends, yields)| Some(Wall { ends, turned: false, yields, replaced: Vec::new() });
        let apart = anchors.iter().copied().filter(|&anchor| model.vertex_at(anchor).is_none());
        Thinning {
            vertices,
            tolerance,
            walls: walls.iter().zip(yields).map(wall).collect(),
            meeting,
            changes: vec![0; vertices.len()],
            joined: walls.iter().map(|&[u, v]| [u.min(v), u.max(v)]).collect(),
            near: Near::new(vertices.iter().copied().chain(apart)),
            offers: BinaryHeap::new(),
            waiting: HashMap::new(),
        }
    }

    /// Takes away what can go.
    pub(super) fn run(&mut self) {
        for vertex in 0..self.vertices.len() as u32 {
            self.offer(vertex);
        }
        while let Some(Reverse(offer)) = self.offers.pop() {
            if self.changes[offer.vertex as usize] == offer.change && self.meeting[offer.vertex as usize].is_some() {
                self.take(offer);
            }
        }
    }

    /// The walls that are left, in the order of the first of those for which they stand: that one's number, and whether
    /// they go against it.
    pub(super) fn walls(&self) -> impl Iterator<Item = ([u32; 2], usize, bool)> {
        let left = |(number, wall): (usize, &Option<Wall>)| wall.as_ref().map(|wall| (wall.ends, number, wall.turned));
        self.walls.iter().enumerate().filter_map(left)
    }

    /// Of a vertex that may go: the walls that meet there, and their other ends.
    fn arms(&self, v: u32) -> Option<([u32; 2], [u32; 2], [bool; 2])> {
        let pair = self.meeting[v as usize]?;
        let [from, to] = pair.map(|wall| self.walls[wall as usize].as_ref().expect("walls that meet are there"));
        let ((u, there), (w, back)) = (from.towards(v), to.towards(v));
        // On the way from u over v to w.
        Some((pair, [u, w], [there[0] && back[1], there[1] && back[0]]))
    }

    /// Offers to take `v` away, if that moves no wall too far, and none to where it may not go.
    fn offer(&mut self, v: u32) {
        let Some((pair, [u, w], yields)) = self.arms(v) else { return };
        let [a, o, b] = [u, v, w].map(|vertex| self.vertices[vertex as usize]);
        let turn = orient(a, o, b);
        let may_go = match turn {
            _ if turn > 0.0 => yields[0],
            _ if turn < 0.0 => yields[1],
            _ => yields == [true; 2] && between(a, b, o),
        };
        if !may_go || u == w {
            return;
        }
        let replaced = pair.iter().flat_map(|&wall| &self.walls[wall as usize].as_ref().expect("it is there").replaced);
        let (mut furthest, mut count) = (0.0f64, 0);
        for &gone in replaced.chain([&v]) {
            furthest = furthest.max(distance(self.vertices[gone as usize], [a, b]));
            count += 1;
            if furthest > self.tolerance {
                return;
            }
        }
        let (distance, change) = (furthest.to_bits(), self.changes[v as usize]);
        self.offers.push(Reverse(Offer { distance, replaced: count, vertex: v, change }));
    }

    /// Takes a vertex away, unless something stands in its triangle; then it has to wait for that.
    fn take(&mut self, offer: Offer) {
        let v = offer.vertex;
        let Some((pair, [u, w], yields)) = self.arms(v) else { return };
        if self.joined.contains(&[u.min(w), u.max(w)]) {
            return;
        }
        let corners = [u, v, w].map(|vertex| (vertex, self.vertices[vertex as usize]));
        if let Some(inside) = self.near.inside(corners) {
            self.waiting.entry(inside).or_default().push(offer);
            return;
        }
        let [kept, gone] = [pair[0].min(pair[1]), pair[0].max(pair[1])];
        // The new wall goes from u over v to w.
        let first = self.walls[kept as usize].as_ref().expect("walls that meet are there");
        let turned = first.turned != (if kept == pair[0] { first.ends[1] != v } else { first.ends[0] != v });
        let [mut few, mut many] =
            pair.map(|wall| self.walls[wall as usize].take().expect("walls that meet are there").replaced);
        if few.len() > many.len() {
            std::mem::swap(&mut few, &mut many);
        }
        many.append(&mut few);
        many.push(v);
        self.walls[kept as usize] = Some(Wall { ends: [u, w], turned, yields, replaced: many });
        self.joined.insert([u.min(w), u.max(w)]);
        self.meeting[v as usize] = None;
        self.near.remove(v, self.vertices[v as usize]);
        for end in [u, w] {
            for wall in self.meeting[end as usize].iter_mut().flatten() {
                if *wall == gone {
                    *wall = kept;
                }
            }
            self.changes[end as usize] += 1;
            self.offer(end);
        }
        self.offers.extend(self.waiting.remove(&v).into_iter().flatten().map(Reverse));
    }
}

/// The two walls at each vertex where there are two, each meeting others at its ends only, and no rope is tied.
fn candidates(model: &Model, anchors: &[DVec2]) -> Vec<Option<[u32; 2]>> {
    let mut ends: Vec<([u32; 2], usize)> = vec![([0; 2], 0); model.vertices().len()];
    for (wall, number) in model.scene().walls().iter().zip(0..) {
        for &v in wall {
            let (walls, count) = &mut ends[v as usize];
            if let Some(slot) = walls.get_mut(*count) {
                *slot = number;
            }
            *count += 1;
        }
    }
    for &anchor in anchors {
        if let Some(vertex) = model.vertex_at(anchor) {
            ends[vertex as usize].1 = 0;
            continue;
        }
        // Nor does a wall move in the middle of which one is tied.
        for wall in model.walls_at(anchor) {
            model.scene().walls()[wall].iter().for_each(|&v| ends[v as usize].1 = 0);
        }
    }
    let asked = model.scene().walls().iter().zip(0..);
    let clean: Vec<bool> =
        asked.map(|(wall, number)| wall.iter().any(|&v| ends[v as usize].1 == 2) && is_clean(model, number)).collect();
    let pair = |(walls, count): ([u32; 2], usize)| {
        (count == 2 && walls.iter().all(|&wall| clean[wall as usize])).then_some(walls)
    };
    ends.into_iter().map(pair).collect()
}

/// How far `p` is from the segment between two points, rounded.
fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + share * along)
}
