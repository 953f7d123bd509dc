//! Engines: ways to turn settled traces into ropes. All share the exact update; they differ in how they find the
//! vertices to try (but for `note` and `funnel`, which are other methods altogether).

mod cpu;
mod ends;
mod engine;
mod engines;
mod error;
mod follow;
mod funnel;
mod gpu;
mod hand;
mod job;
mod live;
mod live_ends;
mod note;
mod precision;
mod progress;
mod reference;
mod table;
mod windows;

pub use cpu::{CPU, Cpu};
pub use engine::Engine;
pub use engines::{ENGINES, open_best};
pub use error::EngineError;
pub(crate) use follow::{follow, leaves};
pub use funnel::{FUNNEL, Funnel};
pub use gpu::{FastGpu, GPU, GPU_RAYS, GPU_WINDOWS, Gpu, GpuRays, GpuWindows};
pub use job::{Job, Phase};
pub use live::{AdvanceError, LiveEvent, LiveRope};
pub use live_ends::LiveEnds;
pub use note::{NOTE, Note};
pub use precision::Precision;
pub use reference::{REFERENCE, Reference};
pub use table::{EngineKind, Opened, Options, Promise, RunsOn, Why};
pub(crate) use windows::FIRST_WINDOW;
pub use windows::WINDOW;
