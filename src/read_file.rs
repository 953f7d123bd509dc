//! Files as they are opened and read: of which kind they may be, and how large.

use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

use crate::read_error::{Fault, Place, ReadError};

/// How many bytes a scene or an image may have: it is held as a whole while it is read.
pub(crate) const SCENE_MAX: u64 = 1 << 29;

/// How many bytes a file of settings may have, a study's or a map's: no person writes as many.
pub(crate) const SETTINGS_MAX: u64 = 1 << 20;

/// What stands at a path, if it is neither a regular file nor a folder.
pub(crate) fn special(metadata: &Metadata) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = metadata.file_type();
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
    }
    (!metadata.is_file() && !metadata.is_dir()).then_some("a device")
}

/// Opens a regular file, or with `pipes` a pipe too. Anything else may never end, or not even open, and is refused
/// first.
pub(crate) fn open(path: &Path, pipes: bool) -> Result<File, ReadError> {
    let io = |cause| ReadError::io(path, cause);
    let metadata = std::fs::metadata(path).map_err(io)?;
    // A folder opens like a file and fails later, where a decoder would take it for damage.
    if metadata.is_dir() {
        return Err(io(std::io::ErrorKind::IsADirectory.into()));
    }
    match special(&metadata) {
        Some("a pipe") if pipes => {}
        Some(kind) => {
            let what = format!("this is {kind}; write what it gives to a regular file, and give that");
            return Err(Fault::new(Place::default(), what).in_file(path));
        }
        None => {}
    }
    File::open(path).map_err(io)
}

/// The whole of a regular file, which may have `most` bytes.
pub(crate) fn read_bytes(path: &Path, most: u64) -> Result<Vec<u8>, ReadError> {
    let mut file = open(path, false)?;
    let size = file.metadata().map_or(0, |m| m.len());
    let mut bytes = Vec::new();
    if size <= most {
        // Some files do not know how large they are.
        let room = bytes.try_reserve_exact(size as usize + 1).map_err(|_| std::io::ErrorKind::OutOfMemory.into());
        let read = room.and_then(|()| file.by_ref().take(most + 1).read_to_end(&mut bytes));
        read.map_err(|cause| ReadError::io(path, cause))?;
    }
    let size = size.max(bytes.len() as u64);
    if size > most {
        let what = format!("the file has {size} bytes; one of its kind may have {most} at the most");
        return Err(Fault::new(Place::default(), what).in_file(path));
    }
    Ok(bytes)
}

/// The same as text, without a byte order mark.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String, ReadError> {
    let mut bytes = read_bytes(path, most)?;
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(Fault::new(Place::default(), "UTF-16; save the file as UTF-8 text").in_file(path));
    }
    String::from_utf8(bytes).map_err(|e| {
        let good = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|&&b| b == b'\n').count();
        let column = 1 + good.iter().rev().take_while(|&&b| b != b'\n').count();
        let place = Place::default().then("line", line).then("column", column);
        Fault::new(place, "not UTF-8; save the file as UTF-8 text").in_file(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_file_is_named_with_the_cause() {
        let e = read_text(Path::new("/nowhere/x.map"), SCENE_MAX).unwrap_err();
        assert_eq!(e.to_string(), "cannot read /nowhere/x.map: No such file or directory (os error 2)");
    }

    #[test]
    fn bytes_that_are_not_utf8_are_placed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.map");
        std::fs::write(&path, b"type octile\nhe\xffight").unwrap();
        let e = read_text(&path, SCENE_MAX).unwrap_err().to_string();
        assert!(e.ends_with("a.map: line 2, column 3: not UTF-8; save the file as UTF-8 text"), "{e}");
        std::fs::write(&path, b"\xef\xbb\xbftype").unwrap();
        assert_eq!(read_text(&path, SCENE_MAX).unwrap(), "type");
        std::fs::write(&path, b"\xff\xfet\0y\0").unwrap();
        let e = read_text(&path, SCENE_MAX).unwrap_err().to_string();
        assert!(e.ends_with("a.map: UTF-16; save the file as UTF-8 text"), "{e}");
    }

    #[test]
    fn a_file_is_read_up_to_its_bound_and_not_a_byte_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.map");
        std::fs::write(&path, b"12345").unwrap();
        assert_eq!(read_bytes(&path, 5).unwrap(), b"12345");
        let e = read_bytes(&path, 4).unwrap_err().to_string();
        assert!(e.ends_with("a.map: the file has 5 bytes; one of its kind may have 4 at the most"), "{e}");
        // A terabyte with nothing in it.
        File::options().write(true).open(&path).unwrap().set_len(1 << 40).unwrap();
        let e = read_bytes(&path, SCENE_MAX).unwrap_err().to_string();
        assert!(e.ends_with("the file has 1099511627776 bytes; one of its kind may have 536870912 at the most"), "{e}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_may_never_end_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("a.map");
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
        let socket = folder.path().join("b.map");
        let _listens = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, kind) in [(&*fifo, "a pipe"), (&*socket, "a socket"), (Path::new("/dev/zero"), "a device")] {
            let rest = "write what it gives to a regular file, and give that";
            let e = read_bytes(path, SCENE_MAX).unwrap_err().to_string();
            assert_eq!(e, format!("{}: this is {kind}; {rest}", path.display()));
        }
        let e = read_bytes(folder.path(), SCENE_MAX).unwrap_err().to_string();
        assert!(e.ends_with("is a directory"), "{e}");
        // The kernel's own files say that they are empty.
        assert!(read_text(Path::new("/proc/self/status"), SETTINGS_MAX).unwrap().contains("Name:"));
    }
}
