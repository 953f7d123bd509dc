//! What stands where a file is to be put, and whether a whole file may take its place.

use std::fs::{self, File, Metadata};
use std::path::{Path, PathBuf};

use super::WriteError;
use crate::read_file::special;

/// A place for a file.
#[derive(Debug)]
pub(super) struct Target {
    /// The path with links followed: a link stays a link.
    pub(super) path: PathBuf,
    /// The file that stands there now.
    found: Option<Metadata>,
}

impl Target {
    /// Looks at `path`. O(1); changes nothing.
    ///
    /// # Errors
    ///
    /// What stands there cannot be replaced, or not without a loss: anything but a regular file, one that is read-only,
    /// has other names or is open as this program's own output, and a link to nothing.
    pub(super) fn at(path: &Path) -> Result<Self, WriteError> {
        refuse_special(path)?;
        let wrong = |fault: &str| Err(WriteError::target(path, fault));
        let found = match fs::metadata(path) {
            Ok(found) if found.permissions().readonly() => return wrong("the file that stands there is read-only"),
            Ok(found) => Some(found),
            Err(_) if path.is_symlink() => return wrong("what stands there is a link to nothing"),
            Err(_) => None,
        };
        let target = match &found {
            Some(_) => fs::canonicalize(path).map_err(|cause| WriteError::io(path, cause))?,
            None => path.to_owned(),
        };
        let target = Target { path: target, found };
        match target.tied() {
            Some(fault) => wrong(&fault),
            None => Ok(target),
        }
    }

    /// Why the file that stands there would not be the same file afterwards, to all who know it.
    #[cfg(unix)]
    fn tied(&self) -> Option<String> {
        use std::os::fd::AsFd;
        use std::os::unix::fs::MetadataExt;

        let found = self.found.as_ref()?;
        let same = |open: std::io::Result<std::os::fd::OwnedFd>| {
            let open = open.and_then(|open| File::from(open).metadata());
            open.is_ok_and(|open| (open.dev(), open.ino()) == (found.dev(), found.ino()))
        };
        let standard = [
            ("output", std::io::stdout().as_fd().try_clone_to_owned()),
            ("error", std::io::stderr().as_fd().try_clone_to_owned()),
        ];
        if let Some((name, _)) = standard.into_iter().find_map(|(name, open)| same(open).then_some((name, ()))) {
            return Some(format!("standard {name} goes into that file; give the name of another"));
        }
        if found.nlink() > 1 {
            let links = found.nlink();
            let what = "the others would keep the old contents; remove this one first, or give another name";
            return Some(format!("the file that stands there has {links} names (hard links), and {what}"));
        }
        None
    }

    #[cfg(not(unix))]
    fn tied(&self) -> Option<String> {
        None
    }

    /// Gives the new file the mode and the owner of the one that it replaces.
    #[cfg(unix)]
    pub(super) fn hand_over(&self, file: &File) -> Result<(), String> {
        use std::os::unix::fs::{MetadataExt, fchown};

        let Some(found) = &self.found else { return Ok(()) };
        let system = |e: std::io::Error| e.to_string();
        let new = file.metadata().map_err(system)?;
        let owner = (found.uid(), found.gid());
        if (new.uid(), new.gid()) != owner && fchown(file, Some(owner.0), Some(owner.1)).is_err() {
            return Err(format!(
                "the file that stands there belongs to user {} and group {}, and a new one in its place would not; \
                 remove it first, or give another name",
                owner.0, owner.1
            ));
        }
        // After the owner, whose change takes some of the mode away.
        if new.mode() == found.mode() { Ok(()) } else { file.set_permissions(found.permissions()).map_err(system) }
    }

    #[cfg(not(unix))]
    pub(super) fn hand_over(&self, _: &File) -> Result<(), String> {
        Ok(())
    }
}

/// Refuses what is no place for a whole file, whatever its name: folders, devices, pipes, open files such as
/// `/dev/stdout`.
pub(super) fn refuse_special(path: &Path) -> Result<(), WriteError> {
    let kind = match fs::metadata(path) {
        _ if is_descriptor(path) => "an open file of this program",
        Ok(found) if found.is_dir() => "a folder",
        Ok(found) => special(&found).unwrap_or_default(),
        Err(_) => "",
    };
    if kind.is_empty() {
        return Ok(());
    }
    let why = "files appear when they are whole, so give the name of one";
    Err(WriteError::target(path, format!("what stands there is not a regular file but {kind}; {why}")))
}

/// The folder in which a file lies: of a bare name, the one that is the current one.
///
/// ```
/// use std::path::Path;
/// use tautline::output::folder_of;
/// assert_eq!(["a.csv", "b/a.csv"].map(|path| folder_of(Path::new(path))), [".", "b"].map(Path::new));
/// ```
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether `path` leads to a file through the number under which a process has it open, as `/dev/stdout` and
/// `/dev/fd/3` do. A new file in its place would not be the one that is open.
fn is_descriptor(path: &Path) -> bool {
    let mut path = path.to_owned();
    // As many links as the system follows.
    for _ in 0..40 {
        let Some(name) = path.file_name() else { return false };
        let Ok(folder) = folder_of(&path).canonicalize() else { return false };
        if folder.ends_with("fd") && (folder.starts_with("/proc") || folder.starts_with("/dev")) {
            return true;
        }
        let Ok(link) = fs::read_link(folder.join(name)) else { return false };
        path = folder.join(link);
    }
    false
}
