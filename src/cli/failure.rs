//! What a command fails with: the message and the exit code that belongs to it.

use std::fmt;
use std::io::ErrorKind;
use std::process::ExitCode;

use tautline::ReadError;
use tautline::engine::EngineError;
use tautline::gpu::GpuError;
use tautline::lab::bench::SweepError;
use tautline::lab::tradeoff::WorkError;
use tautline::output::WriteError;
use tautline::picture::DrawError;
use tautline::scene::AnchorError;
use tautline::session::SessionError;
use tautline::stream::StreamError;
use tautline::study::{PlanError, StateError};

/// A failed command.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    error: anyhow::Error,
}

impl Failure {
    /// Something broke that should not have.
    pub(crate) fn internal(error: anyhow::Error) -> Self {
        Failure { code: 1, error }
    }

    /// The input or the usage is bad.
    pub(crate) fn input(error: anyhow::Error) -> Self {
        Failure { code: 2, error }
    }

    /// What the operating system refuses: bad input where the place is not one to write to, whatever the command (no
    /// such folder, no permission, something else stands there); an internal error where writing broke off, as on a
    /// full disk.
    pub(crate) fn system(kind: ErrorKind, error: anyhow::Error) -> Self {
        match kind {
            ErrorKind::NotFound
            | ErrorKind::PermissionDenied
            | ErrorKind::AlreadyExists
            | ErrorKind::NotADirectory
            | ErrorKind::IsADirectory
            | ErrorKind::ReadOnlyFilesystem
            | ErrorKind::InvalidFilename => Failure::input(error),
            _ => Failure::internal(error),
        }
    }

    /// Stopped by Ctrl-C.
    pub(crate) fn interrupted(is_written: bool) -> Self {
        let what = if is_written {
            "stopped; files that were whole by then are written"
        } else {
            "stopped; nothing was written"
        };
        Failure { code: 130, error: anyhow::anyhow!(what) }
    }

    /// Stopped early, with a checkpoint from which to go on.
    pub(crate) fn checkpoint(error: anyhow::Error) -> Self {
        Failure { code: 4, error }
    }

    /// Done, but not as was asked for.
    pub(crate) fn unmet(error: anyhow::Error) -> Self {
        Failure { code: 5, error }
    }

    /// Another process writes there.
    pub(crate) fn busy(error: anyhow::Error) -> Self {
        Failure { code: 6, error }
    }

    pub(crate) fn code(&self) -> ExitCode {
        ExitCode::from(self.code)
    }

    pub(crate) fn number(&self) -> u8 {
        self.code
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.error)
    }
}

/// Errors that are the input's fault, whatever they say.
macro_rules! input {
    ($($Error:ty),*) => {
        $(impl From<$Error> for Failure {
            fn from(error: $Error) -> Self {
                Failure::input(error.into())
            }
        })*
    };
}

input!(ReadError, PlanError, StateError, AnchorError, DrawError, SweepError, WorkError);

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        Failure { code: 3, error: error.into() }
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::Gpu(error) => error.into(),
            EngineError::Stopped => Failure::interrupted(false),
            EngineError::Unfit { .. }
            | EngineError::NoDevice { .. }
            | EngineError::Precision { .. }
            | EngineError::TwoEnds { .. } => Failure::input(error.into()),
        }
    }
}

impl From<StreamError> for Failure {
    fn from(error: StreamError) -> Self {
        match error {
            StreamError::Read(error) => error.into(),
            StreamError::Engine(error) => error.into(),
            StreamError::Write(error) => error.into(),
            StreamError::Violation(_)
            | StreamError::AnchorViolation(_)
            | StreamError::Ends(_)
            | StreamError::NoAnchor { .. } => Failure::input(error.into()),
            StreamError::Ended => Failure::internal(error.into()),
        }
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        match error {
            SessionError::Engine(error) => error.into(),
            SessionError::Write(error) => error.into(),
            error if error.is_busy() => Failure::busy(error.into()),
            error if error.is_input() => Failure::input(error.into()),
            error => Failure::internal(error.into()),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Io { ref cause, .. } => Failure::system(cause.kind(), error.into()),
            WriteError::Extension { .. }
            | WriteError::SceneExtension { .. }
            | WriteError::Target { .. }
            | WriteError::Source { .. } => Failure::input(error.into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_that_is_not_to_be_written_to_is_bad_input_and_a_full_disk_is_not() {
        let code = |kind: ErrorKind| {
            let error = WriteError::Io { path: "a.csv".into(), cause: kind.into() };
            Failure::from(error).code
        };
        for kind in [ErrorKind::PermissionDenied, ErrorKind::NotFound, ErrorKind::ReadOnlyFilesystem] {
            assert_eq!(code(kind), 2, "{kind}");
        }
        for kind in [ErrorKind::StorageFull, ErrorKind::QuotaExceeded, ErrorKind::WriteZero, ErrorKind::Other] {
            assert_eq!(code(kind), 1, "{kind}");
        }
    }
}
