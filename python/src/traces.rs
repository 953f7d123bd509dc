//! Traces as they come from Python: arrays, or the rows of a table.

use std::sync::{Mutex, PoisonError};

use glam::DVec2;
use numpy::{PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use tautline::geometry::check_points;
use tautline::trace::{Trace, traces_of_rows};

use crate::arrow_in;
use crate::compute;
use crate::fault::Fault;

/// The columns of a table of points.
#[derive(Default)]
pub(crate) struct Rows {
    pub(crate) trace: Vec<u64>,
    pub(crate) step: Option<Vec<u64>>,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
}

impl Rows {
    fn traces(&self) -> Result<Vec<Trace>, Fault> {
        let points = |rows: std::ops::Range<usize>| rows.map(|row| DVec2::new(self.x[row], self.y[row]));
        traces_of_rows(&self.trace, self.step.as_deref(), points)
            .map_err(|(row, what)| Fault::input(format!("row {row}: {what}")).number("row", row as u64))
    }
}

/// Traces on their way to where they are needed: each serves once.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Traces(Mutex<Option<Vec<Trace>>>);

impl Traces {
    fn new(traces: Vec<Trace>) -> Self {
        Traces(Mutex::new(Some(traces)))
    }

    pub(crate) fn take(&self) -> Result<Vec<Trace>, Fault> {
        let mut traces = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        traces.take().ok_or_else(|| Fault::input("these traces were used already"))
    }
}

#[pymethods]
impl Traces {
    /// Traces 0, 1, 2, ...: the points of trace i are those from offsets[i] up to offsets[i + 1] of xy, which is flat.
    #[staticmethod]
    fn of_points(offsets: PyReadonlyArray1<'_, i64>, xy: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        let (offsets, xy) = (offsets.as_slice()?, xy.as_slice()?);
        let count = (xy.len() / 2) as i64;
        let wrong = |what: String| Fault::input(format!("offsets: {what}"));
        if offsets.first() != Some(&0) || offsets.last() != Some(&count) {
            let what = format!("the first must be 0 and the last {count}, the number of points");
            return Err(wrong(what).into());
        }
        if let Some(trace) = offsets.windows(2).position(|pair| pair[0] >= pair[1]) {
            let what = format!("trace {trace} has no points; each needs one at least, and offsets increase");
            return Err(wrong(what).number("trace", trace as u64).into());
        }
        // With the lock held, so that nobody writes to the arrays meanwhile.
        Ok(split(offsets, xy).map(Traces::new)?)
    }

    /// Traces by the rows of a table.
    #[staticmethod]
    #[pyo3(signature = (trace, x, y, step=None))]
    fn of_rows(
        py: Python<'_>,
        trace: PyReadonlyArray1<'_, u64>,
        x: PyReadonlyArray1<'_, f64>,
        y: PyReadonlyArray1<'_, f64>,
        step: Option<PyReadonlyArray1<'_, u64>>,
    ) -> PyResult<Self> {
        let step = step.map(|step| step.to_vec()).transpose()?;
        let rows = Rows { trace: trace.to_vec()?, step, x: x.to_vec()?, y: y.to_vec()? };
        Ok(py.detach(|| rows.traces()).map(Traces::new)?)
    }

    /// The same of a table that is handed over as an Arrow C stream.
    #[staticmethod]
    fn of_stream(py: Python<'_>, capsule: &Bound<'_, PyCapsule>) -> PyResult<Self> {
        let rows = arrow_in::rows(py, capsule)?;
        compute::run(py, |_| rows.traces(), |_, _| Ok(())).map(Traces::new)
    }
}

fn split(offsets: &[i64], xy: &[f64]) -> Result<Vec<Trace>, Fault> {
    let trace = |(id, pair): (usize, &[i64])| {
        let flat = &xy[2 * pair[0] as usize..2 * pair[1] as usize];
        // Adding zero turns negative zeros into positive ones.
        let points: Vec<DVec2> = flat.chunks_exact(2).map(|p| DVec2::new(p[0], p[1]) + DVec2::ZERO).collect();
        if let Err((point, fault)) = check_points(&points) {
            let fault = Fault::input(format!("trace {id}, point {point}: {fault}"));
            return Err(fault.number("trace", id as u64).number("step", point as u64));
        }
        Ok(Trace { id: id as u64, points })
    };
    offsets.windows(2).enumerate().map(trace).collect()
}
