//! The classes of ropes in a scene: its cuts, and which of them a rope passes over.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec2;

use super::Class;
use super::angle::{Direction, by_angle};
use super::components::components;
use crate::geometry::{TracePoint, between, left_of, orient};
use crate::rope::{Event, EventKind, Rope, Side, Status, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;
use crate::visibility::Visibility;

/// An obstacle and its cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// The obstacle's number: the lowest of its wall ends' numbers. Walls are one obstacle if they hang together: by
    /// common ends, or because they touch or cross.
    pub obstacle: u32,
    /// Where the cut starts, from where it goes straight up: the highest of the obstacle's wall ends, and of several
    /// the rightmost.
    pub at: DVec2,
    /// What the scene's file calls it: the label of the first of its wall ends that has one.
    pub label: Option<String>,
}

/// Tells the classes of the ropes of a model apart.
///
/// Obstacles are walls that hang together and about which ropes from the model's anchor can be wound. Each has a cut, a
/// ray straight up from its highest wall end through whatever lies above. A rope's word says over which cuts it passes,
/// in order, and is reduced: what goes over a cut and at once back over it goes over none. All is decided by the exact
/// signs of input points; a rope that touches a cut's wall end passes it on the side that its contact says.
///
/// Memory for the cuts. See the [room](super) for an example.
pub struct Classes {
    /// From left to right, and straight above each other from the top down: the higher cut counts as left of the lower
    /// one.
    cuts: Vec<Cut>,
    model: Arc<Model>,
    start: Option<Start>,
}

/// The walls at an anchor that stands on some.
struct Start {
    /// Their directions counter-clockwise from the cut that may start there, each with the side that begins there.
    walls: Vec<(DVec2, u32)>,
    /// Whether several sides are free.
    several: bool,
    /// The obstacle whose cut starts there.
    cut: Option<u32>,
}

/// A point of a rope.
pub(super) type Node = (DVec2, Option<Side>);

