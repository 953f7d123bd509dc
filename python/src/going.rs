//! Going on with studies in their folders, to their end.

use std::path::Path;
use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use pyo3::prelude::*;
use tautline::engine::Engine;
use tautline::output::write_whole;
use tautline::session::{Computed, Folder, Session};
use tautline::study::{Shard, Study};

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

/// Who is told how far a study is: how many steps are done, and of how many.
pub(crate) struct Told {
    who: Option<Py<PyAny>>,
    /// The steps of studies before this one, and those of all; without them this one is all.
    within: Option<(u64, u64)>,
}

impl Told {
    /// Of one study.
    pub(crate) fn all(who: Option<Py<PyAny>>) -> Self {
        Told { who, within: None }
    }

    /// Of the study that has `before` steps before it among `all`.
    pub(crate) fn within(py: Python<'_>, who: &Option<Py<PyAny>>, before: u64, all: u64) -> Self {
        Told { who: who.as_ref().map(|who| who.clone_ref(py)), within: Some((before, all)) }
    }

    fn tell(&self, py: Python<'_>, done: u64, of: u64) -> PyResult<()> {
        let Some(who) = &self.who else { return Ok(()) };
        let (done, of) = self.within.map_or((done, of), |(before, all)| (before + done, all));
        who.call1(py, (done, of)).map(drop)
    }
}

/// Runs a session to its end, has the answer written, and returns what is to be known of its folder.
pub(crate) fn to_the_end(
    py: Python<'_>,
    begin: impl FnOnce(&Work) -> Result<Session, Fault> + Send,
    engine: Option<&str>,
    told: &Told,
) -> PyResult<Vec<String>> {
    through(py, begin, engine, told, true)
}

/// The same, where a part of a study that is shared out needs no answer of its own.
pub(crate) fn through(
    py: Python<'_>,
    begin: impl FnOnce(&Work) -> Result<Session, Fault> + Send,
    engine: Option<&str>,
    told: &Told,
    has_answer: bool,
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
        if has_answer {
            session.conclude(&report)?;
        }
        Ok(())
    };
    let watch = |py: Python<'_>, work: &Work| told.tell(py, work.job.steps(), left.steps);
    compute::run(py, run, watch)?;
    Ok(session.folder().notes().iter().map(ToString::to_string).collect())
}

/// Begins a study in the folder `out`, or goes on with what is there of it; its files are named from `base`. What was
/// made for nothing is taken back.
pub(crate) fn begin(out: &Path, study: Arc<Study>, base: &Path) -> Result<Session, Fault> {
    let folder = Arc::new(Folder::make(out)?);
    let begun = Session::begin(folder.clone(), study, base, Shard::WHOLE);
    Ok(begun.inspect_err(|_| folder.take_back())?)
}

/// Writes a scene's text to a study's folder, whole or not at all.
pub(crate) fn write_scene(folder: &Path, text: &str) -> Result<(), Fault> {
    Ok(write_whole(&folder.join(SCENE), text.as_bytes())?)
}
