//! One row for each trace, in a folder of Parquet files: one for each time between two checkpoints, so that a study that
//! was stopped or killed goes on where its state does.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tautline::output::{ResultWriter, WriteError};
use tautline::rope::TraceRecord;

use crate::cli::failure::Failure;

pub(super) struct Parts {
    folder: PathBuf,
    /// What is noted in each file.
    notes: Vec<(&'static str, String)>,
    current: Option<ResultWriter>,
}

impl Parts {
    /// Goes on after the first `done` blocks: what was written of others is dropped.
    pub(super) fn open(folder: &Path, done: u64, notes: Vec<(&'static str, String)>) -> Result<Self, Failure> {
        let failed = |e: std::io::Error| Failure::internal(anyhow!("cannot write {}: {e}", folder.display()));
        fs::create_dir_all(folder).map_err(failed)?;
        for entry in fs::read_dir(folder).map_err(failed)? {
            let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
            let number = name.strip_suffix(".parquet").map(|stem| stem.trim_start_matches('.').split('.').next());
            let first = number.flatten().and_then(|n| n.parse::<u64>().ok());
            // Hidden files are those that were under way when the program was killed.
            if first.is_some_and(|first| first >= done) || (name.starts_with('.') && name.contains(".parquet.")) {
                fs::remove_file(folder.join(name)).map_err(failed)?;
            }
        }
        Ok(Parts { folder: folder.to_owned(), notes, current: None })
    }

    /// Adds rows; `first` is the number of the block with which they begin, among those of the shard.
    pub(super) fn write(&mut self, first: u64, records: &[TraceRecord]) -> Result<(), WriteError> {
        if self.current.is_none() {
            let mut writer = ResultWriter::create(&self.folder.join(format!("{first:010}.parquet")))?;
            self.notes.iter().for_each(|(key, value)| writer.note(key, value));
            self.current = Some(writer);
        }
        self.current.as_mut().map_or(Ok(()), |writer| writer.write_all(records))
    }

    /// Puts the rows since the last time in their place.
    pub(super) fn close(&mut self) -> Result<(), WriteError> {
        self.current.take().map_or(Ok(()), ResultWriter::finish)
    }
}
