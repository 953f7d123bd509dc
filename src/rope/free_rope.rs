//! The rope whose ends both move: contacts come and go at either end.

use std::collections::VecDeque;

use glam::DVec2;

use super::stack::{is_straight, pull};
use super::{Event, EventKind, Leg, Side, Strand, Sweep};
use crate::geometry::{Stand, TracePoint};
use crate::trace::End;

/// A vertex on a rope whose ends both move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeContact {
    /// Which vertex of the scene.
    pub vertex: u32,
    /// Where it stands.
    pub at: DVec2,
    /// On which side of the rope it lies, looking from the anchor to the free end.
    pub side: Side,
}

/// A rope that is tied nowhere: its anchor moves as its free end does.
///
/// Seen from the end that moves it is the stack of contacts that a [`Rope`](super::Rope) is, and the update is the same
/// ([`Sweep`]). Every end counts as a hair off all lines through vertices ([`TracePoint::off_all_lines`]), and so off
/// those that legs of the other end turn about.
///
/// ```
/// use tautline::geometry::TracePoint;
/// use tautline::rope::{FreeRope, Side, Sweep};
/// use tautline::trace::End;
///
/// let at = |x: f64, y: f64| TracePoint::from(glam::DVec2::new(x, y));
/// let vertices = [glam::DVec2::new(1.0, 0.0)];
/// let mut rope = FreeRope::new(at(0.0, -1.0));
/// // The free end goes by below the vertex and up behind it, then the anchor goes up before it.
/// for (end, to) in [(End::Free, at(3.0, -1.0)), (End::Free, at(3.0, 1.0)), (End::Anchor, at(-1.0, 1.0))] {
///     let (mut sweep, leg) = (Sweep::Start, rope.leg(end, to));
///     while rope.next(end, &mut sweep, &leg, &vertices, [0]).is_some() {}
///     rope.arrive(end, &leg);
/// }
/// assert_eq!(rope.taut().iter().map(|c| (c.vertex, c.side)).collect::<Vec<_>>(), [(0, Side::Left)]);
/// assert_eq!(rope.measure(), (2.0 * 5f64.sqrt(), 1));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRope {
    /// From the anchor on.
    contacts: VecDeque<FreeContact>,
    anchor: TracePoint,
    free: TracePoint,
}

impl FreeRope {
    /// A rope of no length: both ends are at `at`, which is on no wall.
    pub fn new(at: TracePoint) -> Self {
        let at = at.off_all_lines();
        FreeRope { contacts: VecDeque::new(), anchor: at, free: at }
    }

    /// All contacts from the anchor on, those passed straight included.
    pub fn contacts(&self) -> impl ExactSizeIterator<Item = &FreeContact> {
        self.contacts.iter()
    }

    /// Where an end is.
    pub fn end(&self, end: End) -> TracePoint {
        match end {
            End::Free => self.free,
            End::Anchor => self.anchor,
        }
    }

    /// The vertex about which the leg of `end` turns, and where that is; no vertex where it is the other end.
    pub fn pivot(&self, end: End) -> (Option<u32>, DVec2) {
        match self.nth(end, 0) {
            Some(contact) => (Some(contact.vertex), contact.at),
            None => (None, self.end(end.other()).at),
        }
    }

    /// The straight move of `end` to `to`.
    pub fn leg(&self, end: End, to: TracePoint) -> Leg {
        Leg { a0: self.end(end), a1: to.off_all_lines() }
    }

    /// Applies the next event of a [`leg`](Self::leg) of `end` and returns it, or `None` when the leg has no more: what
    /// happens, to which vertex, and on which side that lies, looking from the anchor to the free end. The rest is as
    /// in [`Sweep::next`].
    pub fn next(
        &mut self,
        end: End,
        sweep: &mut Sweep<Stand>,
        leg: &Leg,
        vertices: &[DVec2],
        candidates: impl IntoIterator<Item = u32>,
    ) -> Option<(EventKind, u32, Side)> {
        let (kind, vertex, side) = sweep.next(&mut Seen { rope: self, end }, leg, vertices, candidates)?;
        Some((kind, vertex, seen(end, side)))
    }

    /// Puts `end` where a leg goes that has no more events.
    pub fn arrive(&mut self, end: End, leg: &Leg) {
        match end {
            End::Free => self.free = leg.a1,
            End::Anchor => self.anchor = leg.a1,
        }
    }

