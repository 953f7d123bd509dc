//! What becomes of one trace's taut rope, step after step.

use glam::DVec2;

use super::chains::{Chains, Node};
use crate::rope::{Event, EventKind, Rope, Side, Status, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// A contact of the taut rope, and the node that it was last seen as.
#[derive(Debug, Clone, Copy)]
struct Held {
    vertex: u32,
    side: Side,
    stamp: u64,
}

/// The taut rope as it was last seen, and the record so far.
#[derive(Debug, Default)]
pub(super) struct Log {
    /// From the anchor on, which is the first and no contact: a node's place here is its depth.
    held: Vec<Held>,
    /// The nodes that are new, from the last one of the rope on.
    fresh: Vec<u32>,
    max_length: f64,
    max_depth: u32,
    events: Vec<Event>,
}

impl Log {
    /// Nothing seen but the anchor.
    pub(super) fn start(&mut self, chains: &Chains) {
        self.held.clear();
        self.held.push(held(chains.node(0)));
        (self.max_length, self.max_depth) = (0.0, 0);
        self.events.clear();
    }

    /// Writes down what `step` has made of the rope: it now goes from node `tip` straight to `a`.
    #[inline]
    pub(super) fn see(&mut self, chains: &Chains, tip: u32, a: DVec2, step: usize) {
        let node = chains.node(tip);
        self.max_length = self.max_length.max(node.length + node.at.distance(a));
        if self.held[self.held.len() - 1].stamp != node.stamp {
            self.change(chains, tip, step as u32);
            self.max_depth = self.max_depth.max(node.depth);
        }
    }

    /// Unwraps what the rope no longer touches and wraps what is new. O(contacts that are not the same nodes as
    /// before).
    fn change(&mut self, chains: &Chains, tip: u32, step: u32) {
        // A node that is still the same has the same path to it.
        let mut node = tip;
        let is_same = |h: &Held, n: &Node| h.stamp == n.stamp;
        while !self.held.get(chains.node(node).depth as usize).is_some_and(|h| is_same(h, chains.node(node))) {
            self.fresh.push(node);
            node = chains.node(node).prior;
        }
        // Another node may be the same contact, left and come back to.
        let mut kept = chains.node(node).depth as usize + 1;
        while let (Some(&node), Some(h)) = (self.fresh.last(), self.held.get_mut(kept)) {
            let n = chains.node(node);
            if (h.vertex, h.side) != (n.vertex, n.side) {
                break;
            }
            h.stamp = n.stamp;
            kept += 1;
            self.fresh.pop();
        }
        let unwraps = self.held.drain(kept..).rev();
        self.events.extend(unwraps.map(|h| Event { step, kind: EventKind::Unwrap, vertex: h.vertex, side: h.side }));
        for node in self.fresh.drain(..).rev() {
            let h = held(chains.node(node));
            self.held.push(h);
            self.events.push(Event { step, kind: EventKind::Wrap, vertex: h.vertex, side: h.side });
        }
    }

    /// The record of the finished trace; takes the events.
    pub(super) fn record(&mut self, model: &Model, trace: &SettledTrace) -> TraceRecord {
        let a = trace.points()[trace.points().len() - 1];
        let mut rope = Rope::new(model.anchor());
        for h in &self.held[1..] {
            rope.push(h.vertex, model.vertices()[h.vertex as usize], h.side);
        }
        let taut = rope.taut(a);
        TraceRecord {
            trace: trace.id(),
            status: if trace.breaks_rules() { Status::Violation } else { Status::Ok },
            steps: trace.steps() as u64,
            length: rope.length(a),
            max_length: self.max_length,
            depth: taut.len() as u32,
            max_depth: self.max_depth,
            wraps: taut.iter().map(|c| (c.at, c.side)).collect(),
            pull: rope.pull(a),
            events: std::mem::take(&mut self.events),
        }
    }
}

fn held(node: &Node) -> Held {
    Held { vertex: node.vertex, side: node.side, stamp: node.stamp }
}
