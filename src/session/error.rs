//! Why a study's folder cannot be worked in, and what is to be known of it.

use std::fmt;
use std::io;
use std::path::PathBuf;

use super::holder::Holder;
use crate::engine::EngineError;
use crate::output::WriteError;
use crate::picture::PictureError;
use crate::study::{PlanError, RunError, Shard, StateError};

/// Why a study in a folder cannot be begun, gone on with or read. What was saved before stands.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// Another process writes to the folder.
    #[error("{} is in use: {} writes to it; wait for its end, or stop it", folder.display(), writer(holder))]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// Which process, if that is known.
        holder: Option<Box<Holder>>,
    },
    /// This process stood still for so long that another one took the folder over.
    #[error(
        "{}: another run has taken the folder over, since this one stood still; what was saved by then stands, and the \
         other goes on with it",
        folder.display()
    )]
    Lost {
        /// The folder.
        folder: PathBuf,
    },
    /// Something else stands where the folder is to be.
    #[error("{} is there already and is no folder; give another", path.display())]
    NoFolder {
        /// Where.
        path: PathBuf,
    },
    /// There is no study in the folder.
    #[error("{}: {cause}; give the folder that `tautline study run` made", file.display())]
    NoStudy {
        /// The file that would remember it.
        file: PathBuf,
        /// Why it cannot be read.
        #[source]
        cause: io::Error,
    },
    /// The folder is that of a sweep.
    #[error(
        "{0} is the folder of a sweep, which has several studies; give one of theirs, such as {0}/point-000",
        folder.display()
    )]
    IsSweep {
        /// The folder.
        folder: PathBuf,
    },
    /// There is no sweep in the folder.
    #[error("{}: {cause}; give the folder that `tautline study run` made of a sweep", file.display())]
    NoSweep {
        /// The file that would remember it.
        file: PathBuf,
        /// Why it cannot be read.
        #[source]
        cause: io::Error,
    },
    /// The folder holds a part of another sweep.
    #[error("{} holds another sweep than {}: {difference}", folder.display(), first.display())]
    OtherSweep {
        /// The folder.
        folder: PathBuf,
        /// That of the first part: it is there in the difference.
        first: PathBuf,
        /// How it differs.
        difference: Difference,
    },
    /// The folder does not remember its study as it was written.
    #[error(
        "{}: {}; `tautline study run` with the study's own file and this folder as --out writes it again",
        file.display(), damage(cause)
    )]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What is wrong; `None` where only the check sum is.
        #[source]
        cause: Option<serde_json::Error>,
    },
    /// The folder holds another study.
    #[error(
        "{0} holds a study already, and another one: {1}; go on with that by `tautline study resume {0}`, \
         or give another --out",
        folder.display(), difference
    )]
    Another {
        /// The folder.
        folder: PathBuf,
        /// How it differs.
        difference: Difference,
    },
    /// The folder holds what some parts of a study say.
    #[error(
        "{} holds an answer of some parts of a study, which cannot be gone on with; run its parts, and merge them \
         again",
        folder.display()
    )]
    Partial {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds something else.
    #[error("{} is there already; give another --out", file.display())]
    Occupied {
        /// A file that a study would write.
        file: PathBuf,
    },
    /// The folder from which the study's files are named cannot be found.
    #[error("{}: {cause}", path.display())]
    Base {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: io::Error,
    },
    /// The study cannot be opened.
    #[error("{error}{}", named_from(began))]
    Plan {
        /// Why.
        #[source]
        error: PlanError,
        /// The folder from which its files were named as it began, if no other is given now.
        began: Option<PathBuf>,
    },
    /// How far the study is cannot be told.
    #[error("{error}{}", begin_again(folder))]
    State {
        /// Why.
        #[source]
        error: StateError,
        /// The study's folder, if it can begin again once the state is removed.
        folder: Option<PathBuf>,
    },
    /// The rows of a shard are not all there.
    #[error("{}: {fault}; `tautline study resume {}` writes it again", file.display(), folder.display())]
    ShardRows {
        /// Where they would be.
        file: PathBuf,
        /// The shard's folder.
        folder: PathBuf,
        /// What is wrong.
        fault: RowsFault,
    },
    /// A merge with rows cannot take a merge of some parts, which has none.
    #[error("{} has an answer of some parts, without their rows; give those parts instead", folder.display())]
    NoRows {
        /// The folder.
        folder: PathBuf,
    },
    /// One of the shards to be merged is the folder that is to be written to.
    #[error("{} is one of the shards; give another folder", folder.display())]
    IsShard {
        /// That folder.
        folder: PathBuf,
    },
    /// Rows cannot be kept.
    #[error("cannot {} {}: {cause}", action.name(), path.display())]
    Rows {
        /// What was tried.
        action: Action,
        /// With which file or folder.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: io::Error,
    },
    /// The traces cannot be had.
    #[error(transparent)]
    Traces(PlanError),
    /// The ropes cannot be evaluated, or the job was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A picture cannot be drawn.
    #[error("{name}.png: {error}")]
    Picture {
        /// Which one.
        name: String,
        /// Why.
        #[source]
        error: PictureError,
    },
    /// A name has characters that JSON cannot hold.
    #[error(transparent)]
    Encode(#[from] serde_json::Error),
}

impl SessionError {
    /// Whether another process writes to the folder, so that it may help to wait.
    pub fn is_busy(&self) -> bool {
        matches!(self, SessionError::InUse { .. } | SessionError::Lost { .. })
    }

    /// Whether other input helps, and not another machine, a repaired program or patience.
    pub fn is_input(&self) -> bool {
        !matches!(
            self,
            SessionError::InUse { .. }
                | SessionError::Lost { .. }
                | SessionError::Rows { .. }
                | SessionError::Engine(_)
                | SessionError::Write(_)
                | SessionError::Picture { .. }
                | SessionError::Encode(_)
        )
    }
}

impl From<RunError<SessionError>> for SessionError {
    fn from(error: RunError<SessionError>) -> Self {
        match error {
            RunError::Plan(error) => SessionError::Traces(error),
            RunError::Engine(error) => SessionError::Engine(error),
            RunError::Caller(error) => error,
        }
    }
}

/// How a study differs from the one that its folder holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Difference {
    /// It is another part.
    Shard {
        /// Which is there.
        there: Shard,
        /// Which is asked for.
        here: Shard,
    },
    /// A key of its file.
    Key {
        /// Which.
        name: String,
        /// Its value there, as JSON.
        there: String,
        /// Its value here.
        here: String,
    },
    /// What its file names, or the program.
    Inputs,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Difference::Shard { there, here } => write!(f, "shard {there}, and not {here}"),
            Difference::Key { name, there, here } => write!(f, "{name} is {there} there and {here} here"),
            Difference::Inputs => f.write_str("its scene or its traces are others, or another version has begun it"),
        }
    }
}

