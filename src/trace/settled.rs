//! A trace that is ready to be evaluated, and what can be wrong with one.

use std::borrow::Cow;

use glam::DVec2;

use crate::geometry::{Hair, Shown, TracePoint, higher, lower};
use crate::scene::Model;

/// What a trace does that a rope among solid walls cannot follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViolationKind {
    /// The step crosses a wall, or leaves one on which the trace stood to the side from which it did not come.
    Crosses,
    /// The step leads through the end of a wall from one side of the walls that meet there to another.
    SlipsThrough,
    /// The step leads from an anchor on the border of a solid into it.
    EntersSolid,
}

impl ViolationKind {
    fn verb(self) -> &'static str {
        match self {
            ViolationKind::Crosses => "crosses",
            ViolationKind::SlipsThrough => "slips between the walls at the end of",
            ViolationKind::EntersSolid => "leads from the anchor into the solid behind",
        }
    }
}

/// A step that breaks the small update condition: point k must be visible from point k-1, and point 0 from the anchor.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "trace {trace}, step {step}: the move from {} to {} {} wall {wall}, from {} to {}; each point must be visible from \
    the one before, the first from the anchor",
    Shown(*from), Shown(*to), kind.verb(), Shown(ends[0]), Shown(ends[1])
)]
pub struct Violation {
    /// The trace's number.
    pub trace: u64,
    /// The step: the move from point `step - 1` to point `step`; 0 is the move from the anchor to the first point.
    pub step: usize,
    /// What it does.
    pub kind: ViolationKind,
    /// Which wall, counted from 0.
    pub wall: usize,
    /// That wall's endpoints.
    pub ends: [DVec2; 2],
    /// Where the step starts; like all points in the scene's frame and unit.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
}

/// The steps of a trace that break the rules.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Broken {
    pub(super) first: Option<Violation>,
    /// Their numbers, each once and ascending when all are noted and [`sort`](Self::sort) was called.
    pub(super) steps: Vec<u32>,
}

impl Broken {
    /// Notes a violation. Keeps that of the earlier step and there that of the wall with the smaller number; of two
    /// kinds at one wall the one found first.
    pub(super) fn note(&mut self, found: Violation) {
        if self.first.is_none_or(|v| (found.step, found.wall) < (v.step, v.wall)) {
            self.first = Some(found);
        }
        // Most steps that cross one wall cross another: an obstacle's far side.
        if self.steps.last() != Some(&(found.step as u32)) {
            self.steps.push(found.step as u32);
        }
    }

    pub(super) fn sort(&mut self) {
        self.steps.sort_unstable();
        self.steps.dedup();
    }
}

/// A trace that is ready to be evaluated.
///
/// Its points are those of the trace, with the anchor before them (unless the trace starts there) and a point added
/// wherever a step passes through a vertex; of a [coarsened](SettledTrace::coarsened) one some are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct SettledTrace {
    pub(super) id: u64,
    pub(super) points: Vec<DVec2>,
    /// Indices of the points that are not the ends of steps, ascending.
    pub(super) added: Vec<u32>,
    /// The hairs by point index, ascending.
    pub(super) hairs: Vec<(u32, Hair)>,
    pub(super) broken: Broken,
    pub(super) bounds: (DVec2, DVec2),
    pub(super) coarse: Coarse,
    pub(super) walked: Walked,
}

/// What is known of a trace's steps as it was given or drawn, before any point was left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Walked {
    /// How many steps left the free end where it was.
    pub still: usize,
    /// How many steps of a random walk met a wall or the border of the scene as they were drawn first.
    pub met: usize,
    /// How a tether held a random walk back; `None` without one.
    pub held_back: Option<HeldBack>,
}

/// The steps of a random walk that its tether held back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct HeldBack {
    /// How many there are.
    pub steps: usize,
    /// The number of the first, counted from 1.
    pub first: Option<usize>,
}

impl HeldBack {
    /// Notes a step; they come in order.
    pub(crate) fn note(&mut self, step: usize) {
        self.steps += 1;
        self.first = self.first.or(Some(step));
    }
}

/// What became of a trace that was coarsened.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Coarse {
    /// The numbers of the steps that the trace's own points end, ascending; empty if all are there.
    pub used: Vec<u32>,
    /// How many steps of the trace as given leave the free end where it is.
    pub still: usize,
    /// How many longer steps were walked as given, since a wall is in their way.
    pub jumps: usize,
    /// How many steps break the rules among the walls that it was coarsened among.
    pub crossings: usize,
}

/// The lowest and the highest x and y of all points of all traces; `None` if there are no traces. O(traces).
pub fn bounds(traces: &[SettledTrace]) -> Option<(DVec2, DVec2)> {
    traces.iter().map(SettledTrace::bounds).reduce(|(l, h), (low, high)| (lower(l, low), higher(h, high)))
}

impl SettledTrace {
    /// A trace without hairs. Panics if it has no points.
    pub(super) fn new(id: u64, points: Vec<DVec2>, added: Vec<u32>, broken: Broken) -> Self {
        let first = points[0];
        let bounds = points.iter().fold((first, first), |(low, high), &p| (lower(low, p), higher(high, p)));
        SettledTrace {
            id,
            points,
            added,
            hairs: Vec::new(),
            broken,
            bounds,
            coarse: Coarse::default(),
            walked: Walked::default(),
        }
    }

