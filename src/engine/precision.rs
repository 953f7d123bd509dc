//! How much an engine's ropes can be trusted.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How an engine decides, and so how much its ropes can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// By exact signs: the rope is right.
    #[default]
    Certified,
    /// By f32 alone, on a GPU, with nothing to confirm it: the rope can be wrong.
    Fast,
}

impl Precision {
    /// `certified` or `fast`, as the command line knows it.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Certified => "certified",
            Precision::Fast => "fast",
        }
    }
}
