//! Results and events in a thread of their own, which writes them while the next batch is evaluated.

use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

use super::StreamError;
use crate::homotopy::Classes;
use crate::output::{EventWriter, Extras, ForceWriter, ResultWriter, StepWriter, WholeFile, WriteError, commit};
use crate::rope::{Friction, TraceRecord};
use crate::scene::Model;
use crate::trace::SettledTrace;

/// How many records are written at a time; their text is held in memory.
const RECORDS: usize = 1024;

/// The files of a run. They are begun with the first batch and appear under their names in [`finish`](Self::finish);
/// dropped before that, nothing is left of them.
pub struct Files {
    wanted: Wanted,
    running: Option<Running>,
}

/// What is to be written.
#[derive(Clone)]
struct Wanted {
    out: Option<PathBuf>,
    events: Option<PathBuf>,
    /// And what is told beside the ropes.
    steps: Option<(PathBuf, Extras)>,
    /// And with which friction.
    forces: Option<(PathBuf, Friction)>,
    /// What tells the classes of the results, if they have them.
    classes: Option<Arc<Classes>>,
    model: Arc<Model>,
    /// What is noted in Parquet files.
    notes: Vec<(&'static str, String)>,
}

/// Traces, where they are needed, and what became of them.
type Evaluated = (Vec<SettledTrace>, Vec<TraceRecord>);

struct Running {
    /// Taken when no more records come.
    sender: Option<SyncSender<Evaluated>>,
    thread: Option<JoinHandle<Result<Written, WriteError>>>,
}

/// Whole files that wait for their names, and how long writing them took.
type Written = (Vec<WholeFile>, Duration);

impl Files {
    /// Results go to `out`, events to `events`, where they are asked for, for ropes in `model`. The notes go into the
    /// metadata of Parquet files.
    pub fn new(
        out: Option<&Path>,
        events: Option<&Path>,
        model: &Arc<Model>,
        notes: Vec<(&'static str, String)>,
    ) -> Self {
        let [out, events] = [out, events].map(|path| path.map(Path::to_owned));
        let wanted = Wanted { out, events, steps: None, forces: None, classes: None, model: model.clone(), notes };
        Files { wanted, running: None }
    }

    /// The same with the rope after every step in the file at `steps`, and what `extras` asks for beside it: see
    /// [`StepWriter`].
    #[must_use]
    pub fn with_steps(mut self, steps: &Path, extras: Extras) -> Self {
        self.wanted.steps = Some((steps.to_owned(), extras));
        self
    }

    /// The same with the forces of the ropes at the end, with that friction, in the file at `forces`: see
    /// [`ForceWriter`].
    #[must_use]
    pub fn with_forces(mut self, forces: &Path, friction: Friction) -> Self {
        self.wanted.forces = Some((forces.to_owned(), friction));
        self
    }

    /// The same with the class of each rope in the results: see
    /// [`ResultWriter::create_with_classes`]. Records must be those of an engine that promises the events of the
    /// reference.
    #[must_use]
    pub fn with_classes(mut self, classes: Classes) -> Self {
        self.wanted.classes = Some(Arc::new(classes));
        self
    }

    /// Takes the next records, and waits while those before are being written. Their traces, in the same order, are
    /// needed where [every step](Self::with_steps), [forces](Self::with_forces) or [classes](Self::with_classes) are to
    /// be written, and may be left out elsewhere.
    ///
    /// # Errors
    ///
    /// What went wrong with these or with earlier records.
    pub fn write(&mut self, traces: Vec<SettledTrace>, records: Vec<TraceRecord>) -> Result<(), StreamError> {
        if !self.wanted.is_any() {
            return Ok(());
        }
        // Memory is for those who ask.
        let traces = if self.wanted.needs_traces() { traces } else { Vec::new() };
        let running = self.run();
        let sent = running.sender.as_ref().map(|sender| sender.send((traces, records)));
        // The thread ends early for a reason, which it tells.
        if let Some(Ok(())) = sent { Ok(()) } else { running.end().map(drop) }
    }

    /// Writes the rest and gives all files their names; returns how long writing took.
    ///
    /// # Errors
    ///
    /// What went wrong with any records. Then no file has its name.
    pub fn finish(mut self) -> Result<Duration, StreamError> {
        if !self.wanted.is_any() {
            return Ok(Duration::ZERO);
        }
        let (files, took) = self.run().end()?;
        let _together = commit();
        files.into_iter().try_for_each(WholeFile::finish)?;
        Ok(took)
    }

    fn run(&mut self) -> &mut Running {
        self.running.get_or_insert_with(|| {
            let (sender, records) = sync_channel(0);
            let wanted = self.wanted.clone();
            let thread = spawn(move || wanted.write(&records));
            Running { sender: Some(sender), thread: Some(thread) }
        })
    }
}

impl Running {
    /// Waits for the thread.
    fn end(&mut self) -> Result<Written, StreamError> {
        self.sender = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => Ok(result?),
            Some(Err(panic)) => resume_unwind(panic),
            None => Err(StreamError::Ended),
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.sender = None;
        // With the thread's result its files vanish.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Wanted {
    fn is_any(&self) -> bool {
        self.out.is_some() || self.events.is_some() || self.steps.is_some() || self.forces.is_some()
    }

    fn needs_traces(&self) -> bool {
        self.steps.is_some() || self.forces.is_some() || (self.classes.is_some() && self.out.is_some())
    }

    /// Writes all that comes.
    fn write(&self, evaluated: &Receiver<Evaluated>) -> Result<Written, WriteError> {
        let mut took = Duration::ZERO;
        let scene = self.model.scene();
        let classes = self.classes.as_deref();
        let create = if classes.is_some() { ResultWriter::create_with_classes } else { ResultWriter::create };
        let mut out = self.out.as_deref().map(|path| create(path, scene)).transpose()?;
        let mut events = self.events.as_deref().map(|path| EventWriter::create(path, scene)).transpose()?;
        let steps = self.steps.as_ref().map(|(path, extras)| StepWriter::create(path, &self.model, extras));
        let mut steps = steps.transpose()?;
        let forces = self.forces.as_ref().map(|(path, friction)| ForceWriter::create(path, &self.model, *friction));
        let mut forces = forces.transpose()?;
        for (key, value) in &self.notes {
            out.iter_mut().for_each(|out| out.note(key, value));
            events.iter_mut().for_each(|events| events.note(key, value));
            steps.iter_mut().for_each(|steps| steps.note(key, value));
            forces.iter_mut().for_each(|forces| forces.note(key, value));
        }
        for (traces, records) in evaluated {
            let start = Instant::now();
            let (rows, steps) = rayon::join(
                || {
                    records.chunks(RECORDS).enumerate().try_for_each(|(i, records)| {
                        let write = |w: &mut ResultWriter| match classes {
                            None => w.write_all(scene, records),
                            Some(classes) => w.write_classes(classes, &traces[i * RECORDS..][..records.len()], records),
                        };
                        let (results, events) = rayon::join(
                            || out.as_mut().map_or(Ok(()), write),
                            || events.as_mut().map_or(Ok(()), |w| w.write_all(scene, records)),
                        );
                        results.and(events)
                    })
                },
                || steps.as_mut().map_or(Ok(()), |w| w.write_all(&traces, &records)),
            );
            rows.and(steps)?;
            forces.as_mut().map_or(Ok(()), |w| w.write_all(&traces, &records))?;
            took += start.elapsed();
        }
        let start = Instant::now();
        // None appears before all are whole.
        let out = out.map(ResultWriter::complete).transpose()?;
        let events = events.map(EventWriter::complete).transpose()?;
        let steps = steps.map(StepWriter::complete).transpose()?;
        let forces = forces.map(ForceWriter::complete).transpose()?;
        Ok(([out, events, steps, forces].into_iter().flatten().collect(), took + start.elapsed()))
    }
}
