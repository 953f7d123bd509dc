//! Counting a block, trace after trace, so that one that is stopped in the middle can be gone on with.

use rustc_hash::FxHashMap as HashMap;
use serde::{Deserialize, Serialize};

use super::ropes::{Key, Ropes};
use super::setting::Setting;
use super::{Counts, Moments, SCALARS};
use crate::rope::{EventKind, Lasting, Side, TraceRecord, spans};
use crate::trace::SettledTrace;

/// A trace and what became of it.
pub(crate) struct Traced<'a> {
    pub trace: &'a SettledTrace,
    pub record: &'a TraceRecord,
}

/// A block under way: what was counted of its first traces.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(crate) struct Block {
    moments: [Moments; SCALARS.len()],
    /// All but what is known only once the block is whole.
    counts: Counts,
    /// How often the rope wrapped round each wall end, and the steps with the rope about it.
    touched: HashMap<u32, [u64; 2]>,
    /// Of each cell of the map: visits, the lengths of the ropes then, steps with a contact there.
    cells: HashMap<u32, [u64; 3]>,
    /// How many traces ended with each rope.
    ropes: HashMap<Key, u64>,
    traces: u64,
    looks: u64,
}

impl Block {
    /// A block of which nothing is counted.
    pub(crate) fn new(setting: &Setting) -> Self {
        let counts = Counts { exceeded: vec![Default::default(); setting.limits.len()], ..Counts::default() };
        Block { counts, ..Block::default() }
    }

    /// How many of its traces are counted.
    pub(crate) fn traces(&self) -> u64 {
        self.traces
    }

    /// Counts its next traces. O(steps looked at by the map + events + steps up to where limits are exceeded).
    pub(crate) fn add(&mut self, setting: &Setting, traced: &[Traced<'_>]) {
        for Traced { trace, record } in traced {
            let counts = &mut self.counts;
            let wraps = record.events.iter().filter(|e| e.kind == EventKind::Wrap).count() as u64;
            let unwraps = record.events.len() as u64 - wraps;
            let values = [u64::from(record.depth), u64::from(record.max_depth), wraps, unwraps];
            let lengths = [record.length, record.max_length];
            for (moments, value) in self.moments.iter_mut().zip(lengths.into_iter().chain(values.map(|v| v as f64))) {
                moments.add(value);
            }
            for ((bins, classes), length) in counts.bins.iter_mut().zip(&mut counts.lengths).zip(lengths) {
                *bins.entry((length / setting.bin) as u64).or_default() += 1;
                classes.add(length);
            }
            for (counts, value) in counts.values.iter_mut().zip(values) {
                *counts.entry(value).or_default() += 1;
            }
            self.looks += record.steps + 1;
            counts.longest_trace = counts.longest_trace.max(record.steps);
            counts.still += trace.walked().still as u64;
            counts.met += trace.walked().met as u64;
            counts.jumps += trace.jumps() as u64;
            counts.crossing[0] += u64::from(trace.crossings() > 0);
            counts.crossing[1] += trace.crossings() as u64;
            counts.events += record.events.len() as u64;
            let anchor = setting.model(record.trace).anchor();
            let end = *trace.points().last().expect("a trace has points");
            setting.obstacles.wound(anchor, &record.wraps, end, |obstacle, turns| {
                let wound = counts.wound.entry(obstacle).or_default();
                *(if turns > 0 { &mut wound.left } else { &mut wound.right }) += 1;
                wound.turns += turns;
                wound.squares += (turns * turns) as u64;
            });
            self.follow(setting, trace, record);
            *self.ropes.entry(key(setting, record)).or_default() += 1;
            self.traces += 1;
        }
    }

    /// The moments of the block's scalars and its counts, once it is whole.
    pub(crate) fn finish(self) -> ([Moments; SCALARS.len()], Counts) {
        let Block { moments, mut counts, touched, cells, ropes, traces, looks } = self;
        counts.ropes = Ropes::of_block(ropes);
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
    fn follow(&mut self, setting: &Setting, trace: &SettledTrace, record: &TraceRecord) {
        let Block { counts, touched, cells, .. } = self;
        let model = setting.model(record.trace);
        let ends = trace.ends();
        // The limits that are exceeded at some time, and the first of them that was not yet.
        let (exceeded, mut next) = (setting.limits.partition_point(|&limit| limit < record.max_length), 0);
        spans(model.anchor(), model.vertices(), record.steps, &record.events, |lasting| match lasting {
            Lasting::Rope(rope, steps) => {
                if next < exceeded {
                    for step in steps.clone() {
                        while next < exceeded && rope.length(ends[step as usize]) > setting.limits[next] {
                            let gone = setting.times.partition_point(|&time| time < step) as u64;
                            *counts.exceeded[next].entry(gone).or_default() += 1;
                            next += 1;
                        }
                    }
                }
                if let Some(grid) = &setting.cells {
                    let first = steps.start.next_multiple_of(setting.every);
                    for step in (first..steps.end).step_by(setting.every as usize) {
                        if let Some(cell) = grid.of(ends[step as usize]) {
                            let [visits, lengths, _] = cells.entry(cell).or_default();
                            *visits += 1;
                            *lengths += (rope.length(ends[step as usize]) / setting.unit + 0.5) as u64;
                        }
                    }
                }
            }
            Lasting::Contact { vertex, steps } => {
                let [wraps, held] = touched.entry(vertex).or_default();
                *wraps += 1;
                *held += steps;
                if let Some(cell) = setting.cells.and_then(|grid| grid.of(model.vertices()[vertex as usize])) {
                    cells.entry(cell).or_default()[2] += steps;
                }
            }
        });
    }
}

/// What tells a taut rope from others.
fn key(setting: &Setting, record: &TraceRecord) -> Key {
    let model = setting.model(record.trace);
    let contact = |&(at, side)| {
        let vertex = model.vertex_at(at).expect("ropes turn at wall ends");
        2 * vertex + u32::from(side == Side::Right)
    };
    std::iter::once(setting.anchor(record.trace) as u32).chain(record.wraps.iter().map(contact)).collect()
}
