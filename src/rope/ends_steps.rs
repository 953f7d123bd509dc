//! The rope after every step of both of its ends, out of a trace's one replay.

use std::borrow::Cow;

use glam::DVec2;

use super::ends_strain::EndsStraining;
use super::{EndsRecord, FreeRope, Friction, RopeStep, Rounds, Strain};
use crate::scene::{Centre, Model};
use crate::trace::{End, SettledEnds};

/// The rope after every step of a trace whose ends both move, in order: one more than it has steps.
///
/// O(points + events) in all, O(1) for each point and centre, and O(contacts) for each step; memory for one rope.
pub struct EndsSteps<'a> {
    trace: &'a SettledEnds,
    record: &'a EndsRecord,
    vertices: &'a [DVec2],
    /// Where the free end and the anchor are after every step.
    free: Cow<'a, [DVec2]>,
    anchor: Cow<'a, [DVec2]>,
    rope: FreeRope,
    /// How many of the events have happened.
    happened: usize,
    rounds: Vec<Rounds>,
    y_down: bool,
    /// Where friction is asked for.
    straining: Option<EndsStraining>,
    /// The settled point to which the free end goes next.
    point: usize,
    next: usize,
}

impl<'a> EndsSteps<'a> {
    /// Of `trace` in `model`, with the events of its `record`; turns of the free end are counted about each of
    /// `centres`.
    ///
    /// # Panics
    ///
    /// If a centre is no wall end of the scene; later on, if the events are not a rope's: a vertex that is not there,
    /// or an unwrap of an empty rope.
    pub fn new(model: &'a Model, trace: &'a SettledEnds, record: &'a EndsRecord, centres: &[Centre]) -> Self {
        let vertices = model.vertices();
        let rounds = centres.iter().map(|centre| Rounds::about(vertices[centre.vertex as usize])).collect();
        let [free, anchor] = [End::Free, End::Anchor].map(|end| trace.path(end).ends());
        let (rope, y_down) = (FreeRope::new(trace.start().into()), model.scene().y_down());
        let (happened, straining, point, next) = (0, None, 0, 0);
        EndsSteps { trace, record, vertices, free, anchor, rope, happened, rounds, y_down, straining, point, next }
    }

    /// As [`Steps::with_friction`](super::Steps::with_friction).
    #[must_use]
    pub fn with_friction(mut self, friction: Option<Friction>) -> Self {
        self.straining = friction.map(EndsStraining::new);
        self
    }

    /// As [`Steps::strain`](super::Steps::strain). Work is that of the free end, while the anchor rests. O(contacts).
    pub fn strain(&self) -> Option<Strain> {
        self.straining.as_ref().map(|straining| straining.look(&self.rope))
    }

    /// The rope after the next step, and where the anchor is then; `None` after the last.
    #[allow(clippy::should_implement_trait)] // what is counted about the centres is asked in between
    pub fn next(&mut self) -> Option<(RopeStep, DVec2)> {
        let step = self.next;
        let (at, anchor) = (*self.free.get(step)?, self.anchor[step]);
        let mut part = self.straining.as_ref().map(|straining| straining.begin(&self.rope, at));
        while let Some(event) = self.record.record.events.get(self.happened).filter(|e| e.step as usize <= step) {
            let (end, vertex) = (self.record.ends[self.happened], self.vertices[event.vertex as usize]);
            match (&mut self.straining, end) {
                (Some(straining), End::Free) => {
                    part.iter_mut().for_each(|part| straining.go_on(&self.rope, part, event.kind, vertex));
                }
                // By now the free end has come to the end of its step.
                (Some(straining), End::Anchor) => part.take().iter().for_each(|part| straining.end(&self.rope, part)),
                (None, _) => {}
            }
            self.rope.play(end, event, vertex);
            self.happened += 1;
        }
        if let (Some(straining), Some(part)) = (&mut self.straining, part) {
            straining.end(&self.rope, &part);
        }
        self.rope.stand(End::Free, at);
        self.rope.stand(End::Anchor, anchor);
        let path = self.trace.path(End::Free);
        while self.point < path.points().len() && path.step(self.point) <= step {
            let to = path.point(self.point);
            self.rounds.iter_mut().for_each(|rounds| rounds.go_on(to));
            self.point += 1;
        }
        self.next += 1;
        let (length, turns) = self.rope.measure();
        let (contacts, pull) = (self.rope.contacts().len() as u32, self.rope.pull(End::Free));
        Some((RopeStep { step: step as u64, at, length, contacts, turns, pull }, anchor))
    }

    /// As [`Steps::windings`](super::Steps::windings).
    pub fn windings(&self) -> impl Iterator<Item = i64> + use<'_, 'a> {
        self.rounds.iter().map(|rounds| if self.y_down { -rounds.whole() } else { rounds.whole() })
    }
}
