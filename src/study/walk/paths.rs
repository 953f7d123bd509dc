//! Shortest paths among walls.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::DVec2;

use super::links::{LEFT, Links, RIGHT, Sides};
use super::start::From;
use crate::scene::Model;
use crate::study::free_space::Place;
use crate::visibility::{Scratch, Visibility};

/// Finds shortest paths, keeping what it learns of the scene.
pub(super) struct Paths {
    model: Arc<Model>,
    links: Links,
}

/// Memory that searches share, one after the other. A state is a wall end with the side on which its walls lie: twice
/// the vertex, and 1 more for the right; the last one is the goal.
#[derive(Default)]
pub(super) struct Search {
    scratch: Scratch,
    /// How long the way to each state is, as far as is known.
    cost: Vec<f64>,
    /// The state before each; the number of states for none.
    before: Vec<u32>,
    /// The states to which a way is known.
    reached: Vec<u32>,
    /// On which sides one can leave each vertex straight to the goal.
    leaves: Vec<Sides>,
    /// States by the length of a path through them, at least. Lengths are compared by their bits, as they are not
    /// negative.
    open: BinaryHeap<Reverse<(u64, u32)>>,
}

impl Paths {
    pub(super) fn new(model: &Arc<Model>, visibility: Visibility) -> Self {
        Paths { model: model.clone(), links: Links::new(model, visibility) }
    }

    /// The shortest path from one point to another: both, with the wall ends between at which it bends, and perhaps
    /// some that it passes straight. `None` if there is none.
    ///
    /// By A* (Hart, Nilsson and Raphael, IEEE Trans. Syst. Sci. Cybern. 4, 1968) over the tangent visibility graph,
    /// whose links are made when they are needed first.
    pub(super) fn find(&self, from: From, to: Place, search: &mut Search) -> Option<Vec<DVec2>> {
        let start = from.at(&self.model);
        if self.model.is_clear(start, to.at) {
            return Some(vec![start, to.at]);
        }
        let vertices = self.model.vertices();
        let goal = 2 * vertices.len() as u32;
        search.start(vertices.len());
        let first = match from {
            From::Anchor => self.links.after_anchor(&mut search.scratch),
            From::Place(place) => self.links.after_place(place, &mut search.scratch),
        };
        let last = self.links.before_place(to, &mut search.scratch);
        for &(v, sides) in &last {
            search.leaves[v as usize] = sides;
        }
        let at = |state: u32| if state == goal { to.at } else { vertices[state as usize / 2] };
        for (v, sides) in first {
            let cost = start.distance(vertices[v as usize]);
            search.relax_sides(v, sides, cost, goal + 1, cost + vertices[v as usize].distance(to.at));
        }
        while let Some(Reverse((bound, state))) = search.open.pop() {
            if state == goal {
                break;
            }
            let here = at(state);
            let cost = search.cost[state as usize];
            if bound > (cost + here.distance(to.at)).to_bits() {
                // A shorter way was found since.
                continue;
            }
            let side = if state % 2 == 0 { LEFT } else { RIGHT };
            if search.leaves[state as usize / 2] & side != 0 {
                let whole = cost + here.distance(to.at);
                search.relax(goal, whole, state, whole);
            }
            let Search { scratch, .. } = search;
            for link in self.links.of(state / 2, scratch) {
                if link.leaves & side != 0 {
                    let there = vertices[link.to as usize];
                    let arrives = if link.slides { link.arrives & side } else { link.arrives };
                    let cost = cost + here.distance(there);
                    search.relax_sides(link.to, arrives, cost, state, cost + there.distance(to.at));
                }
            }
        }
        for (v, _) in last {
            search.leaves[v as usize] = 0;
        }
        if search.cost[goal as usize] == f64::INFINITY {
            return None;
        }
        let mut path = Vec::new();
        let mut state = goal;
        while state != goal + 1 {
            path.push(at(state));
            state = search.before[state as usize];
        }
        path.push(start);
        path.reverse();
        path.dedup();
        Some(path)
    }
}

impl Search {
    fn start(&mut self, vertices: usize) {
        let states = 2 * vertices + 1;
        self.cost.resize(states, f64::INFINITY);
        self.before.resize(states, 0);
        self.leaves.resize(vertices, 0);
        for state in self.reached.drain(..) {
            self.cost[state as usize] = f64::INFINITY;
        }
        self.open.clear();
    }

    /// Notes ways of length `cost` to both states of vertex `v`, as far as they are among `sides`.
    fn relax_sides(&mut self, v: u32, sides: Sides, cost: f64, before: u32, bound: f64) {
        for (side, state) in [(LEFT, 2 * v), (RIGHT, 2 * v + 1)] {
            if sides & side != 0 {
                self.relax(state, cost, before, bound);
            }
        }
    }

    fn relax(&mut self, state: u32, cost: f64, before: u32, bound: f64) {
        let known = &mut self.cost[state as usize];
        if cost < *known {
            if *known == f64::INFINITY {
                self.reached.push(state);
            }
            *known = cost;
            self.before[state as usize] = before;
            self.open.push(Reverse((bound.to_bits(), state)));
        }
    }
}

#[cfg(test)]
mod tests;