impl Classes {
    /// Finds the obstacles of `model` and their cuts. O(n log n + pairs of walls whose boxes meet).
    ///
    /// Where walls cross at a point that no f64 names, or coordinates span more than 140 binary orders of magnitude,
    /// obstacles that the anchor cannot reach may have cuts too: words may then be longer than needed, but they tell
    /// the same classes apart.
    pub fn new(model: &Arc<Model>) -> Self {
        let (vertices, labels) = (model.vertices(), model.scene().labels());
        let mut highest = BTreeMap::<u32, (DVec2, u32)>::new();
        let mut named = BTreeMap::<u32, String>::new();
        for (v, obstacle) in (0..).zip(components(model)) {
            if let Some(label) = labels.get(v as usize).copied().flatten() {
                named.entry(obstacle).or_insert_with(|| label.to_owned());
            }
            let at = vertices[v as usize];
            let best = highest.entry(obstacle).or_insert((at, v));
            if (at.y, at.x) > (best.0.y, best.0.x) {
                *best = (at, v);
            }
        }
        // Ropes can be wound about an obstacle only if they get to its highest wall end from outside, and then they can
        // turn there.
        let listed = Visibility::new(model).map(|seen| seen.only_required().listed());
        let is_needed = |v: u32| listed.as_ref().is_none_or(|listed| listed.binary_search(&v).is_ok());
        let needed = highest.into_iter().filter(|&(_, (_, v))| is_needed(v));
        let cut = |(obstacle, (at, _))| Cut { obstacle, at, label: named.remove(&obstacle) };
        let mut cuts: Vec<Cut> = needed.map(cut).collect();
        cuts.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(b.at.y.total_cmp(&a.at.y)));
        let mut classes = Classes { cuts, model: model.clone(), start: None };
        classes.start = classes.start();
        classes
    }

    /// The model in which they are.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The obstacles about which ropes can be wound, from left to right by where their cuts start.
    pub fn cuts(&self) -> &[Cut] {
        &self.cuts
    }

    /// The class of a rope that is tied at the model's anchor and goes on from its last contact to `end`.
    /// O(contacts log obstacles + obstacles in the columns over which the rope's legs go).
    pub fn of(&self, rope: &Rope, end: TracePoint) -> Class {
        let contacts = rope.contacts().iter().map(|contact| (contact.at, Some(contact.side)));
        self.of_nodes(&self.tied(contacts), end)
    }

    /// The class of a trace's rope at its end, with the events of its `record` by an engine that promises those of the
    /// reference; `None` if the trace crosses a wall. O(events), and as [`of`](Self::of).
    ///
    /// # Panics
    ///
    /// If an event has a vertex that the model does not have, or unwraps an empty rope.
    pub fn of_record(&self, trace: &SettledTrace, record: &TraceRecord) -> Option<Class> {
        if record.status == Status::Violation {
            return None;
        }
        let mut nodes = self.tied(std::iter::empty());
        record.events.iter().for_each(|event| self.play(&mut nodes, event));
        Some(self.of_nodes(&nodes, trace.point(trace.points().len() - 1)))
    }

    /// Makes an event happen to a rope.
    pub(super) fn play(&self, nodes: &mut Vec<Node>, event: &Event) {
        match event.kind {
            EventKind::Wrap => nodes.push((self.model.vertices()[event.vertex as usize], Some(event.side))),
            EventKind::Unwrap => {
                assert!(nodes.len() > 1, "an unwrap follows a wrap");
                nodes.pop();
            }
        }
    }

    pub(super) fn tied(&self, contacts: impl Iterator<Item = Node>) -> Vec<Node> {
        std::iter::once((self.model.anchor(), None)).chain(contacts).collect()
    }

    /// The class of a rope from the anchor, the first of `nodes`, over its contacts to `end`.
    fn of_nodes(&self, nodes: &[Node], end: TracePoint) -> Class {
        let mut class = self.begin(nodes, end);
        (2..=nodes.len()).for_each(|n| self.reach(&mut class, &nodes[..n]));
        self.finish(&mut class, nodes, end);
        class
    }

    /// The letters from where the rope comes to the last node but one to where it comes to the last.
    pub(super) fn reach(&self, class: &mut Class, nodes: &[Node]) {
        let [.., (from, side), (to, to_side)] = *nodes else { return };
        if let (Some(side), Some(obstacle)) = (side, self.cut_at(from)) {
            pass(class, obstacle, from, nodes[nodes.len() - 3].0, Direction::Towards(to), side);
        }
        // The contacts on one leg came together and lie on one side.
        self.leg(class, from, to, |_| to_side.unwrap_or(Side::Right));
    }

    /// The letters from where the rope comes to the last node to its end.
    pub(super) fn finish(&self, class: &mut Class, nodes: &[Node], end: TracePoint) {
        let [.., (from, side)] = *nodes else { return };
        if let (Some(side), Some(obstacle), Some(on)) = (side, self.cut_at(from), goes_to(from, end)) {
            pass(class, obstacle, from, nodes[nodes.len() - 2].0, on, side);
        }
        let side = |v: DVec2| if left_of(from, v, end) { Side::Right } else { Side::Left };
        self.leg(class, from, end.at, side);
        if let (Some(hair), Some(obstacle), true) = (end.hair, self.cut_at(end.at), end.at != from) {
            // It stops before it has passed, so the way round is less than half a turn, and on the side on which a rope
            // would pass that leaves the wall end on the other.
            arrive(class, obstacle, end.at, from, Direction::Hair(hair), side(end.at));
        }
    }

    /// The letters of a straight leg, but for those of the wall ends at its ends. `side` says on which side of it a
    /// wall end lies that it touches.
    fn leg(&self, class: &mut Class, from: DVec2, to: DVec2, side: impl Fn(DVec2) -> Side) {
        let (low, high) = (from.x.min(to.x), from.x.max(to.x));
        let begin = self.cuts.partition_point(|cut| cut.at.x < low);
        // A cut lies a little to the right of its wall end: it is passed by a leg that starts straight above that, not
        // by one that ends there from the left.
        let end = begin + self.cuts[begin..].partition_point(|cut| cut.at.x < high || (low == high && cut.at.x == low));
        let mut pass_by = |cut: &Cut| {
            let at = cut.at;
            if at == from || at == to {
                return;
            }
            let left = orient(from, to, at);
            if low == high || left == 0.0 {
                if left == 0.0 && between(from, to, at) {
                    pass(class, cut.obstacle, at, from, Direction::Towards(to), side(at));
                }
            } else if from.x < to.x && left < 0.0 {
                class.push(cut.obstacle, -1);
            } else if from.x > to.x && left > 0.0 {
                class.push(cut.obstacle, 1);
            }
        };
        if from.x < to.x || (low == high && from.y > to.y) {
            self.cuts[begin..end].iter().for_each(&mut pass_by);
        } else {
            self.cuts[begin..end].iter().rev().for_each(&mut pass_by);
        }
    }

    /// The obstacle whose cut starts at `at`. O(log obstacles).
    fn cut_at(&self, at: DVec2) -> Option<u32> {
        // Adding zero turns a negative zero into the positive one that wall ends have.
        let at = at + DVec2::ZERO;
        let order = |cut: &Cut| cut.at.x.total_cmp(&at.x).then(at.y.total_cmp(&cut.at.y));
        self.cuts.binary_search_by(order).ok().map(|i| self.cuts[i].obstacle)
    }
}

