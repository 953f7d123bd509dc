//! The options of all tallies, as a plan has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TallyPlan {
    /// How often intervals are to hold the truth, between 0 and 1.
    pub confidence: f64,
    /// Rope lengths: for each, when the rope first becomes longer (the survival curve).
    pub limits: Vec<f64>,
    /// How wide the bins of the histograms of lengths are; 0 for a power of two near a 64th of the scene's size.
    pub bin: f64,
    /// How many cells the longer side of the map of the plane has; they are squares. 0 for no map.
    pub map: u32,
    /// After how many steps the map looks at the free end again: neighbouring steps say nearly the same.
    pub map_every: u32,
    /// How many of the most common taut ropes are reported.
    pub ropes: u32,
    /// Whether the answer has that of each anchor too.
    #[serde(skip_serializing_if = "is_off")]
    pub anchors: bool,
}

fn is_off(is: &bool) -> bool {
    !is
}

impl Default for TallyPlan {
    fn default() -> Self {
        TallyPlan { confidence: 0.95, limits: Vec::new(), bin: 0.0, map: 64, map_every: 8, ropes: 10, anchors: false }
    }
}
