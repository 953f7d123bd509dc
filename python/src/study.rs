//! Studies, run in their folders.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use tautline::output::folder_of;
use tautline::session::{Folder, Session, look};
use tautline::study::{self, EXAMPLE, Plan, Shard};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::going::{self, Told, write_scene};
use crate::ropes::Ropes;
use crate::scene::Scene;

/// A study that can be run.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Study {
    pub(crate) study: Arc<study::Study>,
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
                true => Plan::from_json(text)?,
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

    /// The study in a folder.
    #[staticmethod]
    fn of_folder(py: Python<'_>, folder: PathBuf, base: Option<PathBuf>) -> PyResult<Self> {
        let open = |_: &Work| {
            let (study, _) = look(&folder, base.as_deref())?;
            Ok(Study { study: Arc::new(study), base: base.clone().unwrap_or_else(|| folder.clone()) })
        };
        compute::run(py, open, |_, _| Ok(()))
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
            let base = if scene.is_some() { &out } else { &self.base };
            let begun = going::begin(&out, self.study.clone(), base)?;
            if let Some(text) = scene {
                write_scene(&out, text)?;
            }
            Ok(begun)
        };
        going::to_the_end(py, begin, engine, &Told::all(progress))
    }

    /// How many blocks it has.
    #[getter]
    fn blocks(&self) -> u64 {
        self.study.plan().blocks()
    }

    /// Does the blocks from `first` up to `end` in a folder of their own, as a part that can be merged with others.
    #[pyo3(signature = (out, first, end, engine, progress))]
    fn run_part(
        &self,
        py: Python<'_>,
        out: PathBuf,
        first: u64,
        end: u64,
        engine: Option<&str>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<()> {
        let part = Shard::WHOLE.within(first..end).ok_or_else(|| Fault::input("a part has a block at least"))?;
        let begin = |_: &Work| {
            let folder = Arc::new(Folder::make(&out)?);
            // A study without files needs no folder of the machine on which it was made.
            let base = if self.base.is_dir() { &self.base } else { &out };
            Ok(Session::begin(folder, self.study.clone(), base, part)?)
        };
        going::through(py, begin, engine, &Told::all(progress), false).map(drop)
    }

    /// The rope of one of its traces, drawn again, and the scene in which it is.
    fn replay(&self, py: Python<'_>, trace: u64) -> PyResult<(Scene, Ropes)> {
        let plan = self.study.plan();
        if !plan.is_given() && trace >= plan.run.count() {
            let what = format!("there is no trace {trace}; the study's are 0 to {}", plan.run.count() - 1);
            return Err(Fault::input(what).number("trace", trace).into());
        }
        let ropes = compute::run(py, |work| Ropes::again(&self.study, trace, work), |_, _| Ok(()))?;
        Ok((Scene::of_model(self.study.model(trace).clone()), ropes))
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
    going::to_the_end(py, begin, engine, &Told::all(progress))
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

/// The study that is run when none is given, as TOML.
#[pyfunction]
pub(crate) fn example_study() -> &'static str {
    EXAMPLE
}
