//! By how much the answers of two studies differ, block by block.

use std::collections::BTreeMap;

use super::blocks::BlockMeans;
use super::difference::{Differences, ErrorsFrom, MeanDifference, ShareDifference};
use super::estimate::{Confidence, Estimate};
use super::tally::{FRICTION, scalar_names};

/// What of a study is compared block by block.
pub(super) struct Blocks<'a> {
    pub blocks: &'a BTreeMap<u64, BlockMeans>,
    /// Ascending.
    pub limits: &'a [f64],
}

/// By how much the answer of `here` differs from that of `there`, over the blocks that have as many traces in both.
pub(super) fn paired(here: &Blocks<'_>, there: &Blocks<'_>, confidence: &Confidence) -> Differences {
    let both: Vec<(&BlockMeans, &BlockMeans)> = here
        .blocks
        .iter()
        .filter_map(|(number, block)| Some((block, there.blocks.get(number)?)))
        .filter(|(one, other)| one.traces == other.traces)
        .collect();
    let of = |difference: &dyn Fn(&BlockMeans, &BlockMeans) -> f64| {
        let blocks: Vec<(u64, f64)> = both.iter().map(|(one, other)| (one.traces, difference(one, other))).collect();
        mean_of(&blocks, confidence)
    };
    let scalar = |(place, name): (usize, &'static str)| MeanDifference {
        name: name.to_owned(),
        mean: of(&|one, other| one.scalars[place] - other.scalars[place]),
    };
    let share = |(place, &limit): (usize, &f64)| {
        let other_place = there.limits.iter().position(|&other| other == limit)?;
        let share = of(&|one, other| (other.longer[other_place] as f64 - one.longer[place] as f64) / one.traces as f64);
        let [ropes, longer, other_longer] = both.iter().fold([0; 3], |[ropes, here, there], (one, other)| {
            [ropes + one.traces, here + one.longer[place], there + other.longer[other_place]]
        });
        let says_nothing = longer == other_longer && (longer == 0 || longer == ropes);
        let without = |e: Estimate| Estimate { error: None, low: None, high: None, ..e };
        Some(ShareDifference { limit, share: share.map(|e| if says_nothing { without(e) } else { e }) })
    };
    let frictions = both.iter().all(|(one, other)| !one.friction.is_empty() && !other.friction.is_empty());
    let friction = |(place, name): (usize, &&'static str)| MeanDifference {
        name: (*name).to_owned(),
        mean: of(&|one, other| one.friction[place] - other.friction[place]),
    };
    Differences {
        errors_from: ErrorsFrom::PairedBlocks,
        scalars: scalar_names().into_iter().enumerate().map(scalar).collect(),
        within: here.limits.iter().enumerate().filter_map(share).collect(),
        friction: FRICTION.iter().enumerate().filter(|_| frictions && !both.is_empty()).map(friction).collect(),
    }
}

/// The mean over all traces of what is known of each block: its number of traces, and the mean over them. The error is
/// that of a ratio estimator over blocks (Cochran, "Sampling Techniques", 3rd ed., 2.11); none for a single block.
fn mean_of(blocks: &[(u64, f64)], confidence: &Confidence) -> Option<Estimate> {
    let all: u64 = blocks.iter().map(|(traces, _)| traces).sum();
    if all == 0 {
        return None;
    }
    let count = blocks.len() as f64;
    let value = blocks.iter().map(|&(traces, mean)| traces as f64 * mean).sum::<f64>() / all as f64;
    let squares: f64 = blocks.iter().map(|&(traces, mean)| (traces as f64 * (mean - value)).powi(2)).sum();
    let error = (blocks.len() > 1).then(|| (squares * count / (count - 1.0)).sqrt() / all as f64);
    Some(confidence.around(value, error, blocks.len() as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(traces: u64, mean: f64, longer: u64) -> BlockMeans {
        BlockMeans { traces, scalars: vec![mean; 6], longer: vec![longer], friction: Vec::new() }
    }

    fn compared(here: &[BlockMeans], there: &[BlockMeans]) -> Differences {
        let numbered = |blocks: &[BlockMeans]| (0..).zip(blocks.iter().cloned()).collect::<BTreeMap<u64, BlockMeans>>();
        let (here, there) = (numbered(here), numbered(there));
        let of = |blocks| Blocks { blocks, limits: &[2.0] };
        paired(&of(&here), &of(&there), &Confidence::new(0.95))
    }

    #[test]
    fn what_blocks_have_in_common_cancels() {
        // Differences of 1, 2 and 3: their mean is 2, its error the root of a third.
        let here = [11.0, 52.0, 33.0].map(|mean| block(10, mean, 4));
        let there = [10.0, 50.0, 30.0].map(|mean| block(10, mean, 5));
        let found = compared(&here, &there);
        let mean = found.scalars[1].mean.unwrap();
        assert_eq!(mean.value, 2.0);
        assert!((mean.error.unwrap() - 3f64.sqrt().recip()).abs() < 1e-15, "{mean:?}");
        let share = found.within[0].share.unwrap();
        assert!((share.value - 0.1).abs() < 1e-15 && share.error.unwrap() < 1e-15, "{share:?}");
        // By hand: blocks of 30 and 10 traces with differences of 1 and 5, so 2 on the whole, and 30 (1 - 2) = -30 and
        // 10 (5 - 2) = 30 away from it.
        let found = compared(&[block(30, 1.0, 0), block(10, 5.0, 0)], &[block(30, 0.0, 0), block(10, 0.0, 0)]);
        let mean = found.scalars[0].mean.unwrap();
        assert_eq!((mean.value, mean.error), (2.0, Some(3600f64.sqrt() / 40.0)));
    }

    #[test]
    fn what_cannot_be_known_is_not_said() {
        let one = compared(&[block(10, 3.0, 1)], &[block(10, 2.0, 2)]).scalars[0].mean.unwrap();
        assert_eq!((one.value, one.error, one.low), (1.0, None, None));
        // No two blocks that are alike.
        assert_eq!(compared(&[block(10, 3.0, 0)], &[block(9, 3.0, 0)]).scalars[0].mean, None);
        for all in [0, 10] {
            let same = [block(10, 3.0, all), block(10, 4.0, all)];
            let found = compared(&same, &same);
            assert_eq!(found.scalars[0].mean.unwrap().high, Some(0.0));
            assert_eq!((found.within[0].share.unwrap().value, found.within[0].share.unwrap().error), (0.0, None));
        }
    }
}