/// In which direction a rope goes on from its last contact, at `from`; `None` where it stops right there.
fn goes_to(from: DVec2, end: TracePoint) -> Option<Direction> {
    if end.at != from { Some(Direction::Towards(end.at)) } else { end.hair.map(Direction::Hair) }
}

/// The letter of a rope that goes at least half way round `at`, from where it comes to where it goes on, with `at` on
/// that side.
fn pass(class: &mut Class, obstacle: u32, at: DVec2, from: DVec2, on: Direction, side: Side) {
    match (side, by_angle(at, on, Direction::Towards(from))) {
        // Counter-clockwise, so that it comes over the cut when the angle falls back. Straight back is all the way.
        (Side::Left, Ordering::Less | Ordering::Equal) => class.push(obstacle, 1),
        (Side::Right, Ordering::Greater | Ordering::Equal) => class.push(obstacle, -1),
        _ => {}
    }
}

/// The letter of a rope that goes at most half way round `at`, and ends there in that direction.
fn arrive(class: &mut Class, obstacle: u32, at: DVec2, from: DVec2, end: Direction, side: Side) {
    match (side, by_angle(at, end, Direction::Towards(from))) {
        (Side::Left, Ordering::Less) => class.push(obstacle, 1),
        (Side::Right, Ordering::Greater) => class.push(obstacle, -1),
        _ => {}
    }
}

/// Where ropes start whose anchor stands on walls.
impl Classes {
    fn start(&self) -> Option<Start> {
        let (anchor, (sectors, solid)) = (self.model.anchor(), self.model.border()?);
        let towards = |p: DVec2| Direction::Towards(p);
        let mut walls: Vec<(DVec2, u32)> = sectors.towards.iter().copied().zip(0..).collect();
        walls.sort_by(|a, b| by_angle(anchor, towards(a.0), towards(b.0)));
        let free = solid.iter().filter(|&&solid| !solid).count();
        Some(Start { walls, several: free > 1, cut: self.cut_at(anchor) })
    }

    /// The class of a rope that has only just left the anchor.
    pub(super) fn begin(&self, nodes: &[Node], end: TracePoint) -> Class {
        let Some(start) = &self.start else { return Class::default() };
        let anchor = self.model.anchor();
        let to = match nodes.get(1) {
            Some(&(at, _)) => Some(Direction::Towards(at)),
            None => goes_to(anchor, end),
        };
        // A rope that has never left.
        let Some(to) = to else { return Class::default() };
        let order = |wall: &(DVec2, u32)| by_angle(anchor, Direction::Towards(wall.0), to);
        let before = match start.walls.binary_search_by(order) {
            Err(before) => before,
            // Along a wall: on its left, counter-clockwise of it, or on its right.
            Ok(wall) => {
                let is_left = match nodes.get(1) {
                    Some(&(_, side)) => side == Some(Side::Right),
                    None => left_of(anchor, start.walls[wall].0, end),
                };
                wall + usize::from(is_left)
            }
        };
        let count = start.walls.len();
        let side = start.walls[(before + count - 1) % count].1;
        let mut class = Class::starting(start.several.then_some(side));
        if let Some(obstacle) = start.cut
            && before == count
        {
            // Right of the cut that starts here. All start left of it.
            class.push(obstacle, -1);
        }
        class
    }
}
