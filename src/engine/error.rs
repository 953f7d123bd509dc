//! What can go wrong with engines.

use std::convert::Infallible;
use std::error::Error;

use super::precision::Precision;
use crate::gpu::GpuError;

/// Why an engine cannot be opened, or gave no result.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The job was stopped before it was done.
    #[error("stopped before all traces were evaluated")]
    Stopped,
    /// The engine cannot take this scene.
    #[error("the engine {engine} cannot take this scene: {why}")]
    Unfit {
        /// Which engine.
        engine: &'static str,
        /// What it cannot take.
        #[source]
        why: Box<dyn Error + Send + Sync>,
    },
    /// It runs on a GPU, and was given none.
    #[error("the engine {engine} runs on a GPU, and there is none")]
    NoDevice {
        /// Which engine.
        engine: &'static str,
    },
    /// It cannot be had in this precision.
    #[error("the engine {engine} has no precision {}", precision.name())]
    Precision {
        /// Which engine.
        engine: &'static str,
        /// In which precision.
        precision: Precision,
    },
    /// It has the rope's anchor stay where it is.
    #[error("the engine {engine} does not take ropes whose anchor moves; the engines cpu and reference do")]
    TwoEnds {
        /// Which engine.
        engine: &'static str,
    },
    /// The GPU failed, or exact ropes cannot rely on it.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

impl From<Infallible> for EngineError {
    fn from(never: Infallible) -> Self {
        match never {}
    }
}