    /// The same with what is known of its steps.
    #[must_use]
    pub(crate) fn with_walked(mut self, walked: Walked) -> Self {
        self.walked = walked;
        self
    }

    /// What was noted of its steps; nothing, if nothing was.
    pub(crate) fn walked(&self) -> Walked {
        self.walked
    }

    /// How many of its steps leave the free end where it is; of a [coarsened](Self::coarsened) one those of the trace
    /// as given. O(steps).
    pub fn still(&self) -> usize {
        if self.is_thinned() {
            return self.coarse.still;
        }
        self.ends().windows(2).filter(|pair| pair[0] == pair[1]).count()
    }

    /// The trace's number.
    pub fn id(&self) -> u64 {
        self.id
    }

    /// Where the points stand, those added included.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The lowest and the highest x and y of all points. O(1).
    pub fn bounds(&self) -> (DVec2, DVec2) {
        self.bounds
    }

    /// Whether every point is one of the trace's own and none stands on a vertex: the trace starts at the anchor and
    /// touches nothing. Then every point ends a step, that of its own number unless [points were left
    /// out](Self::is_thinned), and none has a hair.
    #[inline]
    pub fn is_plain(&self) -> bool {
        self.added.is_empty() && self.hairs.is_empty()
    }

    /// Point `i` with its hair. O(log hairs).
    #[inline]
    pub fn point(&self, i: usize) -> TracePoint {
        let hair = match self.hairs.as_slice() {
            [] => None,
            hairs => hairs.binary_search_by_key(&(i as u32), |h| h.0).ok().map(|h| hairs[h].1),
        };
        TracePoint { at: self.points[i], hair }
    }

    /// The step to which the move to point `i` belongs; 0 is the move from the anchor to the trace's first point. O(log
    /// points added).
    #[inline]
    pub fn step(&self, i: usize) -> usize {
        let own = match *self.added.as_slice() {
            [] => i,
            // The anchor, as for most traces that do not start there.
            [0] => i - usize::from(i > 0),
            ref added => i - added.partition_point(|&a| (a as usize) < i),
        };
        match self.coarse.used.as_slice() {
            [] => own,
            used => used[own] as usize,
        }
    }

    /// Whether point `i` is a point of the trace, so that a step ends there. O(log points added).
    #[inline]
    pub fn ends_step(&self, i: usize) -> bool {
        match *self.added.as_slice() {
            [] => true,
            [one] => one as usize != i,
            ref added => added.binary_search(&(i as u32)).is_err(),
        }
    }

    /// The number of the trace's steps: its points less one, those that were left out counted in.
    pub fn steps(&self) -> usize {
        match self.coarse.used.last() {
            Some(&last) => last as usize,
            None => (self.points.len() - self.added.len()).saturating_sub(1),
        }
    }

    /// Whether some of the trace's points were left out.
    pub fn is_thinned(&self) -> bool {
        !self.coarse.used.is_empty()
    }

    /// How many of the longer steps of a [coarsened](Self::coarsened) trace were walked point by point, as given, since
    /// they would have touched a wall.
    pub fn jumps(&self) -> usize {
        self.coarse.jumps
    }

    /// How many of the steps of a [coarsened](Self::coarsened) trace break the small update condition among the walls
    /// that it was coarsened among.
    pub fn crossings(&self) -> usize {
        self.coarse.crossings
    }

    /// Whether a step breaks the small update condition: of the trace as it was given, or as it was coarsened.
    pub fn breaks_rules(&self) -> bool {
        self.broken.first.is_some() || self.coarse.crossings > 0
    }

    /// Where the free end is after each step, step 0 being the move to the trace's first point. After steps that were
    /// left out it still is where it was after the one before. O(steps), or O(1) where the points are just that.
    pub fn ends(&self) -> Cow<'_, [DVec2]> {
        if self.is_plain() && !self.is_thinned() {
            return Cow::Borrowed(&self.points);
        }
        let own = (0..self.points.len()).filter(|&i| self.ends_step(i));
        let mut ends: Vec<DVec2> = Vec::with_capacity(self.steps() + 1);
        for i in own {
            if let Some(&last) = ends.last() {
                ends.resize(self.step(i), last);
            }
            ends.push(self.points[i]);
        }
        ends.into()
    }

    /// The first step that breaks the small update condition, if one does: of the trace as it was given, among the
    /// walls as they were.
    pub fn violation(&self) -> Option<&Violation> {
        self.broken.first.as_ref()
    }

    /// How many of the trace's steps break it, each counted once however many walls it crosses. O(1).
    pub fn violations(&self) -> usize {
        self.broken.steps.len()
    }
}

/// The violation of a step from `from` to `to`.
pub(super) fn violation(
    model: &Model,
    trace: u64,
    step: usize,
    kind: ViolationKind,
    wall: u32,
    [from, to]: [DVec2; 2],
) -> Violation {
    let wall = wall as usize;
    Violation { trace, step, kind, wall, ends: model.scene().ends(wall), from, to }
}
