//! Everything that is counted in whole numbers.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;
use serde::{Deserialize, Serialize};

use super::follow::follow;
use super::lengths::Lengths;
use super::ropes::Ropes;
use super::setting::Setting;
use super::{Batches, Moments, SCALARS, Sizes};
use crate::rope::{EventKind, Side, TraceRecord};
use crate::trace::SettledTrace;

/// A trace and what became of it.
pub(crate) struct Traced<'a> {
    pub trace: &'a SettledTrace,
    pub record: &'a TraceRecord,
}

/// How often ropes go about an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Wound {
    /// How many ropes go about it counter-clockwise, and clockwise: both, like the turns, as if y pointed upwards.
    pub left: u64,
    pub right: u64,
    /// The sum of the turns and of their squares.
    pub turns: i64,
    pub squares: u64,
}

/// How often a wall end was touched.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Touched {
    /// Over blocks as large as they have traces.
    pub wraps: Batches,
    /// Steps, over blocks as large as they have steps.
    pub steps: Batches,
}

/// A cell of the map.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct CellCounts {
    /// How often a free end was seen there.
    pub visits: Sizes,
    /// The lengths of the ropes then, over blocks as large as they have visits.
    pub lengths: Batches,
    /// Steps with a contact there, over blocks as large as they have steps.
    pub contacts: Batches,
}

/// Counts of some blocks.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(crate) struct Counts {
    pub traces: Sizes,
    /// The numbers of steps after which a rope was looked at: one more for each trace than it has steps.
    pub looks: Sizes,
    pub events: u64,
    /// How many steps the longest trace has.
    pub longest_trace: u64,
    /// How many steps left the free end where it was, and how many met a wall or the border as they were drawn first.
    pub still: u64,
    pub met: u64,
    /// How many longer steps of thinned traces were walked point by point.
    pub jumps: u64,
    /// How many traces cross a simplified wall, and how many steps.
    pub crossing: [u64; 2],
    /// For the final and the greatest length: how many traces have one in each bin.
    pub bins: [BTreeMap<u64, u64>; 2],
    /// The same in classes fine enough for quantiles.
    pub lengths: [Lengths; 2],
    /// For the other scalars: how many traces have each value.
    pub values: [BTreeMap<u64, u64>; SCALARS.len() - 2],
    /// For each limit: how many ropes first became longer after so many of the times of the survival curve had gone by.
    pub exceeded: Vec<BTreeMap<u64, u64>>,
    pub ropes: Ropes,
    pub touched: BTreeMap<u32, Touched>,
    pub wound: BTreeMap<u32, Wound>,
    pub cells: BTreeMap<u32, CellCounts>,
}

