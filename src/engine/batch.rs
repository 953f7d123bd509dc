//! Many traces at once on a device: each round, every active trace asks one query, the device answers them all, and the
//! exact update goes on among the candidates. Finished traces leave and waiting ones take their place. Two half-batches
//! take turns, so that one is on the device while the other is on the CPU.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use super::course::Course;
use super::{EngineError, Job, Phase};
use crate::candidates::{Found, List, Lists, Query, ROOM, Simd, Slopes};
use crate::gpu::{GpuPass, HALVES};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;
use crate::visibility::Scratch;

/// What all slots share.
struct Shared<'a, 'm> {
    lists: &'a Lists<'m>,
    window: usize,
    simd: Simd,
    traces: &'a [SettledTrace],
    /// How many traces have been begun.
    begun: AtomicUsize,
    /// Whether the device named a vertex that it was not given.
    astray: AtomicBool,
    tools: Mutex<Vec<Tools>>,
    job: &'a Job,
}

/// Evaluates `traces` in rounds of `pass`, with windows of at most `window` legs.
pub(super) fn evaluate(
    pass: &mut GpuPass,
    lists: &Lists<'_>,
    window: usize,
    traces: &[SettledTrace],
    job: &Job,
) -> Result<Vec<TraceRecord>, EngineError> {
    let (begun, astray) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (simd, tools) = (Simd::detected(), Mutex::default());
    let shared = Shared { lists, window, simd, traces, begun, astray, tools, job };
    let slots = pass.capacity().min(traces.len().div_ceil(HALVES));
    let mut halves: [Half<'_>; HALVES] = std::array::from_fn(|_| Half::new(slots));
    let mut records: Vec<Option<TraceRecord>> = traces.iter().map(|_| None).collect();
    let done = play(pass, &shared, &mut halves, &mut records);
    // Rounds that are still on their way after an early end: so that the next evaluation finds the device free.
    for (half, Half { found, queries, .. }) in halves.iter_mut().enumerate() {
        let _ = pass.collect(half, &mut found[..queries.len()]);
    }
    done?;
    Ok(records.into_iter().map(|r| r.expect("every trace was evaluated")).collect())
}

fn play<'a>(
    pass: &mut GpuPass,
    shared: &Shared<'a, '_>,
    halves: &mut [Half<'a>],
    records: &mut [Option<TraceRecord>],
) -> Result<(), EngineError> {
    while halves.iter().any(|half| !half.slots.is_empty()) {
        for (number, half) in halves.iter_mut().enumerate() {
            shared.job.go_on()?;
            half.collect(pass, number, shared.job)?;
            half.advance(shared, records);
            shared.job.go_on()?;
            if shared.astray.load(Ordering::Relaxed) {
                return Err(pass.device().failed("it named a vertex that it was not given").into());
            }
            half.send(pass, number, shared);
            if shared.job.is_timed() {
                // Alone on the machine, so that each phase's time is its own.
                shared.job.time(Phase::Kernel, || pass.wait(number))?;
            }
        }
    }
    Ok(())
}

/// A half-batch and its round.
struct Half<'a> {
    slots: Vec<Slot<'a>>,
    /// The places of the slots' lists and the slots' numbers, in one number, so that sorting puts equal lists together.
    order: Vec<u64>,
    queries: Vec<Query>,
    found: Vec<Found>,
}

impl<'a> Half<'a> {
    fn new(slots: usize) -> Self {
        Half {
            slots: (0..slots).map(|_| Slot::new()).collect(),
            order: Vec::with_capacity(slots),
            queries: Vec::with_capacity(slots),
            found: vec![Found::default(); slots],
        }
    }

    fn collect(&mut self, pass: &mut GpuPass, number: usize, job: &Job) -> Result<(), EngineError> {
        let found = &mut self.found[..self.queries.len()];
        Ok(job.time(Phase::Readback, || pass.collect(number, found))?)
    }

    /// Takes every slot as far as the answers allow, and on to its next query. Slots without a trace leave.
    fn advance(&mut self, shared: &Shared<'a, '_>, records: &mut [Option<TraceRecord>]) {
        let found = &self.found;
        self.slots.par_iter_mut().with_min_len(64).for_each_init(
            || Loan::from(&shared.tools),
            |loan, slot| {
                shared.job.time(Phase::Update, || slot.answered(shared, found, &mut loan.tools));
                slot.ask(shared, &mut loan.tools);
            },
        );
        for slot in &mut self.slots {
            slot.records.drain(..).for_each(|(number, record)| records[number] = Some(record));
        }
        self.slots.retain(|slot| slot.asked.is_some());
    }

    /// Sends the slots' queries, sorted by list. Those whose lists find no room wait for the next round.
    fn send(&mut self, pass: &mut GpuPass, number: usize, shared: &Shared<'a, '_>) {
        shared.job.time(Phase::Upload, || {
            pass.start_round();
            self.order.clear();
            for (number, slot) in (0..).zip(&mut self.slots) {
                if let Some(asked) = &mut slot.asked
                    && let Some(place) = pass.place(asked.pivot, &asked.list)
                {
                    self.order.push(u64::from(place) << 32 | number);
                }
            }
            self.order.sort_unstable();
            self.queries.clear();
            let mut tests = 0;
            for (answer, &ordered) in (0..).zip(&self.order) {
                let Some(asked) = &mut self.slots[ordered as u32 as usize].asked else { continue };
                let first = (ordered >> 32) as u32;
                self.queries.push(Query { first, ..asked.query });
                asked.answer = Some((first, answer));
                tests += u64::from(asked.query.count);
            }
            pass.send(number, &self.queries);
            shared.job.count_tests(tests);
        });
    }
}

