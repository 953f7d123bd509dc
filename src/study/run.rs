//! Running a study: drawing, evaluating and tallying block after block.

use std::ops::ControlFlow::{Break, Continue};
use std::ops::Range;
use std::sync::Mutex;
use std::time::Instant;

use rayon::prelude::*;

use super::groups::{Group, Room, groups};
use super::moments::Moments;
use super::opened::Study;
use super::run_error::RunError;
use super::shard::Shard;
use super::state::{State, Stopped};
use super::tally::{Block, Counts, Merge};
use crate::engine::{Engine, Job};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

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
/// What the traces, the engines or the caller say; `EngineError::Stopped` when the job was stopped. Traces that were
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
    let room = Room::growing(study, engines);
    in_groups(study, engines, state, job, room, after)
}

/// The same with groups of at most as many traces as there is room for.
fn in_groups<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    state: &Mutex<State>,
    job: &Job,
    room: Room,
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
    groups(study, engines, (shard, places), &room, job, |group, records, [waited, evaluated]| {
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
    let room = Room::growing(study, engines);
    groups(study, engines, (shard, places), &room, job, |_, records, _| {
        each(records).map_err(RunError::Caller).map(|()| Continue(()))
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
