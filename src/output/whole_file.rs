//! Files that are whole or not there at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::WriteError;
use super::passing::Passing;
use super::target::{Target, folder_of};

/// A file under way: it grows under a temporary name in the target's folder and takes the target's name when it is
/// whole, in [`finish`](Self::finish). Dropped before that, it vanishes and the target is as it was.
///
/// Output is buffered. After a failed write nothing more is taken and the file cannot be finished.
#[derive(Debug)]
pub struct WholeFile {
    out: BufWriter<File>,
    temporary: Passing,
    /// The path as the user gave it, for messages.
    path: PathBuf,
    target: Target,
    failed: bool,
}

impl WholeFile {
    /// Starts the file that is to stand at `path`, in place of what stands there now, whose mode and owner it takes
    /// over.
    ///
    /// # Errors
    ///
    /// A folder that does not exist or cannot be written to; and what cannot be replaced without a loss: a target that
    /// is there and is no regular file, is read-only, has several names (hard links), is where standard output or error
    /// go, or belongs to somebody to whom the new file could not be given.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let target = Target::at(path)?;
        let Some(name) = target.path.file_name() else {
            return Err(WriteError::target(path, "the path names no file"));
        };
        let folder = folder_of(&target.path);
        if !folder.is_dir() {
            let fault = if folder.exists() { "is not a folder" } else { "does not exist" };
            return Err(WriteError::target(path, format!("the folder {} {fault}", folder.display())));
        }
        let (file, temporary) = Passing::create(folder, name).map_err(|cause| WriteError::io(path, cause))?;
        target.hand_over(&file).map_err(|fault| WriteError::target(path, fault))?;
        let out = BufWriter::with_capacity(1 << 16, file);
        Ok(WholeFile { out, temporary, path: path.to_owned(), target, failed: false })
    }

    /// Writes what is still buffered, so that all that can be left to fail is taking the new name.
    pub(super) fn complete(mut self) -> Result<Self, WriteError> {
        self.flush().map_err(|cause| self.error(cause))?;
        Ok(self)
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    ///
    /// What the operating system says about the last bytes or the new name; or that an earlier write failed.
    pub fn finish(self) -> Result<(), WriteError> {
        self.take_place(|_| Ok(()))
    }

    /// Puts the file in its place once its bytes are on the disk, so that not even a failing machine leaves half of it
    /// there.
    ///
    /// # Errors
    ///
    /// As [`finish`](Self::finish).
    pub fn finish_durably(self) -> Result<(), WriteError> {
        self.take_place(|file| file.sync_all())
    }

    fn take_place(self, then: impl FnOnce(&File) -> io::Result<()>) -> Result<(), WriteError> {
        let WholeFile { out, temporary, path, target, failed } = self;
        if failed {
            return Err(WriteError::target(&path, "an earlier write failed"));
        }
        let file = out.into_inner().map_err(|e| WriteError::io(&path, e.into_error()))?;
        then(&file).map_err(|cause| WriteError::io(&path, cause))?;
        // Some systems do not rename open files.
        drop(file);
        temporary.persist(&target.path).map_err(|cause| WriteError::io(&path, cause))
    }

    /// Puts the path to an error of one of this file's writes.
    pub(super) fn error(&self, cause: io::Error) -> WriteError {
        WriteError::io(&self.path, cause)
    }

    fn watched<T>(&mut self, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>) -> io::Result<T> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        let result = write(&mut self.out);
        self.failed = result.as_ref().is_err_and(|e| e.kind() != io::ErrorKind::Interrupted);
        result
    }

    /// A file under way whose bytes go to `file`.
    #[cfg(test)]
    pub(super) fn onto(path: &Path, file: File) -> Self {
        let whole = WholeFile::create(path).unwrap();
        WholeFile { out: BufWriter::new(file), ..whole }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.watched(|out| out.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.watched(|out| out.flush())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn the_target_changes_only_when_the_file_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "old").unwrap();
        let mut file = WholeFile::create(&path).unwrap();
        file.write_all(b"new").unwrap();
        file.flush().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        drop(file);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.csv"]);

        let mut file = WholeFile::create(&path).unwrap();
        file.write_all(b"new").unwrap();
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[test]
    fn targets_that_cannot_be_written_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let refused = |path: &Path, why: String| {
            let e = WholeFile::create(path).unwrap_err();
            assert_eq!(e.to_string(), format!("cannot write {}: {why}", path.display()));
        };
        fs::create_dir(at("folder.csv")).unwrap();
        fs::write(at("file"), "").unwrap();
        fs::write(at("fixed.csv"), "old").unwrap();
        let mut permissions = fs::metadata(at("fixed.csv")).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(at("fixed.csv"), permissions).unwrap();
        let why = "files appear when they are whole, so give the name of one";
        refused(&at("folder.csv"), format!("what stands there is not a regular file but a folder; {why}"));
        refused(&at("fixed.csv"), "the file that stands there is read-only".into());
        refused(&at("no/a.csv"), format!("the folder {} does not exist", at("no").display()));
        refused(&at("file/a.csv"), format!("the folder {} is not a folder", at("file").display()));
        refused(Path::new(""), "the path names no file".into());
        assert_eq!(names(folder.path()), ["file", "fixed.csv", "folder.csv"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_are_usual() {
        use std::os::unix::fs::{PermissionsExt, symlink};

        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("usual"), "").unwrap();
        fs::write(at("there"), "old").unwrap();
        symlink(at("there"), at("link.csv")).unwrap();
        symlink(at("nothing"), at("lost.csv")).unwrap();
        let mut file = WholeFile::create(&at("link.csv")).unwrap();
        file.write_all(b"new").unwrap();
        file.finish().unwrap();
        assert!(at("link.csv").is_symlink());
        assert_eq!(fs::read(at("there")).unwrap(), b"new");
        let mode = |name| fs::metadata(at(name)).unwrap().permissions().mode();
        assert_eq!(mode("there"), mode("usual"));
        let e = WholeFile::create(&at("lost.csv")).unwrap_err().to_string();
        assert!(e.ends_with("lost.csv: what stands there is a link to nothing"), "{e}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_a_whole_file_cannot_replace_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let refused = |path: &Path, kind: &str| {
            let e = WholeFile::create(path).unwrap_err().to_string();
            let why = "files appear when they are whole, so give the name of one";
            let what = format!("what stands there is not a regular file but {kind}; {why}");
            assert_eq!(e, format!("cannot write {}: {what}", path.display()));
        };
        assert!(std::process::Command::new("mkfifo").arg(at("pipe.csv")).status().unwrap().success());
        refused(&at("pipe.csv"), "a pipe");
        refused(Path::new("/dev/null"), "a device");
        // Whatever they are, and however one comes to them.
        fs::write(at("open.csv"), "old").unwrap();
        let open = File::open(at("open.csv")).unwrap();
        let number = std::os::fd::AsRawFd::as_raw_fd(&open);
        for link in ["/dev/stdout", "/proc/self/fd/2", &format!("/dev/fd/{number}")] {
            refused(Path::new(link), "an open file of this program");
            let _ = fs::remove_file(at("link.csv"));
            std::os::unix::fs::symlink(link, at("link.csv")).unwrap();
            refused(&at("link.csv"), "an open file of this program");
        }
        // By its own name it can be replaced.
        WholeFile::create(&at("open.csv")).unwrap().finish().unwrap();
        assert_eq!(names(folder.path()), ["link.csv", "open.csv", "pipe.csv"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_file_of_several_names_is_not_split() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a.csv"), "old").unwrap();
        fs::hard_link(at("a.csv"), at("b.csv")).unwrap();
        let e = WholeFile::create(&at("a.csv")).unwrap_err().to_string();
        assert!(
            e.contains("a.csv: the file that stands there has 2 names (hard links), and the others would keep"),
            "{e}"
        );
        fs::remove_file(at("b.csv")).unwrap();
        WholeFile::create(&at("a.csv")).unwrap().finish().unwrap();
        assert_eq!(names(folder.path()), ["a.csv"]);
    }

    #[cfg(unix)]
    #[test]
    fn mode_and_owner_are_those_of_the_file_before() {
        use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "old").unwrap();
        // Only the superuser can give files away.
        let given = chown(&path, Some(1234), Some(4321)).is_ok();
        for mode in [0o600, 0o666, 0o4750, 0o640] {
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let mut file = WholeFile::create(&path).unwrap();
            file.write_all(b"new").unwrap();
            file.finish().unwrap();
            let found = fs::metadata(&path).unwrap();
            assert_eq!(found.mode() & 0o7777, mode);
            assert!(!given || (found.uid(), found.gid()) == (1234, 4321));
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_leaves_the_target_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "old").unwrap();
        let full = || File::options().write(true).open("/dev/full").unwrap();

        // Little output: the disk is found full at the end.
        let mut file = WholeFile::onto(&path, full());
        file.write_all(b"new").unwrap();
        let e = file.finish().unwrap_err().to_string();
        assert_eq!(e, format!("cannot write {}: No space left on device (os error 28)", path.display()));

        // Much output: it is found full on the way, and the rest is refused too.
        let mut file = WholeFile::onto(&path, full());
        assert!(file.write_all(&[b'x'; 1 << 20]).is_err());
        assert!(file.write_all(b"x").is_err());
        let e = file.finish().unwrap_err().to_string();
        assert_eq!(e, format!("cannot write {}: an earlier write failed", path.display()));

        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.csv"]);
    }
}
