//! Scenes, and the engines that belong to them.

use std::collections::HashMap;
use std::path::PathBuf;
use std::process;
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec2;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use rayon::prelude::*;
use tautline::engine::{ENGINES, Engine, EngineError, EngineKind, Opened, Options, Precision, open_best};
use tautline::example::{BuiltIn, Walker, walks};
use tautline::gpu::{AdapterChoice, Device};
use tautline::output::write_scene;
use tautline::picture::Drawing;
use tautline::scene::{self, Model, Ros, SceneOptions, Unknown, read_scene_with};
use tautline::study::anchor_warnings;
use tautline::trace::{SettledTrace, Trace, ViolationKind, settle_owned};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::ropes::{Asked, Ropes, called, friction_of};
use crate::table::pairs;
use crate::traces::Traces;

/// An engine that is kept, and what it runs on.
pub(crate) struct Kept {
    pub(crate) engine: Box<dyn Engine>,
    pub(crate) on: String,
}

/// The engines of a process, by name and precision. A lock of its own keeps each to one evaluation at a time.
type Engines = HashMap<(Option<String>, &'static str), Arc<Mutex<Kept>>>;

/// A scene, with its anchor or without.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Scene {
    tied: Tied,
    engines: Mutex<(u32, Engines)>,
}

enum Tied {
    Model(Arc<Model>),
    Loose(scene::Scene),
}

