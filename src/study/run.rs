//! Running a study: drawing, evaluating and tallying block after block.

use std::ops::ControlFlow::{self, Break, Continue};
use std::ops::Range;
use std::sync::Mutex;
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::moments::Moments;
use super::opened::{Source, Study};
use super::plan_error::PlanError;
use super::shard::Shard;
use super::state::{State, Stopped};
use super::tally::{Block, Counts, Merge};
use crate::engine::{Engine, EngineError, Job};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// About how many points the traces have together that are drawn at once: 64 MB of them.
const POINTS: u64 = 1 << 22;

/// Why a study could not go on. What was done before is in its state.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E> {
    /// The traces cannot be had.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The ropes cannot be evaluated, or the job was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The caller had enough.
    #[error(transparent)]
    Caller(E),
}

/// How long the parts of a run took, in seconds. Drawing goes on beside the rest.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spent {
    /// Drawing traces.
    pub drawn: f64,
    /// Waiting for them.
    pub waited: f64,
    /// Evaluating ropes.
    pub evaluated: f64,
    /// Counting.
    pub tallied: f64,
}

/// Traces that are worked on at once.
struct Group {
    /// Their places among the shard's traces.
    places: Range<u64>,
    traces: Vec<SettledTrace>,
    drawn: f64,
}

/// What a group's traces of one block have come to.
enum Tallied {
    /// The block is whole.
    Whole(Box<Counts>),
    /// It is whole and the study's last, with fewer traces than others.
    Short(Box<Block>, Box<Counts>),
    /// There is more to come of it.
    Open(Box<Block>),
}

/// Goes on with `state` until the study, or the shard, is done or the job is stopped.
///
/// `engines` has one for each of the study's [`models`](Study::models), in their order. After each group of traces
/// `after` is called with the state, the group's records, and how many of them, from the first on, are in the state.
/// The state is the same after the same number of traces, whatever the engines, their number of threads and how often
/// the study was interrupted. It is locked only while traces are added to it and `after` runs, so that another thread
/// may save it at any other time.
///
/// # Errors
///
/// What the traces, the engines or the caller say; [`EngineError::Stopped`] when the job was stopped. Traces that were
/// not finished by then are not in the state.
///
/// # Panics
///
/// If there are not as many engines as anchors, or a thread panicked that held the state.
pub fn run<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    state: &Mutex<State>,
    job: &Job,
    after: impl FnMut(&mut State, Vec<TraceRecord>, usize) -> Result<(), E>,
) -> Result<Spent, RunError<E>> {
    let size = group_size(study, engines);
    in_groups(study, engines, state, job, size, after)
}

/// The same with groups of at most `size` traces.
fn in_groups<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    state: &Mutex<State>,
    job: &Job,
    size: u64,
    mut after: impl FnMut(&mut State, Vec<TraceRecord>, usize) -> Result<(), E>,
) -> Result<Spent, RunError<E>> {
    let mut spent = Spent::default();
    let (shard, first, mut open, mut longest) = {
        let state = state.lock().expect("nobody panicked with the state");
        if state.stopped != Stopped::Unfinished {
            return Ok(spent);
        }
        // In the order of the blocks, as sums of floats depend on it.
        let mut longest = Moments::default();
        state.blocks.values().for_each(|block| longest.merge(block));
        (state.shard, state.place(study), state.open.clone(), longest)
    };
    let all = shard.count(study.plan().blocks());
    let places = first..study.places(shard);
    groups(study, engines, (shard, places, size), job, |group, records, [waited, evaluated]| {
        let clock = Instant::now();
        let tallied = tally(study, shard, &group, &records, open.take());
        let mut state = state.lock().expect("nobody panicked with the state");
        let mut added = 0;
        for (index, count, tallied) in tallied {
            added += count;
            match tallied {
                Tallied::Open(block) => {
                    open = Some(Block::clone(&block));
                    state.open = Some(*block);
                }
                Tallied::Whole(counts) => {
                    let block = counts.scalars.max_length();
                    (state.done, state.open) = (index + 1, None);
                    if state.may_count_too_many(study) {
                        state.apart.insert(shard.block(index), *counts);
                    } else {
                        state.counts.merge_with(*counts);
                    }
                    longest.merge(&block);
                    state.blocks.insert(shard.block(index), block);
                }
                Tallied::Short(open, counts) => {
                    let block = counts.scalars.max_length();
                    (state.done, state.open) = (index + 1, Some(*open));
                    longest.merge(&block);
                    state.blocks.insert(shard.block(index), block);
                }
            }
            if state.done > index {
                // Of a part alone nobody knows whether the study is certain enough.
                let is_certain = shard == Shard::WHOLE && is_certain(study, &longest);
                state.stopped = match state.done == all {
                    _ if is_certain => Stopped::RelativeError,
                    true => Stopped::Complete,
                    false => Stopped::Unfinished,
                };
                if state.stopped != Stopped::Unfinished {
                    break;
                }
            }
        }
        let tallied = clock.elapsed().as_secs_f64();
        state.seconds += waited + evaluated + tallied;
        let is_over = study.plan().until.seconds.is_some_and(|most| state.seconds >= most);
        // Only whole blocks count.
        if is_over && state.open.is_none() && state.stopped == Stopped::Unfinished {
            state.stopped = Stopped::Seconds;
        }
        spent.drawn += group.drawn;
        spent.waited += waited;
        spent.evaluated += evaluated;
        spent.tallied += tallied;
        after(&mut state, records, added).map_err(RunError::Caller)?;
        Ok(if state.stopped == Stopped::Unfinished { Continue(()) } else { Break(()) })
    })?;
    Ok(spent)
}

