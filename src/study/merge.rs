//! Parts of a study, put together.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::moments::Moments;
use super::opened::Study;
use super::run::is_certain;
use super::shard::{Shard, as_ranges};
use super::state::{State, Stopped};
use super::state_error::{StateError, StateFault};
use super::tally::Merge;

/// A part as it is seen before it is taken.
struct Part {
    path: PathBuf,
    shard: Shard,
    done: u64,
    is_unfinished: bool,
}

/// Puts parts of one study together, whichever blocks are done in them: those at `paths`, which `load` reads, in any
/// order. Each is read up to twice, and one is held at a time. Where the study ends as soon as it is certain enough,
/// it ends with the first block, in the order of the blocks, with which it is: blocks behind that are left out.
///
/// Blocks that are missing are a fault unless `is_partial` is asked for: then the state says what is there.
///
/// # Errors
///
/// Parts that belong to another study, have blocks in common, or leave some out; none at all; and what `load` says.
pub fn merge<E: From<StateError>>(
    study: &Study,
    paths: &[PathBuf],
    is_partial: bool,
    mut load: impl FnMut(&Path) -> Result<State, E>,
) -> Result<State, E> {
    let whole = State::new(study, Shard::WHOLE);
    let (mut heap, mut seconds) = (Heap::default(), 0.0);
    let mut owners: BTreeMap<u64, usize> = BTreeMap::new();
    let mut longest: BTreeMap<u64, Moments> = BTreeMap::new();
    let mut parts: Vec<Part> = Vec::new();
    let has_rule = study.plan().until.relative_error.is_some();
    if let [path] = paths {
        let state = load(path)?;
        if state.shard == Shard::WHOLE && state.stopped != Stopped::Unfinished && state.identity == whole.identity {
            // A study that was not shared out, which may have stopped before its last block.
            return Ok(State { kept: Default::default(), ..state });
        }
    }
    for path in paths {
        let state = load(path)?;
        if state.identity != whole.identity {
            return Err(fault(path, StateFault::Foreign).into());
        }
        for block in state.blocks() {
            if let Some(other) = owners.insert(block, parts.len()) {
                let other = &parts[other];
                let what = match other.shard == state.shard && !state.is_partial {
                    true => StateFault::Twice(state.shard),
                    false => StateFault::Shared { block, other: other.path.clone() },
                };
                return Err(fault(path, what).into());
            }
        }
        let (shard, done) = (state.shard, state.done);
        let is_unfinished = !state.is_partial && state.stopped == Stopped::Unfinished;
        parts.push(Part { path: path.clone(), shard, done, is_unfinished });
        seconds += state.seconds;
        longest.extend(state.blocks.iter());
        if !has_rule {
            heap.add(taken(state, study, u64::MAX, u64::MAX));
        }
    }
    let all = study.plan().blocks();
    // The first block that is missing, and the first behind the study's end.
    let mut pooled = Moments::default();
    let (mut gap, mut end) = (0, None);
    while let Some(block) = longest.get(&gap).filter(|_| end.is_none()) {
        pooled.merge(block);
        gap += 1;
        end = is_certain(study, &pooled).then_some(gap);
    }
    if end.is_none() && gap < all && !is_partial {
        return Err(missing(&parts, &longest, all).into());
    }
    if has_rule {
        for path in paths {
            heap.add(taken(load(path)?, study, gap, end.unwrap_or(u64::MAX)));
        }
    }
    let mut whole = heap.all(State { seconds, ..whole });
    whole.stopped = match end {
        Some(_) => Stopped::RelativeError,
        None if gap == all => Stopped::Complete,
        None => Stopped::Unfinished,
    };
    whole.is_partial = whole.stopped == Stopped::Unfinished;
    whole.done = if whole.is_partial { 0 } else { gap };
    Ok(whole)
}

/// What is put together so far, the larger of it first: each is at least twice as large as the next, so that what was
/// counted is moved as often as there are doublings, however many parts there are.
#[derive(Default)]
struct Heap(Vec<State>);

impl Heap {
    fn add(&mut self, mut part: State) {
        while let Some(last) = self.0.pop_if(|last| last.blocks.len() < 2 * part.blocks.len().max(1)) {
            part = joined(last, part);
        }
        self.0.push(part);
    }

    /// All of it, with what `whole` says besides.
    fn all(mut self, whole: State) -> State {
        let mut all = self.0.pop().unwrap_or_else(|| whole.clone());
        while let Some(last) = self.0.pop() {
            all = joined(last, all);
        }
        let State { blocks, counts, apart, open, .. } = all;
        State { blocks, counts, apart, open, ..whole }
    }
}

/// What was counted in both.
fn joined(mut one: State, mut other: State) -> State {
    one.blocks.append(&mut other.blocks);
    one.apart.append(&mut other.apart);
    one.counts.merge_with(other.counts);
    one.open = one.open.or(other.open);
    one
}

/// The blocks of a part that come before `end`. What lies behind `gap` may yet have to be left out.
fn taken(mut part: State, study: &Study, gap: u64, end: u64) -> State {
    part.blocks.retain(|&block, _| block < end);
    // The study's last block, if it is short.
    let has_last = part.blocks.last_key_value().is_some_and(|(block, _)| block + 1 == study.plan().blocks());
    part.open = part.short().filter(|_| has_last).cloned();
    for (block, counts) in std::mem::take(&mut part.apart) {
        if block < gap.min(end) {
            part.counts.merge_with(counts);
        } else if block < end {
            part.apart.insert(block, counts);
        }
    }
    part
}

fn fault(path: &Path, fault: StateFault) -> StateError {
    StateError { path: path.to_owned(), fault }
}

/// What is said where not all blocks are there.
fn missing(parts: &[Part], there: &BTreeMap<u64, Moments>, all: u64) -> StateError {
    let Some(last) = parts.last() else { return fault(Path::new(""), StateFault::NoShards) };
    if let Some(part) = parts.iter().find(|part| part.is_unfinished) {
        let (shard, done, all) = (part.shard, part.done, part.shard.count(all));
        return fault(&part.path, StateFault::Undone { shard, done, all });
    }
    let of = last.shard.of();
    if parts.iter().all(|part| part.shard.is_of_all() && part.shard.of() == of)
        && let Some(number) = (0..of).find(|&number| parts.iter().all(|part| part.shard.number != number))
    {
        return fault(&last.path, StateFault::MissingShard { number, of });
    }
    let blocks = as_ranges((0..all).filter(|block| !there.contains_key(block)));
    fault(&last.path, StateFault::MissingBlocks { blocks, all })
}
