//! The rope: the stack of contacts, the exact update, and the record of what happened. Knows nothing of files, threads
//! or GPUs.

mod moment;
mod record;
mod replay;
mod stack;
mod update;

pub use moment::Moment;
pub use record::{Event, EventKind, Status, TraceRecord};
pub(crate) use replay::{Lasting, lasting};
pub use replay::{moments, replay};
pub use stack::{Contact, Rope, Side};
pub use update::{Leg, Sweep};
