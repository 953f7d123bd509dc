//! How a tether holds walks back.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::batches::{Batches, Sizes};
use super::merge::Merge;
use super::scalars::{Quantile, of_rank};
use super::setting::Setting;
use super::survival::{SurvivalPoint, times};
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;
use crate::study::walk::AtTether;

/// The tally of the steps that a tether held back.
pub(crate) struct HeldBack {
    /// Of which shares quantiles are given, ascending.
    quantiles: Vec<f64>,
}

/// What is counted of some traces, where there is a tether. Traces say nothing of each other: each is a batch of its
/// own.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Counts {
    traces: Sizes,
    /// How many of their steps were held back.
    steps: Batches,
    /// Those that were held back, and the numbers of the first steps that were.
    held: Sizes,
    first: Batches,
    /// How many were held back first in each step.
    firsts: BTreeMap<u64, u64>,
}

impl Merge for Counts {
    fn merge_with(&mut self, other: Counts) {
        let Counts { traces, steps, held, first, firsts } = other;
        self.traces.merge_with(traces);
        self.steps.merge_with(steps);
        self.held.merge_with(held);
        self.first.merge_with(first);
        self.firsts.merge_with(firsts);
    }
}

impl Tally for HeldBack {
    type Part = Counts;
    type Counts = Counts;
    type Answer = Option<TetherAnswer>;

    fn new(options: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        Ok(HeldBack { quantiles: options.ascending_quantiles() })
    }

    fn add(&self, part: &mut Counts, traced: &Traced<'_>) {
        let Some(held_back) = traced.trace.walked().held_back else { return };
        part.traces.add(1);
        part.steps.add(1, held_back.steps as u64);
        if let Some(first) = held_back.first {
            part.held.add(1);
            part.first.add(1, first as u64);
            *part.firsts.entry(first as u64).or_default() += 1;
        }
    }

    fn finish(&self, part: Counts, _: &Size) -> Counts {
        part
    }

    fn answer(&self, counts: &Counts, _: &Totals, setting: &Setting) -> Option<TetherAnswer> {
        let (tether, steps, confidence) = (setting.tether?, setting.steps?, &setting.confidence);
        let traces = counts.traces.sum;
        let mean = |batches: &Batches, sizes: &Sizes, unit: f64| {
            let (mean, error) = batches.ratio(sizes);
            confidence.around(mean / unit, error.map(|e| e / unit), sizes.blocks)
        };
        // A rank beyond those that were held back is that of a walk that was not.
        let at = |rank: u64| of_rank(&counts.firsts, rank).filter(|_| rank <= counts.held.sum).map(|step| step as f64);
        let quantile = |&share: &f64| {
            let [low, high] = confidence.ranks(share, traces).map(|rank| rank.and_then(at));
            let value = at(((share * traces as f64).ceil() as u64).max(1))?;
            Some(Quantile { share, value: Estimate { value, error: None, low, high } })
        };
        let (mut held, mut firsts) = (0, counts.firsts.iter().peekable());
        let point = |step: u64| {
            while let Some((_, count)) = firsts.next_if(|(first, _)| **first <= step) {
                held += count;
            }
            SurvivalPoint { step, share: confidence.share(traces - held, traces) }
        };
        (traces > 0).then(|| TetherAnswer {
            length: tether.length,
            at: tether.at,
            held_back: mean(&counts.steps, &counts.traces, steps.into()),
            never: confidence.share(traces - counts.held.sum, traces),
            first: (counts.held.sum > 0).then(|| mean(&counts.first, &counts.held, 1.0)),
            quantiles: self.quantiles.iter().filter_map(quantile).collect(),
            curve: times(steps).into_iter().map(point).collect(),
        })
    }
}

/// How a tether held walks back: the steps at whose end the rope would have been longer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TetherAnswer {
    /// How long the tether is.
    pub length: f64,
    /// What became of the steps that it held back.
    pub at: AtTether,
    /// The share of the steps that it held back: of the time, the share for which the walk strained at the tether.
    pub held_back: Estimate,
    /// The share of the walks that it never held back.
    pub never: Estimate,
    /// The mean number of the first step that it held back, counted from 1, over the walks of which it held back any;
    /// `None` if there are none. Walks that end before they are held back are not in it, so it says little where
    /// `never` is great; the quantiles do not have that fault.
    pub first: Option<Estimate>,
    /// Quantiles of the number of that step over all walks, those that were never held back counting as later than all
    /// others. Those that lie among these are left out; an end of an interval that does is `None`.
    pub quantiles: Vec<Quantile>,
    /// At how many steps the curve is given, and what it is there: the share of walks that were not held back up to
    /// that step.
    pub curve: Vec<SurvivalPoint>,
}
