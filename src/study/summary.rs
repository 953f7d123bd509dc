//! A study's answer: what `summary.json` holds. The same study gives the same bytes, wherever and in however many parts
//! it was computed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::opened::Study;
use super::plan::Plan;
use super::shard::{Shard, as_ranges};
use super::state::{State, Stopped};
use super::tally::{self, Tally, table};
use crate::trade::Traded;

macro_rules! summary {
    ($($(#[$doc:meta])* $name:ident: $Answer:ty = $Tally:ty;)*) => {
        /// The answer. Lengths are in the scene's unit.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub struct Summary {
            /// The study, with everything that its file left out.
            pub study: Plan,
            /// A hash of all that the answer depends on: the study, the scene and the traces given.
            pub identity: String,
            /// How many traces the answer is made of.
            pub traces: u64,
            /// How many steps they have together.
            pub steps: u64,
            /// The share of the steps that left the free end where it was; `None` where there are no steps.
            pub still: Option<f64>,
            /// The share of the steps that met a wall or the scene's border as they were drawn first, so that they were
            /// drawn again, not taken or thrown back, as `study.walk.at_walls` says; `None` for walks that have no such
            /// steps.
            pub at_walls: Option<f64>,
            /// How many wraps and unwraps there were.
            pub events: u64,
            /// How many blocks are in it.
            pub blocks: u64,
            /// Why no more blocks are.
            pub stopped: Stopped,
            /// What it came to that accuracy was given for speed, if it was; `study.run` says how.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub traded: Option<Traded>,
            /// Which shard this is, `K/N` with K from 0, or `K/N of blocks A..B`; `None` for the whole study.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub shard: Option<String>,
            /// Which blocks are not in it, as `A..B` for those from A up to the one before B, where it was put together
            /// from some parts of the study only; `None` otherwise.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub missing: Option<String>,
            $($(#[$doc])* pub $name: $Answer,)*
        }

        impl State {
            /// What the blocks done so far say. O(what was counted).
            pub fn summary(&self, study: &Study) -> Summary {
                let (plan, tallies, counts) = (study.plan(), &study.tallies, &*self.counted(study));
                let (totals, setting) = (&counts.totals, &tallies.setting);
                Summary {
                    study: plan.clone(),
                    identity: self.identity.clone(),
                    traces: totals.traces.sum,
                    steps: totals.steps(),
                    still: totals.share_of_steps(totals.still),
                    at_walls: plan.walk.at_walls().and_then(|_| totals.share_of_steps(totals.met)),
                    events: totals.events,
                    blocks: totals.traces.blocks,
                    stopped: self.stopped,
                    traded: plan.run.trade().is_any().then(|| {
                        totals.traded(study.vertices(), setting.models[0].vertices().len())
                    }),
                    shard: (self.shard != Shard::WHOLE).then(|| self.shard.to_string()),
                    missing: self.is_partial.then(|| {
                        as_ranges((0..plan.blocks()).filter(|block| !self.blocks.contains_key(block)))
                    }),
                    $($name: tallies.$name.answer(&counts.$name, totals, setting),)*
                }
            }
        }
    };
}

table!(summary);

impl Summary {
    /// The JSON Schema of `summary.json`; its descriptions say what each field means, and how bins and cells are
    /// numbered.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Summary).to_value()
    }
}
