//! Rows in any of the formats: what results and events have in common.

use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;

use super::tables::{Columns, Table};
use super::{Format, WholeFile, WriteError};

/// How many items a thread writes at a time.
const TOGETHER: usize = 32;

/// A file of rows that is being written; `C` are its columns where it is Parquet.
pub(super) enum Rows<C> {
    Jsonl(WholeFile),
    Csv(WholeFile),
    Parquet(Box<Table<C>>),
}

impl<C: Columns> Rows<C> {
    /// Starts the file at `path`, in the format that its extension names; `header` is the first line of CSV.
    pub(super) fn create(path: &Path, header: &str, columns: C) -> Result<Self, WriteError> {
        let format = Format::of(path)?;
        let mut file = WholeFile::create(path)?;
        Ok(match format {
            Format::Jsonl => Rows::Jsonl(file),
            Format::Csv => {
                writeln!(file, "{header}").map_err(|cause| file.error(cause))?;
                Rows::Csv(file)
            }
            Format::Parquet => Rows::Parquet(Box::new(Table::new(path, file, columns)?)),
        })
    }

    /// Notes something in the metadata of a Parquet file.
    pub(super) fn note(&mut self, key: &str, value: &str) {
        if let Rows::Parquet(table) = self {
            table.note(key, value);
        }
    }

    /// Writes all `items`, which are independent of each other: `text` writes one as lines, `push` adds it to the
    /// columns. Lines are made in parallel and written in order; all of their text is held in memory.
    pub(super) fn write_all<T: Sync>(
        &mut self,
        items: &[T],
        json: impl Fn(&mut Vec<u8>, &T) -> io::Result<()> + Sync,
        csv: impl Fn(&mut Vec<u8>, &T) -> io::Result<()> + Sync,
        mut push: impl FnMut(&mut Table<C>, &T) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        match self {
            Rows::Jsonl(file) => write_lines(file, items, json),
            Rows::Csv(file) => write_lines(file, items, csv),
            Rows::Parquet(table) => items.iter().try_for_each(|item| push(table, item)),
        }
    }

    /// Writes the rest and returns the whole file.
    pub(super) fn complete(self) -> Result<WholeFile, WriteError> {
        match self {
            Rows::Jsonl(file) | Rows::Csv(file) => file.complete(),
            Rows::Parquet(table) => table.complete(),
        }
    }
}

/// Makes the lines of all items in parallel and writes them in order.
fn write_lines<T: Sync>(
    file: &mut WholeFile,
    items: &[T],
    line: impl Fn(&mut Vec<u8>, &T) -> io::Result<()> + Sync,
) -> Result<(), WriteError> {
    let texts = items.par_chunks(TOGETHER).map(|items| {
        let mut text = Vec::new();
        items.iter().try_for_each(|item| line(&mut text, item)).map(|()| text)
    });
    let texts: Vec<io::Result<Vec<u8>>> = texts.collect();
    texts.into_iter().try_for_each(|text| file.write_all(&text?)).map_err(|cause| file.error(cause))
}
