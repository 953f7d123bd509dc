//! The ropes of many traces.

use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use glam::DVec2;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use tautline::engine::{Engine, EngineKind, Precision, Reference};
use tautline::homotopy::Classes;
use tautline::output::{
    Extras, ResultWriter, StepWriter, class_batches, class_change_batches, event_batches, result_batches, step_batches,
    write_events, write_results,
};
use tautline::picture::{Drawing, Theme};
use tautline::rope::{Friction, TraceRecord, replay};
use tautline::scene::{Centre, Model};
use tautline::study::Study;
use tautline::trace::{SettledTrace, Trace, settle_owned};
use tautline::words::plainly;

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::scene::{Scene, settle_all};
use crate::steps::StepStream;
use crate::stored::{Pickled, Stored};
use crate::table::{Table, pairs};

/// The most points that are evaluated at once.
const POINTS: usize = 1 << 25;

/// The ropes of many traces.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Ropes {
    of: Arc<Kept>,
    results: OnceLock<Table>,
    steps: OnceLock<Table>,
}

/// What is kept of an evaluation.
pub(crate) struct Kept {
    pub(crate) model: Arc<Model>,
    /// What evaluated them.
    engine: String,
    pub(crate) records: Vec<TraceRecord>,
    /// Where the free ends came to rest.
    ends: Vec<DVec2>,
    /// The traces, unless only results are kept; then records have no events.
    settled: Option<Vec<SettledTrace>>,
    /// About what turns are counted, step by step; all obstacles with a label unless they were named.
    centres: Option<Vec<Centre>>,
    /// With which friction the rope's strain is told then, if it is.
    friction: Option<Friction>,
}

/// What is asked of an evaluation.
pub(crate) struct Asked {
    /// Whether traces that break the rules are marked, where otherwise the first ends it.
    pub(crate) flag: bool,
    /// Whether what happens step by step is kept.
    pub(crate) keep: bool,
    /// Whether the rope after every step is wanted.
    pub(crate) steps: bool,
    /// About what turns are counted then, if obstacles are named.
    pub(crate) centres: Option<Vec<Centre>>,
    /// And with which friction the rope's strain is told.
    pub(crate) friction: Option<Friction>,
}

impl Kept {
    /// The traces, if what happened step by step is kept.
    pub(crate) fn settled(&self) -> Result<&[SettledTrace], Fault> {
        let lost = || Fault::input("what happened step by step was not kept; evaluate with events=True");
        self.settled.as_deref().ok_or_else(lost)
    }

    fn steps(&self) -> Result<Table, Fault> {
        Ok(Table::of(step_batches(&self.model, self.settled()?, &self.records, &self.extras())))
    }

    /// What tells the classes of the ropes.
    fn classes(&self) -> Result<Classes, Fault> {
        let name = self.engine.split(' ').next().unwrap_or_default();
        if EngineKind::named(name).is_some_and(EngineKind::counts_events) {
            return Ok(Classes::new(&self.model));
        }
        let what = "takes no note of wall ends that a rope passes straight, so its ropes have no classes";
        Err(Fault::input(format!("the engine {name} {what}; evaluate with engine=\"cpu\"")))
    }

    /// What is told of steps beside the ropes.
    fn extras(&self) -> Extras {
        let centres = self.centres.clone().unwrap_or_else(|| self.model.scene().labelled());
        Extras { centres, friction: self.friction }
    }
}

/// A coefficient of friction, if there is one.
pub(crate) fn friction_of(coefficient: Option<f64>) -> Result<Option<Friction>, Fault> {
    let friction = |coefficient| Friction::new(coefficient).map_err(|fault| Fault::input(format!("friction: {fault}")));
    coefficient.map(friction).transpose()
}

/// The obstacles with these names.
pub(crate) fn called(model: &Model, names: &[String]) -> Result<Vec<Centre>, Fault> {
    model.scene().called(names).map_err(|error| Fault::input(format!("about: {error}")))
}

impl Ropes {
    fn new(of: Kept) -> Self {
        Ropes { of: Arc::new(of), results: OnceLock::new(), steps: OnceLock::new() }
    }

