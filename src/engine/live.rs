//! One rope, step by step as its free end moves: for loops that cannot wait for the end of a trace.

use std::sync::Arc;

use glam::DVec2;

use super::follow::{follow, leaves};
use crate::candidates::Lists;
use crate::geometry::{CoordinateFault, Shown, TracePoint, check_point};
use crate::rope::{EventKind, Leg, Rope, Side};
use crate::scene::Model;

/// A rope that follows its free end, one straight move at a time.
///
/// The events and ropes are those of a trace of the same points that starts at the anchor. A move that touches a wall
/// is refused: on which side it passes would depend on the next one.
///
/// ```
/// use tautline::engine::LiveRope;
/// use tautline::scene::{Model, Scene};
///
/// let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
/// let model = Model::new(scene, Some([0.0, -1.0].into()))?;
/// let mut rope = LiveRope::new(model.into());
/// rope.advance([2.0, -1.0].into())?;
/// assert_eq!(rope.advance([2.0, 1.0].into())?.len(), 1);
/// // Towards the wall's end.
/// let pull = rope.pull().unwrap();
/// assert!((pull - glam::DVec2::new(-1.0, -1.0).normalize()).length() < 1e-15);
/// // Down through the wall: refused, and the rope is as it was.
/// assert!(rope.advance([-0.5, -1.0].into()).is_err());
/// assert_eq!(rope.free_end(), [2.0, 1.0].into());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LiveRope {
    lists: Lists,
    rope: Rope,
    at: DVec2,
    /// Of the last move.
    events: Vec<LiveEvent>,
}

/// A wrap or an unwrap in a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LiveEvent {
    /// Wrap or unwrap.
    pub kind: EventKind,
    /// Which vertex of the scene.
    pub vertex: u32,
    /// The side on which it lies.
    pub side: Side,
}

/// Why the free end cannot move there. The rope is as it was.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum AdvanceError {
    /// A wall is in the way, or stands where the move passes.
    #[error(
        "the move from {} to {} touches wall {wall}, from {} to {}; keep off the walls",
        Shown(*from), Shown(*to), Shown(ends[0]), Shown(ends[1])
    )]
    Touches {
        /// One of the walls touched, counted from 0.
        wall: usize,
        /// Its endpoints.
        ends: [DVec2; 2],
        /// Where the move starts.
        from: DVec2,
        /// Where it would end.
        to: DVec2,
    },
    /// The goal is no point to compute with exactly.
    #[error("the free end cannot move to {}: {fault}", Shown(*to))]
    Coordinate {
        /// Where the move would end.
        to: DVec2,
        /// What is wrong with it.
        fault: CoordinateFault,
    },
}

impl LiveRope {
    /// A rope whose free end is at the model's anchor. O(n log n) for n wall ends: what each pivot sees is found with
    /// the help of a triangulation.
    pub fn new(model: Arc<Model>) -> Self {
        let lists = Lists::new(model).after(0);
        // Made now rather than in the first move.
        let _ = lists.keeps_all();
        let anchor = lists.model().anchor();
        LiveRope { lists, rope: Rope::new(anchor), at: anchor, events: Vec::new() }
    }

    /// Moves the free end straight to `to` and returns what happened to the rope, in order. O(vertices that the pivot
    /// sees within reach of the move) for each event and once more; the list of those is made when a pivot comes up
    /// first.
    ///
    /// # Errors
    ///
    /// [`AdvanceError`]: a move that touches a wall, and a coordinate that is not finite, too large or too small.
    /// Nothing has happened then.
    pub fn advance(&mut self, to: DVec2) -> Result<&[LiveEvent], AdvanceError> {
        let (model, from) = (self.lists.model(), self.at);
        check_move(model, from, to)?;
        self.events.clear();
        if to == from {
            return Ok(&self.events);
        }
        let leg = Leg { a0: leaves(model, from, to), a1: TracePoint::from(to) };
        let events = &mut self.events;
        follow(&self.lists, &mut self.rope, &leg, |kind, vertex, side| events.push(LiveEvent { kind, vertex, side }));
        self.at = to;
        Ok(&self.events)
    }

    /// Where the free end is.
    pub fn free_end(&self) -> DVec2 {
        self.at
    }

    /// The rope, contacts passed straight included.
    pub fn rope(&self) -> &Rope {
        &self.rope
    }

    /// The taut rope's length, in the scene's unit. O(1).
    pub fn length(&self) -> f64 {
        self.rope.length(self.free_end())
    }

    /// The unit vector along which the rope pulls the free end; `None` for a rope of no length. O(1).
    pub fn pull(&self) -> Option<DVec2> {
        self.rope.pull(self.free_end())
    }
}

/// Whether an end may move straight from `from` to `to`; it may always stay.
pub(super) fn check_move(model: &Model, from: DVec2, to: DVec2) -> Result<(), AdvanceError> {
    check_point(to).map_err(|fault| AdvanceError::Coordinate { to, fault })?;
    if from != to
        && let Some(wall) = model.touched(from, to)
    {
        return Err(AdvanceError::touches(model, wall, from, to));
    }
    Ok(())
}

impl AdvanceError {
    pub(super) fn touches(model: &Model, wall: u32, from: DVec2, to: DVec2) -> Self {
        let wall = wall as usize;
        AdvanceError::Touches { wall, ends: model.scene().ends(wall), from, to }
    }
}
