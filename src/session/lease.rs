//! A sign of life of who writes to a folder, for machines that do not see each other's locks.
//!
//! The writer holds a file `lease.N` that it made itself and writes again every few seconds. Who wants to take its
//! place watches the file by a clock of its own, so that clocks need not agree: one that does not change for
//! [`LAPSE`] is over. Then `lease.N+1` is made, which one only can do, and the file before it removed. So whoever stood
//! still meanwhile sees at its next look, which comes before all that it writes, that its own is gone.
//!
//! That asks of a file system that a file is made by one only where several try, and that what was written and closed
//! is read by who opens it afterwards. Both hold for NFS from version 3 on, Lustre, BeeGFS, GPFS and CephFS.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use super::error::SessionError;
use super::holder::{Holder, now};
use crate::output::WriteError;

/// How often a lease is renewed.
const BEAT: Duration = Duration::from_secs(5);

/// A lease that has not changed for so long is over: several beats, and more than a file system needs to show them.
const LAPSE: Duration = Duration::from_secs(30);

/// How long a lease file is, whatever it says: writing it again needs no more room.
const LENGTH: usize = 512;

/// What the names of leases begin with.
const NAME: &str = "lease.";

/// The lease of this process on a folder. Dropped, it is given up.
pub(super) struct Lease {
    path: PathBuf,
    token: String,
    /// Whether it was given up, and what wakes the thread that renews it.
    over: Arc<(Mutex<bool>, Condvar)>,
}

impl Lease {
    /// Takes the lease of a folder. `is_locked` says that no other process of this machine writes there.
    pub(super) fn take(folder: &Path, is_locked: bool) -> Result<Self, SessionError> {
        Lease::take_after(folder, is_locked, BEAT, LAPSE)
    }

    fn take_after(folder: &Path, is_locked: bool, beat: Duration, lapse: Duration) -> Result<Self, SessionError> {
        let failed = |path: &Path, cause| SessionError::Write(WriteError::Io { path: path.to_owned(), cause });
        let mut holder = Holder::here();
        'again: loop {
            let leases = numbers(folder).map_err(|cause| failed(folder, cause))?;
            let before = leases.last().copied();
            for number in leases {
                match watch(&file(folder, number), is_locked, lapse) {
                    Watched::Over if Some(number) == before => {}
                    // Who took over from that one ended before removing it.
                    Watched::Over => drop(fs::remove_file(file(folder, number))),
                    Watched::Gone => continue 'again,
                    Watched::Lives(holder) => {
                        let holder = holder.map(Box::new);
                        return Err(SessionError::InUse { folder: folder.to_owned(), holder });
                    }
                }
            }
            let number = before.map_or(0, |number| number + 1);
            let path = file(folder, number);
            let mut own = match File::options().write(true).create_new(true).open(&path) {
                Ok(own) => own,
                Err(cause) if cause.kind() == ErrorKind::AlreadyExists => continue,
                Err(cause) => return Err(failed(&path, cause)),
            };
            holder.renewed = now();
            if let Err(cause) = write(&mut own, &holder) {
                let _ = fs::remove_file(&path);
                return Err(failed(&path, cause));
            }
            // Nothing is closed in vain: others see it from here on.
            drop(own);
            let there = numbers(folder).map_err(|cause| failed(folder, cause))?;
            if there.iter().any(|&other| other != number && Some(other) != before) {
                // Another took the folder while this process looked at who had it before.
                let _ = fs::remove_file(&path);
                continue;
            }
            before.into_iter().for_each(|number| drop(fs::remove_file(file(folder, number))));
            let lease = Lease { path, token: holder.token.clone(), over: Arc::default() };
            lease.renew(holder, beat);
            return Ok(lease);
        }
    }

    /// Has a thread renew it until it is given up or lost.
    fn renew(&self, mut holder: Holder, beat: Duration) {
        let (path, over) = (self.path.clone(), self.over.clone());
        thread::spawn(move || {
            let (is_over, wake) = &*over;
            loop {
                let guard = is_over.lock().unwrap_or_else(PoisonError::into_inner);
                let (guard, _) =
                    wake.wait_timeout_while(guard, beat, |over| !*over).unwrap_or_else(PoisonError::into_inner);
                if *guard || !is_own(&path, &holder.token) {
                    return;
                }
                (holder.beat, holder.renewed) = (holder.beat + 1, now());
                // What fails now may succeed at the next beat.
                let _ = File::options().write(true).open(&path).and_then(|mut file| write(&mut file, &holder));
            }
        });
    }

    /// Whether nobody has taken it over.
    pub(super) fn is_held(&self) -> bool {
        is_own(&self.path, &self.token)
    }

    /// Gives it up.
    pub(super) fn give_up(&self) {
        // Held while the file is removed, so that it is not renewed meanwhile.
        let mut over = self.over.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !std::mem::replace(&mut *over, true) && self.is_held() {
            let _ = fs::remove_file(&self.path);
        }
        self.over.1.notify_all();
    }
}

impl Drop for Lease {
    fn drop(&mut self) {
        self.give_up();
    }
}

/// Who has the lease of a folder, if it says so. That one may have ended.
pub(super) fn holder(folder: &Path) -> Option<Holder> {
    let number = *numbers(folder).ok()?.last()?;
    parse(&fs::read(file(folder, number)).ok()?)
}

