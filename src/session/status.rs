//! How far studies are, over many folders at once.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::SessionError;
use super::folder::Folder;
use super::holder::Holder;
use super::lease::holder;
use super::names::{STATE, STUDY};
use super::sweep::SweepFolder;
use crate::study::{Plan, Shard, State, Stopped, as_ranges};

/// How far one folder is.
#[derive(Debug, Clone, Serialize)]
pub struct FolderStatus {
    /// The folder.
    pub folder: PathBuf,
    /// Which part of the study is in it: K/N, or K/N of blocks A..B.
    pub shard: String,
    /// How many of its blocks are done.
    pub done: u64,
    /// Of how many.
    pub blocks: u64,
    /// Why there is nothing left to do, or that there is.
    pub stopped: Stopped,
    /// Who holds its lease, if anyone does. A process that was killed may still seem to.
    pub holder: Option<Holder>,
    /// How many traces a second it has done, over all its runs; `None` before the first block.
    pub traces_per_second: Option<f64>,
    /// How many seconds are left at that rate.
    pub seconds_left: Option<f64>,
}

/// How far one study is, in all of the folders.
#[derive(Debug, Clone, Serialize)]
pub struct StudyStatus {
    /// Its identity; `None` of those of which nothing is saved yet.
    pub identity: Option<String>,
    /// How many blocks it has.
    pub blocks: u64,
    /// How many of them are done, in whichever folder.
    pub done: u64,
    /// Those that are not, as `A..B` for those from A up to the one before B: the first hundred such ranges.
    pub missing: String,
    /// Its folders, in the order in which they were given.
    pub folders: Vec<FolderStatus>,
}

/// How far a sweep is, in one folder.
#[derive(Debug, Clone, Serialize)]
pub struct SweepStatus {
    /// The folder.
    pub folder: PathBuf,
    /// Which part of each of its studies is in it: K/N, or K/N of blocks A..B.
    pub shard: String,
    /// How many of its studies have nothing left to do.
    pub studies_done: u64,
    /// How many of the blocks of all studies are done.
    pub done: u64,
    /// Of how many.
    pub blocks: u64,
    /// Its studies, each in its folder.
    pub studies: Vec<FolderStatus>,
}

/// What lies in folders.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Status {
    /// The sweeps in them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sweeps: Vec<SweepStatus>,
    /// The studies in them that are in no sweep.
    pub studies: Vec<StudyStatus>,
    /// Those that hold none, or one that cannot be read, with the reason.
    pub others: Vec<(PathBuf, String)>,
}

/// Looks at studies' folders, without their scenes and traces, and disturbs nobody who writes there. O(what is saved).
pub fn status(folders: &[PathBuf]) -> Status {
    let mut all = Status::default();
    let mut studies: BTreeMap<Option<String>, (StudyStatus, BTreeSet<u64>)> = BTreeMap::new();
    for path in folders {
        if SweepFolder::is_at(path) {
            match look_at_sweep(path) {
                Ok((sweep, others)) => {
                    all.sweeps.push(sweep);
                    all.others.extend(others);
                }
                Err(error) => all.others.push((path.clone(), error.to_string())),
            }
            continue;
        }
        let (plan, state, folder) = match look(path) {
            Ok(found) => found,
            Err(error) => {
                all.others.push((path.clone(), error.to_string()));
                continue;
            }
        };
        let identity = state.as_ref().map(|state| state.identity().to_owned());
        let (study, done) = studies.entry(identity.clone()).or_insert_with(|| {
            let blocks = plan.blocks();
            let study = StudyStatus { identity, blocks, done: 0, missing: String::new(), folders: Vec::new() };
            (study, BTreeSet::new())
        });
        done.extend(state.iter().flat_map(State::blocks));
        study.folders.push(folder);
    }
    for (mut study, done) in studies.into_values() {
        study.done = done.len() as u64;
        study.missing = as_ranges((0..study.blocks).filter(|block| !done.contains(block)));
        all.studies.push(study);
    }
    all
}

fn look(path: &Path) -> Result<(Plan, Option<State>, FolderStatus), SessionError> {
    let folder = Folder::at(path);
    let (plan, shard) = folder.plan()?;
    let file = folder.file(STATE);
    let state = if file.exists() { Some(State::read(&file)?) } else { None };
    let blocks = plan.blocks();
    let part = state.as_ref().map_or(shard, State::shard);
    let (count, done) = match &state {
        Some(state) if state.is_partial() => (blocks, state.blocks().count() as u64),
        Some(state) => (part.count(blocks), state.done()),
        None => (part.count(blocks), 0),
    };
    let rate = state.as_ref().filter(|state| state.traces() > 0).map(|state| state.traces() as f64 / state.seconds());
    let stopped = state.as_ref().map_or(Stopped::Unfinished, State::stopped);
    let left = rate.filter(|_| stopped == Stopped::Unfinished);
    let status = FolderStatus {
        folder: path.to_owned(),
        shard: part.to_string(),
        done,
        blocks: count,
        stopped,
        holder: holder(path),
        traces_per_second: rate,
        seconds_left: left.map(|rate| ((count - done) * u64::from(plan.run.block)) as f64 / rate),
    };
    Ok((plan, state, status))
}

/// How far a sweep is, and which of its studies' folders cannot be read.
fn look_at_sweep(path: &Path) -> Result<(SweepStatus, Vec<(PathBuf, String)>), SessionError> {
    let sweep = SweepFolder::open(path)?;
    let (mut studies, mut others) = (Vec::new(), Vec::new());
    for (folder, point) in sweep.points() {
        if !folder.join(STUDY).exists() {
            studies.push(not_begun(&folder, &point.study, sweep.record().shard));
            continue;
        }
        match look(&folder) {
            Ok((.., status)) => studies.push(status),
            Err(error) => others.push((folder, error.to_string())),
        }
    }
    let sum = |of: fn(&FolderStatus) -> u64| studies.iter().map(of).sum();
    let status = SweepStatus {
        folder: path.to_owned(),
        shard: sweep.record().shard.to_string(),
        studies_done: sum(|study| u64::from(study.stopped != Stopped::Unfinished)),
        done: sum(|study| study.done),
        blocks: sum(|study| study.blocks),
        studies,
    };
    Ok((status, others))
}

/// How far a study is that has no folder yet.
fn not_begun(folder: &Path, plan: &Plan, shard: Shard) -> FolderStatus {
    FolderStatus {
        folder: folder.to_owned(),
        shard: shard.to_string(),
        done: 0,
        blocks: shard.count(plan.blocks()),
        stopped: Stopped::Unfinished,
        holder: None,
        traces_per_second: None,
        seconds_left: None,
    }
}
