//! Sweeps: studies that differ in the values of some keys, run in the folder of all.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::prelude::*;
use tautline::output::folder_of;
use tautline::picture;
use tautline::session::{SessionError, SweepFolder, answered, status};
use tautline::study::{self, PlanError, Shard, Study, StudyFile};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::going::{self, Told, write_scene};
use crate::table::Table;

/// A sweep that can be run.
#[pyclass(module = "tautrope._tautrope", frozen)]
pub(crate) struct Sweep {
    sweep: study::Sweep,
    /// From where its files are named.
    base: PathBuf,
}

impl Sweep {
    /// The sweep of a file, once all its studies are known to be sound.
    fn checked(file: &StudyFile, base: &Path, work: &Work) -> Result<Self, Fault> {
        let Some(sweep) = file.sweep()? else {
            return Err(Fault::new("StudyError", "the plan has no section sweep; run it as a Study"));
        };
        for (number, point) in sweep.points().iter().enumerate() {
            if work.is_stopped() {
                return Err(Fault::new("StudyError", "stopped"));
            }
            let study = Study::open(point.plan.clone(), base).and_then(|study| study.check_moves());
            study.map_err(|error| sweep.located(error, number))?;
        }
        Ok(Sweep { sweep, base: base.to_owned() })
    }

    /// Its folder, begun or gone on with; and from where files are named there.
    fn folder(&self, out: &Path, scene: Option<&str>) -> Result<(SweepFolder, PathBuf), Fault> {
        let Some(text) = scene else {
            let folder = SweepFolder::begin(out, &self.sweep, &self.base, Shard::WHOLE, false)?;
            return Ok((folder, self.base.clone()));
        };
        let is_new = !out.exists();
        fs::create_dir_all(out).map_err(|error| Fault::new("WriteError", format!("{}: {error}", out.display())))?;
        let begun = SweepFolder::begin(out, &self.sweep, out, Shard::WHOLE, false);
        let begun = begun.inspect_err(|_| {
            if is_new {
                drop(fs::remove_dir(out))
            }
        })?;
        write_scene(out, text)?;
        Ok((begun, out.to_owned()))
    }
}

#[pymethods]
impl Sweep {
    /// The sweep in a file.
    #[staticmethod]
    fn of_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let open = |work: &Work| Sweep::checked(&StudyFile::read(&path, &[])?, folder_of(&path), work);
        compute::run(py, open, |_, _| Ok(()))
    }

    /// The sweep that a text in TOML describes, of which nobody has seen the lines.
    #[staticmethod]
    fn of_text(py: Python<'_>, text: &str, base: PathBuf) -> PyResult<Self> {
        let bare = |error: PlanError| PlanError { line: None, ..error };
        let open = |work: &Work| Sweep::checked(&StudyFile::parse(text, &[]).map_err(bare)?, &base, work);
        compute::run(py, open, |_, _| Ok(()))
    }

    /// The names of the keys.
    #[getter]
    fn keys(&self) -> Vec<String> {
        self.sweep.keys().map(str::to_owned).collect()
    }

    /// Of each point the values of the keys and the plan, as JSON.
    #[getter]
    fn points(&self) -> PyResult<Vec<(String, String)>> {
        let of = |point: &study::SweepPoint| {
            Ok((serde_json::to_string(&point.values)?, serde_json::to_string(&point.plan)?))
        };
        let points = self.sweep.points().iter().map(of).collect::<Result<_, serde_json::Error>>();
        Ok(points.map_err(|error| Fault::new("StudyError", error))?)
    }

    /// Runs all its studies in a folder, or goes on with what is there; as `Study.run` does.
    fn run(
        &self,
        py: Python<'_>,
        out: PathBuf,
        engine: Option<&str>,
        progress: Option<Py<PyAny>>,
        scene: Option<&str>,
    ) -> PyResult<Vec<String>> {
        let (folder, base) = compute::run(py, |_| self.folder(&out, scene), |_, _| Ok(()))?;
        all(py, &folder, &base, engine, &progress)
    }

    /// Has a folder remember the sweep; the folders of its points, from where files are named.
    fn begin(&self, out: PathBuf, scene: Option<&str>) -> PyResult<(Vec<PathBuf>, PathBuf)> {
        let (folder, base) = self.folder(&out, scene)?;
        Ok((folder.points().map(|(path, _)| path).collect(), base))
    }
}

