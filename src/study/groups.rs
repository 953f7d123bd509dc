//! Traces drawn and evaluated group by group.

use std::ops::ControlFlow;
use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::sync_channel;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::opened::{Source, Study};
use super::run_error::RunError;
use super::shard::Shard;
use crate::engine::{Engine, EngineError, Job};
use crate::rope::TraceRecord;
use crate::trace::SettledTrace;

/// About how many points the traces have together that are drawn at once: 64 MB of them.
const POINTS: u64 = 1 << 22;

/// Traces that are worked on at once.
pub(super) struct Group {
    /// Their places among the shard's traces.
    pub places: Range<u64>,
    pub traces: Vec<SettledTrace>,
    /// How long it took to draw them, in seconds.
    pub drawn: f64,
}

/// Draws and evaluates the traces at these places, in groups of at most as many as there is room for. The next group is
/// drawn while one is evaluated and given to `each`, with how many seconds were waited for it and how long evaluating
/// took.
pub(super) fn groups<E: Send>(
    study: &Study,
    engines: &mut [Box<dyn Engine>],
    (shard, places): (Shard, Range<u64>),
    room: &Room,
    job: &Job,
    mut each: impl FnMut(Group, Vec<TraceRecord>, [f64; 2]) -> Result<ControlFlow<()>, RunError<E>>,
) -> Result<(), RunError<E>> {
    assert_eq!(engines.len(), study.models().len(), "each anchor has its engine");
    thread::scope(|scope| {
        let (ready, waiting) = sync_channel::<Result<Group, RunError<E>>>(0);
        scope.spawn(move || {
            let Some((_, numbers)) = study.numbers(shard, places.clone()).next() else { return };
            let mut drawing = match study.source(numbers.start) {
                Ok(source) => Drawing { study, shard, source, room, pace: 1 },
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
            room.took(group.traces.len() as u64, evaluated);
            if each(group, records, [waited, evaluated])?.is_break() {
                break;
            }
            lap();
        }
        Ok(())
    })
}

/// How many traces are worked on at once. What is stopped loses those that it was working on, so the first are few, and
/// there are never many more than are evaluated in about [`LONGEST`].
pub(super) struct Room {
    /// Enough for the engines, whole blocks if that can be, and not too many points.
    most: u64,
    /// How many there are at present: whole blocks, if there is one.
    now: AtomicU64,
    block: u64,
    /// How many the last group had, and how many of them were evaluated in a second.
    last: Mutex<(u64, f64)>,
}

/// About how many steps the first traces have together.
const FIRST: u64 = 1 << 16;

/// How much larger a group may be than the one before.
const GROWTH: f64 = 8.0;

impl Room {
    pub(super) fn growing(study: &Study, engines: &[Box<dyn Engine>]) -> Self {
        let batch = engines.iter().map(|engine| engine.batch()).max().unwrap_or(1);
        let block = u64::from(study.plan().run.block);
        let steps = study.plan().walk.steps().map_or(1024, u64::from);
        let most = (POINTS / (steps + 1)).max(1);
        let whole = (batch as u64).div_ceil(block).min(most / block) * block;
        let most = if whole > 0 { whole } else { most };
        let first = whole_blocks((FIRST / (steps + 1)).max(1), block);
        Room { block, ..Room::between(first, most) }
    }

    /// Room for so many at first, and later at the most, whatever blocks there are.
    pub(super) fn between(first: u64, most: u64) -> Self {
        Room { most, now: AtomicU64::new(first.min(most)), block: 1, last: Mutex::default() }
    }

    /// Makes more room after a group of so many traces, if it took less than [`LONGEST`] or more were evaluated in a
    /// second than in the group before, as on a device that takes as long for one as for many.
    fn took(&self, traces: u64, seconds: f64) {
        let rate = traces as f64 / seconds.max(1e-9);
        let (before, slower) =
            std::mem::replace(&mut *self.last.lock().unwrap_or_else(PoisonError::into_inner), (traces, rate));
        let is_gain = traces > before && before > 0 && rate > 1.5 * slower;
        let growth = (LONGEST.as_secs_f64() / seconds.max(1e-9)).clamp(if is_gain { 2.0 } else { 1.0 }, GROWTH);
        let room = whole_blocks((traces as f64 * growth) as u64, self.block).min(self.most);
        self.now.fetch_max(room, Relaxed);
    }
}

/// Of more traces than a block has, those of whole ones.
fn whole_blocks(traces: u64, block: u64) -> u64 {
    if traces < block { traces } else { traces - traces % block }
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
    room: &'s Room,
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
        let size = self.room.now.load(Relaxed);
        let most = if start.is_multiple_of(block) { size } else { size.min(block - start % block) };
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
            self.pace = if lap.elapsed() < LAP { (2 * self.pace).min(size) } else { (self.pace / 2).max(1) };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// How much room there is after each of so many groups, if that many traces take so many seconds.
    fn rooms(room: &Room, groups: usize, seconds: impl Fn(u64) -> f64) -> Vec<u64> {
        let after = |_| {
            let traces = room.now.load(Relaxed);
            room.took(traces, seconds(traces));
            room.now.load(Relaxed)
        };
        (0..groups).map(after).collect()
    }

    #[test]
    fn groups_grow_as_long_as_they_are_evaluated_in_time_or_faster_than_before() {
        // Ten thousand a second, then none that takes longer than a second.
        assert_eq!(rooms(&Room::between(10, 40_000), 5, |n| n as f64 / 1e4), [80, 640, 5120, 10_000, 10_000]);
        // As many as there may be, and no more.
        assert_eq!(rooms(&Room::between(10, 700), 3, |n| n as f64 / 1e4), [80, 640, 700]);
        assert_eq!(rooms(&Room::between(10, 3), 1, |_| 0.0), [3]);
        // One of these alone takes two seconds.
        assert_eq!(rooms(&Room::between(1, 8192), 4, |n| 2.0 * n as f64), [1; 4]);
        // Slow at first, while lists are made, and never less than before.
        assert_eq!(rooms(&Room::between(10, 8192), 1, |_| 30.0), [10]);
        // A device that takes two seconds for any of them is given all it can take, once it is seen to.
        let device = Room::between(10, 8192);
        device.took(5, 2.0);
        assert_eq!(rooms(&device, 11, |_| 2.0).last(), Some(&8192));
    }

    #[test]
    fn a_group_that_is_larger_than_a_block_has_whole_ones() {
        let room = Room { block: 30, ..Room::between(10, 300) };
        assert_eq!(rooms(&room, 4, |n| n as f64 / 100.0), [80 / 30 * 30, 90, 90, 90]);
    }
}
