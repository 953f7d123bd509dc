//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod estimate;
mod file;
mod file_places;
mod free_space;
mod opened;
mod order;
mod plan;
mod random;
mod run;
mod state;
mod student;
mod summarize;
mod summary;
mod surroundings;
mod tally;
mod walk;

pub use file::EXAMPLE;
pub use opened::Study;
pub use plan::{
    AnchorPlan, AtWalls, OutputPlan, Plan, PlanError, RunPlan, Sampled, ScenePlan, Start, TallyPlan, UntilPlan,
    WalkPlan,
};
pub use run::{RunError, Spent, run, run_again};
pub use state::{Check, Kept, Part, Shard, State, StateError, merge};
pub use summary::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Quantile, Scalar, Stopped, Summary, Survival,
    SurvivalPoint, quantity,
};
pub use surroundings::anchor_warnings;
pub(crate) use tally::Moments;
pub use walk::Walks;
