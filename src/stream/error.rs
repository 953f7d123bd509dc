//! Why a stream of traces ended early.

use std::path::PathBuf;

use crate::engine::EngineError;
use crate::escape::escaped_path;
use crate::output::WriteError;
use crate::read_error::ReadError;
use crate::trace::{EndsFault, Violation};

/// Why a stream of traces ended early. No file has appeared then.
#[derive(Debug, thiserror::Error)]
pub enum StreamError {
    /// The traces cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A trace breaks the rules.
    #[error("{0}")]
    Violation(Box<Violation>),
    /// The anchor of a trace does.
    #[error("the anchor of {0}")]
    AnchorViolation(Box<Violation>),
    /// The paths of a trace and its anchor do not go together.
    #[error(transparent)]
    Ends(#[from] EndsFault),
    /// A file of several anchors' paths has none for a trace.
    #[error(
        "{}: no path for the anchor of trace {trace}; give one trace of that number, or one trace for all",
        escaped_path(path)
    )]
    NoAnchor {
        /// The file of paths.
        path: PathBuf,
        /// The trace's number.
        trace: u64,
    },
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
