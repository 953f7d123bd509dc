//! What the ropes of each anchor say, where there are several.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::merge::Merge;
use super::scalars::{Part as ScalarPart, Scalar, ScalarCounts, Scalars, scalar_names};
use super::setting::Setting;
use super::survival::{Limits, ShareWithin};
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use crate::study::difference::{Differences, ErrorsFrom, MeanDifference, ShareDifference};
use crate::study::estimate::Confidence;
use crate::study::plan_error::PlanError;

/// The tally of each anchor's ropes; `None` where it is not asked for.
pub(crate) struct Anchors(Option<(Scalars, Limits)>);

/// What is counted of an anchor's first traces of a block.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct AnchorPart {
    traces: u64,
    scalars: ScalarPart,
    /// How many ropes became longer than each limit, ascending; those that none exceeded may be left out at the end.
    longer: Vec<u64>,
}

/// What is counted of an anchor's traces of some blocks.
#[derive(Clone, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct AnchorCounts {
    traces: u64,
    scalars: ScalarCounts,
    longer: Vec<u64>,
}

impl Merge for AnchorCounts {
    fn merge_with(&mut self, other: AnchorCounts) {
        let AnchorCounts { traces, scalars, longer } = other;
        self.traces += traces;
        self.scalars.merge_with(scalars);
        self.longer.merge_with(longer);
    }
}

impl AnchorCounts {
    /// How many ropes became longer than the limit of this place.
    fn longer(&self, limit: usize) -> u64 {
        self.longer.get(limit).copied().unwrap_or(0)
    }

    /// How many stayed within it, and of how many.
    fn within(&self, limit: usize) -> (u64, u64) {
        (self.traces - self.longer(limit), self.traces)
    }

    /// By how much they differ from those of another anchor.
    fn differences(&self, other: &AnchorCounts, limits: &[f64], confidence: &Confidence) -> Differences {
        let both = scalar_names().into_iter().zip(self.scalars.moments().into_iter().zip(other.scalars.moments()));
        let mean = |(name, (one, other)): (&str, (_, _))| MeanDifference {
            name: name.to_owned(),
            mean: Some(confidence.difference(&one, &other)),
        };
        let share = |(i, &limit): (usize, &f64)| ShareDifference {
            limit,
            share: Some(confidence.share_difference(self.within(i), other.within(i))),
        };
        Differences {
            errors_from: ErrorsFrom::Independent,
            scalars: both.map(mean).collect(),
            within: limits.iter().enumerate().map(share).collect(),
            friction: Vec::new(),
        }
    }
}

impl Tally for Anchors {
    /// For each anchor; those at the end may be left out of which there is no trace yet.
    type Part = Vec<AnchorPart>;
    type Counts = Vec<AnchorCounts>;
    type Answer = Option<Vec<AnchorAnswer>>;

    fn new(options: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        let asked =
            || -> Result<_, PlanError> { Ok((Scalars::new(options, setting)?, Limits::new(options, setting)?)) };
        Ok(Anchors(options.anchors.then(asked).transpose()?))
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let Some((scalars, limits)) = &self.0 else { return };
        part.resize_with(part.len().max(traced.anchor + 1), AnchorPart::default);
        let own = &mut part[traced.anchor];
        own.traces += 1;
        scalars.add(&mut own.scalars, traced);
        let all = limits.exceeded(traced.record.max_length);
        own.longer.resize(own.longer.len().max(all), 0);
        own.longer[..all].iter_mut().for_each(|longer| *longer += 1);
    }

    fn finish(&self, part: Self::Part, block: &Size) -> Self::Counts {
        let Some((tally, _)) = &self.0 else { return Vec::new() };
        let finish = |AnchorPart { traces, scalars, longer }| AnchorCounts {
            traces,
            scalars: tally.finish(scalars, block),
            longer,
        };
        part.into_iter().map(finish).collect()
    }

