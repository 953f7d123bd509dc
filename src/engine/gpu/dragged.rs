//! A trace that is taken along on the device: what comes back of it is written down, and what the device was not
//! certain of is decided here.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec2;

use crate::candidates::{Grid, Lists, Simd};
use crate::engine::hand::Hand;
use crate::engine::windows::Windows;
use crate::engine::{Job, WINDOW};
use crate::gpu::{CHUNK, Lane, Note, RIGHT, STACK, STOPPED, Stacked, UNKNOWN, UNWRAPPED};
use crate::rope::{Contact, Side, TraceRecord};
use crate::scene::{Model, Pivot};
use crate::trace::SettledTrace;

/// How many legs the CPU takes at most where the device was not certain, before that is asked again.
const LEGS_OF_DOUBT: usize = 1;

/// How many contacts a trace brings to the device that has none of them. A rope that unwraps more of them stops once.
const CONTACTS: usize = 8;

/// What all slots share.
pub(super) struct Shared<'a> {
    pub lists: &'a Lists,
    pub grid: &'a Grid,
    simd: Simd,
    pub job: &'a Job,
    traces: &'a [SettledTrace],
    /// The traces that go to the device.
    easy: &'a [usize],
    begun: AtomicUsize,
    /// Whether the device told what cannot be.
    pub astray: AtomicBool,
}

impl<'a> Shared<'a> {
    /// What slots share that take the traces of the numbers `easy` along.
    pub(super) fn new(
        lists: &'a Lists,
        grid: &'a Grid,
        job: &'a Job,
        traces: &'a [SettledTrace],
        easy: &'a [usize],
    ) -> Self {
        let (begun, astray) = (AtomicUsize::new(0), AtomicBool::new(false));
        Shared { lists, grid, simd: Simd::detected(), job, traces, easy, begun, astray }
    }

    pub(super) fn hand(&self) -> Hand<'a> {
        Hand::new(self.lists, WINDOW, self.simd)
    }

    /// The next trace that nobody has begun.
    pub(super) fn next(&self) -> Option<(usize, &'a SettledTrace)> {
        let number = *self.easy.get(self.begun.fetch_add(1, Ordering::Relaxed))?;
        Some((number, &self.traces[number]))
    }
}

/// A place in a half, and the trace in it.
pub(super) struct Slot<'a> {
    windows: Windows,
    trace: Option<(usize, &'a SettledTrace)>,
    /// Where its piece begins in the half's points, and from which to which of the trace's points it goes.
    first: usize,
    from: usize,
    last: usize,
    /// How the device is to know it.
    lane: Lane,
    /// How many events there were when the device had all contacts that the lane counts; `None` if it has none.
    noted: Option<usize>,
    /// Its last contacts, if the device does not have them, and how many of its stack lie below.
    stack: Vec<Stacked>,
    below: usize,
}

/// The device told of a trace what cannot be.
struct Astray;

impl<'a> Slot<'a> {
    pub(super) fn new() -> Self {
        Slot {
            windows: Windows::new(),
            trace: None,
            first: 0,
            from: 0,
            last: 0,
            lane: Lane::default(),
            noted: None,
            stack: Vec::new(),
            below: 0,
        }
    }

    fn at(&self) -> usize {
        self.windows.at()
    }

    /// Whether the trace has not come to the end of its piece.
    pub(super) fn is_on_its_way(&self) -> bool {
        self.trace.is_some() && self.at() < self.last
    }

    /// Goes on to the next trace where one is done, and returns the record of that with its number.
    pub(super) fn next_trace(&mut self, shared: &Shared<'a>) -> Option<(usize, TraceRecord)> {
        let done = self.trace.and_then(|(number, trace)| Some((number, self.windows.finished(trace)?)));
        if done.is_some() || self.trace.is_none() {
            self.trace = shared.next();
            self.noted = None;
            if let Some((_, trace)) = self.trace {
                self.start(shared, trace);
            }
        }
        done
    }

    /// Stands at the start of `trace`, or where its first leg ends if that comes from the anchor: there the rope has no
    /// direction yet, and no ray that it crosses lies before the free end.
    fn start(&mut self, shared: &Shared<'_>, trace: &SettledTrace) {
        let model = shared.lists.model();
        self.windows.start(model, trace);
        if let [first, second, ..] = *trace.points()
            && first == model.anchor()
        {
            self.windows.progress.skip(trace, 1, || second.distance_squared(first));
            shared.job.count(trace.step(1));
        }
    }

