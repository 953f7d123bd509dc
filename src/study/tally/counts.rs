//! Everything that is counted in whole numbers.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::lengths::Lengths;
use super::ropes::Ropes;
use super::{Batches, SCALARS, Sizes};

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
