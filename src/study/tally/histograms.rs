//! How many ropes are how long, bin by bin.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::scalars::{LENGTH, MAX_LENGTH, Quantity};
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::geometry::number;
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// Of what there are histograms.
const DRAWN: [Quantity; 2] = [LENGTH, MAX_LENGTH];

/// The tally of lengths by bins.
pub(crate) struct Histograms {
    /// The width of a bin.
    width: f64,
}

/// How many traces have a length in each bin.
type Bins = BTreeMap<u64, u64>;

impl Tally for Histograms {
    type Part = [Bins; DRAWN.len()];
    type Counts = [Bins; DRAWN.len()];
    type Answer = Vec<Histogram>;

    fn check(options: &TallyPlan) -> Result<(), PlanError> {
        if options.bin.is_finite() && options.bin >= 0.0 {
            return Ok(());
        }
        Err(PlanError::new(format!("tallies.bin: {} is no width", number(options.bin))))
    }

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        let width = if options.bin > 0.0 { options.bin } else { setting.extent() / 64.0 };
        let least = setting.unit();
        if width < least {
            return Err(PlanError::new(format!(
                "tallies.bin: {} is too narrow for lengths in this scene; give at least {least:e}, or 0 for a \
                 usual width",
                number(width)
            )));
        }
        Ok(Histograms { width })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        for (quantity, bins) in DRAWN.iter().zip(part) {
            *bins.entry(((quantity.of)(traced.record) / self.width) as u64).or_default() += 1;
        }
    }

    fn finish(&self, part: Self::Part, _: &Size) -> Self::Counts {
        part
    }

    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Vec<Histogram> {
        let share = |count: u64| setting.confidence.share(count, totals.traces.sum);
        let bin = |(&bin, &count): (&u64, &u64)| Bin { bin, count, share: share(count) };
        let histogram = |(quantity, bins): (&Quantity, &Bins)| Histogram {
            name: quantity.name.to_owned(),
            width: self.width,
            bins: bins.iter().map(bin).collect(),
        };
        DRAWN.iter().zip(counts).map(histogram).collect()
    }
}

/// How many traces have which value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Histogram {
    /// `length` or `max_length`.
    pub name: String,
    /// How wide a bin is, in the scene's unit: bin i is from i times this up to i + 1 times this.
    pub width: f64,
    /// The bins that are not empty, in order.
    pub bins: Vec<Bin>,
}

/// A bin of a histogram.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bin {
    /// Its number, counted from 0: bin i holds the lengths from i times `width` up to i + 1 times `width`, the latter
    /// left out.
    pub bin: u64,
    /// How many traces are in it.
    pub count: u64,
    /// Which share of all traces that is.
    pub share: Estimate,
}
