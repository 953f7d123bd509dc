//! Rows in any of the formats: what results and events have in common.

use std::io::Write;
use std::path::Path;

use super::tables::{Columns, Table};
use super::{Format, WholeFile, WriteError};

/// A file of rows that is being written; `C` are its columns where it is Parquet.
pub(super) enum Rows<C> {
    Jsonl(WholeFile),
    Csv(WholeFile),
    Parquet(Box<Table<C>>),
}

impl<C: Columns> Rows<C> {
    /// Starts the file at `path`, in the format that its extension names; `header` is the first line of CSV.
    pub(super) fn create(path: &Path, header: &str) -> Result<Self, WriteError> {
        let format = Format::of(path)?;
        let mut file = WholeFile::create(path)?;
        Ok(match format {
            Format::Jsonl => Rows::Jsonl(file),
            Format::Csv => {
                writeln!(file, "{header}").map_err(|cause| file.error(cause))?;
                Rows::Csv(file)
            }
            Format::Parquet => Rows::Parquet(Box::new(Table::new(path, file)?)),
        })
    }

    /// Writes the rest and returns the whole file.
    pub(super) fn complete(self) -> Result<WholeFile, WriteError> {
        match self {
            Rows::Jsonl(file) | Rows::Csv(file) => file.complete(),
            Rows::Parquet(table) => table.complete(),
        }
    }
}
