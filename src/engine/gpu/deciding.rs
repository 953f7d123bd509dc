//! A trace on a device that decides: the CPU only pushes and pops what an answer names.

use std::sync::Arc;

use glam::{DVec2, Vec2};

use super::rounds::{Asked, Astray, Player, Shared, Tools};
use crate::candidates::{List, Lists, Window};
use crate::engine::Phase;
use crate::engine::progress::Progress;
use crate::engine::windows::FIRST_WINDOW;
use crate::fast::{Answer, MOST_LEGS, NOBODY, NOTHING, Question, UNWRAP, rounded};
use crate::gpu::Deciding;
use crate::rope::{EventKind, Side, TraceRecord};
use crate::scene::{Model, Pivot};
use crate::trace::SettledTrace;

/// How long the hair is by which a point that stands on a vertex is displaced, in the frame's unit: 2^-14. The turn
/// that comes with it, 2^-5 of that, is still 32 times what f32 rounds away across the whole scene.
const HAIR: f64 = 1.0 / (1 << 14) as f64;

/// How far a trace has come, and the window that was asked for last.
pub(super) struct Hasty {
    progress: Progress,
    /// How many legs the next window should have.
    width: usize,
    /// How many the last one has.
    legs: usize,
    /// Set while the rope has turned on the leg from where it stands.
    turned: Option<Turned>,
    /// How many of the last contacts were wrapped on that leg.
    wraps: usize,
    /// The window's points where some of them are displaced.
    plucked: Vec<DVec2>,
    /// The window's points, relative to the pivot.
    points: Vec<[f32; 2]>,
}

/// How the rope has turned on a leg.
#[derive(Clone, Copy)]
struct Turned {
    /// The direction in which its last leg points.
    start: DVec2,
    /// The side to which it turns.
    to: Side,
    /// The vertex that it has left, if the event was an unwrap.
    left: Option<u32>,
}

impl Player for Hasty {
    type Kernel = Deciding;

    fn new() -> Self {
        let (plucked, points) = (Vec::new(), Vec::new());
        Hasty { progress: Progress::new(), width: FIRST_WINDOW, legs: 0, turned: None, wraps: 0, plucked, points }
    }

    fn start(&mut self, model: &Model, trace: &SettledTrace) {
        self.progress.start(model, trace);
        (self.width, self.turned, self.wraps) = (FIRST_WINDOW, None, 0);
    }

    fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord> {
        self.progress.is_done(trace).then(|| self.progress.record(trace))
    }

    fn at(&self) -> usize {
        self.progress.at
    }

    fn ask(&mut self, shared: &Shared<'_>, trace: &SettledTrace, tools: &mut Tools) -> Option<Asked<Deciding>> {
        let lists = shared.lists;
        let (model, frame, rope) = (lists.model(), lists.frame(), &self.progress.rope);
        let (o, contact) = (rope.pivot(), rope.contacts().last());
        let pivot = model.pivot(contact.map(|c| c.vertex));
        // Where a trace crosses walls, the rope can meet anything. Elsewhere lists are made at once, since all answers
        // have to come from the device.
        let list = shared.job.time(Phase::Queries, || match trace.breaks_rules() {
            true => Some(Arc::clone(lists.all())),
            false => lists.of(pivot, f64::INFINITY),
        })?;
        let query = shared.job.time(Phase::Queries, || {
            let first = self.progress.at;
            let most = self.width.min(shared.window).min(MOST_LEGS).min(trace.points().len() - 1 - first);
            let mut points = &trace.points()[first..=first + most];
            if !trace.is_plain() {
                let hair = frame.unscaled(HAIR);
                self.plucked.clear();
                self.plucked.extend((first..=first + most).map(|i| trace.point(i).plucked(hair)));
                points = &self.plucked;
            }
            let start = self.turned.map(|t| t.start);
            let window = Window::fold(shared.simd, o, start, points, &mut tools.slopes);
            self.legs = window.map_or(1, |w| w.legs);
            self.points.clear();
            self.points.extend(points[..=self.legs].iter().map(|&p| rounded(frame.way(o, p)).to_array()));
            let squared = match window {
                Some(window) => window.squared,
                None => points[..2].iter().map(|p| p.distance_squared(o)).fold(0.0, f64::max),
            };
            Question {
                origin: if list.is_of_any() { frame.place(o).as_vec2() } else { Vec2::ZERO },
                way: rounded(frame.way(rope.prior(), o)),
                back: contact.map_or(0.0, |c| -c.side.sign() as f32),
                start: rounded(frame.way(DVec2::ZERO, start.unwrap_or_default())),
                dir: self.turned.map_or(0.0, |t| t.to.sign() as f32),
                wrapped: self.turned.is_some_and(|t| t.left.is_none()).into(),
                barred: self.turned.and_then(|t| list.rank_of(t.left?)).unwrap_or(NOBODY),
                count: list.within(squared) as u32,
                legs: self.legs as u32,
                ..Question::wedge(frame, window.as_ref())
            }
        });
        Some(Asked { pivot, key: lists.key(pivot, &list), list, query })
    }

