//! Mean, median and maximum of numbers that come one by one and are not held.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use sketches_ddsketch::{Config, DDSketch};

/// How many lengths are held; their median is exact. Beyond that it is approximate.
const HELD: usize = 1 << 16;

/// The relative error of an approximate median: a fraction of the last of the four digits shown.
const ERROR: f64 = 1e-5;

/// How many classes of lengths are counted at most: 16 MB. They reach from the largest length down to 10^-18 of it; all
/// that is shorter counts as that.
const CLASSES: u32 = 1 << 21;

/// Mean, median and maximum over the traces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Statistics {
    /// The mean.
    pub mean: f64,
    /// The middle one; of an even number, the mean of the middle two.
    pub median: f64,
    /// The greatest.
    pub max: f64,
    /// By how much of itself the median may be off; not there where it is exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub median_relative_error: Option<f64>,
}

/// Whole numbers; each different one is counted, so all is exact.
#[derive(Default)]
pub(super) struct Counts(BTreeMap<u32, u64>);

impl Counts {
    pub(super) fn add(&mut self, number: u32) {
        *self.0.entry(number).or_default() += 1;
    }

    /// `None` if there are none.
    pub(super) fn statistics(&self) -> Option<Statistics> {
        let count: u64 = self.0.values().sum();
        let (&max, _) = self.0.last_key_value()?;
        let sum: u128 = self.0.iter().map(|(&number, &times)| u128::from(number) * u128::from(times)).sum();
        let ranked = |rank: u64| {
            let mut seen = 0;
            let reached = self.0.iter().find(|&(_, &times)| {
                seen += times;
                seen > rank
            });
            reached.map_or(0.0, |(&number, _)| f64::from(number))
        };
        let median = (ranked((count - 1) / 2) + ranked(count / 2)) / 2.0;
        let (mean, max) = (sum as f64 / count as f64, f64::from(max));
        Some(Statistics { mean, median, max, median_relative_error: None })
    }
}

/// Lengths, none of them negative.
#[derive(Default)]
pub(super) struct Lengths {
    held: Vec<f64>,
    /// Takes over when too many are held.
    sketch: Option<DDSketch>,
    count: u64,
    sum: f64,
    max: f64,
}

impl Lengths {
    pub(super) fn add(&mut self, length: f64) {
        self.count += 1;
        self.sum += length;
        self.max = self.max.max(length);
        match &mut self.sketch {
            Some(sketch) => sketch.add(length),
            None => {
                self.held.push(length);
                if self.held.len() > HELD {
                    let mut sketch = DDSketch::new(Config::new(ERROR, CLASSES, f64::MIN_POSITIVE));
                    self.held.drain(..).for_each(|held| sketch.add(held));
                    self.sketch = Some(sketch);
                }
            }
        }
    }

    /// `None` if there are none.
    pub(super) fn statistics(&self) -> Option<Statistics> {
        if self.count == 0 {
            return None;
        }
        let median = match &self.sketch {
            Some(sketch) => sketch.quantile(0.5).ok().flatten().unwrap_or(f64::NAN),
            None => {
                let mut sorted = self.held.clone();
                sorted.sort_by(f64::total_cmp);
                (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]) / 2.0
            }
        };
        let (mean, median_relative_error) = (self.sum / self.count as f64, self.sketch.as_ref().map(|_| ERROR));
        Some(Statistics { mean, median, max: self.max, median_relative_error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_exact() {
        let mut counts = Counts::default();
        assert_eq!(counts.statistics(), None);
        [3, 1, 7, u32::MAX].into_iter().for_each(|n| counts.add(n));
        let max = f64::from(u32::MAX);
        assert_eq!(
            counts.statistics(),
            Some(Statistics { mean: (11.0 + max) / 4.0, median: 5.0, max, median_relative_error: None })
        );
        counts.add(3);
        assert_eq!(counts.statistics().unwrap().median, 3.0);
    }

    #[test]
    fn few_lengths_are_exact_and_many_nearly_so() {
        let mut lengths = Lengths::default();
        assert_eq!(lengths.statistics(), None);
        [2.5, 0.0, 8.0, 4.0].into_iter().for_each(|n| lengths.add(n));
        let found = lengths.statistics().unwrap();
        assert_eq!(found, Statistics { mean: 3.625, median: 3.25, max: 8.0, median_relative_error: None });
        let json = serde_json::to_string(&found).unwrap();
        assert_eq!(json, r#"{"mean":3.625,"median":3.25,"max":8.0}"#);

        for scale in [1.0, 1e-130, 1e130] {
            let mut lengths = Lengths::default();
            let count = 3 * HELD;
            // Some of no length, the others evenly spread; in an order that is not theirs.
            (0..count).for_each(|i| lengths.add(scale * (i * 7919 % count).saturating_sub(1000) as f64));
            let found = lengths.statistics().unwrap();
            let expected = scale * (count / 2 - 1000) as f64;
            assert!((found.median / expected - 1.0).abs() < 2.0 * ERROR, "{} for {expected}", found.median);
            assert_eq!(found.max, scale * (count - 1001) as f64);
            assert_eq!(found.median_relative_error, Some(ERROR));
        }
    }
}
