//! What is counted of all traces together.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::batches::Sizes;
use super::merge::Merge;
use super::traced::{Size, Traced};
use crate::trade::Traded;

/// Sums over all traces of some blocks.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Totals {
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
    pub crossing_traces: u64,
    pub crossing_steps: u64,
}

impl Totals {
    /// Counts a trace, but for the sizes, which are known once its block is whole.
    pub(super) fn add(&mut self, traced: &Traced<'_>) {
        let (trace, record) = (traced.trace, traced.record);
        self.events += record.events.len() as u64;
        self.longest_trace = self.longest_trace.max(record.steps);
        self.still += trace.walked().still as u64;
        self.met += trace.walked().met as u64;
        self.jumps += trace.jumps() as u64;
        self.crossing_traces += u64::from(trace.crossings() > 0);
        self.crossing_steps += trace.crossings() as u64;
    }

    pub(super) fn finish(mut self, block: &Size) -> Self {
        self.traces.add(block.traces);
        self.looks.add(block.looks);
        self
    }

    /// How many steps there are.
    pub(crate) fn steps(&self) -> u64 {
        self.looks.sum - self.traces.sum
    }

    /// Which share of the steps so many are; `None` where there are no steps.
    pub(crate) fn share_of_steps(&self, count: u64) -> Option<f64> {
        let steps = self.steps();
        (steps > 0).then(|| count as f64 / steps as f64)
    }

    /// What it came to that accuracy was given for speed, in a scene of so many wall ends of which so many were left.
    pub(crate) fn traded(&self, vertices: usize, vertices_left: usize) -> Traded {
        Traded {
            vertices: vertices as u64,
            vertices_left: vertices_left as u64,
            jumps: self.jumps,
            crossing_traces: self.crossing_traces,
            crossing_steps: self.crossing_steps,
        }
    }
}

impl Merge for Totals {
    fn merge_with(&mut self, other: Totals) {
        // Taken apart, so that nothing that is counted is forgotten here.
        let Totals { traces, looks, events, longest_trace, still, met, jumps, crossing_traces, crossing_steps } = other;
        self.traces.merge_with(traces);
        self.looks.merge_with(looks);
        self.events += events;
        self.longest_trace = self.longest_trace.max(longest_trace);
        self.still += still;
        self.met += met;
        self.jumps += jumps;
        self.crossing_traces += crossing_traces;
        self.crossing_steps += crossing_steps;
    }
}
