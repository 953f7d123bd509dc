//! How often ropes are wound about obstacles at the end.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::TallyPlan;
use super::merge::Merge;
use super::setting::Setting;
use super::tally::Tally;
use super::totals::Totals;
use super::traced::{Size, Traced};
use super::winding::Islands;
use crate::study::estimate::Estimate;
use crate::study::plan_error::PlanError;

/// How often ropes go about an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Wound {
    /// How many ropes go about it counter-clockwise, and clockwise: both, like the turns, as if y pointed upwards.
    left: u64,
    right: u64,
    /// The sum of the turns and of their squares.
    turns: i64,
    squares: u64,
}

impl Merge for Wound {
    fn merge_with(&mut self, other: Wound) {
        self.left += other.left;
        self.right += other.right;
        self.turns += other.turns;
        self.squares += other.squares;
    }
}

/// The tally of obstacles with ropes about them.
pub(crate) struct Obstacles {
    islands: Islands,
}

impl Tally for Obstacles {
    type Part = BTreeMap<u32, Wound>;
    type Counts = BTreeMap<u32, Wound>;
    type Answer = Vec<Obstacle>;

    fn new(_: &TallyPlan, setting: &Setting) -> Result<Self, PlanError> {
        Ok(Obstacles { islands: Islands::new(&setting.models[0]) })
    }

    fn add(&self, part: &mut Self::Part, traced: &Traced<'_>) {
        let end = *traced.trace.points().last().expect("a trace has points");
        self.islands.wound(traced.model.anchor(), &traced.record.wraps, end, |obstacle, turns| {
            let wound = part.entry(obstacle).or_default();
            *(if turns > 0 { &mut wound.left } else { &mut wound.right }) += 1;
            wound.turns += turns;
            wound.squares += (turns * turns) as u64;
        });
    }

    fn finish(&self, part: Self::Part, _: &Size) -> Self::Counts {
        part
    }

    fn answer(&self, counts: &Self::Counts, totals: &Totals, setting: &Setting) -> Vec<Obstacle> {
        let (traces, confidence) = (totals.traces.sum, &setting.confidence);
        // As a picture shows it.
        let y_down = setting.y_down();
        let obstacle = |(&vertex, wound): (&u32, &Wound)| {
            let known = self.islands.get(vertex)?;
            let n = traces as f64;
            let [left, right] = if y_down { [wound.right, wound.left] } else { [wound.left, wound.right] };
            let mean = if y_down { -wound.turns } else { wound.turns } as f64 / n;
            // In whole numbers, since the difference can be small beside what it is one of.
            let (turns, count) = (u128::from(wound.turns.unsigned_abs()), u128::from(traces));
            let spread = (count * u128::from(wound.squares)).saturating_sub(turns * turns) as f64 / n;
            let error = (traces > 1).then(|| (spread / (n - 1.0) / n).sqrt());
            Some(Obstacle {
                vertex,
                at: known.middle.into(),
                label: setting.label(known.named),
                walls: known.walls,
                wound: confidence.share(left + right, traces),
                left: confidence.share(left, traces),
                right: confidence.share(right, traces),
                mean: confidence.around(mean, error, traces),
            })
        };
        let mut all: Vec<Obstacle> = counts.iter().filter_map(obstacle).collect();
        all.sort_by(|a, b| b.wound.value.total_cmp(&a.wound.value).then(a.vertex.cmp(&b.vertex)));
        all
    }
}

/// Walls that hang together by common ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Obstacle {
    /// Its number: the lowest of its wall ends' numbers.
    pub vertex: u32,
    /// The point about which the times round are counted: the middle of the first of its walls, x and y.
    pub at: [f64; 2],
    /// What the scene's file calls it: the label of that wall end, or of the first of its wall ends that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// How many walls it has.
    pub walls: u32,
    /// The share of ropes that go about it at least once at the end, all the way round.
    pub wound: Estimate,
    /// The share that does so counter-clockwise, as a picture of the scene shows it.
    pub left: Estimate,
    /// The share that does so clockwise, as a picture of the scene shows it.
    pub right: Estimate,
    /// The mean number of times round over all ropes, counter-clockwise counting as positive, clockwise as negative.
    pub mean: Estimate,
}
