//! Many traces at once: each round, every active trace asks one query, a candidate pass answers them all, and the exact
//! update goes on among the candidates. Finished traces leave and waiting ones take their place.

use rayon::prelude::*;

use super::walk::Walk;
use super::{EngineError, Job};
use crate::candidates::{CandidatePass, Found, Frame, Query, ROOM, swept};
use crate::rope::{EventKind, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many legs the first window of a trace covers at most.
const FIRST_WINDOW: usize = 8;

/// Evaluates `traces` in rounds of `pass`, with windows of at most `window` legs.
pub(super) fn evaluate<P>(
    pass: &mut P,
    window: usize,
    traces: &[SettledTrace],
    job: &Job,
) -> Result<Vec<TraceRecord>, EngineError>
where
    P: CandidatePass,
    EngineError: From<P::Error>,
{
    let mut records: Vec<Option<TraceRecord>> = traces.iter().map(|_| None).collect();
    let mut waiting = traces.iter().enumerate();
    let (capacity, frame) = (pass.capacity(), *pass.frame());
    let mut slots: Vec<Slot<'_>> = waiting.by_ref().take(capacity).map(|t| Slot::new(pass.model(), t)).collect();
    let mut queries = vec![Query::default(); slots.len()];
    let mut found = vec![Found::default(); slots.len()];
    loop {
        job.go_on()?;
        // From the back, so that a slot moved into a gap has been looked at.
        for i in (0..slots.len()).rev() {
            while let Some(record) = slots[i].finished() {
                records[slots[i].number] = Some(record);
                match waiting.next() {
                    Some(next) => slots[i].take(pass.model(), next),
                    None => {
                        slots.swap_remove(i);
                        break;
                    }
                }
            }
        }
        if slots.is_empty() {
            break;
        }
        let (queries, found) = (&mut queries[..slots.len()], &mut found[..slots.len()]);
        let ask = |(slot, query): (&mut Slot<'_>, &mut Query)| *query = slot.ask(&frame, window);
        slots.par_iter_mut().zip(queries.par_iter_mut()).with_min_len(64).for_each(ask);
        pass.run(queries, found)?;
        job.count_tests((queries.len() * pass.model().vertices().len()) as u64);
        let model = pass.model();
        let advance = |(slot, found): (&mut Slot<'_>, &Found)| slot.advance(model, found);
        job.count(slots.par_iter_mut().zip(found.par_iter()).with_min_len(64).map(advance).sum());
    }
    Ok(records.into_iter().map(|r| r.expect("every trace was evaluated")).collect())
}

/// A place in the batch and the trace in it.
struct Slot<'a> {
    trace: &'a SettledTrace,
    /// The trace's place in the batch.
    number: usize,
    walk: Walk,
    /// How many legs the next query should cover.
    window: usize,
    /// The point to which the last query reaches.
    end: usize,
    /// The number of contacts when it was asked.
    depth: usize,
}

impl<'a> Slot<'a> {
    fn new(model: &Model, (number, trace): (usize, &'a SettledTrace)) -> Self {
        let mut slot = Slot { trace, number, walk: Walk::new(), window: 0, end: 0, depth: 0 };
        slot.take(model, (number, trace));
        slot
    }

    fn take(&mut self, model: &Model, (number, trace): (usize, &'a SettledTrace)) {
        (self.trace, self.number, self.window) = (trace, number, FIRST_WINDOW);
        self.walk.start(model, trace);
    }

    /// The record of a trace that is done.
    fn finished(&mut self) -> Option<TraceRecord> {
        self.walk.is_done(self.trace).then(|| self.walk.record(self.trace))
    }

    /// The query for what comes next; the trace is not done.
    fn ask(&mut self, frame: &Frame, window: usize) -> Query {
        let at = self.walk.at;
        let legs = self.window.min(window).min(self.trace.points().len() - 1 - at);
        self.depth = self.walk.rope.contacts().len();
        let swept = swept(frame, self.walk.rope.pivot(), &self.trace.points()[at..=at + legs]);
        self.end = at + swept.legs;
        swept.query
    }

    /// Goes on exactly as far as the candidates suffice, and returns by how many steps of the trace.
    fn advance(&mut self, model: &Model, found: &Found) -> usize {
        let start = self.walk.at;
        match found.candidates() {
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet what lies outside the swept
            // triangle.
            _ if self.trace.violation().is_some() => self.try_all(model),
            Some(candidates) => {
                self.follow(model, candidates);
                self.adapt(candidates.len(), self.end - start);
            }
            None if self.end - start > 1 => self.window = 1.max((self.end - start) / 4),
            // Too many for one leg.
            None => self.try_all(model),
        }
        self.trace.step(self.walk.at) - self.trace.step(start)
    }

    /// Plays the window's legs with all vertices, as the reference does.
    fn try_all(&mut self, model: &Model) {
        while self.walk.at < self.end {
            self.walk.next(model, self.trace, 0..model.vertices().len() as u32);
        }
    }

    /// Plays the window's legs. After wraps the pivot stays inside the swept triangle, which is convex and so holds all
    /// that the remaining legs can meet; an unwrap from the pivot that asked leads out of it.
    fn follow(&mut self, model: &Model, candidates: &[u32]) {
        while self.walk.at < self.end {
            let event = self.walk.next(model, self.trace, candidates.iter().copied());
            if event == Some(EventKind::Unwrap) && self.walk.rope.contacts().len() < self.depth {
                return;
            }
        }
    }

    /// Widens the windows while little is found, narrows them when much is.
    fn adapt(&mut self, found: usize, legs: usize) {
        if found > ROOM / 2 {
            self.window = 1.max(legs / 2);
        } else if found <= ROOM / 4 && legs == self.window {
            self.window *= 2;
        }
    }
}