/// A violation: trace, step, wall, what the step does, from where, to where.
type Found = (u64, usize, usize, &'static str, (f64, f64), (f64, f64));

impl Scene {
    fn new(scene: scene::Scene, anchor: Option<(f64, f64)>) -> Result<Self, Fault> {
        let anchor = anchor.map(DVec2::from);
        let tied = match anchor.or(scene.anchor()) {
            Some(_) => Tied::Model(Arc::new(Model::new(scene, anchor)?)),
            None => Tied::Loose(scene),
        };
        Ok(Scene::of(tied))
    }

    /// The scene of a model.
    pub(crate) fn of_model(model: Arc<Model>) -> Self {
        Scene::of(Tied::Model(model))
    }

    fn of(tied: Tied) -> Self {
        Scene { tied, engines: Mutex::new((process::id(), Engines::new())) }
    }

    fn scene(&self) -> &scene::Scene {
        match &self.tied {
            Tied::Model(model) => model.scene(),
            Tied::Loose(scene) => scene,
        }
    }

    pub(crate) fn model(&self) -> Result<&Arc<Model>, Fault> {
        match &self.tied {
            Tied::Model(model) => Ok(model),
            Tied::Loose(_) => Err(scene::AnchorError::Missing.into()),
        }
    }

    /// The engine of that name, opened for the scene when it is asked for first.
    fn engine(&self, py: Python<'_>, name: Option<String>, precision: Precision) -> PyResult<Arc<Mutex<Kept>>> {
        let key = (name, precision.name());
        if let Some(kept) = self.engines(py).1.get(&key) {
            return Ok(kept.clone());
        }
        let model = self.model()?;
        let opened = py.detach(|| open(model, key.0.as_deref(), precision))?;
        let kept = Arc::new(Mutex::new(Kept { on: words(&opened), engine: opened.engine }));
        Ok(self.engines(py).1.entry(key).or_insert(kept).clone())
    }

    /// Taken only by who holds the interpreter's lock, as does who forks: so nobody holds this one then.
    fn engines(&self, _: Python<'_>) -> std::sync::MutexGuard<'_, (u32, Engines)> {
        let mut engines = self.engines.lock().unwrap_or_else(PoisonError::into_inner);
        if engines.0 != process::id() {
            // Those of the process that was forked: locks in them may be held, and devices are not here.
            std::mem::forget(std::mem::replace(&mut *engines, (process::id(), Engines::new())));
        }
        engines
    }
}

/// Opens an engine by its name; the one that suits the machine without one.
pub(crate) fn open(model: &Arc<Model>, name: Option<&str>, precision: Precision) -> Result<Opened, Fault> {
    let options = Options { precision, ..Options::default() };
    let Some(name) = name else { return Ok(open_best(model.clone(), &options)?) };
    let kind = EngineKind::named(name).ok_or_else(|| {
        let all: Vec<&str> = ENGINES.iter().map(|kind| kind.name).collect();
        Fault::input(format!("engine: there is no {name}; give one of {}", all.join(", ")))
    })?;
    let device = kind.needs_gpu().then(|| Device::open(&AdapterChoice::Best)).transpose().map_err(EngineError::from)?;
    Ok(kind.open(model.clone(), device, &options)?)
}

/// `cpu (certified) on 2 threads`.
pub(crate) fn words(opened: &Opened) -> String {
    let precision = opened.engine.precision().map_or("f64", Precision::name);
    format!("{} ({precision}) on {}", opened.engine.name(), opened.on)
}

/// What the package calls a precision.
pub(crate) fn precision(name: &str) -> Result<Precision, Fault> {
    [Precision::Certified, Precision::Fast]
        .into_iter()
        .find(|precision| precision.name() == name)
        .ok_or_else(|| Fault::input(format!("precision: {name} is none; give certified or fast")))
}

/// Settles all traces, until the work is stopped.
pub(crate) fn settle_all(model: &Model, traces: Vec<Trace>, work: &Work) -> Result<Vec<SettledTrace>, Fault> {
    let settle =
        |trace| if work.is_stopped() { Err(EngineError::Stopped.into()) } else { Ok(settle_owned(model, trace)) };
    traces.into_par_iter().map(settle).collect()
}

#[pymethods]
impl Scene {
    /// The scene in a file.
    #[staticmethod]
    #[allow(clippy::too_many_arguments)] // what the package takes by their names
    fn read(
        py: Python<'_>,
        path: PathBuf,
        layers: Vec<String>,
        without_layers: Vec<String>,
        flatten: Option<f64>,
        unknown_blocked: bool,
        ros: u8,
        anchor: Option<(f64, f64)>,
    ) -> PyResult<Self> {
        if flatten.is_some_and(|flatten| !(flatten.is_finite() && flatten > 0.0)) {
            return Err(Fault::input("flatten: give a length above 0, or None").into());
        }
        let options = SceneOptions {
            flatten,
            unknown: if unknown_blocked { Unknown::Blocked } else { Unknown::Free },
            ros: if ros == 1 { Ros::One } else { Ros::Two },
            layers,
            without_layers,
        };
        Ok(py.detach(|| Scene::new(read_scene_with(&path, &options)?, anchor))?)
    }

    /// A scene that the program brings.
    #[staticmethod]
    fn built_in(name: &str, anchor: Option<(f64, f64)>) -> PyResult<Self> {
        let built_in: BuiltIn = name.parse().map_err(Fault::input)?;
        Ok(Scene::new(built_in.scene(1), anchor)?)
    }

    /// Thin walls, four numbers each, in one flat array.
    #[staticmethod]
    fn of_walls(walls: PyReadonlyArray1<'_, f64>, anchor: Option<(f64, f64)>) -> PyResult<Self> {
        let flat = walls.as_slice()?;
        let walls = flat.chunks_exact(4).map(|w| [DVec2::new(w[0], w[1]), DVec2::new(w[2], w[3])]);
        let scene = scene::Scene::new(walls).map_err(|fault| {
            let sound =
                |w: &[f64]| tautline::geometry::check_points(&[[w[0], w[1]].into(), [w[2], w[3]].into()]).is_ok();
            let wall = flat.chunks_exact(4).position(|w| !sound(w)).unwrap_or_default();
            Fault::input(format!("wall {wall}: {fault}")).number("wall", wall as u64)
        })?;
        Ok(Scene::new(scene, anchor)?)
    }

    /// The same scene with the rope tied elsewhere; walls and their index are shared.
    fn tied(&self, py: Python<'_>, anchor: (f64, f64)) -> PyResult<Self> {
        Ok(match &self.tied {
            Tied::Model(model) => {
                let tied = py.detach(|| model.tied(anchor.into())).map_err(Fault::from)?;
                Scene::of(Tied::Model(Arc::new(tied)))
            }
            Tied::Loose(scene) => Scene::new(scene.clone(), Some(anchor))?,
        })
    }

    #[getter]
    fn anchor(&self) -> Option<(f64, f64)> {
        self.model().ok().map(|model| model.anchor().into())
    }

    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pairs(py, self.scene().vertices().iter().flat_map(|p| p.to_array()).collect::<Vec<f64>>())
    }

    #[getter]
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pairs(py, self.scene().walls().iter().flatten().map(|&end| i64::from(end)).collect::<Vec<i64>>())
    }

    #[getter]
    fn labels(&self) -> Vec<Option<String>> {
        self.scene().labels().into_iter().map(|label| label.map(str::to_owned)).collect()
    }

    #[getter]
    fn layers(&self) -> HashMap<String, usize> {
        self.scene().layers().into_iter().map(|(name, walls)| (name.to_owned(), walls)).collect()
    }

    #[getter]
    fn y_down(&self) -> bool {
        self.scene().y_down()
    }

    /// What is to be known of the scene, and of where its anchor stands.
    #[getter]
    fn notes(&self) -> Vec<String> {
        let warnings = self.model().map_or(Vec::new(), |model| anchor_warnings(model));
        self.scene().notes().iter().cloned().chain(warnings).collect()
    }

    /// The picture of the scene and its anchor.
    fn svg(&self) -> PyResult<String> {
        let drawing = match &self.tied {
            Tied::Model(model) => Drawing::new(model).rays(0),
            Tied::Loose(scene) => Drawing::of_scene(scene),
        };
        Ok(drawing.svg().map_err(Fault::from)?)
    }

    /// Writes a file from which the same scene is read.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let anchor = self.model().ok().map(|model| model.anchor());
        let scene = anchor.iter().fold(self.scene().clone(), |scene, &anchor| scene.with_anchor(anchor));
        Ok(py.detach(|| write_scene(&path, &scene)).map_err(Fault::from)?)
    }

    /// Random walks from the anchor: count * (steps + 1) points, flat.
    fn walks<'py>(
        &self,
        py: Python<'py>,
        count: u64,
        steps: usize,
        step: f64,
        seed: u64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = self.model()?;
        if !(step.is_finite() && step > 0.0) {
            return Err(Fault::input("step: give a length above 0").into());
        }
        let walker = Walker { step, steps, seed };
        let traces = compute::run(py, |_| Ok(walks(model, walker, count)), |_, _| Ok(()))?;
        pairs(py, traces.iter().flat_map(|t| &t.points).flat_map(|p| p.to_array()).collect::<Vec<f64>>())
    }

    /// The first step of each trace that breaks the rules.
    fn check(&self, py: Python<'_>, traces: &Traces) -> PyResult<Vec<Found>> {
        let (model, traces) = (self.model()?, traces.take()?);
        let settled = compute::run(py, |work| settle_all(model, traces, work), |_, _| Ok(()))?;
        let kind = |kind| match kind {
            ViolationKind::Crosses => "crosses",
            ViolationKind::EntersSolid => "enters a solid",
            ViolationKind::SlipsThrough => "slips through",
        };
        let found = settled.iter().filter_map(|trace| trace.violation());
        Ok(found.map(|v| (v.trace, v.step, v.wall, kind(v.kind), v.from.into(), v.to.into())).collect())
    }

    /// The ropes of all traces. A trace that breaks the rules ends it, or is marked if `flag` says so. With `keep`,
    /// what happened step by step is kept; with `steps`, the rope after every step is told, and turns about obstacles;
    /// with `friction`, the strain of the rope too.
    #[allow(clippy::too_many_arguments)] // what the package takes by their names
    #[pyo3(signature = (traces, engine, precision, flag, keep, steps=false, about=None, friction=None))]
    fn evaluate(
        &self,
        py: Python<'_>,
        traces: &Traces,
        engine: Option<String>,
        precision: &str,
        flag: bool,
        keep: bool,
        steps: bool,
        about: Option<Vec<String>>,
        friction: Option<f64>,
    ) -> PyResult<Ropes> {
        let (model, precision) = (self.model()?, self::precision(precision)?);
        let centres = about.map(|names| called(model, &names)).transpose()?;
        let asked = Asked { flag, keep, steps, centres, friction: friction_of(friction)? };
        let kept = self.engine(py, engine, precision)?;
        let traces = traces.take()?;
        compute::locked(py, &kept, |py, kept| {
            let (engine, on) = (&mut kept.engine, kept.on.clone());
            compute::run(py, |work| Ropes::evaluated(model, engine, on, traces, asked, work), |_, _| Ok(()))
        })
    }
}

/// The names of all engines, with what each does.
#[pyfunction]
pub(crate) fn engines() -> Vec<(&'static str, &'static str)> {
    ENGINES.iter().map(|kind| (kind.name, kind.about)).collect()
}

/// The length of a step that suits a built-in scene.
#[pyfunction]
pub(crate) fn built_in_step(name: &str) -> PyResult<f64> {
    Ok(name.parse::<BuiltIn>().map_err(Fault::input)?.step())
}
