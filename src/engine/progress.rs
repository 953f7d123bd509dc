//! One trace on its way: its rope, how far it has come, and its record so far.

use glam::DVec2;

use crate::rope::{Event, EventKind, Leg, Rope, Side, Status, Sweep, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The state of one trace's evaluation; made once a slot and reset for each trace.
pub(super) struct Progress {
    pub rope: Rope,
    /// The settled point at which the free end stands, or from which it moves on.
    pub at: usize,
    /// How far the leg from point `at` on has been swept.
    sweep: Sweep,
    max_length: f64,
    max_depth: u32,
    events: Vec<Event>,
    /// The wraps that the current leg can still have, and one more.
    wraps_left: usize,
    /// What a leg starts with.
    wraps_of_a_leg: usize,
}

impl Progress {
    pub(super) fn new() -> Self {
        Progress {
            rope: Rope::new(DVec2::ZERO),
            at: 0,
            sweep: Sweep::Start,
            max_length: 0.0,
            max_depth: 0,
            events: Vec::new(),
            wraps_left: 0,
            wraps_of_a_leg: 0,
        }
    }

    /// Stands at the start of `trace`.
    pub(super) fn start(&mut self, model: &Model, trace: &SettledTrace) {
        self.rope.reset(model.anchor());
        self.at = 0;
        self.sweep = Sweep::Start;
        self.max_length = 0.0;
        self.max_depth = 0;
        self.events.clear();
        self.wraps_of_a_leg = model.vertices().len() + 1;
        self.wraps_left = self.wraps_of_a_leg;
        self.look(trace);
    }

    /// Whether the free end stands at the trace's last point.
    pub(super) fn is_done(&self, trace: &SettledTrace) -> bool {
        self.at + 1 >= trace.points().len()
    }

    /// The next event on the leg from point `at`, applied to the rope; `None`, and on to the next point, when the leg
    /// has no more.
    #[inline]
    pub(super) fn next(
        &mut self,
        model: &Model,
        trace: &SettledTrace,
        candidates: impl IntoIterator<Item = u32>,
    ) -> Option<EventKind> {
        let leg = Leg { a0: trace.point(self.at), a1: trace.point(self.at + 1) };
        let event = match self.wraps_left {
            // A leg wraps no vertex twice. Only where a trace goes through walls can a rope turn more than half way
            // round a wall's end, and then the update may find no end.
            0 => {
                assert!(trace.breaks_rules(), "a leg that keeps to the rules wraps no vertex twice");
                None
            }
            _ => self.sweep.next(&mut self.rope, &leg, model.vertices(), candidates),
        };
        match event {
            Some((kind, vertex, side)) => {
                self.wraps_left -= usize::from(kind == EventKind::Wrap);
                self.note(trace, kind, vertex, side);
                Some(kind)
            }
            None => {
                self.end_leg(trace);
                None
            }
        }
    }

    /// Goes on to the next point: the leg has no more events.
    pub(super) fn end_leg(&mut self, trace: &SettledTrace) {
        self.wraps_left = self.wraps_of_a_leg;
        self.arrive(trace);
    }

    /// Wraps the rope round `vertex`, which stands at `at`: the next event of the leg from point `at`, in which the
    /// rope turns by `dir`. `None` if the leg has had all wraps that it can have.
    pub(super) fn wrap(&mut self, trace: &SettledTrace, vertex: u32, at: DVec2, dir: f64) -> Option<()> {
        self.wraps_left = self.wraps_left.checked_sub(1)?;
        let side = self.sweep.wrap(&mut self.rope, vertex, at, dir);
        self.note(trace, EventKind::Wrap, vertex, side);
        Some(())
    }

    /// Unwraps the rope from its pivot: as [`wrap`](Self::wrap). `None` if it has none, or cannot turn that way there.
    pub(super) fn unwrap(&mut self, trace: &SettledTrace, dir: f64) -> Option<()> {
        self.rope.contacts().last().filter(|c| c.side != Side::of(dir))?;
        let (vertex, side) = self.sweep.unwrap(&mut self.rope, dir)?;
        self.note(trace, EventKind::Unwrap, vertex, side);
        Some(())
    }

    /// Ends the leg on which the rope has turned, if it has, and goes on to point `to`, on the way to which nothing
    /// happens. No point on the way is further than `within` from the pivot. `None` if `to` lies behind.
    pub(super) fn go_to(&mut self, trace: &SettledTrace, to: usize, within: f64) -> Option<()> {
        if self.at < to && self.start_direction().is_some() {
            self.end_leg(trace);
        }
        if self.at < to {
            let from = self.at;
            let (length, _) = self.rope.base();
            // Most spans hold no rope that is longer than all before.
            let farthest = if length + within <= self.max_length {
                0.0
            } else {
                farthest(self.rope.pivot(), &trace.points()[from + 1..=to])
            };
            self.skip(trace, to, || farthest);
        }
        (self.at == to).then_some(())
    }

    /// How many events there are so far.
    pub(super) fn events(&self) -> usize {
        self.events.len()
    }

    /// The fewest contacts that the rope has had since there were `events` of those; then it had `contacts`.
    pub(super) fn fewest(&self, events: usize, contacts: usize) -> usize {
        let mut now = contacts;
        let after = self.events[events..].iter().map(|event| {
            now = if event.kind == EventKind::Wrap { now + 1 } else { now - 1 };
            now
        });
        after.fold(contacts, usize::min)
    }

    /// Writes an event of the leg from point `at` down.
    pub(super) fn note(&mut self, trace: &SettledTrace, kind: EventKind, vertex: u32, side: Side) {
        self.events.push(Event { step: trace.step(self.at + 1) as u32, kind, vertex, side });
    }

    /// Goes on to the next point.
    pub(super) fn arrive(&mut self, trace: &SettledTrace) {
        self.at += 1;
        self.sweep = Sweep::Start;
        self.look(trace);
    }

    /// Goes on to point `to`, on the way to which nothing happens and the free end never stands on the line of the
    /// unwrapping ray. `farthest` is the square of the greatest distance from the pivot on the way.
    pub(super) fn skip(&mut self, trace: &SettledTrace, to: usize, farthest: impl FnOnce() -> f64) {
        self.wraps_left = self.wraps_of_a_leg;
        if !trace.is_plain() {
            while self.at < to {
                self.arrive(trace);
            }
            return;
        }
        self.at = to;
        self.sweep = Sweep::Start;
        let (length, depth) = self.rope.base();
        // Rounded sums and square roots keep the order, so the furthest point has the longest rope.
        self.max_length = self.max_length.max(length + farthest().sqrt());
        self.max_depth = self.max_depth.max(depth);
    }

    /// The direction in which the rope's last leg points where it stands, if that is not at point `at` but on the way
    /// from there.
    pub(super) fn start_direction(&self) -> Option<DVec2> {
        match self.sweep {
            Sweep::Start => None,
            Sweep::After { x, y, .. } => Some(y - x),
        }
    }

    fn look(&mut self, trace: &SettledTrace) {
        if trace.ends_step(self.at) {
            let a = trace.points()[self.at];
            let (length, depth) = self.rope.measure(a);
            self.max_length = self.max_length.max(length);
            self.max_depth = self.max_depth.max(depth);
        }
    }

    /// The record of the finished trace; takes the events.
    pub(super) fn record(&mut self, trace: &SettledTrace) -> TraceRecord {
        let a = trace.points()[self.at];
        let taut = self.rope.taut(a);
        TraceRecord {
            trace: trace.id(),
            status: if trace.breaks_rules() { Status::Violation } else { Status::Ok },
            steps: trace.steps() as u64,
            length: self.rope.length(a),
            max_length: self.max_length,
            depth: taut.len() as u32,
            max_depth: self.max_depth,
            wraps: taut.iter().map(|c| (c.at, c.side)).collect(),
            pull: self.rope.pull(a),
            events: std::mem::take(&mut self.events),
        }
    }
}

/// The square of the greatest distance of `points` from `o`.
fn farthest(o: DVec2, points: &[DVec2]) -> f64 {
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let (blocks, rest) = points.as_chunks::<8>();
    let mut most = [0.0; 8];
    for block in blocks {
        for (most, p) in most.iter_mut().zip(block) {
            *most = greater(*most, p.distance_squared(o));
        }
    }
    rest.iter().map(|p| p.distance_squared(o)).chain(most).fold(0.0, greater)
}