    /// Gives it a piece of its trace of at most `most` legs, at place `first` of the half's points, and returns how
    /// many chunks these take; nothing if it has no trace.
    pub(super) fn take_piece(&mut self, first: usize, most: usize) -> Option<usize> {
        let (_, trace) = self.trace?;
        let from = self.at();
        (self.first, self.from, self.last) = (first, from, (from + most).min(trace.points().len() - 1));
        Some(self.chunks())
    }

    /// Takes its piece back, for which there is no room.
    pub(super) fn put_back(&mut self) {
        self.last = self.at();
    }

    /// How many chunks its piece takes.
    pub(super) fn chunks(&self) -> usize {
        (self.last - self.from + 1).div_ceil(CHUNK)
    }

    /// The points of its piece.
    pub(super) fn points(&self) -> &'a [DVec2] {
        self.trace.map_or(&[], |(_, trace)| &trace.points()[self.from..=self.last])
    }

    /// Its lane, with the stack of this `number`, where the half's points begin at `first`.
    pub(super) fn lane(&self, first: u32, number: usize) -> Lane {
        let at = |point: usize| first + (self.first + point - self.from) as u32;
        Lane { point: at(self.at()), last: at(self.last), number: number as u32, ..self.lane }
    }

    /// Its last contacts, if the device does not have them, and how many of its stack lie below.
    pub(super) fn take_stack(&mut self) -> (usize, Vec<Stacked>) {
        (self.below, std::mem::take(&mut self.stack))
    }

    /// What its rope turns about.
    pub(super) fn pivot(&self, model: &Model) -> Pivot {
        self.windows.pivot(model)
    }

    /// Takes the trace as far as the device took it, and a bit further where that was not certain of what comes next.
    pub(super) fn collect(
        &mut self,
        hand: &mut Hand<'_>,
        shared: &Shared<'_>,
        first: u32,
        lane: &Lane,
        notes: &[Note],
    ) {
        let Some((_, trace)) = self.trace else { return };
        let before = trace.step(self.at());
        if self.write_down(shared, trace, first, lane, notes).is_err() {
            shared.astray.store(true, Ordering::Relaxed);
            return;
        }
        shared.job.count(trace.step(self.at()) - before);
        self.lane = Lane { events: 0, farthest: 0.0, ..*lane };
        self.noted = Some(self.windows.progress.events());
        if lane.does == STOPPED {
            self.go_on(hand, shared, LEGS_OF_DOUBT);
            self.position(hand, shared);
        }
    }

    /// Writes down what the device noted.
    fn write_down(
        &mut self,
        shared: &Shared<'_>,
        trace: &SettledTrace,
        first: u32,
        lane: &Lane,
        notes: &[Note],
    ) -> Result<(), Astray> {
        let model = shared.lists.model();
        let (begins, from, last) = (first as usize + self.first, self.from, self.last);
        let at = |point: u32| {
            let at = (point as usize).checked_sub(begins).ok_or(Astray)? + from;
            if at <= last { Ok(at) } else { Err(Astray) }
        };
        let progress = &mut self.windows.progress;
        for note in notes.get(..lane.events as usize).ok_or(Astray)? {
            progress.go_to(trace, at(note.point)?, shared.grid.at_most(note.farthest)).ok_or(Astray)?;
            let dir = if note.clockwise == 0 { 1.0 } else { -1.0 };
            if note.vertex == UNWRAPPED {
                progress.unwrap(trace, dir).ok_or(Astray)?;
            } else {
                let to = *model.vertices().get(note.vertex as usize).ok_or(Astray)?;
                progress.wrap(trace, note.vertex, to, dir).ok_or(Astray)?;
            }
        }
        progress.go_to(trace, at(lane.point)?, shared.grid.at_most(lane.farthest)).ok_or(Astray)?;
        let contacts = progress.rope.contacts();
        let pivot = model.pivot(contacts.last().map(|c| c.vertex));
        let knows = lane.depth as usize + lane.deeper as usize;
        if lane.pivot as usize == pivot.index() && knows == contacts.len() { Ok(()) } else { Err(Astray) }
    }

    /// Takes the trace on on the CPU until it stands where the device can go on, or is at the end of its piece.
    pub(super) fn position(&mut self, hand: &mut Hand<'_>, shared: &Shared<'_>) {
        while self.is_on_its_way() && shared.job.go_on().is_ok() {
            match self.place(hand, shared) {
                Ok(()) => return,
                Err(legs) => self.go_on(hand, shared, legs),
            }
        }
    }

    /// Takes the trace to the end of its piece on the CPU.
    pub(super) fn finish_piece(&mut self, hand: &mut Hand<'_>, shared: &Shared<'_>) {
        // What it would have brought is not sent.
        self.noted = None;
        while self.is_on_its_way() && shared.job.go_on().is_ok() {
            self.go_on(hand, shared, WINDOW);
        }
    }

    /// Takes the trace on on the CPU by at most `most` legs, or to the next event.
    fn go_on(&mut self, hand: &mut Hand<'_>, shared: &Shared<'_>, most: usize) {
        if let Some((_, trace)) = self.trace.filter(|_| self.is_on_its_way()) {
            let before = self.at();
            hand.go_on(&mut self.windows, trace, most.min(self.last - before), shared.job);
            let steps = trace.step(self.at()) - trace.step(before);
            shared.job.count(steps);
            shared.job.count_doubts(steps);
        }
    }

    /// Finds where the device can go on; if it cannot, how many legs the CPU should take at most.
    fn place(&mut self, hand: &mut Hand<'_>, shared: &Shared<'_>) -> Result<(), usize> {
        let (model, grid, job) = (shared.lists.model(), shared.grid, shared.job);
        let progress = &self.windows.progress;
        let (rope, contacts) = (&progress.rope, progress.rope.contacts());
        let Some((_, trace)) = self.trace.filter(|_| progress.start_direction().is_none()) else {
            return Err(LEGS_OF_DOUBT);
        };
        let pivot = model.pivot(contacts.last().map(|c| c.vertex));
        let list = hand.list(pivot, f64::INFINITY, job).ok_or(WINDOW)?;
        let fan = list.fan(model, rope.pivot()).filter(|fan| grid.tells(fan)).ok_or(WINDOW)?;
        let low = fan.locate(trace.points()[progress.at] - rope.pivot()).ok_or(LEGS_OF_DOUBT)?;
        let way_low = contacts.last().map_or(UNKNOWN, |contact| {
            let (ray, on_it) = fan.goes_on(model, rope.prior(), rope.pivot());
            if on_it && contact.side == Side::Left { fan.before(ray) as u32 } else { ray as u32 }
        });
        // The device has the lower ones that are as they were.
        let lowest = self.lane.deeper as usize;
        let kept = self.noted.map_or(0, |noted| progress.fewest(noted, lowest + self.lane.depth as usize));
        let has = kept > lowest && contacts.len() - lowest <= STACK;
        let (mut deeper, mut below) =
            if has { (lowest, kept - lowest) } else { (contacts.len().saturating_sub(CONTACTS), 0) };
        self.stack.clear();
        for (i, contact) in contacts.iter().enumerate().skip(deeper + below).rev() {
            let (prior, from) = match i.checked_sub(1) {
                Some(i) => (Pivot::at_vertex(contacts[i].vertex), contacts[i].at),
                None => (model.pivot(None), model.anchor()),
            };
            let way = contact.at - from;
            let list = hand.list(prior, f64::INFINITY, job);
            let Some(ray) = list.and_then(|list| list.fan(model, from)?.ray_along(way)) else {
                (deeper, below) = (i + 1, 0);
                break;
            };
            let side = if contact.side == Side::Right { RIGHT } else { 0 };
            self.stack.push(Stacked { vertex: contact.vertex | side, ray: ray as u32, way: grid.way(way) });
        }
        self.stack.reverse();
        let back = |c: &Contact| if c.side == Side::Right { 1.0 } else { -1.0 };
        (self.below, self.noted) = (below, Some(progress.events()));
        self.lane = Lane {
            pivot: pivot.index() as u32,
            low: low as u32,
            depth: (contacts.len() - deeper) as u32,
            deeper: deeper as u32,
            way: grid.way(rope.pivot() - rope.prior()),
            back: contacts.last().map_or(0.0, back),
            way_low,
            ..Lane::default()
        };
        Ok(())
    }
}
