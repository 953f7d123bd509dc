//! The rope after every step, made as it is read.

use std::ops::Range;
use std::sync::Arc;

use arrow_array::{RecordBatch, RecordBatchReader};
use arrow_schema::{ArrowError, SchemaRef};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use rayon::ThreadPool;
use tautline::output::{Extras, step_batches};

use crate::compute;
use crate::ropes::Kept;
use crate::table::{Table, capsule};

/// How many steps are made at once, about: enough for all threads.
const STEPS: usize = 1 << 18;

/// The rope after every step, made as it is read: as many streams of it as are asked for.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct StepStream {
    pub(crate) of: Arc<Kept>,
    pub(crate) extras: Extras,
}

impl StepStream {
    /// The rows of the traces at these places.
    fn rows(&self, places: Range<usize>) -> (SchemaRef, Vec<RecordBatch>) {
        let (records, settled) = (&self.of.records, self.of.settled().unwrap_or_default());
        step_batches(&self.of.model, &settled[places.clone()], &records[places], &self.extras)
    }

    /// The places of the next traces from `first` on, so many that they have enough steps; none at the end.
    fn next(&self, first: usize) -> Range<usize> {
        let (mut end, mut steps) = (first, 0);
        let settled = self.of.settled().unwrap_or_default();
        while end < settled.len() && steps < STEPS {
            steps += settled[end].points().len();
            end += 1;
        }
        first..end
    }
}

#[pymethods]
impl StepStream {
    /// A new stream of all rows.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let of = StepStream { of: self.of.clone(), extras: self.extras.clone() };
        let (schema, pool) = (self.rows(0..0).0, compute::pool(py)?);
        capsule(py, Reader { of, schema, pool, place: 0, ready: Vec::new() })
    }

    /// The rows of the next traces from place `first` on, and the place behind them; none at the end.
    fn part(&self, py: Python<'_>, first: usize) -> PyResult<Option<(Table, usize)>> {
        let places = self.next(first);
        if places.is_empty() {
            return Ok(None);
        }
        let end = places.end;
        Ok(Some((compute::run(py, |_| Ok(Table::of(self.rows(places))), |_, _| Ok(()))?, end)))
    }
}

/// One stream.
struct Reader {
    of: StepStream,
    schema: SchemaRef,
    /// Whoever reads it may hold no interpreter's lock, and be no thread of the package's.
    pool: Arc<ThreadPool>,
    place: usize,
    /// What is made and not read yet, the last of it first.
    ready: Vec<RecordBatch>,
}

impl Iterator for Reader {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ready.is_empty() {
            let places = self.of.next(self.place);
            self.place = places.end;
            self.ready = self.pool.install(|| self.of.rows(places)).1;
            self.ready.reverse();
        }
        self.ready.pop().map(Ok)
    }
}

impl RecordBatchReader for Reader {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }
}
