//! Some traces of a study, of which more is written than of all.

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::plan_error::PlanError;

/// Which traces: `true` for all, a number for the first so many, or a list of their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "must be true, a number of traces, or a list of traces' numbers")]
pub enum Chosen {
    /// All, or none.
    All(bool),
    /// The first so many.
    First(u64),
    /// Those with these numbers; of a file of traces, those that it has.
    These(Vec<u64>),
}

impl Chosen {
    /// Whether there can be these traces among as many, those of the plan's `key`; `None` where only the traces' file
    /// says which there are.
    pub(super) fn check(&self, key: &str, count: Option<u64>) -> Result<(), PlanError> {
        match (self, count) {
            (Chosen::These(numbers), Some(count)) => match numbers.iter().find(|&&number| number >= count) {
                Some(bad) => Err(PlanError::new(format!(
                    "{key}: the study's traces are 0 to {}, so there is no {bad}",
                    count - 1
                ))),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    /// The traces' numbers among those of a block; for a list, only the number's place may be told by it.
    pub(super) fn of_block(&self, block: Range<u64>) -> Range<u64> {
        match self {
            Chosen::All(false) => block.start..block.start,
            Chosen::All(true) | Chosen::These(_) => block,
            Chosen::First(count) => block.start.min(*count)..block.end.min(*count),
        }
    }

    /// Whether the trace of that number is one of them, as far as its block does not tell.
    pub(super) fn has(&self, number: u64) -> bool {
        match self {
            Chosen::These(numbers) => numbers.contains(&number),
            _ => true,
        }
    }
}
