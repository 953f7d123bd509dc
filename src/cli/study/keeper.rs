//! A study under way, and how what is done of it is kept.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use anyhow::anyhow;
use tautline::rope::TraceRecord;
use tautline::study::{State, Stopped, Study};

use super::folder::Folder;
use super::parts::{self, Parts, TRACES};
use crate::cli::failure::Failure;

/// How often the state is saved.
const CHECKPOINT: Duration = Duration::from_secs(10);

/// A study under way. Its state is locked while traces and their rows are added, so that whoever else locks it finds both at
/// the same place, and may save them.
pub(super) struct Keeper {
    folder: Arc<Folder>,
    pub(super) state: Mutex<State>,
    /// Locked only by who holds the state.
    rows: Mutex<Rows>,
    /// How many traces there are to do, and how many of them are done.
    traces: u64,
    done: AtomicU64,
}

struct Rows {
    parts: Option<Parts>,
    saved: Instant,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Keeper {
    pub(super) fn new(folder: Arc<Folder>, study: &Study, state: State, parts: Option<Parts>) -> Self {
        let (traces, done) = (study.places(state.shard()), AtomicU64::new(state.place(study)));
        let rows = Rows { parts, saved: Instant::now() };
        Keeper { folder, state: Mutex::new(state), rows: Mutex::new(rows), traces, done }
    }

    /// The state as it is.
    pub(super) fn state(&self) -> State {
        locked(&self.state).clone()
    }

    /// Takes the rows of the traces from that at place `first` on, with which `state` is on hand. Saves it when it is time.
    pub(super) fn add(&self, state: &mut State, first: u64, records: &[TraceRecord]) -> Result<(), Failure> {
        self.folder.is_begun();
        self.done.fetch_max(first + records.len() as u64, Ordering::SeqCst);
        let mut rows = locked(&self.rows);
        rows.parts.as_mut().map_or(Ok(()), |parts| parts.write(first, records))?;
        if rows.saved.elapsed() >= CHECKPOINT { self.save(state, &mut rows) } else { Ok(()) }
    }

    /// The same of rows that are computed again.
    pub(super) fn add_again(&self, first: u64, records: &[TraceRecord]) -> Result<(), Failure> {
        self.add(&mut locked(&self.state), first, records)
    }

    /// Saves what is done.
    pub(super) fn keep(&self) -> Result<(), Failure> {
        self.save(&mut locked(&self.state), &mut locked(&self.rows))
    }

    fn save(&self, state: &mut State, rows: &mut Rows) -> Result<(), Failure> {
        self.folder.check_place()?;
        // First the rows: the state must not know of any that are not there.
        rows.parts.as_mut().map_or(Ok(()), |parts| parts.close(state))?;
        self.folder.save(state)?;
        rows.saved = Instant::now();
        Ok(())
    }

    /// Puts all rows into their file, once the study is done. All are saved.
    pub(super) fn finish_rows(&self) -> Result<(), Failure> {
        let (parts, state) = {
            let state = locked(&self.state);
            (locked(&self.rows).parts.take(), state.clone())
        };
        let Some(parts) = parts else { return Ok(()) };
        // The state is not locked meanwhile: this can take its time.
        let check = parts.finish(&self.folder, &state.kept.parts, state.traces())?;
        {
            let mut state = locked(&self.state);
            state.kept.parts.clear();
            state.kept.files.insert(TRACES.to_owned(), check);
            self.folder.save(&state)?;
        }
        parts::clear(&self.folder)
    }

    /// Saves what is done because the program is to end, and says how to go on.
    pub(super) fn stop(&self) -> Failure {
        let mut state = locked(&self.state);
        // Past its end there is nothing new, but that what there is to say may not be written yet.
        if let Err(failure) = self.save(&mut state, &mut locked(&self.rows)) {
            return failure;
        }
        let (done, all, shown) = (self.done.load(Ordering::SeqCst), self.traces, self.folder.path().display());
        let what = match state.stopped() {
            Stopped::Unfinished => format!("{done} of {all} traces are saved: go on"),
            _ => "all that was to be done is saved: have the answer written".to_owned(),
        };
        Failure::checkpoint(anyhow!("stopped; {what} with `tautline study resume {shown}`"))
    }
}
