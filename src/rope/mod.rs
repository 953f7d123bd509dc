//! The rope: the stack of contacts, the exact update, and the record of what happened. Knows nothing of files, threads
//! or GPUs.

mod moment;
mod record;
mod stack;
mod update;

pub use moment::{Moment, moments};
pub use record::{Event, EventKind, Status, TraceRecord, replay};
pub use stack::{Contact, Rope, Side};
pub use update::{Leg, Sweep};
