//! A study that was shared out, put together.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::SessionError;
use super::folder::{Folder, check};
use super::lock::Lock;
use super::names::{STATE, TRACES};
use super::report::{Computed, RunReport, provenance};
use super::rows;
use super::under_way::Session;
use crate::output::{WriteError, merge_results};
use crate::study::{Shard, State, StateError, Stopped, Study, merge as merge_states};

/// How often rows of parts under way are looked for before it is said that they are not there.
const TRIES: u32 = 3;

/// Puts the parts in these folders together, which make up a study, in the folder `out`; or, if `is_partial`, those
/// that are there, also while others write to them. `made` is told of that once the parts are known to be sound and it
/// is there. Returns the study there, to be [concluded](Session::conclude) with the report. Holds one part at a time.
///
/// # Errors
///
/// Parts that do not make a whole, have blocks in common, or are damaged; a folder that holds something else, and what
/// the operating system says.
///
/// # Panics
///
/// If no part is given.
pub fn merge(
    parts: &[PathBuf],
    is_partial: bool,
    base: Option<&Path>,
    out: &Path,
    made: impl FnOnce(&Arc<Folder>),
) -> Result<(Session, RunReport), SessionError> {
    if let Some(folder) = parts.iter().find(|part| is_same(part, out)) {
        return Err(SessionError::IsShard { folder: folder.clone() });
    }
    let begun: Vec<PathBuf> =
        parts.iter().filter(|part| !is_partial || Folder::at(part).file(STATE).exists()).cloned().collect();
    let (study, base) = Folder::at(begun.first().unwrap_or(&parts[0])).study(base)?;
    let load = |path: &Path| {
        // Nobody writes there meanwhile. There may be more parts than files can be open.
        let _shared = if is_partial { None } else { Lock::share(path)? };
        Folder::at(path).state(&study)
    };
    let gather = || {
        let state = merge_states(&study, &begun, is_partial, load)?;
        let mut rows = Vec::new();
        if study.plan().outputs.traces && !state.is_partial() {
            for path in &begun {
                let folder = Folder::at(path);
                rows.extend(rows::of_blocks(&folder, &folder.state(&study)?)?);
            }
        }
        Ok::<_, SessionError>((state, rows))
    };
    // Where a part is under way, its rows may be put into one file just as they are looked for.
    let mut left = if is_partial && study.plan().outputs.traces { TRIES } else { 1 };
    let mut gathered = gather();
    while gathered.is_err() && left > 1 {
        left -= 1;
        gathered = gather();
    }
    let (state, rows) = gathered?;
    let folder = Arc::new(Folder::make(out)?);
    made(&folder);
    let mut merged = put_together(&folder, &study, &base, state, &rows);
    while merged.is_err() && left > 1 {
        left -= 1;
        merged = gather().and_then(|(state, rows)| put_together(&folder, &study, &base, state, &rows));
    }
    if merged.is_err() {
        folder.take_back();
    }
    let state = merged?;
    let report = RunReport::merged(&begun, study.plan().run.precision, state.seconds());
    Ok((Session::new(folder, Arc::new(study), state), report))
}

/// Has the folder hold what was merged.
fn put_together(
    folder: &Folder,
    study: &Study,
    base: &Path,
    mut state: State,
    rows: &[(PathBuf, u64)],
) -> Result<State, SessionError> {
    if let Some(held) = folder.held(study, Shard::WHOLE, false)?
        && state.is_partial()
    {
        match held.stopped() {
            // It says more.
            Stopped::Complete | Stopped::RelativeError | Stopped::Seconds => return Ok(held),
            Stopped::Unfinished if !held.is_partial() => {
                return Err(SessionError::Occupied { file: folder.file(STATE) });
            }
            Stopped::Unfinished => {}
        }
    }
    // The state comes last: without it, this can be done again.
    folder.remember(study.plan(), base, Shard::WHOLE)?;
    if study.plan().outputs.traces && !state.is_partial() {
        let precision = study.plan().run.precision.name();
        let computed = Computed { engine: "merged", precision, on: "several runs".to_owned() };
        let (file, notes) = (folder.file(TRACES), provenance(study, &computed));
        // Parts may have done blocks behind the one with which the study is certain enough.
        let is_cut = state.stopped() == Stopped::RelativeError;
        merge_results(rows, &file, study.models()[0].scene(), &notes, state.traces(), is_cut)?;
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

impl From<StateError> for SessionError {
    /// Of a part that cannot be merged.
    fn from(error: StateError) -> Self {
        SessionError::State { error, folder: None }
    }
}
