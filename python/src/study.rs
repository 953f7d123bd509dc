//! Studies, run in their folders.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use pyo3::prelude::*;
use tautline::engine::Engine;
use tautline::output::{WholeFile, folder_of};
use tautline::session::{Computed, Folder, Session, look};
use tautline::study::{self, EXAMPLE, Plan, Shard};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::scene::open;

/// What a scene is called that the package writes to a study's folder.
const SCENE: &str = "scene.geojson";

/// The process that ran a study first; 0 before that.
static RAN: AtomicU32 = AtomicU32::new(0);

/// Drawing has a thread of its own, which uses threads that a forked process has lost.
fn refuse_forked() -> Result<(), Fault> {
    let own = process::id();
    match RAN.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst) {
        Err(other) if other != own => Err(Fault::new(
            "EngineError",
            "this process was forked from one that had run a study; start it by spawn: \
             multiprocessing.get_context(\"spawn\")",
        )),
        _ => Ok(()),
    }
}

/// A study that can be run.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Study {
    study: Arc<study::Study>,
    /// From where its files are named.
    base: PathBuf,
}

#[pymethods]
impl Study {
    /// The study in a file.
    #[staticmethod]
    fn of_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let base = folder_of(&path).to_owned();
        let open = |_: &Work| {
            let study = study::Study::open(Plan::read(&path)?, &base).map_err(|error| error.in_file(&path))?;
            study.check_moves().map_err(|error| error.in_file(&path))?;
            Ok(Study { study: Arc::new(study), base: base.clone() })
        };
        compute::run(py, open, |_, _| Ok(()))
    }

    /// The study that a text describes: TOML, or JSON.
    #[staticmethod]
    fn of_text(py: Python<'_>, text: &str, is_json: bool, base: PathBuf) -> PyResult<Self> {
        let open = |_: &Work| {
            let plan = match is_json {
                true => serde_json::from_str::<Plan>(text).map_err(|error| Fault::new("StudyError", plain(&error)))?,
                false => Plan::parse(text)?,
            };
            let study = study::Study::open(plan, &base)?;
            study.check_moves()?;
            Ok(Study { study: Arc::new(study), base: base.clone() })
        };
        compute::run(py, open, |_, _| Ok(()))
    }

    /// The plan with everything that was left out, as JSON.
    #[getter]
    fn plan(&self) -> PyResult<String> {
        Ok(serde_json::to_string(self.study.plan()).map_err(|error| Fault::new("StudyError", error))?)
    }

    #[getter]
    fn identity(&self) -> &str {
        self.study.identity()
    }

    /// Runs it in a folder, or goes on with what is there. `progress` is told how many steps are done, and of how many.
    /// A scene that is no file of the user's is written to the folder, from where it is read when the study goes on.
    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        engine: Option<&str>,
        progress: Option<Py<PyAny>>,
        scene: Option<&str>,
    ) -> PyResult<Vec<String>> {
        let begin = |_: &Work| {
            let folder = Arc::new(Folder::make(&out)?);
            let base = if scene.is_some() { &out } else { &self.base };
            let begun = Session::begin(folder.clone(), self.study.clone(), base, Shard::WHOLE);
            let begun = begun.inspect_err(|_| folder.take_back())?;
            if let Some(text) = scene {
                write_scene(&out.join(SCENE), text)?;
            }
            Ok(begun)
        };
        go_on(py, begin, engine, progress)
    }
}

/// Goes on with the study in a folder.
#[pyfunction]
pub(crate) fn resume_study(
    py: Python<'_>,
    folder: PathBuf,
    base: Option<PathBuf>,
    engine: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    let begin = |_: &Work| Ok(Session::resume(Arc::new(Folder::open(&folder)?), base.as_deref())?);
    go_on(py, begin, engine, progress)
}

/// The summary of what is done of the study in a folder, as JSON. Whoever writes there is not disturbed.
#[pyfunction]
pub(crate) fn look_at_study(py: Python<'_>, folder: PathBuf, base: Option<PathBuf>) -> PyResult<String> {
    let look = |_: &Work| {
        let (study, state) = look(&folder, base.as_deref())?;
        serde_json::to_string(&state.summary(&study)).map_err(|error| Fault::new("StudyError", error))
    };
    compute::run(py, look, |_, _| Ok(()))
}

/// Writes a scene's text, whole or not at all.
fn write_scene(path: &Path, text: &str) -> Result<(), Fault> {
    let mut file = WholeFile::create(path)?;
    file.write_all(text.as_bytes()).map_err(|error| Fault::new("WriteError", error))?;
    Ok(file.finish()?)
}

/// Runs a session to its end, and returns what is to be known of its folder.
fn go_on(
    py: Python<'_>,
    begin: impl FnOnce(&Work) -> Result<Session, Fault> + Send,
    engine: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    refuse_forked()?;
    let session = compute::run(py, begin, |_, _| Ok(()))?;
    let study = session.study().clone();
    let prepare = |_: &Work| {
        let mut engines: Vec<Box<dyn Engine>> = Vec::new();
        let mut on = String::new();
        for model in study.models() {
            let opened = open(model, engine, study.plan().run.precision)?;
            if !opened.kind.counts_events() {
                let what = "does not count the same events as the other engines; give one of those for a study";
                return Err(Fault::input(format!("engine: {} {what}", opened.kind.name)));
            }
            on = opened.on.to_string();
            engines.push(opened.engine);
        }
        let left = session.prepare(Computed::by(&*engines[0], &on))?;
        Ok((engines, left))
    };
    let prepared = compute::run(py, prepare, |_, _| Ok(()));
    let (mut engines, left) = prepared.inspect_err(|_| session.folder().take_back())?;
    let run = |work: &Work| {
        let report = session.run(&mut engines, &work.job)?;
        session.conclude(&report)?;
        Ok(())
    };
    let watch = |py: Python<'_>, work: &Work| match &progress {
        Some(progress) => progress.call1(py, (work.job.steps(), left.steps)).map(drop),
        None => Ok(()),
    };
    compute::run(py, run, watch)?;
    Ok(session.folder().notes().iter().map(ToString::to_string).collect())
}

/// What is wrong with a study that is no file: without the line and column of a text that nobody has seen.
fn plain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    format!("the plan: {}", text.split(" at line ").next().unwrap_or(&text))
}

/// The study that is run when none is given, as TOML.
#[pyfunction]
pub(crate) fn example_study() -> &'static str {
    EXAMPLE
}
