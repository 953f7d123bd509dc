//! One row for each trace: `traces.parquet`. Until the study is done, the rows are in a folder of such files, one for each
//! time between two checkpoints. The state knows each of them by its check sum; what is missing or is not as it was written is
//! computed again.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tautline::output::{ResultWriter, merge_results};
use tautline::rope::TraceRecord;
use tautline::scene::Scene;
use tautline::study::{Check, Part, State, Stopped, Study};

use super::folder::{Folder, check};
use crate::cli::failure::Failure;

/// The file that is there in the end, in the study's folder.
pub(super) const TRACES: &str = "traces.parquet";

/// The folder of the parts, in the study's folder.
pub(super) const PARTS: &str = "traces";

pub(super) struct Parts {
    folder: PathBuf,
    /// The scene in which the ropes are.
    scene: Scene,
    /// What is noted in each file.
    notes: Vec<(&'static str, String)>,
    /// The part under way, and the places of the traces in it.
    current: Option<(Range<u64>, ResultWriter)>,
}

impl Parts {
    /// Goes on where `state` does, of the study in `folder`, and tells which rows are to be computed again, by the places of their
    /// traces: the state then does not count on the files in which they were. What it does not know is dropped. No parts if all rows
    /// are in their place.
    pub(super) fn open(
        folder: &Folder,
        study: &Study,
        state: &mut State,
        notes: Vec<(&'static str, String)>,
    ) -> Result<(Option<Self>, Vec<Range<u64>>), Failure> {
        let parts = folder.file(PARTS);
        let failed = |e: std::io::Error| Failure::internal(anyhow!("cannot write {}: {e}", parts.display()));
        if let Some(sum) = state.kept.files.remove(TRACES)
            && state.stopped() != Stopped::Unfinished
            && is_whole(&folder.file(TRACES), &sum)
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
            let is_kept = start >= next && start < to && to <= end && is_whole(&path(&parts, start), &part.check);
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
                fs::remove_file(file).map_err(failed)?;
            }
        }
        let scene = study.models()[0].scene().clone();
        Ok((Some(Parts { folder: parts, scene, notes, current: None }), gaps))
    }

    /// Adds the rows of the traces from that at place `first` on.
    pub(super) fn write(&mut self, first: u64, records: &[TraceRecord]) -> Result<(), Failure> {
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
        Ok(writer.write_all(&self.scene, records)?)
    }

    /// Puts the rows since the last time in their place, and has the state know of them.
    pub(super) fn close(&mut self, state: &mut State) -> Result<(), Failure> {
        let Some((places, writer)) = self.current.take() else { return Ok(()) };
        writer.complete()?.finish_durably()?;
        let file = path(&self.folder, places.start);
        let check = check(&file).map_err(|e| unread(&file, &e))?;
        state.kept.parts.push(Part { places, check });
        state.kept.parts.sort_by_key(|part| part.places.start);
        Ok(())
    }

    /// Puts all rows into one file, once the study is done, those of so many traces; the parts of which are these.
    pub(super) fn finish(self, folder: &Folder, parts: &[Part], traces: u64) -> Result<Check, Failure> {
        let (parts, whole): (Vec<PathBuf>, _) =
            (parts.iter().map(|part| path(&self.folder, part.places.start)).collect(), folder.file(TRACES));
        merge_results(&parts, &whole, &self.scene, &self.notes, traces)?;
        check(&whole).map_err(|e| unread(&whole, &e))
    }
}

/// Removes the parts, which are not needed any more.
pub(super) fn clear(folder: &Folder) -> Result<(), Failure> {
    let parts = folder.file(PARTS);
    match fs::remove_dir_all(&parts) {
        Err(e) if parts.exists() => Err(Failure::internal(anyhow!("cannot remove {}: {e}", parts.display()))),
        _ => Ok(()),
    }
}

/// The check sum of the rows of a shard that is done.
pub(super) fn of_shard(folder: &Folder, state: &State) -> Result<PathBuf, Failure> {
    let file = folder.file(TRACES);
    let fault = |what: &str| {
        let shown = folder.path().display();
        Failure::input(anyhow!("{}: {what}; `tautline study resume {shown}` writes it again", file.display()))
    };
    match (state.kept.files.get(TRACES), check(&file)) {
        (None, _) => Err(fault("its rows are not all there")),
        (Some(_), Err(e)) => Err(fault(&e.to_string())),
        (Some(known), Ok(found)) if *known != found => Err(fault("damaged: its check sum is wrong")),
        _ => Ok(file),
    }
}

fn path(parts: &Path, first: u64) -> PathBuf {
    parts.join(format!("{first:012}.parquet"))
}

/// Whether a file is as it was written; says so if it is not.
fn is_whole(file: &Path, known: &Check) -> bool {
    let what = match check(file) {
        Ok(found) if found == *known => return true,
        Ok(_) => "damaged: its check sum is wrong".to_owned(),
        Err(e) => e.to_string(),
    };
    say!("note: {}: {what}; its rows are computed again", file.display());
    false
}

fn unread(file: &Path, e: &std::io::Error) -> Failure {
    Failure::internal(anyhow!("cannot read {}: {e}", file.display()))
}
