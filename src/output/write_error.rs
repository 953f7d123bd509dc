//! Why a file cannot be written.

use std::path::{Path, PathBuf};

use crate::escape::{escaped, escaped_path};
use crate::scene::alternatives;

/// Why results, events or a scene cannot be written. Whatever stood at the path before still stands there.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The extension names no format that is written here.
    #[error(
        "{}: the extension does not name a format; results and events are written as .jsonl, .csv or .parquet",
        escaped_path(path)
    )]
    Extension {
        /// Which file.
        path: PathBuf,
    },
    /// The extension names no format in which scenes are written.
    #[error(
        "{}: the extension does not name a format; scenes are written as {}",
        escaped_path(path),
        alternatives(extensions)
    )]
    SceneExtension {
        /// Which file.
        path: PathBuf,
        /// The extensions of files that are, each with its dot.
        extensions: Vec<&'static str>,
    },
    /// A file cannot be put there.
    #[error("cannot write {}: {}", escaped_path(path), escaped(fault))]
    Target {
        /// Which file.
        path: PathBuf,
        /// What is in the way.
        fault: String,
    },
    /// A file from which another is made cannot be read.
    #[error("cannot read {}: {}", escaped_path(path), escaped(fault))]
    Source {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// The operating system refuses.
    #[error("cannot write {}: {cause}", escaped_path(path))]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: std::io::Error,
    },
}

impl WriteError {
    pub(super) fn io(path: &Path, cause: std::io::Error) -> Self {
        WriteError::Io { path: path.into(), cause }
    }

    pub(super) fn source(path: &Path, fault: impl ToString) -> Self {
        WriteError::Source { path: path.into(), fault: fault.to_string() }
    }

    pub(super) fn target(path: &Path, fault: impl Into<String>) -> Self {
        WriteError::Target { path: path.into(), fault: fault.into() }
    }
}
