//! Files under way and the passing names under which they grow, of which nothing is left: not when they are dropped,
//! not when the process ends early by [`abandon`], and not for long when it is killed.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempPath;

/// What passing names end with, so that nothing else is taken for one.
const SUFFIX: &str = ".tautline";

/// How many letters make a passing name another than all others.
const LETTERS: usize = 6;

/// The files under way in this process.
static UNDER_WAY: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Whether a file of this process has been given its name.
static PLACED: AtomicBool = AtomicBool::new(false);

/// Held while files are given their names that belong together.
static COMMIT: Mutex<()> = Mutex::new(());

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Files that are finished while this is held appear together: [`abandon`] comes before all of them or after.
pub fn commit() -> impl Drop {
    locked(&COMMIT)
}

/// Removes all files that are under way in this process, for good: it is about to end, and what is still at work gives
/// no file its name from now on. Tells whether one has got its name before.
pub fn abandon() -> bool {
    let commit = locked(&COMMIT);
    let mut files = locked(&UNDER_WAY);
    for file in std::mem::take(&mut *files) {
        // One that cannot be removed is removed when its target is written the next time.
        let _ = fs::remove_file(file);
    }
    std::mem::forget((commit, files));
    PLACED.load(Ordering::SeqCst)
}

/// The passing name of a file under way. The file is locked as long as it has one, so that another process can tell it
/// from those that killed processes left.
#[derive(Debug)]
pub(super) struct Passing {
    /// `None` once the file has its own name.
    path: Option<TempPath>,
    /// Holds the lock when the file itself is closed already.
    #[cfg(unix)]
    _lock: Option<File>,
}

impl Passing {
    /// A new file under way in `folder`, which is to be called `name` in the end. Those that killed processes left of
    /// that name are removed.
    pub(super) fn create(folder: &Path, name: &OsStr) -> io::Result<(File, Passing)> {
        let prefix = format!(".{}.", name.to_string_lossy());
        sweep(folder, &prefix);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(LETTERS);
        #[cfg(unix)]
        {
            // The temporary file becomes the result, so it has a usual file's permissions (less the umask).
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        loop {
            let (file, path) = {
                let mut files = locked(&UNDER_WAY);
                let (file, path) = builder.tempfile_in(folder)?.into_parts();
                files.insert(path.to_path_buf());
                (file, path)
            };
            // Where there are no locks, nothing is swept.
            let _ = file.lock();
            let is_there = path.exists();
            let passing = Passing {
                path: Some(path),
                #[cfg(unix)]
                _lock: file.try_clone().ok(),
            };
            // Another process may have swept it before it was locked.
            if is_there {
                return Ok((file, passing));
            }
        }
    }

    /// Gives the file its name.
    pub(super) fn persist(mut self, target: &Path) -> io::Result<()> {
        let Some(path) = self.path.take() else { return Ok(()) };
        let mut files = locked(&UNDER_WAY);
        files.remove(&*path);
        path.persist(target).map_err(|e| e.error)?;
        PLACED.store(true, Ordering::SeqCst);
        Ok(())
    }
}

impl Drop for Passing {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            locked(&UNDER_WAY).remove(&**path);
        }
    }
}

/// Removes the files that begin with `prefix` and are passing names of nobody any more. What cannot be removed stays.
fn sweep(folder: &Path, prefix: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let letters = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        if letters.is_some_and(|letters| letters.len() == LETTERS && letters.bytes().all(|b| b.is_ascii_alphanumeric()))
        {
            remove_if_left(&entry.path());
        }
    }
}

/// Removes all files in `folder` that are passing names of nobody any more, whatever they were to become.
pub fn remove_left_files(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') && name.ends_with(SUFFIX) {
            remove_if_left(&entry.path());
        }
    }
}

fn remove_if_left(path: &Path) {
    let is_file = fs::symlink_metadata(path).is_ok_and(|found| found.is_file());
    let Some(file) = is_file.then(|| File::options().write(true).open(path).ok()).flatten() else { return };
    match file.try_lock() {
        Ok(()) => drop(fs::remove_file(path)),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_killed_processes_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let (_file, under_way) = Passing::create(folder.path(), OsStr::new("a.csv")).unwrap();
        let others = [".a.csv.backup", ".a.csv.old.tautline", ".a.csv.1234567.tautline", ".b.csv.Abc123.tautline"];
        for name in others.into_iter().chain([".a.csv.Abc123.tautline"]) {
            fs::write(folder.path().join(name), "left").unwrap();
        }
        let (_, again) = Passing::create(folder.path(), OsStr::new("a.csv")).unwrap();
        let own =
            [&under_way, &again].map(|p| p.path.as_ref().unwrap().file_name().unwrap().to_str().unwrap().to_owned());
        let mut expected: Vec<String> = others.map(str::to_owned).into_iter().chain(own).collect();
        expected.sort();
        assert_eq!(names(folder.path()), expected);
        again.persist(&folder.path().join("a.csv")).unwrap();
        drop(under_way);
        remove_left_files(folder.path());
        assert_eq!(names(folder.path()), [".a.csv.backup", "a.csv"]);
    }
}
