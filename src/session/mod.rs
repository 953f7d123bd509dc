//! A study in a folder: begun, gone on with, saved, put together from shards, and concluded.
//!
//! All that a study needs to go on lies in its folder, whenever and however the process ends. One process writes there
//! at a time.
//!
//! ```
//! use std::path::Path;
//! use std::sync::Arc;
//! use tautline::engine::{Cpu, Engine, Job};
//! use tautline::session::{Computed, Folder, Session};
//! use tautline::study::{Plan, Shard, Study};
//!
//! let plan = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.5\nsteps = 20\n\
//!     [run]\ntraces = 100\nblock = 20\n[outputs]\npictures = false\n";
//! let study = Arc::new(Study::open(Plan::parse(plan)?, Path::new("."))?);
//! let room = tempfile::tempdir()?;
//!
//! let folder = Arc::new(Folder::make(&room.path().join("study"))?);
//! let session = Session::begin(folder, study.clone(), Path::new("."), Shard::WHOLE)?;
//! let mut engines: Vec<Box<dyn Engine>> = vec![Box::new(Cpu::new(study.models()[0].clone()))];
//! let left = session.prepare(Computed::by(&*engines[0], "threads"))?;
//! assert_eq!((left.traces, left.steps), (100, 2000));
//! let report = session.run(&mut engines, &Job::new())?;
//! let summary = session.conclude(&report)?;
//! assert_eq!(summary.traces, 100);
//! assert!(room.path().join("study/summary.json").exists());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chosen;
mod conclude;
mod error;
mod folder;
mod holder;
mod lease;
mod lock;
mod merge;
mod names;
mod report;
mod rows;
mod status;
mod sweep;
mod sweep_record;
mod under_way;

pub use conclude::{answered, is_answer, is_answered, look};
pub use error::{Action, Difference, Note, RowsFault, SessionError};
pub use folder::Folder;
pub use holder::Holder;
pub use merge::merge;
pub use report::{Computed, MergeCost, RunCost, RunReport, SpentSeconds, Tried};
pub use status::{FolderStatus, Status, StudyStatus, SweepStatus, status};
pub use sweep::{SweepFolder, merge_sweep};
pub use sweep_record::{SweepRecord, SweptStudy};
pub use under_way::{Left, Saved, Session};
