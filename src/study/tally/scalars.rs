//! The numbers of which every trace has one.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::lengths;
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::geometry::number;
use crate::rope::{EventKind, TraceRecord};
use crate::study::estimate::{Confidence, Estimate};
use crate::study::moments::Moments;
use crate::study::plan_error::PlanError;

/// A number of which every trace has one.
pub(super) struct Quantity {
    pub name: &'static str,
    /// What it is, in the words of every table, picture and page.
    words: &'static str,
    /// Lengths are counted in classes, other numbers are whole and counted one by one.
    is_length: bool,
    pub of: fn(&TraceRecord) -> f64,
}

pub(super) const LENGTH: Quantity =
    Quantity { name: "length", words: "rope length at the end", is_length: true, of: |record| record.length };

pub(super) const MAX_LENGTH: Quantity =
    Quantity { name: "max_length", words: "greatest rope length", is_length: true, of: |record| record.max_length };

/// All of them, in the order of the summary.
const ALL: [Quantity; 6] = [
    LENGTH,
    MAX_LENGTH,
    Quantity { name: "depth", words: "depth at the end", is_length: false, of: |record| record.depth.into() },
    Quantity { name: "max_depth", words: "greatest depth", is_length: false, of: |record| record.max_depth.into() },
    Quantity { name: "wraps", words: "wraps", is_length: false, of: |record| count(record, EventKind::Wrap) },
    Quantity { name: "unwraps", words: "unwraps", is_length: false, of: |record| count(record, EventKind::Unwrap) },
];

/// Their names, in the order of the summary.
pub(in crate::study) fn scalar_names() -> [&'static str; ALL.len()] {
    ALL.map(|quantity| quantity.name)
}

/// How many quantiles there are at the most.
const MOST: usize = 1000;

/// What a scalar or a histogram of this name is about, in the words of every table, picture and page: those of the
/// glossary in `docs/studies.md`.
///
/// ```
/// assert_eq!(tautline::study::quantity("max_depth"), "greatest depth");
/// ```
pub fn quantity(name: &str) -> &str {
    ALL.iter().find(|quantity| quantity.name == name).map_or(name, |quantity| quantity.words)
}

fn count(record: &TraceRecord, kind: EventKind) -> f64 {
    record.events.iter().filter(|event| event.kind == kind).count() as f64
}

impl Quantity {
    /// The class in which a number is counted. Greater numbers have no lower one.
    fn class(&self, number: f64) -> u64 {
        if self.is_length { lengths::class(number) } else { number as u64 }
    }

    /// The ends between which the numbers of a class lie.
    fn ends(&self, class: u64) -> [f64; 2] {
        if self.is_length { lengths::ends(class) } else { [class as f64; 2] }
    }
}

/// How many numbers are in each class.
pub(super) type Classes = BTreeMap<u64, u64>;

/// The class of the number of that rank, ranks counted from 1; the last class for ranks beyond all.
pub(super) fn of_rank(classes: &Classes, rank: u64) -> Option<u64> {
    let mut below = 0;
    let reached = classes.iter().find(|&(_, &count)| {
        below += count;
        below >= rank
    });
    reached.or(classes.iter().next_back()).map(|(&class, _)| class)
}

/// The tally of all scalars.
pub(crate) struct Scalars {
    /// Of which shares quantiles are given, ascending.
    quantiles: Vec<f64>,
}

/// What is counted of a block.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Part {
    moments: [Moments; ALL.len()],
    classes: [Classes; ALL.len()],
}

/// What is counted of some blocks.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ScalarCounts {
    /// Of each block, by its number.
    moments: BTreeMap<u64, [Moments; ALL.len()]>,
    classes: [Classes; ALL.len()],
}

impl ScalarCounts {
    /// The moments of the greatest length, over all blocks in their order.
    pub(in crate::study) fn max_length(&self) -> Moments {
        let place = ALL.iter().position(|quantity| quantity.name == MAX_LENGTH.name);
        self.moments()[place.expect("it is a scalar")]
    }

    /// Of each block, by its number: the mean of each number.
    pub(in crate::study) fn means(&self) -> impl Iterator<Item = (u64, [f64; ALL.len()])> {
        self.moments.iter().map(|(&block, moments)| (block, moments.map(|moments| moments.mean)))
    }

    /// The moments over all blocks, in their order.
    pub(super) fn moments(&self) -> [Moments; ALL.len()] {
        let mut all = [Moments::default(); ALL.len()];
        for block in self.moments.values() {
            all.iter_mut().zip(block).for_each(|(all, block)| all.merge(block));
        }
        all
    }
}

impl Merge for ScalarCounts {
    fn merge_with(&mut self, mut other: ScalarCounts) {
        debug_assert!(other.moments.keys().all(|block| !self.moments.contains_key(block)), "a block is added once");
        self.moments.append(&mut other.moments);
        self.classes.merge_with(other.classes);
    }
}

impl Tally for Scalars {
    type Part = Part;
    type Counts = ScalarCounts;
    type Answer = Vec<Scalar>;

