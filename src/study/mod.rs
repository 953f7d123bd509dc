//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod estimate;
mod file;
mod file_places;
mod free_space;
mod opened;
mod plan;
mod random;
mod run;
mod state;
mod summarize;
mod summary;
mod tally;
mod walk;

pub use file::EXAMPLE;
pub use opened::Study;
pub use plan::{
    AnchorPlan, AtWalls, OutputPlan, Plan, PlanError, RunPlan, Sampled, ScenePlan, Start, TallyPlan, UntilPlan,
    WalkPlan,
};
pub use run::{RunError, Spent, run};
pub use state::{Shard, State, StateError, merge};
pub use summary::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Quantile, Scalar, Stopped, Summary, Survival,
    SurvivalPoint, Traded, quantity,
};
pub(crate) use tally::Moments;
pub use walk::Walks;
