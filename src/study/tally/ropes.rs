//! How common each taut rope is.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::rope::Side;
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// How many different ropes of each block are counted at the most: the most common ones.
const ROPES_A_BLOCK: usize = 256;

/// A taut rope: its anchor's number, then for each contact twice the wall end's number, and one more if it lies right.
type Key = Vec<u32>;

/// Counts of ropes. In each block the most common ropes are counted and the others left out, so that memory grows
/// slowly: by no more than these a block, and in fact by those that were not common before. What may be missing from a
/// count is known.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Common {
    counts: BTreeMap<Key, u64>,
    /// By how much each count can be too low at the most: in each block, by as much as the least count that was kept.
    missing: u64,
}

impl Common {
    /// The ropes of one block, with how many traces ended with each.
    fn of_block(counts: HashMap<Key, u64>) -> Self {
        if counts.len() <= ROPES_A_BLOCK {
            return Common { counts: counts.into_iter().collect(), missing: 0 };
        }
        let mut all: Vec<(Key, u64)> = counts.into_iter().collect();
        all.sort_unstable_by(|(k, n), (l, m)| m.cmp(n).then_with(|| k.cmp(l)));
        all.truncate(ROPES_A_BLOCK);
        let missing = all.last().map_or(0, |last| last.1);
        Common { counts: all.into_iter().collect(), missing }
    }

    /// The `most` most common ropes, the most common first, with their counts and what these are at the most.
    fn top(&self, most: usize) -> Vec<(&Key, u64, u64)> {
        let mut all: Vec<_> = self.counts.iter().map(|(key, &n)| (key, n, n + self.missing)).collect();
        all.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(b.0)));
        all.truncate(most);
        all
    }
}

impl Merge for Common {
    fn merge_with(&mut self, other: Common) {
        self.counts.merge_with(other.counts);
        self.missing += other.missing;
    }
}

/// The tally of taut ropes at the end.
pub(crate) struct Ropes {
    /// How many are told.
    most: usize,
}

impl Tally for Ropes {
    /// How many traces ended with each rope.
    type Part = HashMap<Key, u64>;
    type Counts = Common;
    type Answer = Vec<CommonRope>;

    fn new(options: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        Ok(Ropes { most: options.ropes as usize })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        *part.entry(key(traced)).or_default() += 1;
    }

    fn finish(&self, part: Self::Part, _: &Size) -> Common {
        Common::of_block(part)
    }

    fn answer(&self, counts: &Common, totals: &Totals, setting: &Setting) -> Vec<CommonRope> {
        let traces = totals.traces.sum;
        let rope = |(key, count, at_most): (&Key, u64, u64)| {
            let (anchor, contacts) = key.split_first().expect("a rope has an anchor");
            let side = |&contact: &u32| if contact % 2 == 1 { Side::Right } else { Side::Left }.shown(setting.y_down());
            let at_most = at_most.min(traces);
            // As low as the lower count may be, as high as the higher one.
            let [lower, higher] = [count, at_most].map(|count| setting.confidence.share(count, traces));
            CommonRope {
                count,
                at_most,
                share: Estimate { high: higher.high, ..lower },
                anchor: setting.models[*anchor as usize].anchor().into(),
                wraps: contacts.iter().map(|c| setting.at(c / 2)).collect(),
                sides: contacts.iter().map(|c| side(c).name().to_owned()).collect(),
                labels: match setting.is_nameless() {
                    true => Vec::new(),
                    false => contacts.iter().map(|c| setting.label(c / 2)).collect(),
                },
            }
        };
        counts.top(self.most).into_iter().map(rope).collect()
    }
}

/// What tells a trace's taut rope from others.
fn key(traced: &Traced<'_>) -> Key {
    let contact = |&(at, side)| {
        let vertex = traced.model.vertex_at(at).expect("ropes turn at wall ends");
        2 * vertex + u32::from(side == Side::Right)
    };
    std::iter::once(traced.anchor as u32).chain(traced.record.wraps.iter().map(contact)).collect()
}

/// A taut rope and how common it is. Ropes that turn at the same wall ends on the same sides in the same order are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonRope {
    /// How many traces ended with it, at the least.
    pub count: u64,
    /// How many at the most: ropes that are rare in a block are not all counted.
    pub at_most: u64,
    /// The share of all traces that `count` is.
    pub share: Estimate,
    /// Which of the anchors it is tied to.
    pub anchor: [f64; 2],
    /// Its turns, from the anchor: the places of the wall ends at which it bends.
    pub wraps: Vec<[f64; 2]>,
    /// On which side of the rope the wall end of each turn lies, seen from the anchor: `left` or `right`, as a picture
    /// of the scene shows it.
    pub sides: Vec<String>,
    /// What the scene's file calls the things there; left out where it calls nothing anything.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<Option<String>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_block(ropes: impl Iterator<Item = Key>) -> Common {
        let mut counts = HashMap::default();
        ropes.for_each(|key| *counts.entry(key).or_default() += 1);
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
    }
}
