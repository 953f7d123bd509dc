//! A study that is being run in its folder.

use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::error::{Note, SessionError};
use super::folder::Folder;
use super::names::{RUN_REPORT, TRACES};
use super::report::{Computed, RunCost, RunReport, SpentSeconds, Tried, provenance};
use super::rows::{self, Rows};
use crate::engine::{Engine, Job};
use crate::environment::Environment;
use crate::rope::TraceRecord;
use crate::study::{Shard, Spent, State, Stopped, Study, run, run_again};

/// How often the state is saved.
const CHECKPOINT: Duration = Duration::from_secs(10);

/// A study under way in its folder. Its state is locked while traces and their rows are added, so that whoever else
/// locks it finds both at the same place, and may save them: another thread may [`save`](Self::save) at any time.
pub struct Session {
    pub(super) folder: Arc<Folder>,
    pub(super) study: Arc<Study>,
    pub(super) state: Mutex<State>,
    /// Locked only by who holds the state.
    under_way: Mutex<UnderWay>,
}

/// What belongs to a run and not to the study.
struct UnderWay {
    rows: Option<Rows>,
    /// Places of traces whose rows are to be computed again.
    gaps: Vec<Range<u64>>,
    computed: Option<Computed>,
    saved: Instant,
    /// How many of the part's traces are done, those of blocks that do not count yet included.
    done: u64,
}

/// What is left to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Left {
    /// How many traces, those whose rows are computed again included.
    pub traces: u64,
    /// How many steps they have together; 0 if nobody knows.
    pub steps: u64,
}

/// What is saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Saved {
    /// How many of the traces of this part are done.
    pub done: u64,
    /// Of how many.
    pub all: u64,
    /// Whether there is nothing left to do, and why.
    pub stopped: Stopped,
}

fn refuse_partial(folder: &Folder, state: &State) -> Result<(), SessionError> {
    if state.is_partial() { Err(SessionError::Partial { folder: folder.path().to_owned() }) } else { Ok(()) }
}

pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session {
    /// Begins part `shard` of a study in `folder`, or goes on with it if it is there. The study's files are named from
    /// `base`.
    ///
    /// Nothing is saved yet but what the study is: [`prepare`](Self::prepare) saves the first state.
    ///
    /// # Errors
    ///
    /// A folder that holds something else, and what the operating system says.
    pub fn begin(folder: Arc<Folder>, study: Arc<Study>, base: &Path, shard: Shard) -> Result<Self, SessionError> {
        Session::begin_with(folder, study, base, shard, false)
    }

    /// The same, where the folder may also hold the study with fewer traces: what is done of that stays done.
    ///
    /// # Errors
    ///
    /// As those of [`begin`](Self::begin).
    pub fn begin_or_raise(
        folder: Arc<Folder>,
        study: Arc<Study>,
        base: &Path,
        shard: Shard,
    ) -> Result<Self, SessionError> {
        Session::begin_with(folder, study, base, shard, true)
    }

    fn begin_with(
        folder: Arc<Folder>,
        study: Arc<Study>,
        base: &Path,
        shard: Shard,
        may_raise: bool,
    ) -> Result<Self, SessionError> {
        let mut held = folder.held(&study, shard, may_raise)?;
        if let Some(state) = &mut held {
            refuse_partial(&folder, state)?;
            let path = folder.path().to_owned();
            folder.note(match state.stopped() {
                Stopped::Unfinished => {
                    Note::Holds { folder: path, done: state.place(&study), all: study.places(shard) }
                }
                _ => Note::Answered { folder: path },
            });
            if may_raise {
                rows::reopen(&folder, &study, state)?;
                // Before the study is remembered: a state of one with fewer traces is told from others by that.
                folder.save(state)?;
            }
        }
        // What is written besides the answer may be asked for in another way than before.
        folder.remember(study.plan(), base, shard)?;
        let state = held.unwrap_or_else(|| State::new(&study, shard));
        Ok(Session::new(folder, study, state))
    }

    /// Goes on with the study in `folder`. Its files are named from `base`, or else from where they were as it began.
    ///
    /// # Errors
    ///
    /// A folder without a study or with a damaged one; a study whose files are not there any more.
    pub fn resume(folder: Arc<Folder>, base: Option<&Path>) -> Result<Self, SessionError> {
        let (study, _) = folder.study(base)?;
        let state = folder.state_or_new(&study)?;
        refuse_partial(&folder, &state)?;
        Ok(Session::new(folder, Arc::new(study), state))
    }

    pub(super) fn new(folder: Arc<Folder>, study: Arc<Study>, state: State) -> Self {
        let done = state.place(&study);
        let under_way = UnderWay { rows: None, gaps: Vec::new(), computed: None, saved: Instant::now(), done };
        Session { folder, study, state: Mutex::new(state), under_way: Mutex::new(under_way) }
    }

    /// The study.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Its folder.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// The state as it is.
    pub fn state(&self) -> State {
        locked(&self.state).clone()
    }

    /// Saves the state, looks through the rows that were kept, and tells what is left to do. What computes the ropes
    /// stands in the rows' metadata.
    ///
    /// # Errors
    ///
    /// What the operating system says.
    pub fn prepare(&self, computed: Computed) -> Result<Left, SessionError> {
        let mut state = locked(&self.state);
        self.folder.save(&state)?;
        let mut under_way = locked(&self.under_way);
        let study = &*self.study;
        if study.plan().outputs.traces {
            let notes = provenance(study, &computed);
            (under_way.rows, under_way.gaps) = Rows::open(&self.folder, study, &mut state, notes)?;
        } else if !std::mem::take(&mut state.kept.parts).is_empty() {
            rows::clear(&self.folder)?;
        }
        under_way.computed = Some(computed);
        let left = match state.stopped() {
            Stopped::Unfinished => study.places(state.shard()) - state.place(study),
            _ => 0,
        };
        let traces = left + under_way.gaps.iter().map(|gap| gap.end - gap.start).sum::<u64>();
        let steps = study.plan().walk.steps().map_or(0, |steps| traces * u64::from(steps));
        Ok(Left { traces, steps })
    }

    /// Goes on to the end, with one engine for each of the study's [models](Study::models). Saves now and then, and at
    /// the end. Returns what it cost; where nothing was left to do, what was said of the run that did it.
    ///
    /// # Errors
    ///
    /// What the traces, the engines or the operating system say; what was done before is saved but where saving itself
    /// failed.
    ///
    /// # Panics
    ///
    /// Without [`prepare`](Self::prepare), and as [`study::run`](crate::study::run).
    pub fn run(&self, engines: &mut [Box<dyn Engine>], job: &Job) -> Result<RunReport, SessionError> {
        let start = Instant::now();
        let (shard, traces_before, mut place) = {
            let state = locked(&self.state);
            (state.shard(), state.traces(), state.place(&self.study))
        };
        let (gaps, computed) = {
            let mut under_way = locked(&self.under_way);
            let computed = under_way.computed.clone().expect("a session is prepared before it runs");
            (std::mem::take(&mut under_way.gaps), computed)
        };
        let work = || {
            for gap in gaps {
                let mut next = gap.start;
                run_again(&self.study, engines, shard, gap, job, |records| {
                    let first = next;
                    next += records.len() as u64;
                    self.add(&mut locked(&self.state), first, &records)
                })?;
                self.keep()?;
            }
            Ok(run(&self.study, engines, &self.state, job, |state, records, added| {
                let first = place;
                place += added as u64;
                self.add(state, first, &records[..added])
            })?)
        };
        let spent = match work() {
            Ok(spent) => self.keep().map(|()| spent)?,
            Err(SessionError::Traces(error)) => return self.keep_after(SessionError::Traces(error)),
            Err(SessionError::Engine(error)) => return self.keep_after(SessionError::Engine(error)),
            // Rows may be lost that the state counts: what was saved before stands.
            Err(error) => return Err(error),
        };
        self.finish_rows()?;
        let state = self.state();
        let traces = state.traces() - traces_before;
        let before = if traces == 0 { self.folder.run_report(&state) } else { None };
        if traces == 0 && before.is_none() && state.kept.files.contains_key(RUN_REPORT) {
            self.folder.note(Note::Cost { file: self.folder.file(RUN_REPORT) });
        }
        Ok(before.unwrap_or_else(|| {
            let cost =
                self.cost(&state, &computed, start.elapsed(), &spent, [traces, job.steps(), job.tests()], engines);
            RunReport::Run(Box::new(cost))
        }))
    }

    /// Saves what is done, after an error that is to be told rather than another one.
    fn keep_after<T>(&self, error: SessionError) -> Result<T, SessionError> {
        let _ = self.keep();
        Err(error)
    }

    /// Takes the rows of the traces from that at place `first` on, with which `state` is on hand. Saves it when it is
    /// time.
    fn add(&self, state: &mut State, first: u64, records: &[TraceRecord]) -> Result<(), SessionError> {
        self.folder.is_begun();
        let mut under_way = locked(&self.under_way);
        under_way.done = under_way.done.max(first + records.len() as u64);
        under_way.rows.as_mut().map_or(Ok(()), |rows| rows.write(first, records))?;
        if under_way.saved.elapsed() >= CHECKPOINT { self.save_with(state, &mut under_way) } else { Ok(()) }
    }

    fn keep(&self) -> Result<(), SessionError> {
        self.save_with(&mut locked(&self.state), &mut locked(&self.under_way))
    }

    fn save_with(&self, state: &mut State, under_way: &mut UnderWay) -> Result<(), SessionError> {
        self.folder.check_place()?;
        // First the rows: the state must not know of any that are not there.
        under_way.rows.as_mut().map_or(Ok(()), |rows| rows.close(state))?;
        self.folder.save(state)?;
        under_way.saved = Instant::now();
        Ok(())
    }

    /// Saves what is done, also from another thread while the session runs.
    ///
    /// # Errors
    ///
    /// What the operating system says.
    pub fn save(&self) -> Result<Saved, SessionError> {
        let mut state = locked(&self.state);
        let mut under_way = locked(&self.under_way);
        self.save_with(&mut state, &mut under_way)?;
        Ok(Saved { done: under_way.done, all: self.study.places(state.shard()), stopped: state.stopped() })
    }

    /// Puts all rows into their file, once the study is done. All are saved.
    fn finish_rows(&self) -> Result<(), SessionError> {
        let (rows, state) = {
            let state = locked(&self.state);
            (locked(&self.under_way).rows.take(), state.clone())
        };
        let Some(rows) = rows else { return Ok(()) };
        // The state is not locked meanwhile: this can take its time.
        self.folder.check_place()?;
        let check = rows.finish(&self.folder, &state.kept.parts, state.traces())?;
        {
            let mut state = locked(&self.state);
            state.kept.parts.clear();
            state.kept.files.insert(TRACES.to_owned(), check);
            self.folder.save(&state)?;
        }
        rows::clear(&self.folder)
    }

    /// What the run cost and where it ran.
    fn cost(
        &self,
        state: &State,
        computed: &Computed,
        took: Duration,
        spent: &Spent,
        [traces, steps, tests]: [u64; 3],
        engines: &[Box<dyn Engine>],
    ) -> RunCost {
        let here = Environment::here(None);
        let seconds = took.as_secs_f64();
        RunCost {
            version: here.version.to_owned(),
            commit: here.commit.to_owned(),
            engine: computed.engine.to_owned(),
            precision: computed.precision.to_owned(),
            on: computed.on.clone(),
            processor: here.processor,
            os: here.os,
            threads: here.threads,
            shard: state.shard().to_string(),
            traces,
            steps,
            seconds,
            steps_per_second: steps as f64 / seconds,
            tests,
            tests_per_second: tests as f64 / spent.evaluated.max(1e-9),
            seconds_of_all_runs: state.seconds(),
            spent: SpentSeconds {
                drawing_beside: spent.drawn,
                waiting_for_traces: spent.waited,
                evaluating: spent.evaluated,
                tallying: spent.tallied,
            },
            scene: Tried {
                vertices: self.study.models()[0].vertices().len(),
                remaining: engines.iter().map(|engine| engine.remaining()).collect(),
            },
        }
    }
}
