//! What is counted of every trace, block by block.
//!
//! All but the moments are whole numbers, so that blocks may be put together in any order; the moments are kept for
//! each block and put together in the order of the blocks.
//!
//! A tally is a file with a struct that is a [`Tally`], and a line in [`table`](mod@table), in the order of the
//! summary; its options have their lines in [`TallyPlan`], in the order of a plan.

pub(super) mod anchors;
mod batches;
mod block;
pub(super) mod by_obstacle;
pub(super) mod classes;
mod common;
pub(super) mod contacts;
pub(super) mod friction;
pub(super) mod histograms;
mod lengths;
pub(super) mod map;
mod merge;
pub(super) mod obstacles;
mod options;
pub(super) mod ropes;
pub(super) mod scalars;
mod setting;
pub(super) mod survival;
mod table;
#[allow(clippy::module_inception)] // the trait is named as what it is
mod tally;
pub(super) mod tether;
mod totals;
mod traced;
mod winding;

pub use anchors::AnchorAnswer;
pub(super) use block::{Block, Counts, Tallies};
pub use by_obstacle::{ByObstacle, ObstacleContacts};
pub use classes::{ClassAnswer, CommonClass, Letter};
pub use contacts::Contact;
pub(super) use friction::NAMES as FRICTION;
pub use friction::{FrictionAnswer, StepsAbove};
pub use histograms::{Bin, Histogram};
pub use map::{Cell, Map, Visited};
pub(super) use merge::Merge;
pub use obstacles::Obstacle;
pub use options::TallyPlan;
pub use ropes::CommonRope;
pub(super) use scalars::scalar_names;
pub use scalars::{Quantile, Scalar, quantity};
pub(super) use setting::Setting;
pub use survival::{ShareWithin, Survival, SurvivalPoint};
pub(super) use table::table;
pub(super) use tally::Tally;
pub use tether::TetherAnswer;