/// What is wrong with kept rows.
#[derive(Debug)]
pub enum RowsFault {
    /// They are not all written.
    Missing,
    /// They cannot be read.
    Unread(io::Error),
    /// They are not as they were written.
    Damaged,
}

impl fmt::Display for RowsFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RowsFault::Missing => f.write_str("its rows are not all there"),
            RowsFault::Unread(cause) => cause.fmt(f),
            RowsFault::Damaged => f.write_str("damaged: its check sum is wrong"),
        }
    }
}

/// What was tried with rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// To read them.
    Read,
    /// To write them.
    Write,
    /// To remove them.
    Remove,
}

impl Action {
    fn name(self) -> &'static str {
        match self {
            Action::Read => "read",
            Action::Write => "write",
            Action::Remove => "remove",
        }
    }
}

/// What is to be known of a study's folder, though nothing is wrong with the study.
#[derive(Debug)]
pub enum Note {
    /// Nothing keeps others from writing there too.
    NoLocks {
        /// The folder.
        folder: PathBuf,
        /// What the file system says.
        cause: io::Error,
    },
    /// Nothing of the study was saved.
    Begins {
        /// The folder.
        folder: PathBuf,
    },
    /// Some of the study is done.
    Holds {
        /// The folder.
        folder: PathBuf,
        /// How many traces are done.
        done: u64,
        /// Of how many.
        all: u64,
    },
    /// The study is done.
    Answered {
        /// The folder.
        folder: PathBuf,
    },
    /// What was said of the run before is gone or damaged, and written anew.
    Cost {
        /// The file.
        file: PathBuf,
    },
    /// Rows that were kept are gone or damaged.
    Again {
        /// Where they were.
        file: PathBuf,
        /// What is wrong with them.
        fault: RowsFault,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Note::NoLocks { folder, cause } => {
                let folder = folder.display();
                write!(
                    f,
                    "{folder}: the file system has no locks ({cause}); a lease alone keeps others from writing there"
                )
            }
            Note::Begins { folder } => write!(f, "{}: no state was saved, so the study begins", folder.display()),
            Note::Holds { folder, done, all } => {
                write!(f, "{} holds {done} of {all} traces of this study already", folder.display())
            }
            Note::Answered { folder } => write!(f, "{} holds the answer of this study already", folder.display()),
            Note::Cost { file } => {
                write!(f, "{}: gone or damaged; what is written now says nothing of the runs before", file.display())
            }
            Note::Again { file, fault } => write!(f, "{}: {fault}; its rows are computed again", file.display()),
        }
    }
}

fn writer(holder: &Option<Box<Holder>>) -> String {
    holder.as_ref().map_or("another run".to_owned(), |holder| holder.to_string())
}

fn damage(cause: &Option<serde_json::Error>) -> String {
    match cause {
        Some(cause) => format!("damaged: {cause}"),
        None => "damaged, or made into another study by hand: its check sum is wrong".to_owned(),
    }
}

fn named_from(began: &Option<PathBuf>) -> String {
    began.as_ref().map_or(String::new(), |folder| {
        format!("\n(the study's files are named from {}; if they have moved, give --base DIR)", folder.display())
    })
}

fn begin_again(folder: &Option<PathBuf>) -> String {
    folder.as_ref().map_or(String::new(), |folder| {
        format!("; remove it to have `tautline study resume {}` begin again", folder.display())
    })
}
