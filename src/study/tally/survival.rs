//! For how long ropes stay short.

use std::collections::BTreeMap;

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::geometry::number;
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// At how many steps survival curves are given.
const TIMES: u64 = 100;

/// The steps at which curves of walks of so many are given, ascending.
pub(super) fn times(steps: u32) -> Vec<u64> {
    let mut times: Vec<u64> =
        (0..=TIMES).map(|i| (u128::from(steps) * u128::from(i) / u128::from(TIMES)) as u64).collect();
    times.dedup();
    times
}

/// The tally of when ropes become longer than each limit.
pub(crate) struct Limits {
    /// The limits, ascending.
    limits: Vec<f64>,
    /// The steps at which survival curves are given, ascending.
    times: Vec<u64>,
}

impl Limits {
    /// The limits, ascending.
    pub(in crate::study) fn limits(&self) -> &[f64] {
        &self.limits
    }

    /// How many of the limits a rope exceeds that is at most so long.
    pub(super) fn exceeded(&self, max_length: f64) -> usize {
        self.limits.partition_point(|&limit| limit < max_length)
    }
}

/// For each limit: how many ropes first became longer after so many of the times had gone by. Limits that no rope
/// exceeded may be left out at the end.
type Times = Vec<BTreeMap<u64, u64>>;

/// What is counted of some blocks.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct LimitCounts {
    times: Times,
    /// Of each block, by its number, where there are limits: how many of its ropes became longer than each; those that
    /// none exceeded may be left out at the end. For comparisons block by block.
    blocks: BTreeMap<u64, Vec<u64>>,
}

impl LimitCounts {
    /// How many ropes of a block became longer than the limit of this place.
    pub(in crate::study) fn longer(&self, block: u64, limit: usize) -> u64 {
        self.blocks.get(&block).and_then(|longer| longer.get(limit)).copied().unwrap_or(0)
    }
}

impl Merge for LimitCounts {
    fn merge_with(&mut self, other: LimitCounts) {
        let LimitCounts { times, blocks } = other;
        self.times.merge_with(times);
        self.blocks.merge_with(blocks);
    }
}

impl Tally for Limits {
    type Part = Times;
    type Counts = LimitCounts;
    type Answer = Vec<Survival>;

    fn check(options: &TallyPlan) -> Result<(), PlanError> {
        match options.limits.iter().find(|l| !(l.is_finite() && **l >= 0.0)) {
            Some(bad) => Err(PlanError::new(format!("tallies.limits: {} is no length", number(*bad)))),
            None => Ok(()),
        }
    }

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        let mut limits = options.limits.clone();
        limits.sort_by(f64::total_cmp);
        // Nobody knows yet how long given traces are.
        let unknown = || (0..4).chain((8..128).map(|i| (4 + i % 4) << (i / 4 - 2))).collect();
        Ok(Limits { limits, times: setting.steps.map_or_else(unknown, times) })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let all = self.exceeded(traced.record.max_length);
        part.resize_with(part.len().max(all), BTreeMap::new);
        // The limits that are exceeded at some time, and the first of them that was not yet.
        let (exceeded, mut next) = (&self.limits[..all], 0);
        for span in &traced.lasting.spans {
            let (pivot, mut step) = (span.leg.pivot(), span.steps.start);
            while let Some(&limit) = exceeded.get(next) {
                // Most steps end so near that no length needs to be computed.
                let near = span.leg.surely_within(limit);
                let is_far = |end: &DVec2| pivot.distance_squared(*end) > near;
                let Some(far) = traced.ends[step..span.steps.end].iter().position(is_far) else { break };
                step += far;
                let length = span.leg.length(traced.ends[step]);
                while next < exceeded.len() && length > exceeded[next] {
                    let gone = self.times.partition_point(|&time| time < step as u64) as u64;
                    *part[next].entry(gone).or_default() += 1;
                    next += 1;
                }
                step += 1;
            }
        }
    }

    fn finish(&self, part: Times, block: &Size) -> LimitCounts {
        let longer = part.iter().map(|times| times.values().sum()).collect();
        let blocks = if self.limits.is_empty() { BTreeMap::new() } else { BTreeMap::from([(block.number, longer)]) };
        LimitCounts { times: part, blocks }
    }

    /// For each limit the share of ropes that were never longer up to a step, or up to their trace's end if that came
    /// before.
    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Vec<Survival> {
        let (traces, last) = (totals.traces.sum, totals.longest_trace);
        let curve = |(i, &limit): (usize, &f64)| {
            let exceeded =
                |time: usize| counts.times.get(i).and_then(|times| times.get(&(time as u64))).copied().unwrap_or(0);
            let still = |longer: u64| setting.confidence.share(traces - longer, traces);
            let mut longer = 0;
            let point = |(time, &step): (usize, &u64)| {
                longer += exceeded(time);
                SurvivalPoint { step, share: still(longer) }
            };
            let before = self.times.iter().enumerate().take_while(|&(_, &step)| step < last);
            let mut curve: Vec<SurvivalPoint> = before.map(point).collect();
            // How long given traces are is only known in the end.
            let all = counts.times.get(i).map_or(0, |times| times.values().sum());
            curve.push(SurvivalPoint { step: last, share: still(all) });
            Survival { limit, curve }
        };
        // There is no curve before the first block is whole.
        let limits = if totals.traces.blocks > 0 { &self.limits[..] } else { &[] };
        limits.iter().enumerate().map(curve).collect()
    }
}

