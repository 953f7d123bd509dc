//! One writer a folder.

use std::fs::{File, Metadata, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::error::{Note, SessionError};
use super::holder::Holder;
use super::lease::{Lease, holder};
use super::names::LOCK;
use crate::output::WriteError;

/// Held by the process that writes to a study's folder: a lock, of which the operating system lets go when the process
/// ends, in whatever way, and beside it a lease, since other machines may not see the lock.
pub(super) struct Lock {
    file: File,
    path: PathBuf,
    /// Taken last.
    lease: Option<Lease>,
    /// Whether no process had it before.
    pub(super) is_new: bool,
}

impl Lock {
    /// Takes the lock of a folder, which is there. An error if another process has it, and still has it after a moment.
    pub(super) fn take(folder: &Path, mut note: impl FnMut(Note)) -> Result<Self, SessionError> {
        let path = folder.join(LOCK);
        let is_new = !path.exists();
        loop {
            let open = File::options().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = open.map_err(|cause| WriteError::Io { path: path.clone(), cause })?;
            let is_locked = match patiently(|| file.try_lock()) {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => return Err(in_use(folder, &mut file)),
                Err(TryLockError::Error(cause)) => {
                    note(Note::NoLocks { folder: folder.to_owned(), cause });
                    false
                }
            };
            // Who had it before may have removed the folder meanwhile.
            let mut lock = Lock { file, path: path.clone(), lease: None, is_new };
            if lock.is_in_place() {
                lock.lease = Some(Lease::take(folder, is_locked)?);
                // Whose it is, is only said: without room for that, the lock is as good.
                let _ = lock.file.set_len(0).and_then(|()| writeln!(lock.file, "{}", std::process::id()));
                return Ok(lock);
            }
        }
    }

    /// Takes part in the lock of a folder that is only read, so that nobody writes to it meanwhile. `None` for one that
    /// has never been written to by a process with a lock.
    pub(super) fn share(folder: &Path) -> Result<Option<File>, SessionError> {
        let Ok(mut file) = File::open(folder.join(LOCK)) else { return Ok(None) };
        match patiently(|| file.try_lock_shared()) {
            Err(TryLockError::WouldBlock) => Err(in_use(folder, &mut file)),
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(file)),
        }
    }

    /// Whether no other machine has taken the folder over.
    pub(super) fn is_held(&self) -> bool {
        self.lease.as_ref().is_none_or(Lease::is_held)
    }

    /// Lets go of the folder, where nothing more is written.
    pub(super) fn give_up(&self) {
        self.lease.iter().for_each(Lease::give_up);
    }

    /// Whether the folder is where it was: it may have been moved, and another have taken its place.
    pub(super) fn is_in_place(&self) -> bool {
        match (self.file.metadata(), std::fs::metadata(&self.path)) {
            (Ok(own), Ok(there)) => is_same(&own, &there),
            _ => false,
        }
    }
}

/// How long a lock is waited for: a process that was killed may take a moment to be gone.
const PATIENCE: Duration = Duration::from_secs(1);

/// Tries until there is a lock, for a while.
fn patiently(lock: impl Fn() -> Result<(), TryLockError>) -> Result<(), TryLockError> {
    let start = Instant::now();
    loop {
        match lock() {
            Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => sleep(Duration::from_millis(20)),
            ended => return ended,
        }
    }
}

#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// A folder with an open file in it can be neither moved nor removed.
#[cfg(not(unix))]
fn is_same(_: &Metadata, _: &Metadata) -> bool {
    true
}

fn in_use(folder: &Path, file: &mut File) -> SessionError {
    let mut text = String::new();
    let read = file.take(20).read_to_string(&mut text);
    let process = read.ok().and_then(|_| text.trim().parse().ok());
    // The lease says more, unless it is not there yet.
    let holder = holder(folder).or(process.map(|process| Holder { process, ..Holder::here() }));
    SessionError::InUse { folder: folder.to_owned(), holder: holder.map(Box::new) }
}
