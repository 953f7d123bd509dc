//! Along which straight lines a shortest path can go from wall end to wall end, and on which sides it passes them.
//!
//! A shortest path bends only at wall ends, round the walls that meet there: those all lie on one side of it, which
//! then is the side of the bend. So a path is a way through pairs of a wall end and a side, and a line belongs to it
//! only if all walls at both its ends lie on the sides named, or along it. This rules out slipping through between
//! walls that meet.

use std::ops::ControlFlow::{Break, Continue};
use std::sync::{Arc, OnceLock};

use glam::DVec2;

use crate::geometry::{between, higher, lower, opposite, orient};
use crate::scene::Model;
use crate::study::free_space::Place;
use crate::visibility::{Scratch, Visibility};

/// On which sides of a line all walls at one of its ends lie: bit 0 left, bit 1 right, both if all lie along it.
pub(super) type Sides = u8;

/// The walls lie left of the path, or right of it.
pub(super) const LEFT: Sides = 1;
pub(super) const RIGHT: Sides = 2;

/// A line from a wall end to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    pub(super) to: u32,
    /// The sides at the wall end where it starts.
    pub(super) leaves: Sides,
    /// The sides at the one where it ends.
    pub(super) arrives: Sides,
    /// Whether it runs along a wall, so that it starts and ends on the same side.
    pub(super) slides: bool,
}

/// The links of all wall ends, found when they are asked for first.
pub(super) struct Links {
    model: Arc<Model>,
    visibility: Visibility,
    /// Points towards which walls go from each vertex: those that end there and those that pass through.
    walls: Vec<OnceLock<Box<[DVec2]>>>,
    links: Vec<OnceLock<Box<[Link]>>>,
    /// Whether walls cross, so that what seems visible may not be.
    has_crossings: bool,
}

impl Links {
    pub(super) fn new(model: &Arc<Model>, visibility: Visibility) -> Self {
        let has_crossings = (0..model.scene().walls().len()).any(|wall| {
            let [a, b] = model.scene().ends(wall);
            is_crossed(model, a, b)
        });
        let n = model.vertices().len();
        Links {
            model: model.clone(),
            visibility,
            walls: std::iter::repeat_with(OnceLock::new).take(n).collect(),
            links: std::iter::repeat_with(OnceLock::new).take(n).collect(),
            has_crossings,
        }
    }

    /// The links that start at vertex `v`.
    pub(super) fn of(&self, v: u32, scratch: &mut Scratch) -> &[Link] {
        self.links[v as usize].get_or_init(|| {
            let at = self.model.vertices()[v as usize];
            let mut seen = Vec::new();
            self.visibility.look(self.model.pivot(Some(v)), scratch, &mut seen);
            let link = |to: u32| {
                let there = self.model.vertices()[to as usize];
                let leaves = self.sides(v, [at, there]);
                let slides = self.walls(v).iter().any(|&end| orient(at, there, end) == 0.0 && !between(end, at, there));
                let link = Link { to, leaves, arrives: self.sides(to, [at, there]), slides };
                (link.leaves != 0 && link.arrives != 0 && self.is_visible(at, there)).then_some(link)
            };
            seen.into_iter().filter_map(link).collect()
        })
    }

    /// The wall ends to which a path can go straight from the anchor, with the sides there.
    pub(super) fn after_anchor(&self, scratch: &mut Scratch) -> Vec<(u32, Sides)> {
        let mut seen = Vec::new();
        self.visibility.look(self.model.pivot(None), scratch, &mut seen);
        let at = self.model.anchor();
        seen.into_iter().filter_map(|v| self.seen_from(at, v, false)).collect()
    }

    /// The wall ends to which a path can go straight from a place, with the sides there.
    pub(super) fn after_place(&self, place: Place, scratch: &mut Scratch) -> Vec<(u32, Sides)> {
        self.look_from(place, scratch, false)
    }

    /// The wall ends from which a path can go straight to a place, with the sides there.
    pub(super) fn before_place(&self, place: Place, scratch: &mut Scratch) -> Vec<(u32, Sides)> {
        self.look_from(place, scratch, true)
    }

    fn look_from(&self, place: Place, scratch: &mut Scratch, back: bool) -> Vec<(u32, Sides)> {
        let mut seen = Vec::new();
        self.visibility.look_from(place.at, place.triangle, scratch, &mut seen);
        seen.into_iter().filter_map(|v| self.seen_from(place.at, v, back)).collect()
    }

    /// Vertex `v` with the sides of the line to it from `at`, or the other way.
    fn seen_from(&self, at: DVec2, v: u32, back: bool) -> Option<(u32, Sides)> {
        let there = self.model.vertices()[v as usize];
        let sides = self.sides(v, if back { [there, at] } else { [at, there] });
        (sides != 0 && self.is_visible(at, there)).then_some((v, sides))
    }

    /// On which sides of a line the walls at vertex `v` lie.
    fn sides(&self, v: u32, [from, to]: [DVec2; 2]) -> Sides {
        self.walls(v).iter().fold(LEFT | RIGHT, |sides, &end| {
            let side = orient(from, to, end);
            sides & !if side > 0.0 { RIGHT } else { 0 } & !if side < 0.0 { LEFT } else { 0 }
        })
    }

    fn walls(&self, v: u32) -> &[DVec2] {
        self.walls[v as usize].get_or_init(|| {
            let at = self.model.vertices()[v as usize];
            let near = self.model.index().near(at, at).map(|wall| self.model.scene().ends(wall as usize));
            let through = near.filter(|&[a, b]| orient(a, b, at) == 0.0);
            through.flatten().filter(|&end| end != at).collect()
        })
    }

    /// Whether a vertex that was seen is visible indeed.
    fn is_visible(&self, a: DVec2, b: DVec2) -> bool {
        !self.has_crossings || !is_crossed(&self.model, a, b)
    }
}

/// Whether a wall lies properly across the way from `a` to `b`.
fn is_crossed(model: &Model, a: DVec2, b: DVec2) -> bool {
    let visit = |_, [u, v]: [DVec2; 2]| {
        let across = opposite(orient(u, v, a), orient(u, v, b)) && opposite(orient(a, b, u), orient(a, b, v));
        if across { Break(()) } else { Continue(()) }
    };
    model.index().visit(lower(a, b), higher(a, b), visit).is_break()
}