impl Counts {
    /// The counts of one block, and the moments of its scalars. O(steps looked at by the map + events + steps up to where
    /// limits are exceeded).
    pub(crate) fn of_block(setting: &Setting, traced: &[Traced<'_>]) -> ([Moments; SCALARS.len()], Self) {
        let mut counts = Counts { exceeded: vec![BTreeMap::new(); setting.limits.len()], ..Counts::default() };
        let mut moments = [Moments::default(); SCALARS.len()];
        let mut touched = HashMap::default();
        let mut cells = HashMap::default();
        let (mut looks, mut lookups) = (0, Vec::new());
        for Traced { trace, record } in traced {
            let wraps = record.events.iter().filter(|e| e.kind == EventKind::Wrap).count() as u64;
            let unwraps = record.events.len() as u64 - wraps;
            let values = [u64::from(record.depth), u64::from(record.max_depth), wraps, unwraps];
            let lengths = [record.length, record.max_length];
            for (moments, value) in moments.iter_mut().zip(lengths.into_iter().chain(values.map(|v| v as f64))) {
                moments.add(value);
            }
            for ((bins, classes), length) in counts.bins.iter_mut().zip(&mut counts.lengths).zip(lengths) {
                *bins.entry((length / setting.bin) as u64).or_default() += 1;
                classes.add(length);
            }
            for (counts, value) in counts.values.iter_mut().zip(values) {
                *counts.entry(value).or_default() += 1;
            }
            looks += record.steps + 1;
            counts.longest_trace = counts.longest_trace.max(record.steps);
            counts.still += trace.walked().still as u64;
            counts.met += trace.walked().met as u64;
            counts.jumps += trace.jumps() as u64;
            counts.crossing[0] += u64::from(trace.crossings() > 0);
            counts.crossing[1] += trace.crossings() as u64;
            counts.events += record.events.len() as u64;
            counts.follow(setting, trace, record, &mut touched, &mut cells);
            let anchor = setting.model(record.trace).anchor();
            let end = *trace.points().last().expect("a trace has points");
            setting.obstacles.wound(anchor, &record.wraps, end, |obstacle, turns| {
                let wound = counts.wound.entry(obstacle).or_default();
                *(if turns > 0 { &mut wound.left } else { &mut wound.right }) += 1;
                wound.turns += turns;
                wound.squares += (turns * turns) as u64;
            });
            lookups.push(key(setting, record));
        }
        counts.ropes = Ropes::of_block(lookups.into_iter());
        let traces = traced.len() as u64;
        counts.traces.add(traces);
        counts.looks.add(looks);
        for (vertex, [wraps, steps]) in touched {
            let touched = counts.touched.entry(vertex).or_default();
            touched.wraps.add(traces, wraps);
            touched.steps.add(looks, steps);
        }
        for (cell, [visits, lengths, contacts]) in cells {
            let cell = counts.cells.entry(cell).or_default();
            if visits > 0 {
                cell.visits.add(visits);
                cell.lengths.add(visits, lengths);
            }
            cell.contacts.add(looks, contacts);
        }
        (moments, counts)
    }

    /// What has to be looked at step by step: contacts, limits, the map.
    fn follow(
        &mut self,
        setting: &Setting,
        trace: &SettledTrace,
        record: &TraceRecord,
        touched: &mut HashMap<u32, [u64; 2]>,
        cells: &mut HashMap<u32, [u64; 3]>,
    ) {
        let model = setting.model(record.trace);
        let ends = trace.ends();
        // The limits that are exceeded at some time, and the first of them that was not yet.
        let (exceeded, mut next) = (setting.limits.partition_point(|&limit| limit < record.max_length), 0);
        let contact_cells = setting.cells.as_ref();
        let span = |span: super::follow::Span| {
            let length = |step: u64| span.length + ends[step as usize].distance(span.pivot);
            if next < exceeded {
                for step in span.steps.clone() {
                    while next < exceeded && length(step) > setting.limits[next] {
                        let gone = setting.times.partition_point(|&time| time < step) as u64;
                        *self.exceeded[next].entry(gone).or_default() += 1;
                        next += 1;
                    }
                }
            }
            if let Some(grid) = &setting.cells {
                let first = span.steps.start.next_multiple_of(setting.every);
                for step in (first..span.steps.end).step_by(setting.every as usize) {
                    if let Some(cell) = grid.of(ends[step as usize]) {
                        let [visits, lengths, _] = cells.entry(cell).or_default();
                        *visits += 1;
                        *lengths += (length(step) / setting.unit + 0.5) as u64;
                    }
                }
            }
        };
        let mut contacts: Vec<(u32, u64)> = Vec::new();
        let left = |held: super::follow::Held, steps| contacts.push((held.vertex, steps));
        follow(model.anchor(), model.vertices(), record.steps, &record.events, span, left);
        for (vertex, steps) in contacts {
            let [wraps, held] = touched.entry(vertex).or_default();
            *wraps += 1;
            *held += steps;
            if let Some(cell) = contact_cells.and_then(|grid| grid.of(model.vertices()[vertex as usize])) {
                cells.entry(cell).or_default()[2] += steps;
            }
        }
    }

    pub(crate) fn merge(&mut self, other: Counts) {
        fn add<K: Ord>(to: &mut BTreeMap<K, u64>, from: BTreeMap<K, u64>) {
            from.into_iter().for_each(|(key, count)| *to.entry(key).or_default() += count);
        }
        // Taken apart, so that nothing that is counted is forgotten here.
        let Counts {
            traces,
            looks,
            events,
            longest_trace,
            still,
            met,
            jumps,
            crossing,
            bins,
            lengths,
            values,
            exceeded,
            ropes,
            touched,
            wound,
            cells,
        } = other;
        self.traces.merge(&traces);
        self.looks.merge(&looks);
        self.events += events;
        self.longest_trace = self.longest_trace.max(longest_trace);
        self.still += still;
        self.met += met;
        self.jumps += jumps;
        self.crossing.iter_mut().zip(crossing).for_each(|(to, from)| *to += from);
        self.bins.iter_mut().zip(bins).for_each(|(to, from)| add(to, from));
        self.lengths.iter_mut().zip(lengths).for_each(|(to, from)| to.merge(from));
        self.values.iter_mut().zip(values).for_each(|(to, from)| add(to, from));
        self.exceeded.resize_with(self.exceeded.len().max(exceeded.len()), BTreeMap::new);
        self.exceeded.iter_mut().zip(exceeded).for_each(|(to, from)| add(to, from));
        self.ropes.merge(ropes);
        for (vertex, from) in touched {
            let to = self.touched.entry(vertex).or_default();
            to.wraps.merge(&from.wraps);
            to.steps.merge(&from.steps);
        }
        for (obstacle, from) in wound {
            let to = self.wound.entry(obstacle).or_default();
            to.left += from.left;
            to.right += from.right;
            to.turns += from.turns;
            to.squares += from.squares;
        }
        for (cell, from) in cells {
            let to = self.cells.entry(cell).or_default();
            to.visits.merge(&from.visits);
            to.lengths.merge(&from.lengths);
            to.contacts.merge(&from.contacts);
        }
    }
}

/// What tells a taut rope from others.
fn key(setting: &Setting, record: &TraceRecord) -> Vec<u32> {
    let model = setting.model(record.trace);
    let contact = |&(at, side)| {
        let vertex = model.vertex_at(at).expect("ropes turn at wall ends");
        2 * vertex + u32::from(side == Side::Right)
    };
    std::iter::once(setting.anchor(record.trace) as u32).chain(record.wraps.iter().map(contact)).collect()
}
