//! One row for each trace: `traces.parquet`. Until the study is done, the rows are in a folder of such files, one for each
//! time between two checkpoints, so that a study that was stopped or killed goes on where its state does.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tautline::output::{ResultWriter, WriteError, merge_results};
use tautline::rope::TraceRecord;
use tautline::scene::Scene;
use tautline::study::{State, Stopped};

use crate::cli::failure::Failure;

/// The file that is there in the end, in the study's folder.
pub(super) const TRACES: &str = "traces.parquet";

/// What the folder of the parts is called once it is to go.
const GONE: &str = ".traces";

pub(super) struct Parts {
    /// Where the file will stand.
    whole: PathBuf,
    /// Where the rows are until then.
    folder: PathBuf,
    /// What is noted in each file.
    notes: Vec<(&'static str, String)>,
    current: Option<ResultWriter>,
}

impl Parts {
    /// Goes on where `state` does, of the study in `folder`: what was written of other blocks is dropped. `None` if the study
    /// is done and all is in its place.
    pub(super) fn open(
        folder: &Path,
        state: &State,
        notes: Vec<(&'static str, String)>,
    ) -> Result<Option<Self>, Failure> {
        let (whole, folder) = (folder.join(TRACES), folder.join("traces"));
        let failed = |e: std::io::Error| Failure::internal(anyhow!("cannot write {}: {e}", folder.display()));
        let gone = folder.with_file_name(GONE);
        if gone.exists() {
            fs::remove_dir_all(gone).map_err(failed)?;
        }
        if state.stopped() != Stopped::Unfinished && whole.exists() && !folder.exists() {
            return Ok(None);
        }
        fs::create_dir_all(&folder).map_err(failed)?;
        for entry in fs::read_dir(&folder).map_err(failed)? {
            let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
            let number = name.strip_suffix(".parquet").map(|stem| stem.trim_start_matches('.').split('.').next());
            let first = number.flatten().and_then(|n| n.parse::<u64>().ok());
            // Hidden files are those that were under way when the program was killed.
            if first.is_some_and(|first| first >= state.done()) || (name.starts_with('.') && name.contains(".parquet."))
            {
                fs::remove_file(folder.join(name)).map_err(failed)?;
            }
        }
        Ok(Some(Parts { whole, folder, notes, current: None }))
    }

    /// Adds rows of ropes in `scene`; `first` is the number of the block with which they begin, among those of the shard.
    pub(super) fn write(&mut self, first: u64, scene: &Scene, records: &[TraceRecord]) -> Result<(), WriteError> {
        if self.current.is_none() {
            let mut writer = ResultWriter::create(&self.folder.join(format!("{first:010}.parquet")))?;
            self.notes.iter().for_each(|(key, value)| writer.note(key, value));
            self.current = Some(writer);
        }
        self.current.as_mut().map_or(Ok(()), |writer| writer.write_all(scene, records))
    }

    /// Puts the rows since the last time in their place.
    pub(super) fn close(&mut self) -> Result<(), WriteError> {
        self.current.take().map_or(Ok(()), |rows| rows.complete()?.finish_durably())
    }

    /// Puts all rows into one file, once the study is done: those of so many traces.
    pub(super) fn finish(mut self, traces: u64) -> Result<(), Failure> {
        self.close()?;
        let failed = |e: std::io::Error| Failure::internal(anyhow!("cannot read {}: {e}", self.folder.display()));
        let mut parts = Vec::new();
        for entry in fs::read_dir(&self.folder).map_err(failed)? {
            parts.push(entry.map_err(failed)?.path());
        }
        merge_results(&parts, &self.whole, &self.notes, traces)?;
        // Gone at once: were only some of them there, the next run would take them for all.
        let gone = self.folder.with_file_name(GONE);
        fs::rename(&self.folder, &gone).and_then(|()| fs::remove_dir_all(&gone)).map_err(failed)
    }
}
