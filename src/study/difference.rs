//! By how much the answers of two studies differ.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::estimate::Estimate;

/// By how much an answer differs from another one: this one's less the other's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Differences {
    /// What the errors come from.
    pub errors_from: ErrorsFrom,
    /// Of each scalar's mean, in the order of the scalars.
    pub scalars: Vec<MeanDifference>,
    /// Of the shares of ropes that never were longer than a limit, for each limit that both have.
    pub within: Vec<ShareDifference>,
    /// Where both have friction: of the means of the greatest tension (`tension`) and of the work (`work`).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub friction: Vec<MeanDifference>,
}

/// What the errors of differences come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ErrorsFrom {
    /// How the difference differs from block to block, over the blocks with as many traces in both. Trace i has the
    /// same random numbers in both, so that what these make alike cancels.
    PairedBlocks,
    /// The errors of both answers, whose traces have nothing to do with each other.
    Independent,
}

/// The difference of two means.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeanDifference {
    /// The scalar: `length`, `max_length`, `depth`, `max_depth`, `wraps` or `unwraps`; of friction `tension` or `work`.
    pub name: String,
    /// The difference of the means; `None` where there is nothing to compare.
    pub mean: Option<Estimate>,
}

/// The difference of two shares.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShareDifference {
    /// The limit.
    pub limit: f64,
    /// The difference of the shares of ropes that never were longer up to their trace's end; `None` where there is
    /// nothing to compare. Where all of both stayed within it, or none, nothing says by how much the shares may differ,
    /// so there is no error.
    pub share: Option<Estimate>,
}