/// Evaluates traces of a study again, without counting them: those at `places` among the traces of the shard, in order.
/// Groups of records are given to `each`.
///
/// # Errors
///
/// As those of [`run`].
///
/// # Panics
///
/// If there are not as many engines as anchors, or not so many places.
pub fn run_again<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    shard: Shard,
    places: Range<u64>,
    job: &Job,
    mut each: impl FnMut(Vec<TraceRecord>) -> Result<(), E>,
) -> Result<(), RunError<E>> {
    assert!(places.end <= study.places(shard), "the shard has that many traces");
    let size = group_size(study, engines);
    groups(study, engines, (shard, places, size), job, |_, records, _| {
        each(records).map_err(RunError::Caller).map(|()| Continue(()))
    })
}

/// Draws and evaluates the traces at these places, in groups of at most that size. The next group is drawn while one is
/// evaluated and given to `each`, with how many seconds were waited for it and how long evaluating took.
fn groups<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    (shard, places, size): (Shard, Range<u64>, u64),
    job: &Job,
    mut each: impl FnMut(Group, Vec<TraceRecord>, [f64; 2]) -> Result<ControlFlow<()>, RunError<E>>,
) -> Result<(), RunError<E>> {
    assert_eq!(engines.len(), study.models().len(), "each anchor has its engine");
    thread::scope(|scope| {
        let (ready, waiting) = sync_channel::<Result<Group, RunError<E>>>(0);
        scope.spawn(move || {
            let Some((_, numbers)) = study.numbers(shard, places.clone()).next() else { return };
            let mut drawing = match study.source(numbers.start) {
                Ok(source) => Drawing { study, shard, source, size, pace: 1 },
                Err(error) => return drop(ready.send(Err(error.into()))),
            };
            let mut start = places.start;
            while start < places.end {
                let group = drawing.next(start..places.end, job);
                start = group.as_ref().map_or(places.end, |group| group.places.end);
                if ready.send(group).is_err() {
                    return;
                }
            }
        });
        let mut clock = Instant::now();
        let mut lap = || std::mem::replace(&mut clock, Instant::now()).elapsed().as_secs_f64();
        for group in waiting {
            let mut group = group?;
            let waited = lap();
            let records = evaluate(study, engines, &mut group.traces, job)?;
            let evaluated = lap();
            if each(group, records, [waited, evaluated])?.is_break() {
                break;
            }
            lap();
        }
        Ok(())
    })
}

/// Counts a group's traces, block by block: each one's place among the shard's blocks, how many traces it has here, and
/// what they come to. `open` is what was counted before of the block with which the group goes on.
fn tally(
    study: &Study,
    shard: Shard,
    group: &Group,
    records: &[TraceRecord],
    open: Option<Block>,
) -> Vec<(u64, usize, Tallied)> {
    let mut traced = &group.traces.iter().zip(records).collect::<Vec<_>>()[..];
    let mut first = open;
    let parts: Vec<_> = study
        .numbers(shard, group.places.clone())
        .map(|(index, numbers)| {
            let count = (numbers.end - numbers.start) as usize;
            let is_whole = numbers.end == study.block(shard.block(index)).end;
            let block = first.take().unwrap_or_default();
            (index, is_whole, block, traced.split_off(..count).expect("the group has the traces of its places"))
        })
        .collect();
    let count = |(index, is_whole, mut block, part): (u64, bool, Block, &[(&SettledTrace, &TraceRecord)])| {
        part.iter().for_each(|(trace, record)| block.add(&study.tallies, trace, record));
        let tallied = match is_whole {
            true if block.traces() < study.plan().run.block.into() => {
                let counts = block.clone().finish(&study.tallies, shard.block(index));
                Tallied::Short(Box::new(block), Box::new(counts))
            }
            true => Tallied::Whole(Box::new(block.finish(&study.tallies, shard.block(index)))),
            false => Tallied::Open(Box::new(block)),
        };
        (index, part.len(), tallied)
    };
    parts.into_par_iter().map(count).collect()
}