    /// Makes an event of `end` happen, whose vertex stands at `at`.
    ///
    /// # Panics
    ///
    /// If it is an unwrap of what is not the contact next to that end.
    pub(super) fn play(&mut self, end: End, event: &Event, at: DVec2) {
        let mut strand = Seen { rope: self, end };
        match event.kind {
            EventKind::Wrap => strand.push(event.vertex, at, seen(end, event.side)),
            EventKind::Unwrap => {
                let gone = strand.pop().map(|(vertex, _)| vertex);
                assert_eq!(gone, Some(event.vertex), "an unwrap follows its wrap");
            }
        }
    }

    /// Puts `end` there, whatever lies between.
    pub(super) fn stand(&mut self, end: End, at: DVec2) {
        let at = TracePoint::from(at).off_all_lines();
        match end {
            End::Free => self.free = at,
            End::Anchor => self.anchor = at,
        }
    }

    /// The taut rope: the contacts without those passed straight, and without those at which an end stands.
    /// O(contacts).
    pub fn taut(&self) -> Vec<FreeContact> {
        let mut taut = Vec::new();
        self.bends(|contact| taut.push(*contact));
        taut
    }

    /// The taut rope's length, in the scene's unit, summed from the anchor on, and the number of its turns.
    /// O(contacts).
    pub fn measure(&self) -> (f64, u32) {
        let (mut from, mut length, mut depth) = (self.anchor.at, 0.0, 0);
        self.bends(|contact| {
            length += from.distance(contact.at);
            from = contact.at;
            depth += 1;
        });
        (length + from.distance(self.free.at), depth)
    }

    /// The unit vector along which the rope pulls `end`; `None` when the rope has no length. O(contacts).
    pub fn pull(&self, end: End) -> Option<DVec2> {
        let taut = self.taut();
        let next = match end {
            End::Free => taut.last(),
            End::Anchor => taut.first(),
        };
        pull(next.map_or(self.end(end.other()).at, |contact| contact.at), self.end(end).at)
    }

    /// Calls `each` with the taut rope's contacts, from the anchor on.
    fn bends(&self, mut each: impl FnMut(&FreeContact)) {
        let (mut start, mut end) = (0, self.contacts.len());
        while end > 0 && self.contacts[end - 1].at == self.free.at {
            end -= 1;
        }
        while start < end && self.contacts[start].at == self.anchor.at {
            start += 1;
        }
        let mut prior = self.anchor.at;
        for i in start..end {
            let here = self.contacts[i].at;
            let next = if i + 1 < end { self.contacts[i + 1].at } else { self.free.at };
            if !is_straight(prior, here, next) {
                each(&self.contacts[i]);
            }
            prior = here;
        }
    }

    /// A contact, counted from an end on.
    fn nth(&self, end: End, n: usize) -> Option<&FreeContact> {
        match end {
            End::Free => self.contacts.len().checked_sub(n + 1).and_then(|i| self.contacts.get(i)),
            End::Anchor => self.contacts.get(n),
        }
    }
}

/// A side of the rope as it is called when looking towards `end` instead of the free end, and back.
fn seen(end: End, side: Side) -> Side {
    match end {
        End::Free => side,
        End::Anchor => side.shown(true),
    }
}

/// The rope as seen from one end.
struct Seen<'a> {
    rope: &'a mut FreeRope,
    end: End,
}

impl Seen<'_> {
    fn nth(&self, n: usize) -> Stand {
        match (self.rope.nth(self.end, n), self.end) {
            (Some(contact), _) => Stand::Vertex(contact.at),
            // Of the two ends' hairs those of the free end are the longer ones.
            (None, End::Free) => Stand::Shorter(self.rope.anchor),
            (None, End::Anchor) => Stand::Longer(self.rope.free),
        }
    }
}

impl Strand for Seen<'_> {
    type Pivot = Stand;

    fn pivot(&self) -> Stand {
        self.nth(0)
    }

    fn prior(&self) -> Stand {
        self.nth(1)
    }

    fn side(&self) -> Option<Side> {
        self.rope.nth(self.end, 0).map(|contact| seen(self.end, contact.side))
    }

    fn push(&mut self, vertex: u32, at: DVec2, side: Side) {
        let contact = FreeContact { vertex, at, side: seen(self.end, side) };
        match self.end {
            End::Free => self.rope.contacts.push_back(contact),
            End::Anchor => self.rope.contacts.push_front(contact),
        }
    }

    fn pop(&mut self) -> Option<(u32, Side)> {
        let contact = match self.end {
            End::Free => self.rope.contacts.pop_back(),
            End::Anchor => self.rope.contacts.pop_front(),
        }?;
        Some((contact.vertex, seen(self.end, contact.side)))
    }
}
