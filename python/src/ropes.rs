//! The ropes of many traces.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use glam::DVec2;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use tautline::engine::Engine;
use tautline::output::{event_batches, result_batches, write_events, write_results};
use tautline::picture::{Drawing, Theme};
use tautline::rope::{TraceRecord, replay};
use tautline::scene::Model;
use tautline::trace::{SettledTrace, Trace, settle_owned};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::scene::{Scene, settle_all};
use crate::stored::{Pickled, Stored};
use crate::table::{Table, pairs};

/// The most points that are evaluated at once.
const POINTS: usize = 1 << 25;

/// The ropes of many traces.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Ropes {
    model: Arc<Model>,
    /// What evaluated them.
    engine: String,
    records: Vec<TraceRecord>,
    /// Where the free ends came to rest.
    ends: Vec<DVec2>,
    /// The traces, unless only results are kept; then records have no events.
    settled: Option<Vec<SettledTrace>>,
    results: OnceLock<Table>,
}

impl Ropes {
    /// Settles and evaluates.
    pub(crate) fn evaluated(
        model: &Arc<Model>,
        engine: &mut Box<dyn Engine>,
        on: String,
        traces: Vec<Trace>,
        flag: bool,
        keep: bool,
        work: &Work,
    ) -> Result<Self, Fault> {
        let settled = settle_all(model, traces, work)?;
        if let (false, Some(first)) = (flag, settled.iter().find_map(|trace| trace.violation())) {
            let fault = Fault::from(*first);
            return Err(fault.and("on_violation=\"flag\" marks such traces and goes on"));
        }
        let mut records = Vec::with_capacity(settled.len());
        let mut rest = settled.as_slice();
        while !rest.is_empty() {
            let (mut points, most) = (0, engine.batch());
            let fits = |trace: &&SettledTrace| {
                points += trace.points().len();
                points <= POINTS
            };
            let count = rest.iter().take(most).take_while(fits).count().max(1);
            records.extend(engine.evaluate(&rest[..count], &work.job)?);
            rest = &rest[count..];
        }
        let ends = settled.iter().map(|trace| trace.points().last().copied().unwrap_or(model.anchor())).collect();
        let mut ropes =
            Ropes { model: model.clone(), engine: on, records, ends, settled: Some(settled), results: OnceLock::new() };
        if !keep {
            ropes.results = OnceLock::from(Table::of(result_batches(model.scene(), &ropes.records)));
            ropes.records.iter_mut().for_each(|record| record.events = Vec::new());
            ropes.settled = None;
        }
        Ok(ropes)
    }

    fn settled(&self) -> Result<&[SettledTrace], Fault> {
        let lost = || Fault::input("what happened step by step was not kept; evaluate with events=True");
        self.settled.as_deref().ok_or_else(lost)
    }
}

#[pymethods]
impl Ropes {
    #[getter]
    fn engine(&self) -> &str {
        &self.engine
    }

    fn __len__(&self) -> usize {
        self.records.len()
    }

    /// One row a trace.
    fn results(&self, py: Python<'_>) -> PyResult<Table> {
        if let Some(table) = self.results.get() {
            return Ok(table.clone());
        }
        let table = py.detach(|| Table::of(result_batches(self.model.scene(), &self.records)));
        Ok(self.results.get_or_init(|| table).clone())
    }

    /// One row an event.
    fn events(&self, py: Python<'_>) -> PyResult<Table> {
        self.settled()?;
        Ok(py.detach(|| Table::of(event_batches(self.model.scene(), &self.records))))
    }