/// Does all studies of a sweep, one after the other, and has their answers written side by side. Those that are done
/// are left as they are.
fn all(
    py: Python<'_>,
    sweep: &SweepFolder,
    base: &Path,
    engine: Option<&str>,
    progress: &Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    let steps = |plan: &study::Plan| plan.run.count() * u64::from(plan.walk.steps().unwrap_or(0));
    let of: u64 = sweep.points().map(|(_, point)| steps(&point.study)).sum();
    let (mut before, mut notes) = (0, Vec::new());
    for (out, point) in sweep.points() {
        let open = |_: &Work| {
            let study = Study::open(point.study.clone(), base);
            let began = Some(base.to_owned());
            let study = Arc::new(study.map_err(|error| SessionError::Plan { error, began })?);
            Ok(answered(&out, &study, Shard::WHOLE)?.is_none().then_some(study))
        };
        if let Some(study) = compute::run(py, open, |_, _| Ok(()))? {
            let begin = |_: &Work| going::begin(&out, study, base);
            notes.extend(going::to_the_end(py, begin, engine, &Told::within(py, progress, before, of))?);
        }
        before += steps(&point.study);
    }
    compute::run(py, |_| Ok(sweep.conclude(Some(base)).map(drop)?), |_, _| Ok(()))?;
    Ok(notes)
}

/// Goes on with the sweep in a folder.
#[pyfunction]
pub(crate) fn resume_sweep(
    py: Python<'_>,
    folder: PathBuf,
    base: Option<PathBuf>,
    engine: Option<&str>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<String>> {
    let sweep = SweepFolder::open(&folder).map_err(Fault::from)?;
    let base = base.unwrap_or_else(|| sweep.record().base.clone());
    all(py, &sweep, &base, engine, &progress)
}

/// Has the answers of all points in a sweep's folder written side by side.
#[pyfunction]
pub(crate) fn conclude_sweep(py: Python<'_>, folder: PathBuf, base: Option<PathBuf>) -> PyResult<()> {
    let conclude = |_: &Work| Ok(SweepFolder::open(&folder)?.conclude(base.as_deref()).map(drop)?);
    compute::run(py, conclude, |_, _| Ok(()))
}

/// What the points in a sweep's folder say, side by side: as JSON, as a table, and as a picture once there is anything
/// to draw. They are compared with point `against`, or else with the one that the sweep names.
#[pyfunction]
pub(crate) fn look_at_sweep(
    py: Python<'_>,
    folder: PathBuf,
    base: Option<PathBuf>,
    against: Option<usize>,
) -> PyResult<(String, Table, Option<String>)> {
    let look = |_: &Work| {
        let sweep = SweepFolder::open(&folder)?;
        let against = against.unwrap_or(sweep.record().against);
        let count = sweep.record().points.len();
        if against >= count {
            return Err(Fault::input(format!("there is no point {against}; they are 0 to {}", count - 1)));
        }
        let answer = sweep.answer_against(against, base.as_deref())?;
        let text = serde_json::to_string(&answer).map_err(|error| Fault::new("StudyError", error))?;
        Ok((text, Table::of(answer.sheet().batches()), picture::sweep(&answer)))
    };
    compute::run(py, look, |_, _| Ok(()))
}

/// Whether a study's file describes a sweep, sound or not.
#[pyfunction]
pub(crate) fn has_sweep(path: PathBuf) -> bool {
    StudyFile::read(&path, &[]).is_ok_and(|file| !matches!(file.sweep(), Ok(None)))
}

/// How far the studies and sweeps in folders are, as JSON. Whoever writes there is not disturbed.
#[pyfunction]
pub(crate) fn status_of(py: Python<'_>, folders: Vec<PathBuf>) -> PyResult<String> {
    let status = py.detach(|| serde_json::to_string(&status(&folders)));
    Ok(status.map_err(|error| Fault::new("StudyError", error))?)
}
