//! One rope whose ends both move, move by move.

use std::sync::Arc;

use glam::DVec2;

use super::ends::{About, drag, listed};
use super::live::check_move;
use super::{AdvanceError, LiveEvent};
use crate::candidates::Lists;
use crate::geometry::TracePoint;
use crate::rope::FreeRope;
use crate::scene::Model;
use crate::trace::End;

/// A rope that follows both of its ends, one straight move of either at a time.
///
/// The events and ropes are those of traces of the same moves whose anchor starts at that of the model. Moves that
/// touch walls are refused, as by [`LiveRope`](super::LiveRope).
///
/// ```
/// use tautline::engine::LiveEnds;
/// use tautline::scene::{Model, Scene};
/// use tautline::trace::End;
///
/// let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
/// let model = Model::new(scene, Some([0.0, -1.0].into()))?;
/// let mut rope = LiveEnds::new(model.into())?;
/// rope.advance(End::Free, [2.0, -1.0].into())?;
/// assert_eq!(rope.advance(End::Free, [2.0, 1.0].into())?.len(), 1);
/// // The anchor follows, the rope is free again, and the anchor goes round the wall's end too.
/// assert_eq!(rope.advance(End::Anchor, [1.5, -1.0].into())?.len(), 1);
/// assert!(rope.advance(End::Anchor, [3.0, 1.0].into())?.is_empty());
/// assert_eq!((rope.length(), rope.pull(End::Anchor)), (1.0, Some([-1.0, 0.0].into())));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LiveEnds {
    lists: Lists,
    rope: FreeRope,
    /// Of the last move.
    events: Vec<LiveEvent>,
    tried: Vec<u32>,
}

impl LiveEnds {
    /// A rope whose ends are both at the model's anchor. O(n log n) for n wall ends: what each pivot sees is found with
    /// the help of a triangulation.
    ///
    /// # Errors
    ///
    /// [`AdvanceError::Touches`] if the model's anchor is on a wall: ends that both move start off the walls.
    pub fn new(model: Arc<Model>) -> Result<Self, AdvanceError> {
        let at = model.anchor();
        if let Some(wall) = model.wall_at(at) {
            return Err(AdvanceError::touches(&model, wall, at, at));
        }
        let lists = Lists::new(model).after(0).anywhere();
        // Made now rather than in the first move.
        let _ = lists.keeps_all();
        let rope = FreeRope::new(TracePoint::from(at));
        Ok(LiveEnds { lists, rope, events: Vec::new(), tried: Vec::new() })
    }

    /// Moves an end straight to `to` and returns what happened to the rope there, in order; the sides are those that
    /// somebody sees who looks from the anchor to the free end. What it costs is said at
    /// [`LiveRope::advance`](super::LiveRope::advance); while the rope touches nothing, it is O(walls near the triangle
    /// of the move and the other end).
    ///
    /// # Errors
    ///
    /// [`AdvanceError`]: a move that touches a wall, and a coordinate that is not finite, too large or too small.
    /// Nothing has happened then.
    pub fn advance(&mut self, end: End, to: DVec2) -> Result<&[LiveEvent], AdvanceError> {
        check_move(self.lists.model(), self.at(end), to)?;
        self.events.clear();
        let LiveEnds { lists, rope, events, tried } = self;
        let mut find = |about: About, leg: [DVec2; 2], tried: &mut Vec<u32>| listed(lists, about, leg, tried);
        let each = |kind, vertex, side| events.push(LiveEvent { kind, vertex, side });
        drag(rope, end, to.into(), lists.model().vertices(), tried, &mut find, each);
        Ok(&self.events)
    }

    /// Where an end is.
    pub fn at(&self, end: End) -> DVec2 {
        self.rope.end(end).at
    }

    /// The rope, contacts passed straight included.
    pub fn rope(&self) -> &FreeRope {
        &self.rope
    }

    /// The taut rope's length, in the scene's unit. O(contacts).
    pub fn length(&self) -> f64 {
        self.rope.measure().0
    }

    /// The unit vector along which the rope pulls an end; `None` for a rope of no length. O(contacts).
    pub fn pull(&self, end: End) -> Option<DVec2> {
        self.rope.pull(end)
    }
}
