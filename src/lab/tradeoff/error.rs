//! Why there is no report.

use std::path::PathBuf;

use crate::engine::EngineError;
use crate::lab::bench::Disagreement;
use crate::read_error::ReadError;
use crate::scene::AnchorError;
use crate::trace::Violation;

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum TradeoffError {
    /// An engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Two exact methods gave different results.
    #[error(transparent)]
    Disagreement(#[from] Disagreement),
    /// A trace crosses a wall, so its rope has no truth.
    #[error(transparent)]
    Violation(#[from] Violation),
}

/// Why there is nothing to measure on.
#[derive(Debug, thiserror::Error)]
pub enum WorkError {
    /// The rope cannot be tied.
    #[error(transparent)]
    Anchor(#[from] AnchorError),
    /// The traces cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file without traces.
    #[error("{}: there are no traces in it", .0.display())]
    Empty(PathBuf),
    /// A file of traces without steps.
    #[error("{}: no trace has a step, so there is none to be timed", .0.display())]
    Still(PathBuf),
}
