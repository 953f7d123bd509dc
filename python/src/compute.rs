//! Long computations: without the interpreter's lock, on threads of this process, and ended by Ctrl-C.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tautline::engine::Job;

use crate::fault::Fault;

/// How often signals are looked at.
const LOOK: Duration = Duration::from_millis(50);

/// The threads of this process. A process that was forked has none of its parent's, and makes its own.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Taken only by who holds the interpreter's lock, as does who forks: so nobody holds this one then.
pub(crate) fn pool(_: Python<'_>) -> Result<Arc<ThreadPool>, Fault> {
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match &*pool {
        Some((process, pool)) if *process == process::id() => return Ok(pool.clone()),
        _ => {}
    }
    let new = Arc::new(ThreadPoolBuilder::new().build().map_err(|e| Fault::new("EngineError", e))?);
    // The parent's pool is forgotten rather than dropped: its threads cannot answer any more.
    std::mem::forget(pool.replace((process::id(), new.clone())));
    Ok(new)
}

/// A computation as seen from where it is done.
#[derive(Default)]
pub(crate) struct Work {
    pub(crate) job: Job,
    stopped: AtomicBool,
}

impl Work {
    /// Whether it is to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
        self.job.stop();
    }
}

/// Does `work` without the interpreter's lock. A signal handler that raises, as that of Ctrl-C does, stops the work,
/// and what it raises is returned once the work has ended. Now and then `watch` is told how far it is; it may raise
/// too.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&Work) -> Result<T, Fault> + Send,
    watch: impl Fn(Python<'_>, &Work) -> PyResult<()> + Sync,
) -> PyResult<T> {
    let pool = pool(py)?;
    let state = Work::default();
    let (done, raised) = py.detach(|| {
        let (ready, waiting) = sync_channel(1);
        let state = &state;
        pool.in_place_scope(|scope| {
            scope.spawn(move |_| drop(ready.send(catch_unwind(AssertUnwindSafe(|| work(state))))));
            let mut raised = None;
            loop {
                match waiting.recv_timeout(LOOK) {
                    Ok(done) => return (done, raised),
                    Err(RecvTimeoutError::Disconnected) => unreachable!("the work sends what came of it"),
                    Err(RecvTimeoutError::Timeout) if raised.is_some() => {}
                    Err(RecvTimeoutError::Timeout) => {
                        let looked = Python::attach(|py| py.check_signals().and_then(|()| watch(py, state)));
                        if let Err(error) = looked {
                            state.stop();
                            raised = Some(error);
                        }
                    }
                }
            }
        })
    });
    match (raised, done) {
        (Some(error), _) => Err(error),
        (None, Ok(done)) => Ok(done?),
        (None, Err(panic)) => resume_unwind(panic),
    }
}

/// Waits for `mutex` without the interpreter's lock, and does `with` what it holds. Signals end the waiting.
pub(crate) fn locked<T: Send, R>(
    py: Python<'_>,
    mutex: &Mutex<T>,
    with: impl FnOnce(Python<'_>, &mut T) -> PyResult<R>,
) -> PyResult<R> {
    // Not within the threads' work: a thread that waits there may be the one that is waited for.
    for waited in 0u64.. {
        match mutex.try_lock() {
            Ok(mut held) => return with(py, &mut held),
            // A panic was told where it happened; what it left is made anew by whoever asks for it.
            Err(TryLockError::Poisoned(held)) => return with(py, &mut held.into_inner()),
            Err(TryLockError::WouldBlock) => {
                py.detach(|| sleep(Duration::from_millis(waited.min(10) + 1)));
                py.check_signals()?;
            }
        }
    }
    unreachable!("waiting does not end")
}
