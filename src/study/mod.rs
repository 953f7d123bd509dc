//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod free_space;
mod plan;
mod random;
mod summary;
mod walk;

pub use plan::{
    AnchorPlan, AtWalls, OutputPlan, Plan, PlanError, RunPlan, Sampled, ScenePlan, Start, TallyPlan, UntilPlan,
    WalkPlan,
};
pub use summary::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Quantile, Scalar, Stopped, Summary, Survival,
    SurvivalPoint,
};
pub use walk::Walks;
