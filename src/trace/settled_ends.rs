//! Traces of ropes whose ends both move, settled.

use glam::DVec2;

use super::settled::Broken;
use super::{End, SettledTrace, Trace, Violation, settle};
use crate::geometry::{CoordinateFault, Shown, TracePoint, check_points};
use crate::scene::{AnchorError, Model};
use crate::words::plainly;

/// The paths of both ends of a rope, ready to be evaluated.
///
/// The rope starts straight from the anchor's first point to the free end's. In each step first the free end moves to
/// its next point, then the anchor to its.
#[derive(Debug, Clone, PartialEq)]
pub struct SettledEnds {
    free: SettledTrace,
    anchor: SettledTrace,
}

/// Why two paths are none of a rope's ends.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EndsFault {
    /// Not as many points for one end as for the other.
    #[error(
        "trace {trace}: the free end has {}, the anchor {anchor}; both move in every step, so give both as many: the \
         same point again where one rests",
        plainly(*free as u64, "point", "points")
    )]
    Lengths {
        /// The trace's number.
        trace: u64,
        /// How many points the free end has.
        free: usize,
        /// How many the anchor has.
        anchor: usize,
    },
    /// A point of the anchor's that exact arithmetic cannot take.
    #[error("trace {trace}, step {step}: the anchor's point {}: {fault}", Shown(*at))]
    Coordinate {
        /// The trace's number.
        trace: u64,
        /// The point's number.
        step: usize,
        /// The point.
        at: DVec2,
        /// What is wrong with it.
        fault: CoordinateFault,
    },
    /// An anchor that moves starts on a wall: of which side of the wall its rope comes would be anybody's guess.
    #[error(
        "trace {trace}: the anchor starts at {} on wall {wall}, from {} to {}; an anchor that moves must start off the \
        walls",
        Shown(*at), Shown(ends[0]), Shown(ends[1])
    )]
    OnWall {
        /// The trace's number.
        trace: u64,
        /// Where the anchor starts.
        at: DVec2,
        /// The wall, counted from 0.
        wall: usize,
        /// Its endpoints.
        ends: [DVec2; 2],
    },
}

/// Checks the paths of both ends of a rope against the walls of `model`, and settles on which side each passes the
/// walls that it touches, as [`settle()`] does. `free` is the trace of the free end, `anchor` has the points of the
/// anchor; where the model's rope is tied is of no matter.
///
/// O(points + walls near them), through the model's index.
///
/// # Errors
///
/// [`EndsFault`]: paths of different lengths, coordinates beyond the limits, and an anchor that moves but starts on a
/// wall.
///
/// # Panics
///
/// Where [`settle()`] does, about `free`.
///
/// ```
/// use tautline::scene::{Model, Scene};
/// use tautline::trace::{Trace, settle_ends};
/// let wall = [[-1.0, 0.0].into(), [1.0, 0.0].into()];
/// let model = Model::new(Scene::new([wall])?, Some([0.0, -1.0].into()))?;
/// let trace = Trace { id: 0, points: vec![[1.0, -1.0].into(), [2.0, 0.0].into()] };
/// let anchor = [[-1.0, -1.0].into(), [-2.0, 1.0].into()];
/// assert_eq!(settle_ends(&model, &trace, &anchor)?.violation(), None);
/// assert!(settle_ends(&model, &trace, &anchor[1..]).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn settle_ends(model: &Model, free: &Trace, anchor: &[DVec2]) -> Result<SettledEnds, EndsFault> {
    let trace = free.id;
    if anchor.len() != free.points.len() {
        return Err(EndsFault::Lengths { trace, free: free.points.len(), anchor: anchor.len() });
    }
    if let Err((step, fault)) = check_points(anchor) {
        return Err(EndsFault::Coordinate { trace, step, at: anchor[step], fault });
    }
    let at = anchor[0];
    let tied = model.tied(at).map_err(|error| match error {
        AnchorError::Coordinate(fault) => EndsFault::Coordinate { trace, step: 0, at, fault },
        AnchorError::Missing => unreachable!("the anchor is given"),
    })?;
    if anchor.iter().any(|&p| p != at)
        && let Some(wall) = model.wall_at(at)
    {
        let wall = wall as usize;
        return Err(EndsFault::OnWall { trace, at, wall, ends: model.scene().ends(wall) });
    }
    let anchor = Trace { id: trace, points: anchor.to_vec() };
    Ok(SettledEnds { free: settle(&tied, free), anchor: settle(&tied, &anchor) })
}

impl SettledEnds {
    /// The path of an end. Both start where the anchor does.
    pub fn path(&self, end: End) -> &SettledTrace {
        match end {
            End::Free => &self.free,
            End::Anchor => &self.anchor,
        }
    }

    /// Where the anchor starts, and with it the rope.
    pub fn start(&self) -> DVec2 {
        self.anchor.points[0]
    }

    /// Whether the anchor stays where it is: then the rope is that of a trace with a fixed anchor. O(points).
    pub fn is_tied(&self) -> bool {
        self.anchor.points.iter().all(|&p| p == self.start())
    }

    /// The number of steps. In step 0 the free end moves from where the anchor starts to its first point.
    pub fn steps(&self) -> usize {
        self.free.steps()
    }

    /// How many steps leave both ends where they are. O(steps).
    pub fn still(&self) -> usize {
        let [free, anchor] = [self.free.ends(), self.anchor.ends()];
        free.windows(2).zip(anchor.windows(2)).filter(|(a, b)| a[0] == a[1] && b[0] == b[1]).count()
    }

    /// The first step that breaks the rules, and the end that it moves; the free end's where both do.
    pub fn violation(&self) -> Option<(End, &Violation)> {
        let first = |end| self.path(end).violation().map(|violation| (end, violation));
        [End::Free, End::Anchor].into_iter().filter_map(first).min_by_key(|(_, violation)| violation.step)
    }

    /// Whether a step breaks the rules.
    pub fn breaks_rules(&self) -> bool {
        self.free.breaks_rules() || self.anchor.breaks_rules()
    }

    /// One trace with the same rope: from where the anchor is after `step` back to where it started, and from there
    /// along the free end's path up to that step. It is a trace of a rope that is tied where the anchor is then: what
    /// other methods make of it checks this one. O(points).
    ///
    /// # Panics
    ///
    /// If a step breaks the rules, or there is no such step.
    pub fn doubled(&self, step: usize) -> SettledTrace {
        assert!(!self.breaks_rules(), "the trace keeps to the rules");
        assert!(step <= self.free.steps(), "a trace has its own steps");
        let until = |path: &SettledTrace| (0..path.points.len()).take_while(|&i| path.step(i) <= step).count();
        // Both start at the same point, on no wall if the anchor moves.
        let back = if self.is_tied() { 1..1 } else { 1..until(&self.anchor) };
        let back = back.rev().map(|i| self.anchor.point(i));
        let on = (0..until(&self.free)).map(|i| self.free.point(i));
        let points: Vec<TracePoint> = back.chain(on).collect();
        let places = points.iter().map(|p| p.at).collect();
        let mut doubled = SettledTrace::new(self.free.id, places, Vec::new(), Broken::default());
        doubled.hairs = (0..).zip(&points).filter_map(|(i, p)| Some((i, p.hair?))).collect();
        doubled
    }
}
