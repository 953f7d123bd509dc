//! What friction makes of the tension in ropes, if it is asked for.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::batches::Batches;
use super::lengths;
use super::merge::Merge;
use super::scalars::{Classes, Scalar, distribution};
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::geometry::number;
use crate::rope::{Friction, Steps};
use crate::study::estimate::Estimate;
use crate::study::moments::Moments;
use crate::study::plan_error::PlanError;

/// The greatest number that is counted; tensions grow exponentially, and this one has a square.
const MOST: f64 = f64::from_bits((1023 + 500) << 52);

/// The numbers of which every trace has one: the greatest tension, and the work.
pub(in crate::study) const NAMES: [&str; 2] = ["tension", "work"];

/// The tally of tensions, if it is asked for.
pub(crate) struct Tensions(Option<Known>);

struct Known {
    friction: Friction,
    /// Of which tensions it is told how often they are exceeded, ascending.
    tensions: Vec<f64>,
    /// Of which shares quantiles are given, ascending.
    quantiles: Vec<f64>,
}

/// What is counted of a block.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Part {
    moments: [Moments; NAMES.len()],
    classes: [Classes; NAMES.len()],
    /// For each tension: in how many steps the rope had a greater one. Those that none had may be left out at the end.
    above: Vec<u64>,
}

/// What is counted of some blocks.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Counts {
    /// Of each block, by its number.
    moments: BTreeMap<u64, [Moments; NAMES.len()]>,
    classes: [Classes; NAMES.len()],
    /// Over blocks as large as they have steps.
    above: Vec<Batches>,
}

impl Counts {
    /// The means of both numbers over the traces of a block, if it is counted.
    pub(in crate::study) fn means(&self, block: u64) -> Option<[f64; NAMES.len()]> {
        self.moments.get(&block).map(|moments| moments.map(|moments| moments.mean))
    }
}

impl Merge for Counts {
    fn merge_with(&mut self, other: Counts) {
        let Counts { mut moments, classes, above } = other;
        self.moments.append(&mut moments);
        self.classes.merge_with(classes);
        self.above.merge_with(above);
    }
}

impl TallyPlan {
    /// The friction of ropes, if a plan that was checked has any.
    pub(in crate::study) fn friction(&self) -> Option<Friction> {
        self.friction.and_then(|coefficient| Friction::new(coefficient).ok())
    }
}

impl Tally for Tensions {
    type Part = Part;
    type Counts = Counts;
    type Answer = Option<FrictionAnswer>;

    fn check(options: &TallyPlan) -> Result<(), PlanError> {
        if let Some(fault) = options.friction.and_then(|coefficient| Friction::new(coefficient).err()) {
            return Err(PlanError::new(format!("tallies.friction: {fault}")));
        }
        match options.tensions.iter().find(|tension| !(tension.is_finite() && **tension >= 1.0)) {
            Some(bad) => Err(PlanError::new(format!(
                "tallies.tensions: {} is below 1, which is that of the anchor, or no number",
                number(*bad)
            ))),
            None if options.friction.is_none() && options.tensions != TallyPlan::default().tensions => {
                Err(PlanError::new("tallies.tensions goes with tallies.friction, which is not given".to_owned()))
            }
            None => Ok(()),
        }
    }

    fn new(options: &TallyPlan, _: &Setting) -> Result<Self, PlanError> {
        let mut tensions = options.tensions.clone();
        tensions.sort_by(f64::total_cmp);
        tensions.dedup();
        let quantiles = options.ascending_quantiles();
        Ok(Tensions(options.friction().map(|friction| Known { friction, tensions, quantiles })))
    }

    /// O(steps).
    fn add(&self, part: &mut Part, traced: &Traced<'_>) {
        let Some(Known { friction, tensions, .. }) = &self.0 else { return };
        let steps = Steps::new(traced.model, traced.trace, traced.record, &[]);
        let mut steps = steps.with_friction(Some(*friction));
        let (mut most, mut work) = (1.0f64, 0.0);
        while steps.next().is_some() {
            let Some(strain) = steps.strain() else { continue };
            (most, work) = (most.max(strain.tension), strain.work);
            let above = tensions.partition_point(|&tension| tension < strain.tension);
            part.above.resize(part.above.len().max(above), 0);
            part.above[..above].iter_mut().for_each(|steps| *steps += 1);
        }
        // Work is no less than the length, but for roundings.
        for (i, value) in [most.min(MOST), work.clamp(0.0, MOST)].into_iter().enumerate() {
            part.moments[i].add(value);
            *part.classes[i].entry(lengths::class(value)).or_default() += 1;
        }
    }

    fn finish(&self, part: Part, block: &Size) -> Counts {
        if self.0.is_none() {
            return Counts::default();
        }
        let above = |steps| {
            let mut batches = Batches::default();
            batches.add(block.looks, steps);
            batches
        };
        Counts {
            moments: BTreeMap::from([(block.number, part.moments)]),
            classes: part.classes,
            above: part.above.into_iter().map(above).collect(),
        }
    }

    fn answer(&self, counts: &Counts, totals: &Totals, setting: &Setting) -> Option<FrictionAnswer> {
        let Known { friction, tensions, quantiles } = self.0.as_ref()?;
        let mut all = [Moments::default(); NAMES.len()];
        for block in counts.moments.values() {
            all.iter_mut().zip(block).for_each(|(all, block)| all.merge(block));
        }
        let told = |i: usize| {
            let (classes, of) = (&counts.classes[i], (totals.traces.sum, &setting.confidence));
            distribution(NAMES[i], (&all[i], classes), lengths::ends, quantiles, of)
        };
        let above = |(i, &tension): (usize, &f64)| {
            // A block that is left out at the end has no such steps.
            let (share, error) = counts.above.get(i).copied().unwrap_or_default().ratio(&totals.looks);
            StepsAbove { tension, share: setting.confidence.around(share, error, totals.traces.blocks) }
        };
        (totals.traces.sum > 0).then(|| FrictionAnswer {
            coefficient: friction.coefficient(),
            tension: told(0),
            work: told(1),
            above: tensions.iter().enumerate().map(above).collect(),
        })
    }
}

/// What Coulomb friction makes of ropes that are hauled at the free end, for a tension of 1 at the anchor. Numbers
/// above 2^500 count as that.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FrictionAnswer {
    /// The coefficient of friction.
    pub coefficient: f64,
    /// Of each trace the greatest tension at the free end after any step: e to the power of the coefficient times all
    /// the angles by which the rope turns.
    pub tension: Scalar,
    /// Of each trace the work of the free end. Without friction it is the rope's length at the end.
    pub work: Scalar,
    /// For each of `tallies.tensions`, how often it is exceeded.
    pub above: Vec<StepsAbove>,
}

/// How often the tension is above a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StepsAbove {
    /// The number.
    pub tension: f64,
    /// The share of all steps after which the tension at the free end, hauled, is greater.
    pub share: Estimate,
}