    fn answer(&self, counts: &Self::Counts, _: &Totals, setting: &Setting) -> Self::Answer {
        let (scalars, limits) = self.0.as_ref()?;
        let (limits, confidence) = (limits.limits(), &setting.confidence);
        let is_there = |counts: &AnchorCounts| counts.traces > 0;
        let first = counts.first().filter(|counts| is_there(counts));
        let of = |(anchor, counts): (usize, &AnchorCounts)| {
            let within = |(i, &limit): (usize, &f64)| {
                let (count, of) = counts.within(i);
                ShareWithin { limit, share: confidence.share(count, of) }
            };
            AnchorAnswer {
                at: setting.models[anchor].anchor().into(),
                traces: counts.traces,
                scalars: scalars.told(&counts.scalars, counts.traces, confidence),
                within: limits.iter().enumerate().map(within).collect(),
                differences: first.filter(|_| anchor > 0).map(|first| counts.differences(first, limits, confidence)),
            }
        };
        Some(counts.iter().enumerate().filter(|(_, counts)| is_there(counts)).map(of).collect())
    }
}

/// What the ropes of one anchor say.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AnchorAnswer {
    /// Where the anchor is.
    pub at: [f64; 2],
    /// How many traces start from it.
    pub traces: u64,
    /// One number a trace: its distribution over the anchor's traces.
    pub scalars: Vec<Scalar>,
    /// For each of `tallies.limits`, ascending: the share of ropes that never were longer, up to their trace's end.
    pub within: Vec<ShareWithin>,
    /// By how much that differs from what the ropes of the first anchor say; `None` for the first itself.
    pub differences: Option<Differences>,
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Mutex;

    use crate::engine::{Cpu, Engine, Job};
    use crate::study::{Plan, Shard, State, Study, Summary, run};

    fn answer(anchor: &str, more: &str) -> Summary {
        let plan = format!(
            "[scene]\nbuilt_in = \"rooms\"\nanchor = {anchor}\n[walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
             [run]\ntraces = 60\nblock = 7\n[tallies]\nlimits = [9.0, 2.0]\n{more}"
        );
        let study = Study::open(Plan::parse(&plan).unwrap(), Path::new("")).unwrap();
        let state = Mutex::new(State::new(&study, Shard::WHOLE));
        let mut engines: Vec<Box<dyn Engine>> =
            study.models().iter().map(|model| Box::new(Cpu::new(model.clone())) as _).collect();
        run(&study, &mut engines, &state, &Job::new(), |_, _, _| Ok::<(), ()>(())).unwrap();
        state.into_inner().unwrap().summary(&study)
    }

    /// The same place three times: what the anchors say is what every third trace of the same walks does.
    #[test]
    fn each_anchor_says_what_its_own_traces_do() {
        let (three, one) = (answer("[[1, 1], [1, 1], [1, 1]]", "anchors = true"), answer("[1, 1]", ""));
        let anchors = three.anchors.as_ref().unwrap();
        assert_eq!(anchors.iter().map(|anchor| (anchor.at, anchor.traces)).collect::<Vec<_>>(), [([1.0; 2], 20); 3]);
        assert_eq!(three.scalars, one.scalars);
        for (place, all) in one.scalars.iter().enumerate() {
            let of = |anchor: usize| &anchors[anchor].scalars[place];
            let mean = (0..3).map(|anchor| of(anchor).mean.value).sum::<f64>() / 3.0;
            assert!((mean - all.mean.value).abs() <= 1e-12 * mean.abs(), "{}", all.name);
            assert_eq!((0..3).map(|anchor| of(anchor).max).fold(0.0, f64::max), all.max);
        }
        for (place, within) in anchors[0].within.iter().enumerate() {
            let share = anchors.iter().map(|anchor| anchor.within[place].share.value).sum::<f64>() / 3.0;
            let whole = one.survival[place].curve.last().unwrap().share.value;
            assert!(within.limit == [2.0, 9.0][place] && (share - whole).abs() < 1e-12);
        }
        assert!(anchors[0].differences.is_none());
        let [first, second] = [0, 1].map(|anchor| &anchors[anchor].scalars[1]);
        let difference = &anchors[1].differences.as_ref().unwrap().scalars[1];
        let mean = difference.mean.unwrap();
        assert_eq!((difference.name.as_str(), mean.value), ("max_length", second.mean.value - first.mean.value));
        let error = first.mean.error.unwrap().hypot(second.mean.error.unwrap());
        assert!((mean.error.unwrap() - error).abs() < 1e-12 * error);
    }

    #[test]
    fn without_the_option_nothing_is_said() {
        let summary = answer("[[1, 1], [2, 2]]", "");
        assert!(summary.anchors.is_none());
        let written = serde_json::to_value(&summary).unwrap();
        assert!(written.get("anchors").is_none() && written["study"]["tallies"].get("anchors").is_none());
    }
}
