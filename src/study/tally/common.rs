//! Counts of what is common, of things of which there may be very many different ones.

use std::collections::BTreeMap;
use std::hash::Hash;

use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::merge::Merge;

/// How many different things of each block are counted at the most: the most common ones.
pub(super) const A_BLOCK: usize = 256;

/// Counts of things. In each block the most common ones are counted and the others left out, so that memory grows
/// slowly: by no more than these a block, and in fact by those that were not common before. What may be missing from a
/// count is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(bound(deserialize = "K: Deserialize<'de> + Ord"))]
pub(crate) struct Common<K> {
    counts: BTreeMap<K, u64>,
    /// By how much each count can be too low at the most: in each block, by as much as the least count that was kept.
    missing: u64,
}

impl<K> Default for Common<K> {
    fn default() -> Self {
        Common { counts: BTreeMap::new(), missing: 0 }
    }
}

impl<K: Ord + Hash> Common<K> {
    /// The things of one block, each with how often it is there.
    pub(super) fn of_block(counts: HashMap<K, u64>) -> Self {
        if counts.len() <= A_BLOCK {
            return Common { counts: counts.into_iter().collect(), missing: 0 };
        }
        let mut all: Vec<(K, u64)> = counts.into_iter().collect();
        all.sort_unstable_by(|(k, n), (l, m)| m.cmp(n).then_with(|| k.cmp(l)));
        all.truncate(A_BLOCK);
        let missing = all.last().map_or(0, |last| last.1);
        Common { counts: all.into_iter().collect(), missing }
    }

    /// The `most` most common ones, the most common first, with their counts and what these are at the most.
    pub(super) fn top(&self, most: usize) -> Vec<(&K, u64, u64)> {
        let mut all: Vec<_> = self.counts.iter().map(|(key, &n)| (key, n, n + self.missing)).collect();
        all.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
        all.truncate(most);
        all
    }

    /// How many different ones are counted, and whether none was left out.
    pub(super) fn distinct(&self) -> (u64, bool) {
        (self.counts.len() as u64, self.missing == 0)
    }
}

impl<K: Ord> Merge for Common<K> {
    fn merge_with(&mut self, other: Common<K>) {
        self.counts.merge_with(other.counts);
        self.missing += other.missing;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_block(things: impl Iterator<Item = Vec<u32>>) -> Common<Vec<u32>> {
        let mut counts = HashMap::default();
        things.for_each(|key| *counts.entry(key).or_default() += 1);
        Common::of_block(counts)
    }

    #[test]
    fn what_is_left_out_is_known() {
        let block = |rare: u32| {
            // One rope is common; of 400 others some are seen twice.
            let others = (0..400).flat_map(move |i| vec![vec![rare, i]; if i < 300 { 2 } else { 1 }]);
            of_block(others.chain(vec![vec![7]; 50]))
        };
        let mut ropes = block(0);
        ropes.merge_with(block(1));
        ropes.merge_with(of_block([vec![7], vec![0, 5]].into_iter()));
        assert_eq!(ropes.top(1), [(&vec![7], 101, 105)]);
        assert_eq!(ropes.top(2)[1], (&vec![0, 5], 3, 7));
        assert_eq!(ropes.distinct(), (1 + 2 * 255, false));
    }
}
