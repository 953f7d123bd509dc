//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod assignment;
mod blocks;
mod difference;
mod estimate;
mod file;
mod file_places;
mod free_space;
mod merge;
mod moments;
mod opened;
mod order;
mod paired;
mod plan;
mod plan_error;
mod random;
mod run;
mod shard;
mod state;
mod state_error;
mod student;
mod study_file;
mod summary;
mod surroundings;
mod sweep;
mod sweep_answer;
mod sweep_sheet;
mod tally;
mod walk;

pub use assignment::Assignment;
pub use difference::{Differences, ErrorsFrom, MeanDifference, ShareDifference};
pub use estimate::Estimate;
pub use file::EXAMPLE;
pub use merge::merge;
pub(crate) use moments::Moments;
pub use opened::Study;
pub use plan::{AnchorPlan, OutputPlan, Plan, RunPlan, Sampled, ScenePlan, UntilPlan};
pub use plan_error::{PlanError, PlanFault};
pub use run::{RunError, Spent, run, run_again};
pub(crate) use shard::as_ranges;
pub use shard::{Shard, read_blocks};
pub use state::{Check, Kept, Part, State, Stopped};
pub use state_error::{StateError, StateFault};
pub use study_file::StudyFile;
pub use summary::Summary;
pub use surroundings::anchor_warnings;
pub(crate) use sweep::names;
pub use sweep::{Sweep, SweepPoint, shown};
pub use sweep_answer::{PointAnswer, Reference, SweepAnswer};
// All answers of tallies, and the plan of their options.
pub use tally::*;
// The plans of all kinds of walks.
pub use walk::*;
