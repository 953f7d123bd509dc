//! One row for each trace: `traces.parquet`. Until the study is done, the rows are in a folder of such files, one for
//! each time between two checkpoints. The state knows each of them by its check sum; what is missing or is not as it
//! was written is computed again.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::error::{Action, Note, RowsFault, SessionError};
use super::folder::{Folder, check};
use super::names::{PARTS, TRACES};
use crate::output::{ResultWriter, WriteError, merge_results};
use crate::rope::TraceRecord;
use crate::scene::Scene;
use crate::study::{Check, Part, State, Stopped, Study};

pub(super) struct Rows {
    folder: PathBuf,
    /// The scene in which the ropes are.
    scene: Scene,
    /// What is noted in each file.
    notes: Vec<(&'static str, String)>,
    /// The part under way, and the places of the traces in it.
    current: Option<(Range<u64>, ResultWriter)>,
}

impl Rows {
    /// Goes on where `state` does, of the study in `folder`, and tells which rows are to be computed again, by the
    /// places of their traces: the state then does not count on the files in which they were. What it does not know is
    /// dropped. No parts if all rows are in their place.
    pub(super) fn open(
        folder: &Folder,
        study: &Study,
        state: &mut State,
        notes: Vec<(&'static str, String)>,
    ) -> Result<(Option<Self>, Vec<Range<u64>>), SessionError> {
        let parts = folder.file(PARTS);
        let failed = |cause| SessionError::Rows { action: Action::Write, path: parts.clone(), cause };
        if let Some(sum) = state.kept.files.remove(TRACES)
            && state.stopped() != Stopped::Unfinished
            && is_whole(folder, &folder.file(TRACES), &sum)
        {
            state.kept.files.insert(TRACES.to_owned(), sum);
            clear(folder)?;
            return Ok((None, Vec::new()));
        }
        fs::create_dir_all(&parts).map_err(failed)?;
        let end = state.place(study);
        let mut next = 0;
        let mut gaps = Vec::new();
        state.kept.parts.retain(|part| {
            let Range { start, end: to } = part.places;
            let is_kept =
                start >= next && start < to && to <= end && is_whole(folder, &path(&parts, start), &part.check);
            if is_kept {
                gaps.push(next..start);
                next = to;
            }
            is_kept
        });
        gaps.push(next..end);
        gaps.retain(|gap| !gap.is_empty());
        let known: Vec<PathBuf> = state.kept.parts.iter().map(|part| path(&parts, part.places.start)).collect();
        for entry in fs::read_dir(&parts).map_err(failed)? {
            let file = entry.map_err(failed)?.path();
            if !known.contains(&file) {
                let action = Action::Remove;
                fs::remove_file(&file).map_err(|cause| SessionError::Rows { action, path: file, cause })?;
            }
        }
        let scene = study.models()[0].scene().clone();
        Ok((Some(Rows { folder: parts, scene, notes, current: None }), gaps))
    }

    /// Adds the rows of the traces from that at place `first` on.
    pub(super) fn write(&mut self, first: u64, records: &[TraceRecord]) -> Result<(), WriteError> {
        if records.is_empty() {
            return Ok(());
        }
        let (places, writer) = match &mut self.current {
            Some(current) => current,
            None => {
                let mut writer = ResultWriter::create(&path(&self.folder, first), &self.scene)?;
                self.notes.iter().for_each(|(key, value)| writer.note(key, value));
                self.current.insert((first..first, writer))
            }
        };
        assert_eq!(places.end, first, "rows come in their order");
        places.end += records.len() as u64;
        writer.write_all(&self.scene, records)
    }

    /// Puts the rows since the last time in their place, and has the state know of them.
    pub(super) fn close(&mut self, state: &mut State) -> Result<(), SessionError> {
        let Some((places, writer)) = self.current.take() else { return Ok(()) };
        writer.complete()?.finish_durably()?;
        let file = path(&self.folder, places.start);
        let check = check(&file).map_err(|cause| unread(&file, cause))?;
        state.kept.parts.push(Part { places, check });
        state.kept.parts.sort_by_key(|part| part.places.start);
        Ok(())
    }

    /// Puts all rows into one file, once the study is done, those of so many traces; the parts of which are these.
    pub(super) fn finish(self, folder: &Folder, parts: &[Part], traces: u64) -> Result<Check, SessionError> {
        let of = |part: &Part| (path(&self.folder, part.places.start), part.places.end - part.places.start);
        let (parts, whole): (Vec<_>, _) = (parts.iter().map(of).collect(), folder.file(TRACES));
        merge_results(&parts, &whole, &self.scene, &self.notes, traces, false)?;
        check(&whole).map_err(|cause| unread(&whole, cause))
    }
}

/// Has the rows of a study that was done and has more traces now be the first of its parts.
pub(super) fn reopen(folder: &Folder, study: &Study, state: &mut State) -> Result<(), SessionError> {
    if state.stopped() != Stopped::Unfinished || !study.plan().outputs.traces {
        return Ok(());
    }
    let Some(check) = state.kept.files.remove(TRACES) else { return Ok(()) };
    let (from, parts) = (folder.file(TRACES), folder.file(PARTS));
    let moved = fs::create_dir_all(&parts).and_then(|()| fs::rename(&from, path(&parts, 0)));
    moved.map_err(|cause| SessionError::Rows { action: Action::Write, path: parts, cause })?;
    state.kept.parts = vec![Part { places: 0..state.place(study), check }];
    Ok(())
}

/// Removes the parts, which are not needed any more.
pub(super) fn clear(folder: &Folder) -> Result<(), SessionError> {
    let parts = folder.file(PARTS);
    match fs::remove_dir_all(&parts) {
        Err(cause) if parts.exists() => Err(SessionError::Rows { action: Action::Remove, path: parts, cause }),
        _ => Ok(()),
    }
}

/// The rows of a shard that is done.
pub(super) fn of_shard(folder: &Folder, state: &State) -> Result<PathBuf, SessionError> {
    match state.kept.files.get(TRACES) {
        None => Err(shard_fault(folder, folder.file(TRACES), RowsFault::Missing)),
        Some(known) => checked(folder, folder.file(TRACES), known),
    }
}

/// The rows of all whole blocks that a part has done, under way or not: files, each with how many of its first rows
/// these are.
pub(super) fn of_blocks(folder: &Folder, state: &State) -> Result<Vec<(PathBuf, u64)>, SessionError> {
    let all = state.traces();
    if state.is_partial() {
        return Err(SessionError::NoRows { folder: folder.path().to_owned() });
    }
    if state.stopped() != Stopped::Unfinished {
        return Ok(vec![(of_shard(folder, state)?, all)]);
    }
    let (parts, mut next, mut files) = (folder.file(PARTS), 0, Vec::new());
    for part in state.kept.parts.iter().filter(|part| part.places.start < all) {
        let Range { start, end } = part.places;
        if start != next {
            break;
        }
        files.push((checked(folder, path(&parts, start), &part.check)?, end.min(all) - start));
        next = end;
    }
    if next < all { Err(shard_fault(folder, parts, RowsFault::Missing)) } else { Ok(files) }
}

/// A file of a shard's rows, if it is as it was written.
fn checked(folder: &Folder, file: PathBuf, known: &Check) -> Result<PathBuf, SessionError> {
    match check(&file) {
        Err(cause) => Err(shard_fault(folder, file, RowsFault::Unread(cause))),
        Ok(found) if found != *known => Err(shard_fault(folder, file, RowsFault::Damaged)),
        Ok(_) => Ok(file),
    }
}

fn shard_fault(folder: &Folder, file: PathBuf, fault: RowsFault) -> SessionError {
    SessionError::ShardRows { file, folder: folder.path().to_owned(), fault }
}

fn path(parts: &Path, first: u64) -> PathBuf {
    parts.join(format!("{first:012}.parquet"))
}

/// Whether a file is as it was written; notes it if it is not.
fn is_whole(folder: &Folder, file: &Path, known: &Check) -> bool {
    let fault = match check(file) {
        Ok(found) if found == *known => return true,
        Ok(_) => RowsFault::Damaged,
        Err(cause) => RowsFault::Unread(cause),
    };
    folder.note(Note::Again { file: file.to_owned(), fault });
    false
}

fn unread(path: &Path, cause: std::io::Error) -> SessionError {
    SessionError::Rows { action: Action::Read, path: path.to_owned(), cause }
}
