//! Monte-Carlo studies: very many random traces, and what their ropes are like on the whole.

mod plan;
mod summary;

pub use plan::{
    AnchorPlan, AtWalls, OutputPlan, Plan, PlanError, RunPlan, Sampled, ScenePlan, Start, TallyPlan, UntilPlan,
    WalkPlan,
};
pub use summary::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Quantile, Scalar, Stopped, Summary, Survival,
    SurvivalPoint,
};
