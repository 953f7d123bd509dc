//! Results and events in a thread of their own, which writes them while the next batch is evaluated.

use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

use super::StreamError;
use crate::output::{EventWriter, ResultWriter, WholeFile, WriteError, commit};
use crate::rope::TraceRecord;
use crate::scene::Model;

/// How many records are written at a time; their text is held in memory.
const RECORDS: usize = 1024;

/// The files of a run. They are begun with the first batch and appear under their names in [`finish`](Self::finish);
/// dropped before that, nothing is left of them.
pub struct Files {
    out: Option<PathBuf>,
    events: Option<PathBuf>,
    model: Arc<Model>,
    /// What is noted in Parquet files.
    notes: Vec<(&'static str, String)>,
    running: Option<Running>,
}

struct Running {
    /// Taken when no more records come.
    sender: Option<SyncSender<Vec<TraceRecord>>>,
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
        Files { out, events, model: model.clone(), notes, running: None }
    }

    /// Takes the next records, and waits while those before are being written.
    ///
    /// # Errors
    ///
    /// What went wrong with these or with earlier records.
    pub fn write(&mut self, records: Vec<TraceRecord>) -> Result<(), StreamError> {
        if self.out.is_none() && self.events.is_none() {
            return Ok(());
        }
        let running = self.run()?;
        let sent = running.sender.as_ref().map(|sender| sender.send(records));
        // The thread ends early for a reason, which it tells.
        if let Some(Ok(())) = sent { Ok(()) } else { running.end().map(drop) }
    }

    /// Writes the rest and gives all files their names; returns how long writing took.
    ///
    /// # Errors
    ///
    /// What went wrong with any records. Then no file has its name.
    pub fn finish(mut self) -> Result<Duration, StreamError> {
        if self.out.is_none() && self.events.is_none() {
            return Ok(Duration::ZERO);
        }
        let (files, took) = self.run()?.end()?;
        let _together = commit();
        files.into_iter().try_for_each(WholeFile::finish)?;
        Ok(took)
    }

    fn run(&mut self) -> Result<&mut Running, StreamError> {
        if self.running.is_none() {
            let (sender, records) = sync_channel(0);
            let (out, events, model) = (self.out.clone(), self.events.clone(), self.model.clone());
            let notes = self.notes.clone();
            let thread = spawn(move || write_all(out.as_deref(), events.as_deref(), &model, &notes, &records));
            self.running = Some(Running { sender: Some(sender), thread: Some(thread) });
        }
        Ok(self.running.as_mut().expect("it has just begun"))
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

fn write_all(
    out: Option<&Path>,
    events: Option<&Path>,
    model: &Model,
    notes: &[(&str, String)],
    records: &Receiver<Vec<TraceRecord>>,
) -> Result<Written, WriteError> {
    let mut took = Duration::ZERO;
    let mut out = out.map(|path| ResultWriter::create(path, model.scene())).transpose()?;
    let mut events = events.map(|path| EventWriter::create(path, model.scene())).transpose()?;
    for (key, value) in notes {
        out.iter_mut().for_each(|out| out.note(key, value));
        events.iter_mut().for_each(|events| events.note(key, value));
    }
    for records in records {
        let start = Instant::now();
        for records in records.chunks(RECORDS) {
            let (results, events) = rayon::join(
                || out.as_mut().map_or(Ok(()), |w| w.write_all(model.scene(), records)),
                || events.as_mut().map_or(Ok(()), |w| w.write_all(model.scene(), records)),
            );
            results.and(events)?;
        }
        took += start.elapsed();
    }
    let start = Instant::now();
    // Neither appears before both are whole.
    let out = out.map(ResultWriter::complete).transpose()?;
    let events = events.map(EventWriter::complete).transpose()?;
    Ok(([out, events].into_iter().flatten().collect(), took + start.elapsed()))
}