    /// Settles and evaluates.
    pub(crate) fn evaluated(
        model: &Arc<Model>,
        engine: &mut Box<dyn Engine>,
        on: String,
        traces: Vec<Trace>,
        asked: Asked,
        work: &Work,
    ) -> Result<Self, Fault> {
        let settled = settle_all(model, traces, work)?;
        if let (false, Some(first)) = (asked.flag, settled.iter().find_map(|trace| trace.violation())) {
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
        let (settled, centres, friction) = (Some(settled), asked.centres, asked.friction);
        let mut kept = Kept { model: model.clone(), engine: on, records, ends, settled, centres, friction };
        let steps = asked.steps.then(|| kept.steps()).transpose()?;
        let mut results = OnceLock::new();
        if !asked.keep {
            results = OnceLock::from(Table::of(result_batches(model.scene(), &kept.records)));
            kept.records.iter_mut().for_each(|record| record.events = Vec::new());
            kept.settled = None;
        }
        let steps = steps.map_or_else(OnceLock::new, OnceLock::from);
        Ok(Ropes { of: Arc::new(kept), results, steps })
    }

    /// The rope of a trace of a study, drawn again.
    pub(crate) fn again(study: &Study, trace: u64, work: &Work) -> Result<Self, Fault> {
        if study.plan().run.precision == Precision::Fast {
            let what = "the study's ropes were decided in f32; draw them again with `tautline study replay`";
            return Err(Fault::new("StudyError", what));
        }
        let (settled, model) = (study.trace(trace)?, study.model(trace));
        let mut engine = Reference::new(model.clone());
        let records = engine.evaluate(std::slice::from_ref(&settled), &work.job)?;
        let ends = vec![settled.points().last().copied().unwrap_or(model.anchor())];
        let (engine, settled) = ("reference (f64) on 1 thread".to_owned(), Some(vec![settled]));
        Ok(Ropes::new(Kept { model: model.clone(), engine, records, ends, settled, centres: None, friction: None }))
    }

    fn settled(&self) -> Result<&[SettledTrace], Fault> {
        self.of.settled()
    }
}

#[pymethods]
impl Ropes {
    #[getter]
    fn engine(&self) -> &str {
        &self.of.engine
    }

    fn __len__(&self) -> usize {
        self.of.records.len()
    }

    /// One row a trace.
    fn results(&self, py: Python<'_>) -> PyResult<Table> {
        if let Some(table) = self.results.get() {
            return Ok(table.clone());
        }
        let table = py.detach(|| Table::of(result_batches(self.of.model.scene(), &self.of.records)));
        Ok(self.results.get_or_init(|| table).clone())
    }

    /// One row an event.
    fn events(&self, py: Python<'_>) -> PyResult<Table> {
        self.settled()?;
        Ok(py.detach(|| Table::of(event_batches(self.of.model.scene(), &self.of.records))))
    }

    /// The class of each rope, one row a trace.
    fn classes(&self, py: Python<'_>) -> PyResult<Table> {
        let settled = self.settled()?;
        let classes = |_: &Work| Ok(Table::of(class_batches(&self.of.classes()?, settled, &self.of.records)));
        compute::run(py, classes, |_, _| Ok(()))
    }

    /// One row for each change of a rope's class.
    fn class_changes(&self, py: Python<'_>) -> PyResult<Table> {
        let settled = self.settled()?;
        let changes = |_: &Work| Ok(Table::of(class_change_batches(&self.of.classes()?, settled, &self.of.records)));
        compute::run(py, changes, |_, _| Ok(()))
    }

    /// One row for the rope after every step.
    fn steps(&self, py: Python<'_>) -> PyResult<Table> {
        if let Some(table) = self.steps.get() {
            return Ok(table.clone());
        }
        let table = compute::run(py, |_| self.of.steps(), |_, _| Ok(()))?;
        Ok(self.steps.get_or_init(|| table).clone())
    }

    /// The same, made as it is read; turns are counted about other obstacles if they are named, and friction may be
    /// another.
    #[pyo3(signature = (about=None, friction=None))]
    fn stream_steps(&self, about: Option<Vec<String>>, friction: Option<f64>) -> PyResult<StepStream> {
        self.settled()?;
        let mut extras = self.of.extras();
        if let Some(names) = about {
            extras.centres = called(&self.of.model, &names)?;
        }
        extras.friction = friction_of(friction)?.or(extras.friction);
        Ok(StepStream { of: self.of.clone(), extras })
    }

    /// The rope's length after each step: offsets, and all lengths.
    #[allow(clippy::type_complexity)]
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>)> {
        let settled = self.settled()?;
        let of = |(trace, record): (&SettledTrace, &TraceRecord)| {
            let ends = trace.ends();
            let mut lengths = Vec::with_capacity(ends.len());
            replay(self.of.model.anchor(), self.of.model.vertices(), ends.len(), &record.events, |step, rope| {
                lengths.push(rope.length(ends[step]));
            });
            lengths
        };
        let work = |_: &Work| Ok(settled.par_iter().zip(&self.of.records).map(of).collect::<Vec<Vec<f64>>>());
        let lengths = compute::run(py, work, |_, _| Ok(()))?;
        let offsets = offsets(lengths.iter().map(Vec::len));
        Ok((PyArray1::from_vec(py, offsets), PyArray1::from_vec(py, lengths.concat())))
    }

