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
mod table;
mod windows;

pub use cpu::{CPU, Cpu};
pub use engine::{Engine, EngineError};
pub use funnel::{FUNNEL, Funnel};
pub use gpu::{FastGpu, GPU, Gpu};
pub use job::{Job, Phase};
pub use live::{AdvanceError, LiveEvent, LiveRope};
pub use note::{NOTE, Note};
pub use precision::Precision;
pub use reference::{REFERENCE, Reference};
pub use table::{EngineKind, Opened, Options, Promise, RunsOn, Why, open_best};
pub(crate) use windows::FIRST_WINDOW;

/// All engines, in the order in which they are offered. A new one is a file of its own, with what the table says of it, and a
/// line here; it is then known to the command line, and tested for what it promises.
pub static ENGINES: [&EngineKind; 5] = [&GPU, &CPU, &REFERENCE, &FUNNEL, &NOTE];

/// The most legs that one query covers unless told otherwise: the exact update tries each candidate at each leg, so
/// longer windows gain little.
pub const WINDOW: usize = 256;
