//! Engines: ways to turn settled traces into ropes. All share the exact update; they differ in how they find the
//! vertices to try (but for `note` and `funnel`, which are other methods altogether).

mod cpu;
mod engine;
mod funnel;
mod gpu;
mod job;
mod live;
mod note;
mod precision;
mod progress;
mod reference;
mod windows;

pub use cpu::Cpu;
pub use engine::{Engine, EngineError};
pub use funnel::Funnel;
pub use gpu::{FastGpu, Gpu};
pub use job::{Job, Phase};
pub use live::{AdvanceError, LiveEvent, LiveRope};
pub use note::Note;
pub use precision::Precision;
pub use reference::Reference;
pub(crate) use windows::FIRST_WINDOW;

/// The most legs that one query covers unless told otherwise: the exact update tries each candidate at each leg, so
/// longer windows gain little.
pub const WINDOW: usize = 256;
