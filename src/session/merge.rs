//! A study that was shared out, put together.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::folder::check;
use super::lock::Lock;
use super::rows::{self, TRACES};
use super::{Computed, Folder, RunReport, Session, SessionError, provenance};
use crate::output::{WriteError, merge_results};
use crate::study::{Shard, State, Study, merge as merge_states};

/// Puts the shards in these folders together, all of a study's, in the folder `out`. `made` is told of that once the shards are
/// known to be sound and it is there. No shard is written to meanwhile. Returns the study there, to be
/// [concluded](Session::conclude) with the report.
///
/// # Errors
///
/// Shards that do not make a whole, or are damaged; a folder that holds something else, and what the operating system says.
///
/// # Panics
///
/// If no shard is given.
pub fn merge(
    shards: &[PathBuf],
    base: Option<&Path>,
    out: &Path,
    made: impl FnOnce(&Arc<Folder>),
) -> Result<(Session, RunReport), SessionError> {
    if let Some(folder) = shards.iter().find(|shard| is_same(shard, out)) {
        return Err(SessionError::IsShard { folder: folder.clone() });
    }
    let _shared = shards.iter().map(|shard| Lock::share(shard)).collect::<Result<Vec<_>, _>>()?;
    let (study, base) = Folder::at(&shards[0]).study(base)?;
    let states: Vec<_> = shards
        .iter()
        .map(|path| Ok((path.clone(), Folder::at(path).state(&study)?)))
        .collect::<Result<_, SessionError>>()?;
    let state = merge_states(&study, states.clone()).map_err(|error| SessionError::State { error, folder: None })?;
    let with_rows = study.plan().outputs.traces;
    let rows = |(path, state): &(PathBuf, State)| rows::of_shard(&Folder::at(path), state);
    let rows: Vec<PathBuf> = states.iter().filter(|_| with_rows).map(rows).collect::<Result<_, _>>()?;
    let folder = Arc::new(Folder::make(out)?);
    made(&folder);
    let merged = put_together(&folder, &study, &base, state, &rows);
    if merged.is_err() {
        folder.take_back();
    }
    let state = merged?;
    let report = RunReport::merged(shards, study.plan().run.precision, state.seconds());
    Ok((Session::new(folder, Arc::new(study), state), report))
}

/// Has the folder hold the whole study.
fn put_together(
    folder: &Folder,
    study: &Study,
    base: &Path,
    mut state: State,
    rows: &[PathBuf],
) -> Result<State, SessionError> {
    folder.held(study, Shard::WHOLE)?;
    // The state comes last: without it, this can be done again.
    folder.remember(study.plan(), base, Shard::WHOLE)?;
    if study.plan().outputs.traces {
        let precision = study.plan().run.precision.name();
        let computed = Computed { engine: "merged", precision, on: "several runs".to_owned() };
        let (file, notes) = (folder.file(TRACES), provenance(study, &computed));
        merge_results(rows, &file, study.models()[0].scene(), &notes, state.traces())?;
        let check = check(&file).map_err(|cause| WriteError::Io { path: file, cause })?;
        state.kept.files.insert(TRACES.to_owned(), check);
    }
    folder.save(&state)?;
    Ok(state)
}

/// Whether both are one folder.
fn is_same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}
