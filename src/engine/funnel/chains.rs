//! The funnel of a crossing word, which follows the word as it grows and shrinks.
//!
//! The funnel is what the shortest paths from the anchor to both ends of the last edge crossed enclose once they part,
//! at the apex: two chains, each bent inwards. They lie in one row, from the left end over the apex to the right end. A
//! new edge keeps one end of the last; the path to the other parts from the row at the corner whose sector holds it,
//! and everything beyond that corner leaves the row. Writing the new end down there overwrites one place of the row, so
//! one place is all that has to be put back when the edge leaves the word again.

use glam::DVec2;

use super::mesh::Mesh;
use super::triangle::{Door, NEXT};
use crate::geometry::orient;
use crate::rope::Side;

/// A corner of shortest paths from the anchor, or the anchor: node 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub at: DVec2,
    /// The corner before it; the anchor's is itself.
    pub prior: u32,
    /// How many corners the path to it has, itself included.
    pub depth: u32,
    pub vertex: u32,
    pub side: Side,
    /// The length of the path to it, in the scene's unit.
    pub length: f64,
    /// Never the same for two nodes of a trace, whether they are there at the same time or not; the anchor's is 0.
    pub stamp: u64,
}

/// A corner in the funnel's row: its node, and where it stands, which is asked for most.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: DVec2,
    node: u32,
}

/// What a door changed.
#[derive(Debug, Clone, Copy)]
struct Undo {
    low: i32,
    high: i32,
    apex: i32,
    /// The place of the row that was overwritten, and what was there.
    place: i32,
    corner: Corner,
    /// The number of nodes.
    nodes: u32,
}

/// The funnel, and the shortest paths of which it is made.
#[derive(Debug, Default)]
pub(super) struct Chains {
    nodes: Vec<Node>,
    /// The row; place i is at index `middle + i`.
    row: Vec<Corner>,
    middle: i32,
    /// The places of the left end, the right end and the apex.
    low: i32,
    high: i32,
    apex: i32,
    /// For each door of the word.
    undo: Vec<Undo>,
    stamp: u64,
    /// The place at which the last tip was found.
    tip: i32,
}

impl Chains {
    /// The funnel of the empty word: the anchor alone.
    pub(super) fn start(&mut self, anchor: DVec2) {
        let root = Node { at: anchor, prior: 0, depth: 0, vertex: 0, side: Side::Left, length: 0.0, stamp: 0 };
        self.nodes.clear();
        self.nodes.push(root);
        self.undo.clear();
        let corner = Corner { at: anchor, node: 0 };
        if self.row.is_empty() {
            (self.row, self.middle) = (vec![corner; 64], 32);
        }
        (self.low, self.high, self.apex, self.tip, self.stamp) = (0, 0, 0, 0, 0);
        self.row[self.middle as usize] = corner;
    }

    #[inline]
    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// Follows the word to `doors`, of which the first `kept` have stayed. O(doors that have changed), times the
    /// logarithm of the corners passed.
    pub(super) fn follow(&mut self, mesh: &Mesh, doors: &[Door], kept: usize) {
        if let Some(&first) = self.undo.get(kept) {
            for undo in self.undo.drain(kept..).rev() {
                self.row[(self.middle + undo.place) as usize] = undo.corner;
            }
            (self.low, self.high, self.apex) = (first.low, first.high, first.apex);
            self.nodes.truncate(first.nodes as usize);
        }
        for i in kept..doors.len() {
            self.enter(mesh, i.checked_sub(1).map(|last| doors[last]), doors[i]);
        }
    }

    /// Takes in a door of which `last` was the one before.
    fn enter(&mut self, mesh: &Mesh, last: Option<Door>, door: Door) {
        let (left, right) = ends(mesh, door);
        let (low, high, apex, nodes) = (self.low, self.high, self.apex, self.nodes.len() as u32);
        let place = match last.map(|last| ends(mesh, last).0.0 == left.0) {
            Some(true) => self.narrow(Side::Right, right),
            Some(false) => self.narrow(Side::Left, left),
            // Both ends of the first are new; what lies beside the anchor, alone in the row, is nothing to put back.
            None => {
                self.narrow(Side::Left, left);
                self.narrow(Side::Right, right);
                (0, self.corner(0))
            }
        };
        self.undo.push(Undo { low, high, apex, place: place.0, corner: place.1, nodes });
    }

