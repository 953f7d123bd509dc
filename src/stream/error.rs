//! Why a stream of traces ended early.

use crate::engine::EngineError;
use crate::output::WriteError;
use crate::read_error::ReadError;
use crate::trace::Violation;

/// Why a stream of traces ended early. No file has appeared then.
#[derive(Debug, thiserror::Error)]
pub enum StreamError {
    /// The traces cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A trace breaks the rules.
    #[error("{0}")]
    Violation(Box<Violation>),
    /// The ropes cannot be evaluated, or the job was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The files cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// More was to be written after an error.
    #[error("the files were ended before")]
    Ended,
}
