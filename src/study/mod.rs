//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod choose;
mod chosen;
mod estimate;
mod file;
mod file_places;
mod free_space;
mod merge;
mod moments;
mod need;
mod opened;
mod order;
mod plan;
mod plan_error;
mod random;
mod run;
mod shard;
mod state;
mod state_error;
mod student;
mod summary;
mod surroundings;
mod tally;
mod walk;

pub use chosen::Chosen;
pub use estimate::Estimate;
pub use file::EXAMPLE;
pub use merge::merge;
pub(crate) use moments::Moments;
pub use need::Held;
pub use opened::Study;
pub use plan::{AnchorPlan, OutputPlan, Plan, RunPlan, Sampled, ScenePlan, UntilPlan};
pub use plan_error::{PlanError, PlanFault};
pub use run::{RunError, Spent, run, run_again};
pub(crate) use shard::as_ranges;
pub use shard::{Shard, read_blocks};
pub use state::{Check, Kept, Part, State, Stopped};
pub use state_error::{StateError, StateFault};
pub use summary::Summary;
pub use surroundings::anchor_warnings;
// All answers of tallies, and the plan of their options.
pub use tally::*;
// The plans of all kinds of walks.
pub use walk::*;
