//! Steps: one row for the rope after every step.

use std::mem::take;
use std::path::Path;
use std::sync::Arc;

use super::rows::Rows;
use super::step_arrays::StepArrays;
use super::{Extras, WholeFile, WriteError, step_text};
use crate::rope::{EndsRecord, EndsSteps, StepColumns, Steps, TraceRecord};
use crate::scene::Model;
use crate::trace::{SettledEnds, SettledTrace};

/// How many rows are held before they are written: the bound on memory.
const ROWS: usize = 1 << 16;

/// Writes the rope after every step of traces to a file that appears when it is finished.
///
/// `.jsonl`, `.csv` and `.parquet` have the same columns: `trace`, `step`, `x`, `y`, `length`, `contacts`, `turns`,
/// `pull_x`, `pull_y` (both null, in `.csv` empty, for a rope of no length), and for each centre `winding_NAME`: what
/// [`RopeStep`](crate::rope::RopeStep) and [`Steps::windings`] say. Where friction is asked for `anchor_pull_x`,
/// `anchor_pull_y`, `turned`, `tension` and `work`, what [`Strain`](crate::rope::Strain) says, follow `pull_y`. Rows
/// come out of one replay of each trace's events and are written as they come: memory grows neither with the number of
/// traces nor with their steps, but for what Parquet's footer says of each million of rows.
pub struct StepWriter {
    rows: Rows<StepArrays>,
    columns: StepColumns,
    model: Arc<Model>,
    extras: Extras,
    both_move: bool,
}

impl StepWriter {
    /// Starts the file at `path`, in the format that its extension names, for ropes in `model`; `extras` says what
    /// is told beside them.
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn create(path: &Path, model: &Arc<Model>, extras: &Extras) -> Result<Self, WriteError> {
        Self::with(path, model, extras, false)
    }

    /// The same for ropes whose ends both move: columns `bx` and `by`, where the anchor is, follow `y`, and
    /// [`write_ends`](Self::write_ends) adds the steps.
    ///
    /// # Errors
    ///
    /// Those of [`check_output`](super::check_output).
    pub fn of_ends(path: &Path, model: &Arc<Model>, extras: &Extras) -> Result<Self, WriteError> {
        Self::with(path, model, extras, true)
    }

    fn with(path: &Path, model: &Arc<Model>, extras: &Extras, both_move: bool) -> Result<Self, WriteError> {
        let header = step_text::header(extras, both_move);
        let rows = Rows::create(path, &header, StepArrays::new(extras, both_move))?;
        let columns = StepColumns::new(extras.centres.len());
        Ok(StepWriter { rows, columns, model: model.clone(), extras: extras.clone(), both_move })
    }

    /// Adds the steps of traces of ropes whose ends both move, each with what became of it, to a file
    /// [of such](Self::of_ends).
    ///
    /// # Errors
    ///
    /// As those of [`write_all`](Self::write_all).
    ///
    /// # Panics
    ///
    /// As [`EndsSteps::new`] and [`EndsSteps::next`], if a record is not that of its trace.
    pub fn write_ends(&mut self, traces: &[SettledEnds], records: &[EndsRecord]) -> Result<(), WriteError> {
        let model = self.model.clone();
        traces.iter().zip(records).try_for_each(|(trace, record)| {
            let steps = EndsSteps::new(&model, trace, record, &self.extras.centres);
            let mut steps = steps.with_friction(self.extras.friction);
            while !self.columns.take_ends(record.record.trace, &mut steps, ROWS) {
                self.flush()?;
            }
            Ok(())
        })
    }

    /// Adds the steps of traces, each with what became of it, tied where the rope of the file's model is.
    ///
    /// # Errors
    ///
    /// What the operating system says; the file cannot be finished after that.
    ///
    /// # Panics
    ///
    /// As [`Steps::new`] and [`Steps::next`], if a record is not that of its trace.
    pub fn write_all(&mut self, traces: &[SettledTrace], records: &[TraceRecord]) -> Result<(), WriteError> {
        let model = self.model.clone();
        traces.iter().zip(records).try_for_each(|(trace, record)| self.write_tied(&model, trace, record))
    }

    /// Adds the steps of one trace in `model`, which has the scene of the file's and may be tied elsewhere.
    ///
    /// # Errors
    ///
    /// As those of [`write_all`](Self::write_all).
    ///
    /// # Panics
    ///
    /// As [`write_all`](Self::write_all).
    pub fn write_tied(&mut self, model: &Model, trace: &SettledTrace, record: &TraceRecord) -> Result<(), WriteError> {
        let steps = Steps::new(model, trace, record, &self.extras.centres);
        let mut steps = steps.with_friction(self.extras.friction);
        while !self.columns.take(record.trace, &mut steps, ROWS) {
            self.flush()?;
        }
        Ok(())
    }

    /// Notes something about the steps, where they come from say, in the metadata of a Parquet file; the other formats
    /// have no place for it.
    pub fn note(&mut self, key: &str, value: &str) {
        self.rows.note(key, value);
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    ///
    /// What the operating system says, or that an earlier write failed.
    pub fn finish(self) -> Result<(), WriteError> {
        self.complete()?.finish()
    }

    /// Writes the rest and returns the whole file, to be put in its place by [`WholeFile::finish`]: for files that
    /// must appear together or not at all.
    ///
    /// # Errors
    ///
    /// What the operating system says, or that an earlier write failed.
    pub fn complete(mut self) -> Result<WholeFile, WriteError> {
        self.flush()?;
        self.rows.complete()
    }

    /// Writes the rows that are held.
    fn flush(&mut self) -> Result<(), WriteError> {
        let columns = take(&mut self.columns);
        self.columns = StepColumns::new(self.extras.centres.len());
        let extras = &self.extras;
        match &mut self.rows {
            Rows::Parquet(table) => table.write_columns(StepArrays::of(columns, extras, self.both_move)),
            text => {
                let rows: Vec<usize> = (0..columns.len()).collect();
                text.write_all(
                    &rows,
                    |text, &row| step_text::json(text, &columns, row, &extras.centres),
                    |text, &row| step_text::csv(text, &columns, row),
                    |_, _| Ok(()),
                )
            }
        }
    }
}
