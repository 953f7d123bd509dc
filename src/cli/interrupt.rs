//! Ctrl-C: ends the process at once where nothing needs to be cleaned up, and in good order where files are half written.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use tautline::engine::Job;

use super::failure::Failure;

static WRITING: AtomicBool = AtomicBool::new(false);
static STOPPED: AtomicBool = AtomicBool::new(false);

/// What to stop when files are half written.
static JOB: OnceLock<Arc<Job>> = OnceLock::new();

/// Listens for Ctrl-C from now on.
pub(crate) fn listen() -> Result<(), Failure> {
    let heard = || {
        STOPPED.store(true, Ordering::SeqCst);
        JOB.get().into_iter().for_each(|job| job.stop());
        if !WRITING.load(Ordering::SeqCst) {
            say!("\nerror: {}", Failure::interrupted());
            leave(130);
        }
    };
    ctrlc::set_handler(heard).map_err(|e| Failure::internal(e.into()))
}

/// Ends the process with that exit code and nothing else. What other threads do must not be taken from under them: a driver that
/// is being loaded while the handlers of a usual exit run brings the process down with a signal.
#[cfg(unix)]
#[allow(unsafe_code)] // there is no safe name for it
fn leave(code: i32) -> ! {
    // SAFETY: it neither returns nor touches memory. Nothing is buffered: stderr is not, and stdout is written at once.
    unsafe { libc::_exit(code) }
}

/// Ends the process with that exit code.
#[cfg(not(unix))]
fn leave(code: i32) -> ! {
    std::process::exit(code)
}

/// Has Ctrl-C stop `job`, the one evaluation of this process.
pub(crate) fn stops(job: &Arc<Job>) {
    let _ = JOB.set(job.clone());
    // It may have come before there was a job.
    if STOPPED.load(Ordering::SeqCst) {
        job.stop();
    }
}

/// An error once Ctrl-C was pressed, so that half-written files are dropped.
pub(crate) fn check() -> Result<(), Failure> {
    if STOPPED.load(Ordering::SeqCst) { Err(Failure::interrupted()) } else { Ok(()) }
}

/// While one of these lives, Ctrl-C waits for [`check`]. One that has just begun must be checked before
/// a file is made: Ctrl-C may have come a moment earlier.
pub(crate) struct Writing;

impl Writing {
    pub(crate) fn begin() -> Self {
        WRITING.store(true, Ordering::SeqCst);
        Writing
    }

    /// Ends it when all files are gone again: an error if Ctrl-C was pressed meanwhile.
    pub(crate) fn end(self) -> Result<(), Failure> {
        WRITING.store(false, Ordering::SeqCst);
        check()
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        WRITING.store(false, Ordering::SeqCst);
    }
}
