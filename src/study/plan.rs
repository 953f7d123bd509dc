//! What a study is: the file that describes it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::chosen::Chosen;
use super::tally::TallyPlan;
use super::walk::WalkPlan;
use crate::engine::Precision;
use crate::scene::{Ros, SceneOptions, Unknown};
use crate::trade::Trade;

/// A study, as its file describes it. All lengths are in the scene's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// Where the walls are and the rope is tied.
    pub scene: ScenePlan,
    /// How the free end is dragged.
    pub walk: WalkPlan,
    /// How much is done.
    #[serde(default)]
    pub run: RunPlan,
    /// What is counted.
    #[serde(default)]
    pub tallies: TallyPlan,
    /// When to stop before all traces are done.
    #[serde(default)]
    pub until: UntilPlan,
    /// What is written besides the summary.
    #[serde(default)]
    pub outputs: OutputPlan,
}

/// Where the walls are and the rope is tied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenePlan {
    /// A built-in scene: `rooms`, `random-M` or `lattice-M` with M walls.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub built_in: Option<String>,
    /// A scene file, relative to the study's own folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Where the rope is tied, instead of where the scene says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anchor: Option<AnchorPlan>,
    /// The layers of the file whose walls are taken; all without it. Of GeoJSON what the property `layer` says, or as
    /// `KEY=VALUE` what the property `KEY` does.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<String>,
    /// The layers whose walls are left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub without_layers: Vec<String>,
    /// How far walls may lie from the curves of an .svg or .dxf, in the scene's unit; without it a 2000th of the
    /// drawing's longer side.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flatten: Option<f64>,
    /// What unknown cells of a `map_server`'s map are: `free` or `blocked`.
    #[serde(default, skip_serializing_if = "is_free")]
    pub unknown: Unknown,
    /// Which ROS's `map_server` says what cells of a map are occupied: 1 or 2.
    #[serde(default = "default_ros", skip_serializing_if = "is_default_ros")]
    pub ros: u8,
}

fn is_free(unknown: &Unknown) -> bool {
    *unknown == Unknown::Free
}

fn default_ros() -> u8 {
    2
}

fn is_default_ros(ros: &u8) -> bool {
    *ros == default_ros()
}

impl ScenePlan {
    /// What the file leaves open.
    pub(super) fn options(&self) -> SceneOptions {
        SceneOptions {
            flatten: self.flatten,
            unknown: self.unknown,
            ros: if self.ros == 1 { Ros::One } else { Ros::Two },
            layers: self.layers.clone(),
            without_layers: self.without_layers.clone(),
        }
    }
}

/// Where the rope is tied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum AnchorPlan {
    /// At one point, x and y.
    One([f64; 2]),
    /// At several points, the traces taking turns.
    Several(Vec<[f64; 2]>),
    /// At points drawn over the free space in which the scene's own anchor lies, the traces taking turns.
    Sampled(Sampled),
}

/// Points drawn by the study's seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sampled {
    /// How many, from 1 to 1024.
    pub sample: u32,
}

/// How much is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RunPlan {
    /// How many traces; without it all that a given file holds, and 10,000 drawn ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub traces: Option<u64>,
    /// How many traces a block has: what is computed, saved and handed out as one.
    pub block: u32,
    /// What all random numbers are made from.
    pub seed: u64,
    /// What decides: exact signs, or f32 alone on a GPU, whose ropes can be wrong.
    pub precision: Precision,
    /// Every so many points of a trace one is used, where no wall is in the way of the longer step; 1 for all. Ropes
    /// can be wrong otherwise.
    #[serde(skip_serializing_if = "is_one")]
    pub stride: u32,
    /// By how much walls may move for there to be fewer wall ends; not at all without it. Traces are drawn among the
    /// walls as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simplify: Option<f64>,
}

fn is_one(stride: &u32) -> bool {
    *stride == 1
}

/// How many traces are drawn unless told otherwise.
const TRACES: u64 = 10_000;

impl RunPlan {
    /// How many traces there are: those that it asks for, else 10,000. Of given traces that is only known once the file
    /// was read: the plan of a [`Study`](super::Study) says it.
    pub fn count(&self) -> u64 {
        self.traces.unwrap_or(TRACES)
    }

    /// What accuracy is given for speed, other than by precision.
    pub fn trade(&self) -> Trade {
        Trade { stride: self.stride, simplify: self.simplify }
    }
}

impl Default for RunPlan {
    fn default() -> Self {
        RunPlan { traces: None, block: 1000, seed: 1, precision: Precision::Certified, stride: 1, simplify: None }
    }
}

/// When to stop before all traces are done. Looked at after each block, in the order of the blocks; the time, after as
/// many as are computed at once.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct UntilPlan {
    /// Stop when half the interval of the mean of the longest rope length is less than this share of that mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_error: Option<f64>,
    /// Stop after that many seconds; what is done by then depends on the machine, not what it says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// What is written besides the summary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OutputPlan {
    /// One row for each trace, in `traces.parquet`.
    pub traces: bool,
    /// Pictures and `report.html`.
    pub pictures: bool,
    /// The rope after every step of some traces, in `steps.parquet`; of none without it. They are evaluated once more
    /// when the study ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<Chosen>,
    /// For `steps`: about which obstacles it is counted how often the free end has gone round, by their labels or by
    /// the numbers of wall ends; about all that have a label without it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub about: Vec<String>,
    /// The points of some walks, in `points.parquet`, which `eval --traces` takes; of none without it. They are drawn
    /// once more when the study ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Chosen>,
}

impl Default for OutputPlan {
    fn default() -> Self {
        OutputPlan { traces: false, pictures: true, steps: None, about: Vec::new(), points: None }
    }
}