    /// The taut ropes at the end: offsets, and the points of all, each from the anchor to the free end.
    fn lines<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyAny>)> {
        let counts = self.of.records.iter().map(|record| record.wraps.len() + 2);
        let offsets = offsets(counts);
        let line = |(record, end): (&TraceRecord, &DVec2)| {
            let turns = record.wraps.iter().map(|(at, _)| *at);
            [self.of.model.anchor()].into_iter().chain(turns).chain([*end]).collect::<Vec<_>>()
        };
        let all = self.of.records.iter().zip(&self.of.ends).flat_map(line);
        Ok((PyArray1::from_vec(py, offsets), pairs(py, all.flat_map(|p| p.to_array()).collect::<Vec<f64>>())?))
    }

    /// The taut rope of one trace after a step, by their places.
    fn rope_at<'py>(&self, py: Python<'py>, place: usize, step: usize) -> PyResult<Bound<'py, PyAny>> {
        let settled = self.settled()?;
        let ends = settled.get(place).map_or(Cow::Borrowed(&[] as &[DVec2]), |trace| trace.ends());
        if step >= ends.len() {
            return Err(Fault::input(format!(
                "there is no step {step}; the trace has {}",
                plainly(ends.len() as u64, "point", "points")
            ))
            .into());
        }
        let mut points = vec![self.of.model.anchor()];
        let (vertices, events) = (self.of.model.vertices(), &self.of.records[place].events);
        replay(self.of.model.anchor(), vertices, step + 1, events, |k, rope| {
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

    /// Writes results, with classes if they are asked for, and events as the program does.
    fn write(
        &self,
        py: Python<'_>,
        results: Option<PathBuf>,
        events: Option<PathBuf>,
        steps: Option<PathBuf>,
        classes: bool,
    ) -> PyResult<()> {
        let settled = self.settled()?;
        let scene = self.of.model.scene();
        let write = |_: &Work| {
            results.iter().try_for_each(|path| {
                if !classes {
                    return Ok::<_, Fault>(write_results(path, scene, &self.of.records)?);
                }
                let classes = self.of.classes()?;
                let mut file = ResultWriter::create_with_classes(path, scene)?;
                file.write_classes(&classes, settled, &self.of.records)?;
                Ok(file.finish()?)
            })?;
            events.iter().try_for_each(|path| write_events(path, scene, &self.of.records))?;
            steps.iter().try_for_each(|path| {
                let mut file = StepWriter::create(path, &self.of.model, &self.of.extras())?;
                file.write_all(settled, &self.of.records)?;
                Ok(file.finish()?)
            })
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
        let mut drawing = Drawing::new(&self.of.model).theme(theme);
        for place in places {
            let record = self.of.records.get(place).ok_or_else(|| Fault::input(format!("there is no rope {place}")))?;
            drawing = drawing.with(&settled[place], record);
        }
        let drawing = step.into_iter().fold(drawing, Drawing::at_step);
        Ok(drawing.svg().map_err(Fault::from)?)
    }

    /// All of it but the scene as bytes.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let points = |t: &SettledTrace| (t.id(), t.ends().iter().flat_map(|p| p.to_array()).collect());
        let pickled = Pickled {
            engine: self.of.engine.clone(),
            traces: self.of.settled.as_ref().map(|settled| settled.iter().map(points).collect()),
            ends: self.of.ends.iter().map(|end| end.to_array()).collect(),
            records: self.of.records.iter().map(Stored::from).collect(),
            results: match &self.of.settled {
                Some(_) => None,
                None => self.results.get().map(Table::ipc).transpose()?,
            },
            centres: self.of.centres.as_ref().map(|all| all.iter().map(|c| (c.name.clone(), c.vertex)).collect()),
            friction: self.of.friction.map(Friction::coefficient),
            steps: match &self.of.settled {
                Some(_) => None,
                None => self.steps.get().map(Table::ipc).transpose()?,
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
        let table = |bytes: &Option<Vec<u8>>| {
            let table = bytes.as_deref().map(Table::from_ipc).transpose()?;
            Ok::<_, Fault>(table.map_or_else(OnceLock::new, OnceLock::from))
        };
        let (results, steps) = (table(&pickled.results)?, table(&pickled.steps)?);
        let kept = Kept {
            friction: friction_of(pickled.friction)?,
            engine: pickled.engine,
            records: pickled.records.iter().map(Stored::record).collect(),
            ends: pickled.ends.iter().map(|&end| end.into()).collect(),
            settled,
            centres: pickled.centres.map(|all| all.into_iter().map(|(name, vertex)| Centre { name, vertex }).collect()),
            model,
        };
        Ok(Ropes { of: Arc::new(kept), results, steps })
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
