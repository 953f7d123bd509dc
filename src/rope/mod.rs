//! The rope: the stack of contacts, the exact update, and the record of what happened. Knows nothing of files, threads
//! or GPUs.

mod moment;
mod record;
mod replay;
mod rounds;
mod stack;
mod step_columns;
mod steps;
mod update;

pub use moment::Moment;
pub use record::{Event, EventKind, Status, TraceRecord};
pub(crate) use replay::{Lasting, lasting};
pub use replay::{moments, replay};
pub use rounds::Rounds;
pub use stack::{Contact, Rope, Side};
pub use step_columns::StepColumns;
pub use steps::{RopeStep, Steps};
pub use update::{Leg, Sweep};
