//! Many traces at once on a device: each round, every active trace asks one query, the device answers them all, and the
//! traces go on by the answers. Finished traces leave and waiting ones take their place. Two half-batches take turns,
//! so that one is on the device while the other is on the CPU.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use crate::candidates::{DevicePlace, List, ListKey, Lists, Simd, Slopes};
use crate::engine::{EngineError, Job, Phase};
use crate::gpu::{GpuPass, HALVES, Kernel};
use crate::rope::TraceRecord;
use crate::scene::{Model, Pivot};
use crate::trace::SettledTrace;
use crate::visibility::Scratch;

/// Takes a trace from query to query, then the next one: it asks, and goes on by what the device answers.
pub(super) trait Player: Send {
    /// What answers it.
    type Kernel: Kernel;

    /// One that stands nowhere.
    fn new() -> Self;

    /// Stands at the start of `trace`.
    fn start(&mut self, model: &Model, trace: &SettledTrace);

    /// The record of a trace that is done.
    fn finished(&mut self, trace: &SettledTrace) -> Option<TraceRecord>;

    /// The settled point at which the free end stands.
    fn at(&self) -> usize;

    /// The query for what comes next; the trace is not done. `None` if it has gone on without the device.
    fn ask(&mut self, shared: &Shared<'_>, trace: &SettledTrace, tools: &mut Tools) -> Option<Asked<Self::Kernel>>;

    /// The points of the trace that come with the query asked last.
    fn points(&self) -> &[[f32; 2]] {
        &[]
    }

    /// Goes on as far as the answer suffices.
    fn answered(
        &mut self,
        shared: &Shared<'_>,
        trace: &SettledTrace,
        asked: (&List, &<Self::Kernel as Kernel>::Query),
        found: &<Self::Kernel as Kernel>::Found,
        tools: &mut Tools,
    ) -> Result<(), Astray>;

    /// What the device is to hold of the `list` of which the key is `pivot`.
    fn coordinates(_: &Lists, _pivot: Pivot, list: &List) -> Vec<[f32; 2]> {
        list.coordinates().collect()
    }
}

/// The device named a vertex that it was not given.
pub(super) struct Astray;

/// What all slots share.
pub(super) struct Shared<'a> {
    pub lists: &'a Lists,
    pub window: usize,
    pub simd: Simd,
    pub job: &'a Job,
    traces: &'a [SettledTrace],
    /// How many traces have been begun.
    begun: AtomicUsize,
    /// Whether an answer was [`Astray`].
    astray: AtomicBool,
    tools: Mutex<Vec<Tools>>,
}