    fn check(options: &TallyPlan) -> Result<(), PlanError> {
        if options.quantiles.is_empty() || options.quantiles.len() > MOST {
            let count = options.quantiles.len();
            return Err(PlanError::new(format!("tallies.quantiles: give 1 to {MOST} shares, not {count}")));
        }
        match options.quantiles.iter().find(|share| !(**share > 0.0 && **share < 1.0)) {
            Some(bad) => Err(PlanError::new(format!("tallies.quantiles: {} is not between 0 and 1", number(*bad)))),
            None => Ok(()),
        }
    }

    fn new(options: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        Ok(Scalars { quantiles: options.ascending_quantiles() })
    }

    fn add(&self, part: &mut Part, traced: &Traced<'_>) {
        for ((quantity, moments), classes) in ALL.iter().zip(&mut part.moments).zip(&mut part.classes) {
            let value = (quantity.of)(traced.record);
            moments.add(value);
            *classes.entry(quantity.class(value)).or_default() += 1;
        }
    }

    fn finish(&self, part: Part, block: &Size) -> ScalarCounts {
        ScalarCounts { moments: BTreeMap::from([(block.number, part.moments)]), classes: part.classes }
    }

    fn answer(&self, counts: &ScalarCounts, totals: &Totals, setting: &Setting) -> Vec<Scalar> {
        self.told(counts, totals.traces.sum, &setting.confidence)
    }
}

impl Scalars {
    /// What the counts of so many traces say.
    pub(super) fn told(&self, counts: &ScalarCounts, traces: u64, confidence: &Confidence) -> Vec<Scalar> {
        let scalar = |((quantity, moments), classes): ((&Quantity, Moments), &Classes)| {
            let ends = |class| quantity.ends(class);
            distribution(quantity.name, (&moments, classes), ends, &self.quantiles, (traces, confidence))
        };
        ALL.iter().zip(counts.moments()).zip(&counts.classes).map(scalar).collect()
    }
}

/// The distribution of a number over so many traces. `ends` are those between which the numbers of a class lie.
pub(super) fn distribution(
    name: &str,
    (moments, classes): (&Moments, &Classes),
    ends: impl Fn(u64) -> [f64; 2],
    shares: &[f64],
    (traces, confidence): (u64, &Confidence),
) -> Scalar {
    // The least number below or at which that share of them lies.
    let rank = |share: f64| ((share * traces as f64).ceil() as u64).max(1);
    // A number's class is known, and that none is beyond the extremes.
    let quantile = |rank: u64| {
        let ends = of_rank(classes, rank).map_or([0.0; 2], &ends);
        ends.map(|x| x.clamp(moments.min, moments.max))
    };
    let estimate = |share: f64| {
        let [low, high] = confidence.ranks(share, traces);
        let [value, above] = quantile(rank(share));
        Estimate {
            value: value + (above - value) / 2.0,
            error: None,
            low: low.map(|rank| quantile(rank)[0]),
            high: high.map(|rank| quantile(rank)[1]),
        }
    };
    Scalar {
        name: name.to_owned(),
        mean: confidence.mean(moments),
        deviation: moments.variance().map(f64::sqrt),
        min: moments.min,
        max: moments.max,
        quantiles: shares.iter().map(|&share| Quantile { share, value: estimate(share) }).collect(),
    }
}

/// The distribution of one number a trace.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scalar {
    /// `length`, `max_length`, `depth`, `max_depth`, `wraps` or `unwraps`.
    pub name: String,
    /// The mean over the traces.
    pub mean: Estimate,
    /// The standard deviation over the traces.
    pub deviation: Option<f64>,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
    /// Quantiles. Those of counts are exact; those of lengths are the middles of classes that are at most a 128th of
    /// the lengths in them wide, so within 0.4 %.
    pub quantiles: Vec<Quantile>,
}

impl Scalar {
    /// The quantile of this share, if it is one of those that are given. O(quantiles).
    pub fn quantile(&self, share: f64) -> Option<Estimate> {
        self.quantiles.iter().find(|quantile| quantile.share == share).map(|quantile| quantile.value)
    }
}

/// A quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Quantile {
    /// Which share of the traces lies below.
    pub share: f64,
    /// The quantile. It has no standard error of its own.
    pub value: Estimate,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_found_in_any_order_of_blocks() {
        let numbers: Vec<f64> = (1..=1000).map(|i| f64::from(i * i)).collect();
        let of = |numbers: &mut dyn Iterator<Item = &f64>| {
            let mut classes = Classes::new();
            numbers.for_each(|&x| *classes.entry(LENGTH.class(x)).or_default() += 1);
            classes
        };
        let [some, others] = [0.0, 1.0].map(|odd| of(&mut numbers.iter().filter(|&x| x % 2.0 == odd)));
        let (mut one, mut two) = (some.clone(), others.clone());
        one.merge_with(others);
        two.merge_with(some);
        assert_eq!(one, two);
        for rank in [1, 10, 500, 999, 1000] {
            let ([low, high], truth) = (LENGTH.ends(of_rank(&one, rank).unwrap()), numbers[rank as usize - 1]);
            assert!(low <= truth && truth <= high, "{low} to {high} for {truth}");
        }
        assert_eq!((of_rank(&one, 1001), of_rank(&Classes::new(), 1)), (of_rank(&one, 1000), None));
    }
}