    fn points(&self) -> &[[f32; 2]] {
        &self.points
    }

    fn answered(
        &mut self,
        shared: &Shared<'_>,
        trace: &SettledTrace,
        (list, question): (&List, &Question),
        answer: &Answer,
        _: &mut Tools,
    ) -> Result<(), Astray> {
        let (first, legs) = (self.progress.at, self.legs);
        if answer.leg == NOTHING {
            self.go_to(trace, first + legs);
            if legs == self.width {
                self.width = (2 * legs).min(MOST_LEGS);
            }
            return Ok(());
        }
        let leg = answer.leg as usize;
        if leg >= legs {
            return Err(Astray);
        }
        self.go_to(trace, first + leg);
        self.width = FIRST_WINDOW.max(leg);
        if answer.place == UNWRAP {
            self.unwrap(trace, Side::of(answer.dir.into()))
        } else {
            let vertex = list.vertex(answer.place.rank(question.first)).ok_or(Astray)?;
            self.wrap(shared.lists.model(), trace, vertex, Side::of(answer.dir.into()));
            Ok(())
        }
    }

    /// Relative to the pivot where the list is its own, so that what is near is as exact as f32 can say.
    fn coordinates(lists: &Lists, pivot: Pivot, list: &List) -> Vec<[f32; 2]> {
        if list.is_of_any() {
            return list.coordinates().collect();
        }
        let (model, frame) = (lists.model(), lists.frame());
        let at = model.position(pivot);
        list.numbers().map(|v| rounded(frame.way(at, model.vertices()[v as usize])).to_array()).collect()
    }
}

impl Hasty {
    /// Goes on to point `to`, on the way to which nothing happens.
    fn go_to(&mut self, trace: &SettledTrace, to: usize) {
        if to == self.progress.at {
            return;
        }
        let (pivot, prior) = (self.progress.rope.pivot(), self.progress.rope.prior());
        let (mut farthest, mut on_line) = (0.0_f64, false);
        for &p in &trace.points()[self.progress.at + 1..to] {
            farthest = farthest.max(p.distance_squared(pivot));
            on_line |= (pivot - prior).perp_dot(p - pivot) == 0.0;
        }
        // On that line the rope passes the pivot straight, which only an exact look tells.
        if on_line && pivot != prior {
            (self.progress.at + 1..to).for_each(|_| self.progress.arrive(trace));
        } else if to > self.progress.at + 1 {
            self.progress.skip(trace, to - 1, || farthest);
        }
        // Exactly, so that the greatest length is no less than that at the end.
        self.progress.arrive(trace);
        (self.turned, self.wraps) = (None, 0);
    }

    /// Wraps the rope round a vertex on the leg from where it stands. A leg wraps no vertex twice: where rounding has
    /// it go round in circles, the rest of the leg is given up.
    fn wrap(&mut self, model: &Model, trace: &SettledTrace, vertex: u32, side: Side) {
        let Progress { rope, at, .. } = &mut self.progress;
        let wrapped = &rope.contacts()[rope.contacts().len() - self.wraps..];
        if wrapped.iter().any(|c| c.vertex == vertex) {
            let next = *at + 1;
            return self.go_to(trace, next);
        }
        let (from, to) = (rope.pivot(), model.vertices()[vertex as usize]);
        rope.push(vertex, to, side);
        self.progress.note(trace, EventKind::Wrap, vertex, side);
        self.turned = Some(Turned { start: to - from, to: side, left: None });
        self.wraps += 1;
    }

    /// Unwraps the pivot on the leg from where the rope stands. The rope turns one way on a leg, so what it wraps there
    /// it does not unwrap there; so a leg comes to an end.
    fn unwrap(&mut self, trace: &SettledTrace, to: Side) -> Result<(), Astray> {
        let (from, prior) = (self.progress.rope.pivot(), self.progress.rope.prior());
        let contact = self.progress.rope.pop().filter(|_| self.wraps == 0).ok_or(Astray)?;
        self.progress.note(trace, EventKind::Unwrap, contact.vertex, contact.side);
        self.turned = Some(Turned { start: from - prior, to, left: Some(contact.vertex) });
        Ok(())
    }
}
