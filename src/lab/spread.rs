//! A number that was measured several times.

use std::fmt;

use schemars::JsonSchema;
use serde::Serialize;

use crate::words::short;

/// The least, the middle and the greatest of several measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Spread {
    /// The least.
    pub min: f64,
    /// The middle one; of an even number, the mean of the middle two.
    pub median: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// The spread of `values`; `None` if there are none.
    ///
    /// ```
    /// use tautline::lab::Spread;
    /// assert_eq!(Spread::of([3.0, 1.0, 2.0, 10.0]), Some(Spread { min: 1.0, median: 2.5, max: 10.0 }));
    /// ```
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        let (min, max) = (*values.first()?, *values.last()?);
        Some(Spread { min, median: (values[(n - 1) / 2] + values[n / 2]) / 2.0, max })
    }
}

impl fmt::Display for Spread {
    /// From the least to the greatest, in words.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", short(self.min), short(self.max))
    }
}
