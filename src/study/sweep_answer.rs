//! What the studies of a sweep say, side by side.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::blocks::BlockMeans;
use super::difference::Differences;
use super::estimate::Estimate;
use super::opened::Study;
use super::paired::{Blocks, paired};
use super::state::{State, Stopped};
use super::sweep::shown;
use super::tally::{FrictionAnswer, Scalar, ShareWithin, TetherAnswer};

/// What the studies of a sweep say, side by side. It holds no times and no names of machines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepAnswer {
    /// The keys that differ from point to point, in the order of the file.
    pub keys: Vec<String>,
    /// The number of the point with which all are compared, counted from 0.
    pub against: usize,
    /// Which shard of each study this is, `K/N` with K from 0, or `K/N of blocks A..B`; `None` for whole studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// What each study says.
    pub points: Vec<PointAnswer>,
}

/// What one study of a sweep says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PointAnswer {
    /// The study's folder, in that of the sweep.
    pub folder: String,
    /// The values of the keys, in their order.
    pub values: Vec<serde_json::Value>,
    /// How many traces its answer is made of.
    pub traces: u64,
    /// How many blocks are in it.
    pub blocks: u64,
    /// Why no more blocks are.
    pub stopped: Stopped,
    /// How often its intervals hold the truth.
    pub confidence: f64,
    /// One number a trace: its distribution over the traces. Empty before the first block.
    pub scalars: Vec<Scalar>,
    /// For each of `tallies.limits`, ascending: the share of ropes that never were longer, up to their trace's end.
    pub within: Vec<ShareWithin>,
    /// How its tether held the walks back; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tether: Option<TetherAnswer>,
    /// What friction makes of the tension in its ropes; `None` unless it is asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionAnswer>,
    /// By how much the answer differs from that of the point `against`; `None` before the first block of either.
    pub differences: Option<Differences>,
}

/// What the other points of a sweep are compared with: what one study says, block by block.
#[derive(Debug, Clone)]
pub struct Reference {
    blocks: BTreeMap<u64, BlockMeans>,
    limits: Vec<f64>,
}

impl Reference {
    /// O(blocks).
    pub fn new(study: &Study, state: &State) -> Reference {
        Reference { blocks: state.by_block(study), limits: study.tallies.survival.limits().to_vec() }
    }

    fn blocks(&self) -> Blocks<'_> {
        Blocks { blocks: &self.blocks, limits: &self.limits }
    }
}

impl PointAnswer {
    /// What the study in `folder` says, with these values of the sweep's keys. O(what was counted).
    pub fn new(
        folder: String,
        values: Vec<serde_json::Value>,
        (study, state): (&Study, &State),
        against: Option<&Reference>,
    ) -> PointAnswer {
        let summary = state.summary(study);
        let is_empty = summary.traces == 0;
        let confidence = &study.tallies.setting.confidence;
        let within = summary
            .survival
            .iter()
            .filter_map(|survival| Some(ShareWithin { limit: survival.limit, share: survival.curve.last()?.share }));
        let differences =
            against.map(|other| paired(&Reference::new(study, state).blocks(), &other.blocks(), confidence));
        PointAnswer {
            folder,
            values,
            traces: summary.traces,
            blocks: summary.blocks,
            stopped: summary.stopped,
            confidence: study.plan().tallies.confidence,
            within: within.collect(),
            tether: summary.tether,
            friction: summary.friction,
            differences: differences.filter(|_| !is_empty),
            scalars: if is_empty { Vec::new() } else { summary.scalars },
        }
    }

    /// Of a study that has not begun.
    pub fn not_begun(folder: String, values: Vec<serde_json::Value>, confidence: f64) -> PointAnswer {
        PointAnswer {
            folder,
            values,
            traces: 0,
            blocks: 0,
            stopped: Stopped::Unfinished,
            confidence,
            scalars: Vec::new(),
            within: Vec::new(),
            tether: None,
            friction: None,
            differences: None,
        }
    }

    /// The scalar of this name; `None` before the first block.
    pub fn scalar(&self, name: &str) -> Option<&Scalar> {
        self.scalars.iter().find(|scalar| scalar.name == name)
    }

    /// The share of ropes that never were longer than a limit, if the study has that.
    pub fn within(&self, limit: f64) -> Option<Estimate> {
        self.within.iter().find(|within| within.limit == limit).map(|within| within.share)
    }

    /// The share of steps after which friction makes the tension greater than that, if the study has that.
    pub fn steps_above(&self, tension: f64) -> Option<Estimate> {
        self.friction.as_ref()?.above.iter().find(|above| above.tension == tension).map(|above| above.share)
    }

    /// By how much the mean of a scalar differs, or of what friction makes: `tension`, `work`.
    pub fn mean_difference(&self, name: &str) -> Option<Estimate> {
        let differences = self.differences.as_ref()?;
        differences.scalars.iter().chain(&differences.friction).find(|difference| difference.name == name)?.mean
    }

    /// By how much the share of ropes differs that never were longer than a limit.
    pub fn share_difference(&self, limit: f64) -> Option<Estimate> {
        self.differences.as_ref()?.within.iter().find(|difference| difference.limit == limit)?.share
    }
}

impl SweepAnswer {
    /// The limits that any of the studies has, ascending.
    pub fn limits(&self) -> Vec<f64> {
        let mut limits: Vec<f64> = self.points.iter().flat_map(|point| &point.within).map(|w| w.limit).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        limits
    }

    /// The tensions of which any of the studies tells how often they are exceeded, ascending.
    pub fn tensions(&self) -> Vec<f64> {
        let above = self.points.iter().flat_map(|point| &point.friction).flat_map(|friction| &friction.above);
        let mut tensions: Vec<f64> = above.map(|above| above.tension).collect();
        tensions.sort_by(f64::total_cmp);
        tensions.dedup();
        tensions
    }

    /// The values of a point in words: `walk.step = 0.2, walk.steps = 100`.
    pub fn words(&self, point: &PointAnswer) -> String {
        let pairs = self.keys.iter().zip(&point.values).map(|(key, value)| format!("{key} = {}", shown(value)));
        pairs.collect::<Vec<_>>().join(", ")
    }

    /// The JSON Schema of what `tautline study show --json` prints of a sweep.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(SweepAnswer).to_value()
    }
}
