//! What is wrong with a study.

use std::io;
use std::path::{Path, PathBuf};

use crate::example::NameError;
use crate::read_error::ReadError;
use crate::scene::{AnchorError, UnknownObstacle};
use crate::simplify::SimplifyError;

/// What is wrong with a study: where, what, and what would be right.
#[derive(Debug, thiserror::Error)]
#[error(
    "{}{}{}",
    .path.as_ref().map_or(String::new(), |p| format!("{}: ", p.display())),
    .option.map_or(String::new(), |option| format!("{option}: ")),
    self.what()
)]
pub struct PlanError {
    /// The file, if it is one.
    pub path: Option<PathBuf>,
    /// The option by which the key was given in place of the file's, if it was.
    pub option: Option<&'static str>,
    /// In which of its lines, counted from 1; `None` where that is not known.
    pub line: Option<usize>,
    /// The key at fault, with the tables in which it lies: `walk.step`. `None` where it is none of the study's keys.
    pub key: Option<String>,
    /// What is wrong there.
    #[source]
    pub fault: Box<PlanFault>,
}

/// What is wrong with a study, or with a key of its file.
#[derive(Debug, thiserror::Error)]
pub enum PlanFault {
    /// What was found will not do, or something is missing; and what would be right.
    #[error("{0}")]
    Value(String),
    /// An anchor of another form.
    #[error("must be [x, y], a list of such, or {{ sample = N }}")]
    AnchorForm,
    /// A file cannot be read: the study's own, that of its scene, or that of its traces.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file could be opened, but not be read to its end.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// There is no built-in scene of this name.
    #[error(transparent)]
    BuiltIn(#[from] NameError),
    /// The rope cannot be tied.
    #[error(transparent)]
    Anchor(#[from] AnchorError),
    /// No obstacle is called so.
    #[error(transparent)]
    Obstacle(#[from] UnknownObstacle),
    /// The scene cannot be simplified.
    #[error(transparent)]
    Simplify(#[from] SimplifyError),
}

impl PlanError {
    /// What is wrong with a value. Words that begin with a key and a colon are about that key.
    pub(super) fn new(what: impl Into<String>) -> Self {
        let what = what.into();
        let is_key = |name: &str| name.bytes().all(|b| b.is_ascii_lowercase() || matches!(b, b'_' | b'.'));
        match what.split_once(": ").filter(|(name, _)| is_key(name)) {
            Some((key, what)) => Self::at_key(key, PlanFault::Value(what.to_owned())),
            None => PlanFault::Value(what).into(),
        }
    }

    /// What is wrong with a key.
    pub(super) fn at_key(key: &str, fault: impl Into<PlanFault>) -> Self {
        PlanError { key: Some(key.to_owned()), ..fault.into().into() }
    }

    /// The same of the file at `path`.
    pub(super) fn at(mut self, path: &Path) -> Self {
        self.path = Some(path.to_owned());
        self
    }

    /// Whether it is known where it lies.
    pub(super) fn is_placed(&self) -> bool {
        self.path.is_some() || self.option.is_some() || self.line.is_some()
    }

    /// The message without the file's name: the line, the key, and what is wrong.
    pub fn what(&self) -> String {
        let line = self.line.map_or(String::new(), |line| format!("line {line}: "));
        let joint = if matches!(*self.fault, PlanFault::AnchorForm) { " " } else { ": " };
        let key = self.key.as_ref().map_or(String::new(), |key| format!("{key}{joint}"));
        format!("{line}{key}{}", self.fault)
    }
}

impl<F: Into<PlanFault>> From<F> for PlanError {
    fn from(fault: F) -> Self {
        PlanError { path: None, option: None, line: None, key: None, fault: Box::new(fault.into()) }
    }
}