/// What has become of another's lease.
enum Watched {
    /// It is over.
    Over,
    /// It was given up.
    Gone,
    /// It is renewed.
    Lives(Option<Holder>),
}

/// Watches a lease until it is known what has become of it.
fn watch(path: &Path, is_locked: bool, lapse: Duration) -> Watched {
    let Ok(first) = fs::read(path) else { return Watched::Gone };
    let holder = parse(&first);
    if holder.as_ref().is_some_and(|holder| holder.is_of_this_machine() && (is_locked || holder.has_ended())) {
        return Watched::Over;
    }
    let start = Instant::now();
    while start.elapsed() < lapse {
        thread::sleep(lapse / 300);
        match fs::read(path) {
            Err(_) => return Watched::Gone,
            Ok(bytes) if bytes != first => return Watched::Lives(parse(&bytes).or(holder)),
            Ok(_) => {}
        }
    }
    Watched::Over
}

/// Whether the lease is that of who has the token. Where it cannot be read for other reasons, it is.
fn is_own(path: &Path, token: &str) -> bool {
    match fs::read(path) {
        Ok(bytes) => parse(&bytes).is_some_and(|holder| holder.token == token),
        Err(cause) => !matches!(cause.kind(), ErrorKind::NotFound | ErrorKind::StaleNetworkFileHandle),
    }
}

fn write(file: &mut File, holder: &Holder) -> io::Result<()> {
    let text = serde_json::to_string(holder)?;
    file.write_all(format!("{text:<width$}\n", width = LENGTH - 1).as_bytes())?;
    file.sync_data()
}

fn parse(bytes: &[u8]) -> Option<Holder> {
    serde_json::from_slice(bytes).ok()
}

fn file(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{NAME}{number}"))
}

/// The numbers of all leases of a folder, in their order.
fn numbers(folder: &Path) -> io::Result<Vec<u64>> {
    let mut numbers = Vec::new();
    for entry in fs::read_dir(folder)? {
        numbers.extend(entry?.file_name().to_str().and_then(|name| name.strip_prefix(NAME)?.parse::<u64>().ok()));
    }
    numbers.sort_unstable();
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEAT: Duration = Duration::from_millis(20);
    const LAPSE: Duration = Duration::from_millis(600);

    /// Has the lease be one of another machine, and no longer renewed.
    fn moved_away(lease: &Lease, folder: &Path) {
        *lease.over.0.lock().unwrap() = true;
        let there = Holder { machine: "elsewhere".to_owned(), ..holder(folder).unwrap() };
        write(&mut File::create(&lease.path).unwrap(), &there).unwrap();
    }

    #[test]
    fn a_lease_that_is_renewed_is_not_taken_and_one_that_is_given_up_leaves_nothing() {
        let room = tempfile::tempdir().unwrap();
        let lease = Lease::take_after(room.path(), false, BEAT, LAPSE).unwrap();
        let refused = Lease::take_after(room.path(), false, BEAT, LAPSE).err().unwrap();
        assert!(matches!(refused, SessionError::InUse { holder: Some(holder), .. } if holder.token == lease.token));
        assert!(lease.is_held());
        drop(lease);
        assert!(numbers(room.path()).unwrap().is_empty());
    }

    #[test]
    fn who_stood_still_notices_that_another_has_taken_over() {
        let room = tempfile::tempdir().unwrap();
        let first = Lease::take_after(room.path(), false, BEAT, LAPSE).unwrap();
        moved_away(&first, room.path());
        assert!(first.is_held());
        let second = Lease::take_after(room.path(), true, BEAT, LAPSE).unwrap();
        assert!(!first.is_held() && second.is_held());
        // Who gives up what it has lost takes nothing from the other.
        first.give_up();
        drop(first);
        assert!(second.is_held());
        assert_eq!(numbers(room.path()).unwrap(), [1]);
    }

    #[test]
    fn one_of_many_takes_over() {
        let room = tempfile::tempdir().unwrap();
        let first = Lease::take_after(room.path(), false, BEAT, LAPSE).unwrap();
        moved_away(&first, room.path());
        let held = thread::scope(|scope| {
            let takers: Vec<_> =
                (0..8).map(|_| scope.spawn(|| Lease::take_after(room.path(), false, BEAT, LAPSE))).collect();
            let taken: Vec<_> = takers.into_iter().filter_map(|taker| taker.join().unwrap().ok()).collect();
            taken.iter().filter(|lease| lease.is_held()).count()
        });
        assert_eq!(held, 1);
    }

    #[test]
    fn who_ended_while_taking_over_is_in_nobodys_way() {
        let room = tempfile::tempdir().unwrap();
        for number in [3, 4, 6] {
            fs::write(file(room.path(), number), "").unwrap();
        }
        let lease = Lease::take_after(room.path(), true, BEAT, LAPSE).unwrap();
        assert!(lease.is_held());
        assert_eq!(numbers(room.path()).unwrap(), [7]);
    }

    #[test]
    fn a_lease_that_says_nothing_lapses_too() {
        let room = tempfile::tempdir().unwrap();
        fs::write(file(room.path(), 41), "").unwrap();
        let lease = Lease::take_after(room.path(), true, BEAT, LAPSE).unwrap();
        assert!(lease.is_held());
        assert_eq!(numbers(room.path()).unwrap(), [42]);
    }
}