    /// Moves one end of the funnel to `vertex`, which stands at `at`. Returns the place overwritten and what was there.
    fn narrow(&mut self, side: Side, (vertex, at): (u32, DVec2)) -> (i32, Corner) {
        let from = match side {
            Side::Left => self.sector(at, self.low),
            Side::Right => self.sector(at, self.high),
        };
        // A vertex on which the anchor stands is no corner: the path to it ends at the anchor.
        let place = match side {
            _ if self.corner(from).at == at => from,
            Side::Left => from - 1,
            Side::Right => from + 1,
        };
        let (corner, there) = (self.corner(from), self.corner(place));
        match side {
            Side::Left => (self.low, self.apex) = (place, self.apex.max(from)),
            Side::Right => (self.high, self.apex) = (place, self.apex.min(from)),
        }
        if place != from {
            self.row[(self.middle + place) as usize] = Corner { at, node: self.nodes.len() as u32 };
            let prior = *self.node(corner.node);
            let length = prior.length + prior.at.distance(at);
            self.stamp += 1;
            self.nodes.push(Node {
                at,
                prior: corner.node,
                depth: prior.depth + 1,
                vertex,
                side,
                length,
                stamp: self.stamp,
            });
            self.widen();
        }
        (place, there)
    }

    /// Makes room in the row for one more place at either end.
    fn widen(&mut self) {
        let size = self.row.len();
        if self.middle + self.low == 0 || (self.middle + self.high) as usize + 1 == size {
            let old = std::mem::take(&mut self.row);
            self.row = vec![old[0]; 3 * size];
            self.row[size..2 * size].copy_from_slice(&old);
            self.middle += size as i32;
        }
    }

    /// What is at place `i` of the row.
    #[inline]
    fn corner(&self, i: i32) -> Corner {
        self.row[(self.middle + i) as usize]
    }

    /// The last corner of the shortest path to `a`, which is in the triangle behind the last door, or the anchor. A
    /// corner on which `a` stands is none. O(log corners between the last tip in the row and this one).
    pub(super) fn tip(&mut self, a: DVec2) -> u32 {
        let apex = self.corner(self.apex);
        if apex.at == a {
            return self.node(apex.node).prior;
        }
        self.tip = self.sector(a, self.tip);
        self.corner(self.tip).node
    }

    /// The place from which the path goes straight to `p`, which lies behind the last door; searched for from the place
    /// `near` on, in strides that double.
    ///
    /// The chains' edges, made longer, cut what is behind the last door into sectors, in the order of the row: on a
    /// chain bent one way they do not meet again.
    #[inline]
    fn sector(&self, p: DVec2, near: i32) -> i32 {
        let (mut low, mut high) = (self.low, self.high);
        let near = near.clamp(low, high);
        let mut stride = 1;
        if near < high && !self.is_left(p, near) {
            low = near + 1;
            while low < high {
                let probe = (low + stride - 1).min(high - 1);
                if self.is_left(p, probe) {
                    high = probe;
                    break;
                }
                (low, stride) = (probe + 1, stride * 2);
            }
        } else {
            high = near;
            while low < high {
                let probe = (high - stride).max(low);
                if !self.is_left(p, probe) {
                    low = probe + 1;
                    break;
                }
                (high, stride) = (probe, stride * 2);
            }
        }
        while low < high {
            let middle = low + (high - low) / 2;
            if self.is_left(p, middle) { high = middle } else { low = middle + 1 }
        }
        low
    }

    /// Whether `p` lies left of the row's edge from place `i` to the next, seen from the anchor and made longer. On the
    /// line it counts as on the apex's side: the path passes the edge's far end straight.
    #[inline]
    fn is_left(&self, p: DVec2, i: i32) -> bool {
        let side = orient(self.corner(i).at, self.corner(i + 1).at, p);
        // Left of the apex, the edge as seen from the anchor goes the other way.
        if i < self.apex { side < 0.0 } else { side >= 0.0 }
    }
}

/// A door's vertices, left and right as one comes through it: their numbers and where they stand.
fn ends(mesh: &Mesh, door: Door) -> ((u32, DVec2), (u32, DVec2)) {
    let (triangle, edge) = (door.triangle(), door.edge());
    (mesh.corner(triangle, edge), mesh.corner(triangle, NEXT[edge]))
}