/// Which share of the ropes was never longer than a limit, step by step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Survival {
    /// The limit.
    pub limit: f64,
    /// At how many steps the curve is given, and what it is there: the share of traces whose rope was never longer than
    /// the limit up to that step.
    pub curve: Vec<SurvivalPoint>,
}

/// A point of a survival curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurvivalPoint {
    /// The step.
    pub step: u64,
    /// The share.
    pub share: Estimate,
}

/// A share of ropes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShareWithin {
    /// The limit.
    pub limit: f64,
    /// The share of ropes that never were longer.
    pub share: Estimate,
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::engine::{Engine, Job, Reference};
    use crate::example::{Walker, floor_plan, walks};
    use crate::rope::replay;
    use crate::scene::Model;
    use crate::trace::settle;

    #[test]
    fn limits_are_exceeded_where_steps_say_so_one_by_one() {
        let model = Arc::new(Model::new(floor_plan(), None).unwrap());
        let traces: Vec<_> = walks(&model, Walker { step: 1.0, steps: 200, seed: 7 }, 24)
            .into_iter()
            .map(|trace| settle(&model, &trace))
            .collect();
        let records = Reference::new(model.clone()).evaluate(&traces, &Job::new()).unwrap();
        // Also limits that some rope is as long as, to the last bit.
        let mut limits: Vec<f64> = (0..40).map(|i| 0.5 * f64::from(i)).collect();
        limits.extend(records.iter().flat_map(|record| [record.max_length, record.length]));
        let options = TallyPlan { limits, ..TallyPlan::default() };
        let setting = Setting::new(&options, vec![model.clone()], model.bounds(), (Some(200), None));
        let tally = Limits::new(&options, &setting).unwrap();
        let mut seen = 0;
        for (trace, record) in traces.iter().zip(&records) {
            let traced = Traced::new(&setting, trace, record);
            let mut part = Vec::new();
            tally.add(&mut part, &traced);
            let mut expected: Vec<BTreeMap<u64, u64>> = vec![BTreeMap::new(); part.len()];
            let mut next = 0;
            replay(model.anchor(), model.vertices(), traced.ends.len(), &record.events, |step, rope| {
                while next < tally.limits.len() && rope.length(traced.ends[step]) > tally.limits[next] {
                    let gone = tally.times.iter().filter(|&&time| time < step as u64).count();
                    expected[next].insert(gone as u64, 1);
                    next += 1;
                }
            });
            assert_eq!(part, expected);
            seen += next;
        }
        assert!(seen > 200, "{seen}");
    }
}
