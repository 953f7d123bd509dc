//! The options of all tallies, as a plan has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TallyPlan {
    /// How often intervals are to hold the truth, between 0 and 1.
    pub confidence: f64,
    /// Which quantiles are given, between 0 and 1; the highest is that of the sentence with which an answer begins.
    #[serde(skip_serializing_if = "are_usual")]
    pub quantiles: Vec<f64>,
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
    /// How many of the most common homotopy classes of ropes are reported; 0 for none.
    #[serde(skip_serializing_if = "is_zero")]
    pub classes: u32,
    /// Whether contacts and turns are also counted by obstacle, however many wall ends of it a rope touches in a row.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub by_obstacle: bool,
    /// Whether the answer has that of each anchor too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub anchors: bool,
    /// The coefficient of friction between ropes and walls, 0 to 10, if the answer is to say what that makes of the
    /// tension in them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<f64>,
    /// With `friction`: for which tensions it is told how often that at the free end is greater, of a rope that is
    /// hauled there and has a tension of 1 at its anchor.
    #[serde(skip_serializing_if = "are_usual_tensions")]
    pub tensions: Vec<f64>,
}

/// The quantiles that are given unless told otherwise.
const QUANTILES: [f64; 9] = [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.99];

fn are_usual(quantiles: &[f64]) -> bool {
    quantiles == QUANTILES
}

fn is_zero(number: &u32) -> bool {
    *number == 0
}

/// The tensions that are told of unless told otherwise.
const TENSIONS: [f64; 3] = [2.0, 5.0, 10.0];

fn are_usual_tensions(tensions: &[f64]) -> bool {
    tensions == TENSIONS
}

impl TallyPlan {
    /// Which quantiles are given, each once.
    pub(super) fn ascending_quantiles(&self) -> Vec<f64> {
        let mut quantiles = self.quantiles.clone();
        quantiles.sort_by(f64::total_cmp);
        quantiles.dedup();
        quantiles
    }
}

impl Default for TallyPlan {
    fn default() -> Self {
        TallyPlan {
            confidence: 0.95,
            quantiles: QUANTILES.to_vec(),
            limits: Vec::new(),
            bin: 0.0,
            map: 64,
            map_every: 8,
            ropes: 10,
            classes: 0,
            by_obstacle: false,
            anchors: false,
            friction: None,
            tensions: TENSIONS.to_vec(),
        }
    }
}
