//! Ctrl-C, and a request to end: the process ends at once, in good order, whatever it is doing. That is done by the
//! thread that hears of it, so that nothing has to be asked to stop: what is still at work is cut off.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tautline::output::abandon;

use super::failure::Failure;

/// What is still to be done before the process ends. It must wait for whatever other threads change.
pub(crate) enum Last {
    /// Saves what there is, and makes what is said then, and the exit code.
    Save(Box<dyn FnOnce() -> Failure + Send>),
    /// Takes back what was done, once no file can appear any more.
    TakeBack(Box<dyn FnOnce() + Send>),
}

static LAST: Mutex<Option<Last>> = Mutex::new(None);

fn last() -> MutexGuard<'static, Option<Last>> {
    LAST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Listens for Ctrl-C from now on, and for requests to end: SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU. Files under way
/// vanish at them. What the process was started to ignore, by nohup say, it goes on to ignore.
pub(crate) fn listen() -> Result<(), Failure> {
    heed()?;
    let ignored = ignored();
    ctrlc::set_handler(end).map_err(|e| Failure::internal(e.into()))?;
    ignore(&ignored);
    Ok(())
}

/// Ends the process in that time as a request to end does.
pub(crate) fn end_in(time: Duration) {
    std::thread::spawn(move || {
        std::thread::sleep(time);
        end();
    });
}

/// Has what schedulers send before a job's end, and the system where its time on the processor is over, be as a request
/// to end. To be called before there are other threads.
#[cfg(unix)]
#[allow(unsafe_code)] // there is no safe name for it
fn heed() -> Result<(), Failure> {
    let heeded = [libc::SIGUSR1, libc::SIGUSR2, libc::SIGXCPU];
    let ignored = ignored_of(&heeded);
    // SAFETY: the set is filled by the first call, and each signal in it is one that may be waited for.
    let (blocked, set) = unsafe {
        let mut set: libc::sigset_t = std::mem::zeroed();
        libc::sigemptyset(&mut set);
        for signal in heeded.into_iter().filter(|signal| !ignored.contains(signal)) {
            libc::sigaddset(&mut set, signal);
        }
        // All threads to come have these blocked too, so that they wait for the one that takes them.
        (libc::pthread_sigmask(libc::SIG_BLOCK, &set, std::ptr::null_mut()), set)
    };
    if blocked != 0 {
        return Err(Failure::internal(std::io::Error::from_raw_os_error(blocked).into()));
    }
    std::thread::spawn(move || {
        let mut signal = 0;
        // SAFETY: both are there, and nobody else has them.
        while unsafe { libc::sigwait(&set, &mut signal) } != 0 {}
        end();
    });
    Ok(())
}

#[cfg(not(unix))]
fn heed() -> Result<(), Failure> {
    Ok(())
}

/// The signals that are listened for and were ignored so far.
#[cfg(unix)]
fn ignored() -> Vec<libc::c_int> {
    ignored_of(&[libc::SIGINT, libc::SIGTERM, libc::SIGHUP])
}

/// Those of these signals that are ignored.
#[cfg(unix)]
#[allow(unsafe_code)] // there is no safe name for it
fn ignored_of(signals: &[libc::c_int]) -> Vec<libc::c_int> {
    let is_ignored = |&signal: &libc::c_int| {
        // SAFETY: all bits zero are a valid value of what is filled in; without a new action nothing is changed.
        let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
        let asked = unsafe { libc::sigaction(signal, std::ptr::null(), &mut action) };
        asked == 0 && action.sa_sigaction == libc::SIG_IGN
    };
    signals.iter().copied().filter(is_ignored).collect()
}

#[cfg(unix)]
#[allow(unsafe_code)] // there is no safe name for it
fn ignore(signals: &[libc::c_int]) {
    for &signal in signals {
        // SAFETY: no handler is installed that could do harm.
        unsafe { libc::signal(signal, libc::SIG_IGN) };
    }
}

#[cfg(not(unix))]
fn ignored() {}

#[cfg(not(unix))]
fn ignore(_: &()) {}

fn end() {
    // Held to the end, so that nobody takes what is done here for something to go on from.
    let mut last = last();
    let failure = match last.take() {
        Some(Last::Save(save)) => {
            let failure = save();
            abandon();
            failure
        }
        Some(Last::TakeBack(take_back)) => {
            abandon();
            take_back();
            Failure::interrupted(false)
        }
        None => Failure::interrupted(abandon()),
    };
    // Where the terminal has gone there is nobody to tell.
    say!("\nerror: {failure}");
    leave(failure.number());
}

/// Ends the process with that exit code and nothing else. What other threads do must not be taken from under them: a
/// driver that is being loaded while the handlers of a usual exit run brings the process down with a signal.
#[cfg(unix)]
#[allow(unsafe_code)] // there is no safe name for it
fn leave(code: u8) -> ! {
    // SAFETY: it neither returns nor touches memory. Nothing is buffered: stderr is not, and stdout is written at once.
    unsafe { libc::_exit(code.into()) }
}

/// Ends the process with that exit code.
#[cfg(not(unix))]
fn leave(code: u8) -> ! {
    std::process::exit(code.into())
}

/// While one of these lives, Ctrl-C does something before the process ends. There is one at a time.
pub(crate) struct Guard;

impl Guard {
    pub(crate) fn new(doing: Last) -> Self {
        *last() = Some(doing);
        Guard
    }

    /// Has something else done from now on.
    pub(crate) fn change(&self, doing: Last) {
        *last() = Some(doing);
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        *last() = None;
    }
}
