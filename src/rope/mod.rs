//! The rope: the stack of contacts, the exact update, and the record of what happened. Knows nothing of files, threads
//! or GPUs.

mod ends_record;
mod ends_steps;
mod ends_strain;
mod free_rope;
mod friction;
mod moment;
mod record;
mod replay;
mod rounds;
mod stack;
mod step_columns;
mod steps;
mod strain;
mod strand;
mod update;

pub use ends_record::EndsRecord;
pub use ends_steps::EndsSteps;
pub use free_rope::{FreeContact, FreeRope};
pub use friction::{Force, Friction, FrictionFault, Slip, forces, turn};
pub use moment::Moment;
pub use record::{Event, EventKind, Status, TraceRecord};
pub(crate) use replay::{Lasting, lasting};
pub use replay::{moments, replay};
pub use rounds::Rounds;
pub use stack::{Contact, Rope, Side};
pub use step_columns::{StepColumns, StrainColumns};
pub use steps::{RopeStep, Steps};
pub use strain::Strain;
pub use strand::Strand;
pub use update::{Leg, Sweep};
