//! What is wrong with a study.

use std::path::{Path, PathBuf};

/// What is wrong with a study's file.
#[derive(Debug, thiserror::Error)]
#[error("{}{what}", .path.as_ref().map_or(String::new(), |p| format!("{}: ", p.display())))]
pub struct PlanError {
    /// The file, if it is one.
    pub path: Option<PathBuf>,
    /// What is wrong, where, and what would be right.
    pub what: String,
}

impl PlanError {
    pub(super) fn new(what: impl Into<String>) -> Self {
        PlanError { path: None, what: what.into() }
    }

    pub(super) fn at(mut self, path: &Path) -> Self {
        self.path = Some(path.to_owned());
        self
    }
}