/// How many traces are worked on at once: enough for the engines, whole blocks if that can be, and not too many points.
fn group_size(study: &Study, engines: &[Box<dyn Engine>]) -> u64 {
    let batch = engines.iter().map(|engine| engine.batch()).max().unwrap_or(1);
    let block = u64::from(study.plan().run.block);
    let steps = study.plan().walk.steps().map_or(1024, u64::from);
    let most = (POINTS / (steps + 1)).max(1);
    let whole = (batch as u64).div_ceil(block).min(most / block) * block;
    if whole > 0 { whole } else { most }
}

/// After that time a group is closed though there is room for more, so that what was drawn is evaluated and saved in
/// time.
const LONGEST: Duration = Duration::from_secs(1);

/// About how long it takes to draw the traces between two looks at the clock.
const LAP: Duration = Duration::from_millis(50);

/// What draws traces, group after group.
struct Drawing<'s> {
    study: &'s Study,
    shard: Shard,
    source: Source<'s>,
    /// How many traces a group has at the most.
    size: u64,
    /// How many are drawn between two looks at the clock.
    pace: u64,
}

impl Drawing<'_> {
    /// The first of the traces at these places, as many as are drawn in time. A group that begins within a block ends
    /// with it.
    fn next<E>(&mut self, places: Range<u64>, job: &Job) -> Result<Group, RunError<E>> {
        let clock = Instant::now();
        let block = u64::from(self.study.plan().run.block);
        let start = places.start;
        let most = if start.is_multiple_of(block) { self.size } else { self.size.min(block - start % block) };
        let end = places.end.min(start + most);
        let mut group = Group { places: start..start, traces: Vec::new(), drawn: 0.0 };
        while group.places.end < end && clock.elapsed() <= LONGEST {
            job.go_on()?;
            let lap = Instant::now();
            let at = group.places.end;
            let some = at..end.min(at + self.pace);
            let Some((_, numbers)) = self.study.numbers(self.shard, some).next() else { break };
            group.places.end += numbers.end - numbers.start;
            group.traces.extend(self.source.take(numbers)?);
            self.pace = if lap.elapsed() < LAP { (2 * self.pace).min(self.size) } else { (self.pace / 2).max(1) };
        }
        group.drawn = clock.elapsed().as_secs_f64();
        Ok(group)
    }
}

/// The records of all traces, in their order. Each is evaluated by the engine of its anchor.
fn evaluate(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    traces: &mut Vec<SettledTrace>,
    job: &Job,
) -> Result<Vec<TraceRecord>, EngineError> {
    if let [engine] = engines {
        return engine.evaluate(traces, job);
    }
    let mut parts: Vec<Vec<(usize, SettledTrace)>> = engines.iter().map(|_| Vec::new()).collect();
    for (i, trace) in traces.drain(..).enumerate() {
        parts[study.tallies.setting.anchor(trace.id())].push((i, trace));
    }
    let mut all = Vec::new();
    for (engine, part) in engines.iter_mut().zip(parts) {
        let (places, own): (Vec<usize>, Vec<SettledTrace>) = part.into_iter().unzip();
        let records = engine.evaluate(&own, job)?;
        all.extend(places.into_iter().zip(own).zip(records));
    }
    all.sort_unstable_by_key(|((place, _), _)| *place);
    let (placed, records): (Vec<(usize, SettledTrace)>, Vec<TraceRecord>) = all.into_iter().unzip();
    traces.extend(placed.into_iter().map(|(_, trace)| trace));
    Ok(records)
}

/// Before that many traces no study is certain enough: of fewer, errors are not known well.
const LEAST: u64 = 100;

/// Whether a study of which blocks have these moments of the greatest length is as certain as was asked for.
pub(super) fn is_certain(study: &Study, longest: &Moments) -> bool {
    study.plan().until.relative_error.is_some_and(|most| {
        let mean = study.tallies.setting.confidence.mean(longest);
        longest.count >= LEAST.max(study.models().len() as u64)
            && mean.high.is_some_and(|high| high - mean.value <= most * mean.value.abs())
    })
}

#[cfg(test)]
mod tests;