/// A place in the batch and the trace in it.
struct Slot<'a> {
    course: Course,
    trace: Option<(usize, &'a SettledTrace)>,
    asked: Option<Asked>,
    /// The records of traces that were finished since they were last fetched, with the traces' numbers.
    records: Vec<(usize, TraceRecord)>,
}

/// What a slot waits for.
struct Asked {
    pivot: u32,
    list: Arc<List>,
    query: Query,
    /// Where its list lies and which answer is its own, once it has been sent.
    answer: Option<(u32, usize)>,
}

impl<'a> Slot<'a> {
    fn new() -> Self {
        Slot { course: Course::new(), trace: None, asked: None, records: Vec::new() }
    }

    /// Goes on as far as the answer suffices.
    fn answered(&mut self, shared: &Shared<'a, '_>, found: &[Found], tools: &mut Tools) {
        let (Some((_, trace)), Some(asked)) = (self.trace, &self.asked) else { return };
        let Some((first, answer)) = asked.answer else { return };
        let (model, simd, slopes) = (shared.lists.model(), shared.simd, &mut tools.slopes);
        let before = trace.step(self.course.at());
        let mut candidates = [0; ROOM];
        match found[answer].places() {
            Some([]) if self.course.is_quiet() => self.course.pass_by(trace),
            Some(places) => {
                let candidates = &mut candidates[..places.len()];
                for (candidate, place) in candidates.iter_mut().zip(places) {
                    match asked.list.number(place.wrapping_sub(first) as usize) {
                        Some(vertex) => *candidate = vertex,
                        None => return shared.astray.store(true, Ordering::Relaxed),
                    }
                }
                self.course.recall(trace, simd, slopes);
                self.course.go_on(model, trace, candidates, simd, slopes);
            }
            None if self.course.narrow() => {}
            // Too many for one leg.
            None => {
                let mut candidates = Vec::new();
                asked.list.sweep(simd, &asked.query, asked.query.count as usize, &mut candidates);
                self.course.recall(trace, simd, slopes);
                self.course.go_on(model, trace, &candidates, simd, slopes);
            }
        }
        shared.job.count(trace.step(self.course.at()) - before);
        self.asked = None;
    }

    /// Asks what comes next, in the next trace where one is done; nothing if no trace is left.
    fn ask(&mut self, shared: &Shared<'a, '_>, tools: &mut Tools) {
        // A query that found no room in the last round is sent again.
        if self.asked.is_some() {
            return;
        }
        let (lists, model) = (shared.lists, shared.lists.model());
        while shared.job.go_on().is_ok() {
            let Some((number, trace)) = self.trace else {
                let number = shared.begun.fetch_add(1, Ordering::Relaxed);
                let Some(trace) = shared.traces.get(number) else { return };
                self.trace = Some((number, trace));
                self.course.start(model, trace);
                continue;
            };
            if let Some(record) = self.course.finished(trace) {
                self.records.push((number, record));
                self.trace = None;
                continue;
            }
            let query = shared.job.time(Phase::Queries, || {
                self.course.ask(lists.frame(), trace, shared.window, shared.simd, &mut tools.slopes)
            });
            if trace.violation().is_none() {
                let pivot = self.course.pivot(model);
                match shared.job.time(Phase::Queries, || lists.of(pivot, f64::INFINITY)) {
                    Some(list) => {
                        let count = list.within(self.course.squared(trace)) as u32;
                        let query = Query { count, ..query };
                        self.asked = Some(Asked { pivot: lists.key(pivot, &list), list, query, answer: None });
                        return;
                    }
                    None => self.look(shared, pivot, &query, tools),
                }
                continue;
            }
            // Where a trace crosses walls, the rope's last leg is not free, and it can meet anything.
            let before = self.course.at();
            self.course.try_all(model, trace);
            shared.job.count(trace.step(self.course.at()) - trace.step(before));
            shared.job.count_tests(((self.course.at() - before) * model.vertices().len()) as u64);
        }
    }

    /// Goes on through the window that was asked for last, whose pivot is not worth a list: it is answered here and now.
    fn look(&mut self, shared: &Shared<'a, '_>, pivot: u32, query: &Query, tools: &mut Tools) {
        let Some((_, trace)) = self.trace else { return };
        let before = trace.step(self.course.at());
        let Tools { slopes, scratch, found } = tools;
        let job = shared.job;
        let tried = job.time(Phase::Kernel, || shared.lists.look_into(pivot, query, shared.simd, scratch, found));
        if found.len() <= ROOM || !self.course.narrow() {
            let model = shared.lists.model();
            job.time(Phase::Update, || self.course.go_on(model, trace, found, shared.simd, slopes));
        }
        shared.job.count_tests(tried as u64);
        shared.job.count(trace.step(self.course.at()) - before);
    }
}

/// Memory that one thread works with.
#[derive(Default)]
struct Tools {
    slopes: Slopes,
    scratch: Scratch,
    found: Vec<u32>,
}

/// Tools taken from a pool, to which they go back: they are too large to be made for every round.
struct Loan<'a> {
    pool: &'a Mutex<Vec<Tools>>,
    tools: Tools,
}

impl<'a> Loan<'a> {
    fn from(pool: &'a Mutex<Vec<Tools>>) -> Self {
        let tools = pool.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        Loan { pool, tools }
    }
}

impl Drop for Loan<'_> {
    fn drop(&mut self) {
        self.pool.lock().unwrap_or_else(PoisonError::into_inner).push(std::mem::take(&mut self.tools));
    }
}
