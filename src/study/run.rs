//! Running a study: drawing, evaluating and tallying block after block.

use std::ops::Range;
use std::sync::mpsc::sync_channel;
use std::thread;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::estimate::Confidence;
use super::opened::{Source, Study};
use super::plan::PlanError;
use super::state::State;
use super::summary::Stopped;
use super::tally::{Counts, Moments, Traced};
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

/// Blocks that are worked on at once.
struct Group {
    /// Their places among the shard's blocks.
    blocks: Range<u64>,
    /// The traces of all of them, and how many each has.
    traces: Vec<SettledTrace>,
    sizes: Vec<usize>,
    drawn: f64,
}

/// Goes on with `state` until the study, or the shard, is done or the job is stopped.
///
/// `engines` has one for each of the study's [`models`](Study::models), in their order. After each group of blocks `after`
/// is called with the state, the group's records, and how many of them, from the first on, are in the state. The state is
/// the same after the same number of blocks, whatever the engines, their number of threads and how often the study was interrupted.
///
/// # Errors
///
/// What the traces, the engines or the caller say; [`EngineError::Stopped`] when the job was stopped. Blocks that were not
/// finished by then are not in the state.
///
/// # Panics
///
/// If there are not as many engines as anchors.
pub fn run<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine + '_>],
    state: &mut State,
    job: &Job,
    mut after: impl FnMut(&State, Vec<TraceRecord>, usize) -> Result<(), E>,
) -> Result<Spent, RunError<E>> {
    assert_eq!(engines.len(), study.models().len(), "each anchor has its engine");
    let mut spent = Spent::default();
    if state.stopped != Stopped::Unfinished {
        return Ok(spent);
    }
    let all = state.shard.count(study.plan().blocks());
    let size = group_size(study, engines.iter().map(|e| e.batch()).max().unwrap_or(1));
    let (shard, first) = (state.shard, state.done);
    let mut total = state.tallies.scalars();
    thread::scope(|scope| {
        let (ready, groups) = sync_channel::<Result<Group, RunError<E>>>(0);
        scope.spawn(move || {
            let mut source = match study.source(study.block(shard.block(first)).start) {
                Ok(source) => source,
                Err(error) => return drop(ready.send(Err(error.into()))),
            };
            let mut start = first;
            while start < all {
                let numbers = (start..(start + size).min(all)).map(|b| study.block(shard.block(b)));
                let group = draw(&mut source, start, numbers, job);
                start = group.as_ref().map_or(all, |group| group.blocks.end);
                if ready.send(group).is_err() {
                    return;
                }
            }
        });
        let mut clock = Instant::now();
        let mut lap = || std::mem::replace(&mut clock, Instant::now()).elapsed().as_secs_f64();
        for group in groups {
            let Group { blocks, mut traces, sizes, drawn } = group?;
            let waited = lap();
            let records = evaluate(study, engines, &mut traces, job)?;
            let evaluated = lap();
            let mut traced = traces.iter().zip(&records).map(|(trace, record)| Traced { trace, record });
            let parts: Vec<Vec<Traced<'_>>> = sizes.iter().map(|&size| traced.by_ref().take(size).collect()).collect();
            let tallied: Vec<_> = parts.par_iter().map(|part| Counts::of_block(&study.setting, part)).collect();
            let mut added = 0;
            for ((block, (moments, counts)), size) in blocks.zip(tallied).zip(sizes) {
                total.iter_mut().zip(&moments).for_each(|(total, block)| total.merge(block));
                state.tallies.add(shard.block(block), moments, counts);
                state.done = block + 1;
                added += size;
                state.stopped = stopped(study, &total[1], state.done == all);
                if state.stopped != Stopped::Unfinished {
                    break;
                }
            }
            let tallied = lap();
            state.seconds += waited + evaluated + tallied;
            if study.plan().until.seconds.is_some_and(|most| state.seconds >= most)
                && state.stopped == Stopped::Unfinished
            {
                state.stopped = Stopped::Seconds;
            }
            spent.drawn += drawn;
            spent.waited += waited;
            spent.evaluated += evaluated;
            spent.tallied += tallied;
            after(state, records, added).map_err(RunError::Caller)?;
            lap();
            if state.stopped != Stopped::Unfinished {
                break;
            }
        }
        Ok(spent)
    })
}

/// How many blocks are worked on at once: enough traces for the engines, and not too many points.
fn group_size(study: &Study, batch: usize) -> u64 {
    let block = u64::from(study.plan().run.block);
    let steps = study.plan().walk.steps().map_or(1024, u64::from);
    (batch as u64).div_ceil(block).min(POINTS / (block * (steps + 1))).max(1)
}

/// After that time a group is closed though there is room for more, so that a study is stopped and saved in time.
const LONGEST: Duration = Duration::from_secs(1);

/// The traces of the blocks from number `first` on whose traces have these `numbers`, as many as are drawn in time.
fn draw<E>(
    source: &mut Source<'_>,
    first: u64,
    numbers: impl Iterator<Item = Range<u64>>,
    job: &Job,
) -> Result<Group, RunError<E>> {
    let clock = Instant::now();
    let mut group = Group { blocks: first..first, traces: Vec::new(), sizes: Vec::new(), drawn: 0.0 };
    for numbers in numbers {
        job.go_on()?;
        let block = source.take(numbers)?;
        group.sizes.push(block.len());
        group.traces.extend(block);
        group.blocks.end += 1;
        if clock.elapsed() > LONGEST {
            break;
        }
    }
    group.drawn = clock.elapsed().as_secs_f64();
    Ok(group)
}

/// The records of all traces, in their order. Each is evaluated by the engine of its anchor.
fn evaluate(
    study: &Study,
    engines: &mut [Box<dyn Engine + '_>],
    traces: &mut Vec<SettledTrace>,
    job: &Job,
) -> Result<Vec<TraceRecord>, EngineError> {
    if let [engine] = engines {
        return engine.evaluate(traces, job);
    }
    let mut parts: Vec<Vec<(usize, SettledTrace)>> = engines.iter().map(|_| Vec::new()).collect();
    for (i, trace) in traces.drain(..).enumerate() {
        parts[study.setting.anchor(trace.id())].push((i, trace));
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

/// Whether the study ends after a block, given the moments of the greatest length so far.
fn stopped(study: &Study, longest: &Moments, is_last: bool) -> Stopped {
    let plan = study.plan();
    if let Some(most) = plan.until.relative_error
        && longest.count >= LEAST.max(study.models().len() as u64)
    {
        let mean = Confidence::new(plan.tallies.confidence).mean(longest);
        if mean.high.is_some_and(|high| high - mean.value <= most * mean.value.abs()) {
            return Stopped::RelativeError;
        }
    }
    if is_last { Stopped::Complete } else { Stopped::Unfinished }
}