/// Evaluates `traces` in rounds of `pass`, with windows of at most `window` legs.
pub(super) fn evaluate<P: Player>(
    pass: &mut GpuPass<P::Kernel>,
    lists: &Lists,
    window: usize,
    traces: &[SettledTrace],
    job: &Job,
) -> Result<Vec<TraceRecord>, EngineError> {
    let (begun, astray) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (simd, tools) = (Simd::detected(), Mutex::default());
    let shared = Shared { lists, window, simd, traces, begun, astray, tools, job };
    let slots = pass.capacity().min(traces.len().div_ceil(HALVES));
    let mut halves: [Half<'_, P>; HALVES] = std::array::from_fn(|_| Half::new(slots));
    let mut records: Vec<Option<TraceRecord>> = traces.iter().map(|_| None).collect();
    let done = play(pass, &shared, &mut halves, &mut records);
    // Rounds that are still on their way after an early end: so that the next evaluation finds the device free.
    for (half, Half { found, queries, .. }) in halves.iter_mut().enumerate() {
        let _ = pass.collect(half, &mut found[..queries.len()]);
    }
    done?;
    Ok(records.into_iter().map(|r| r.expect("every trace was evaluated")).collect())
}

fn play<'a, P: Player>(
    pass: &mut GpuPass<P::Kernel>,
    shared: &Shared<'a>,
    halves: &mut [Half<'a, P>],
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
struct Half<'a, P: Player> {
    slots: Vec<Slot<'a, P>>,
    /// The places of the slots' lists and the slots' numbers, in one number, so that sorting puts equal lists together.
    order: Vec<u64>,
    queries: Vec<<P::Kernel as Kernel>::Query>,
    points: Vec<[f32; 2]>,
    found: Vec<<P::Kernel as Kernel>::Found>,
}

impl<'a, P: Player> Half<'a, P> {
    fn new(slots: usize) -> Self {
        Half {
            slots: (0..slots).map(|_| Slot::new()).collect(),
            order: Vec::with_capacity(slots),
            queries: Vec::with_capacity(slots),
            points: Vec::new(),
            found: vec![Default::default(); slots],
        }
    }

    fn collect(&mut self, pass: &mut GpuPass<P::Kernel>, number: usize, job: &Job) -> Result<(), EngineError> {
        let found = &mut self.found[..self.queries.len()];
        Ok(job.time(Phase::Readback, || pass.collect(number, found))?)
    }

    /// Takes every slot as far as the answers allow, and on to its next query. Slots without a trace leave.
    fn advance(&mut self, shared: &Shared<'a>, records: &mut [Option<TraceRecord>]) {
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
    fn send(&mut self, pass: &mut GpuPass<P::Kernel>, number: usize, shared: &Shared<'a>) {
        shared.job.time(Phase::Upload, || {
            pass.start_round();
            self.order.clear();
            for (number, slot) in (0..).zip(&mut self.slots) {
                if let Some(Asked { pivot, key, list, .. }) = &slot.asked
                    && let Some(place) = pass.place(*key, list.len(), || P::coordinates(shared.lists, *pivot, list))
                {
                    self.order.push(u64::from(place.0) << 32 | number);
                }
            }
            self.order.sort_unstable();
            self.queries.clear();
            self.points.clear();
            let mut tests = 0;
            for (answer, &ordered) in (0..).zip(&self.order) {
                let Slot { player, asked, answer: own, .. } = &mut self.slots[ordered as u32 as usize];
                let Some(asked) = asked else { continue };
                let query =
                    P::Kernel::placed(&asked.query, DevicePlace((ordered >> 32) as u32), self.points.len() as u32);
                tests += u64::from(P::Kernel::tried(&query).1);
                self.queries.push(query);
                self.points.extend_from_slice(player.points());
                asked.query = query;
                *own = Some(answer);
            }
            pass.send(number, &self.queries, &self.points);
            shared.job.count_tests(tests);
        });
    }
}

/// A place in the batch and the trace in it.
struct Slot<'a, P: Player> {
    player: P,
    trace: Option<(usize, &'a SettledTrace)>,
    asked: Option<Asked<P::Kernel>>,
    /// Which answer is that to what was asked, once it has been sent.
    answer: Option<usize>,
    /// The records of traces that were finished since they were last fetched, with the traces' numbers.
    records: Vec<(usize, TraceRecord)>,
}

/// What a slot waits for.
pub(super) struct Asked<K: Kernel> {
    pub pivot: Pivot,
    /// That of the list.
    pub key: ListKey,
    pub list: Arc<List>,
    pub query: K::Query,
}

impl<'a, P: Player> Slot<'a, P> {
    fn new() -> Self {
        Slot { player: P::new(), trace: None, asked: None, answer: None, records: Vec::new() }
    }

    /// Goes on as far as the answer suffices.
    fn answered(&mut self, shared: &Shared<'a>, found: &[<P::Kernel as Kernel>::Found], tools: &mut Tools) {
        let (Some((_, trace)), Some(answer)) = (self.trace, self.answer.take()) else { return };
        let Some(Asked { list, query, .. }) = self.asked.take() else { return };
        let before = trace.step(self.player.at());
        if self.player.answered(shared, trace, (&list, &query), &found[answer], tools).is_err() {
            shared.astray.store(true, Ordering::Relaxed);
        }
        shared.job.count(trace.step(self.player.at()) - before);
    }

    /// Asks what comes next, in the next trace where one is done; nothing if no trace is left.
    fn ask(&mut self, shared: &Shared<'a>, tools: &mut Tools) {
        // A query that found no room in the last round is sent again.
        if self.asked.is_some() {
            return;
        }
        while shared.job.go_on().is_ok() {
            let Some((number, trace)) = self.trace else {
                let number = shared.begun.fetch_add(1, Ordering::Relaxed);
                let Some(trace) = shared.traces.get(number) else { return };
                self.trace = Some((number, trace));
                self.player.start(shared.lists.model(), trace);
                continue;
            };
            if let Some(record) = self.player.finished(trace) {
                self.records.push((number, record));
                self.trace = None;
                continue;
            }
            let before = self.player.at();
            self.asked = self.player.ask(shared, trace, tools);
            if self.asked.is_some() {
                return;
            }
            shared.job.count(trace.step(self.player.at()) - trace.step(before));
        }
    }
}

/// Memory that one thread works with.
#[derive(Default)]
pub(super) struct Tools {
    pub slopes: Slopes,
    pub scratch: Scratch,
    pub found: Vec<u32>,
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
