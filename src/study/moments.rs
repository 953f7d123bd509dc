//! Mean and spread of one number a trace.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Count, mean, sum of squared differences from the mean, and extremes (Welford, Technometrics 4, 1962; merged after
/// Chan, Golub and LeVeque, 1979). Sums of floats depend on their order: numbers are taken in the order of the traces,
/// and blocks are merged in theirs.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Moments {
    pub count: u64,
    pub mean: f64,
    squares: f64,
    pub min: f64,
    pub max: f64,
}

impl Moments {
    pub(crate) fn add(&mut self, value: f64) {
        if self.count == 0 {
            (self.min, self.max) = (value, value);
        }
        self.count += 1;
        let away = value - self.mean;
        self.mean += away / self.count as f64;
        self.squares += away * (value - self.mean);
        self.min = self.min.min(value);
        self.max = self.max.max(value);
    }

    pub(crate) fn merge(&mut self, other: &Moments) {
        if self.count == 0 || other.count == 0 {
            if self.count == 0 {
                *self = *other;
            }
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let away = other.mean - self.mean;
        self.mean += away * (m / (n + m));
        self.squares += other.squares + away * away * (n * m / (n + m));
        self.count += other.count;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
    }

    /// The variance over the traces from which these were drawn; `None` for fewer than two.
    pub(crate) fn variance(&self) -> Option<f64> {
        (self.count > 1).then(|| self.squares / (self.count - 1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_parts_are_the_whole() {
        let values: Vec<f64> = (0..100).map(|i| f64::from(i * i % 37)).collect();
        let of = |values: &[f64]| {
            let mut moments = Moments::default();
            values.iter().for_each(|&v| moments.add(v));
            moments
        };
        let whole = of(&values);
        let mean = values.iter().sum::<f64>() / 100.0;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 99.0;
        assert!((whole.mean - mean).abs() < 1e-12 && (whole.variance().unwrap() - variance).abs() < 1e-10);
        let mut merged = Moments::default();
        for part in [&values[..0], &values[..1], &values[1..60], &values[60..]] {
            merged.merge(&of(part));
        }
        assert_eq!((merged.count, merged.min, merged.max), (100, 0.0, 36.0));
        assert!((merged.mean - mean).abs() < 1e-12 && (merged.variance().unwrap() - variance).abs() < 1e-10);
        assert_eq!(of(&values[..1]).variance(), None);
    }
}