    /// The rope's length after each step: offsets, and all lengths.
    #[allow(clippy::type_complexity)]
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>)> {
        let settled = self.settled()?;
        let of = |(trace, record): (&SettledTrace, &TraceRecord)| {
            let ends = trace.ends();
            let mut lengths = Vec::with_capacity(ends.len());
            replay(self.model.anchor(), self.model.vertices(), ends.len(), &record.events, |step, rope| {
                lengths.push(rope.length(ends[step]));
            });
            lengths
        };
        let work = |_: &Work| Ok(settled.par_iter().zip(&self.records).map(of).collect::<Vec<Vec<f64>>>());
        let lengths = compute::run(py, work, |_, _| Ok(()))?;
        let offsets = offsets(lengths.iter().map(Vec::len));
        Ok((PyArray1::from_vec(py, offsets), PyArray1::from_vec(py, lengths.concat())))
    }

    /// The taut ropes at the end: offsets, and the points of all, each from the anchor to the free end.
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyAny>)> {
        let counts = self.records.iter().map(|record| record.wraps.len() + 2);
        let offsets = offsets(counts);
        let line = |(record, end): (&TraceRecord, &DVec2)| {
            let turns = record.wraps.iter().map(|(at, _)| *at);
            [self.model.anchor()].into_iter().chain(turns).chain([*end]).collect::<Vec<_>>()
        };
        let all = self.records.iter().zip(&self.ends).flat_map(line);
        Ok((PyArray1::from_vec(py, offsets), pairs(py, all.flat_map(|p| p.to_array()).collect::<Vec<f64>>())?))
    }

    /// The taut rope of one trace after a step, by their places.
    fn rope_at<'py>(&self, py: Python<'py>, place: usize, step: usize) -> PyResult<Bound<'py, PyAny>> {
        let settled = self.settled()?;
        let ends = settled.get(place).map_or(Cow::Borrowed(&[] as &[DVec2]), |trace| trace.ends());
        if step >= ends.len() {
            return Err(Fault::input(format!("there is no step {step}; the trace has {} points", ends.len())).into());
        }
        let mut points = vec![self.model.anchor()];
        let (vertices, events) = (self.model.vertices(), &self.records[place].events);
        replay(self.model.anchor(), vertices, step + 1, events, |k, rope| {
            if k == step {
                points.extend(rope.taut(ends[step]).iter().map(|contact| contact.at));
            }
        });
        points.push(ends[step]);
        pairs(py, points.iter().flat_map(|p| p.to_array()).collect::<Vec<f64>>())
    }

    /// The traces' points: offsets, and all points.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyAny>)> {
        let ends: Vec<Cow<'_, [DVec2]>> = self.settled()?.iter().map(SettledTrace::ends).collect();
        let offsets = offsets(ends.iter().map(|ends| ends.len()));
        let flat: Vec<f64> = ends.iter().flat_map(|ends| ends.iter()).flat_map(|p| p.to_array()).collect();
        Ok((PyArray1::from_vec(py, offsets), pairs(py, flat)?))
    }

    /// Writes results and events as the program does.
    fn write(&self, py: Python<'_>, results: Option<PathBuf>, events: Option<PathBuf>) -> PyResult<()> {
        self.settled()?;
        let scene = self.model.scene();
        let write = |_: &Work| {
            results.iter().try_for_each(|path| write_results(path, scene, &self.records))?;
            Ok(events.iter().try_for_each(|path| write_events(path, scene, &self.records))?)
        };
        compute::run(py, write, |_, _| Ok(()))
    }

    /// The picture of some traces and their ropes, by their places.
    #[pyo3(signature = (places, step=None, dark=None))]
    fn svg(&self, places: Vec<usize>, step: Option<usize>, dark: Option<bool>) -> PyResult<String> {
        let settled = self.settled()?;
        let theme = match dark {
            None => Theme::Reader,
            Some(true) => Theme::Dark,
            Some(false) => Theme::Light,
        };
        let mut drawing = Drawing::new(&self.model).theme(theme);
        for place in places {
            let record = self.records.get(place).ok_or_else(|| Fault::input(format!("there is no rope {place}")))?;
            drawing = drawing.with(&settled[place], record);
        }
        let drawing = step.into_iter().fold(drawing, Drawing::at_step);
        Ok(drawing.svg().map_err(Fault::from)?)
    }

    /// All of it but the scene as bytes.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let points = |t: &SettledTrace| (t.id(), t.ends().iter().flat_map(|p| p.to_array()).collect());
        let pickled = Pickled {
            engine: self.engine.clone(),
            traces: self.settled.as_ref().map(|settled| settled.iter().map(points).collect()),
            ends: self.ends.iter().map(|end| end.to_array()).collect(),
            records: self.records.iter().map(Stored::from).collect(),
            results: match &self.settled {
                Some(_) => None,
                None => self.results.get().map(Table::ipc).transpose()?,
            },
        };
        Ok(PyBytes::new(py, &pickled.bytes()?))
    }

    /// What `state` gave, in the same scene.
    #[staticmethod]
    fn restored(py: Python<'_>, scene: &Scene, bytes: &[u8]) -> PyResult<Self> {
        let model = scene.model()?.clone();
        let pickled = Pickled::read(bytes)?;
        let settle = |_: &Work| {
            let point = |(id, flat): &(u64, Vec<f64>)| {
                let points = flat.chunks_exact(2).map(|p| DVec2::new(p[0], p[1])).collect();
                settle_owned(&model, Trace { id: *id, points })
            };
            Ok(pickled.traces.as_ref().map(|traces| traces.par_iter().map(point).collect()))
        };
        let settled = compute::run(py, settle, |_, _| Ok(()))?;
        let results = pickled.results.as_deref().map(Table::from_ipc).transpose()?;
        Ok(Ropes {
            engine: pickled.engine,
            records: pickled.records.iter().map(Stored::record).collect(),
            ends: pickled.ends.iter().map(|&end| end.into()).collect(),
            settled,
            results: results.map_or_else(OnceLock::new, OnceLock::from),
            model,
        })
    }
}

/// Where lists begin that lie one after the other, and where the last ends.
fn offsets(counts: impl Iterator<Item = usize>) -> Vec<i64> {
    let mut offsets = vec![0];
    for count in counts {
        offsets.push(offsets[offsets.len() - 1] + count as i64);
    }
    offsets
}
