//! Who writes to a study's folder.

use std::collections::hash_map::RandomState;
use std::fmt;
use std::fs;
use std::hash::{BuildHasher, Hasher};
use std::process::Command;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

/// The process that writes to a folder, as it says itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Holder {
    /// What its machine is called.
    pub host: String,
    /// Its number there.
    pub process: u32,
    /// When it wrote this, in seconds since 1970 by its own clock.
    pub renewed: u64,
    /// How often it has done so.
    pub(super) beat: u64,
    /// What no other process has.
    pub(super) token: String,
    /// Which machine it is, from one start to the next.
    pub(super) machine: String,
    /// In which of the machine's spaces its number is its.
    pub(super) space: String,
    /// When it began, by which another process of its number is told from it.
    pub(super) began: String,
}

impl Holder {
    /// This process.
    pub(super) fn here() -> Self {
        let host = host();
        let process = std::process::id();
        let mut hasher = blake3::Hasher::new();
        // Each of these begins with numbers of the operating system that nobody else has.
        let random = [(); 2].map(|()| RandomState::new().build_hasher().finish());
        hasher.update(format!("{random:?} {host} {process} {}", now()).as_bytes());
        Holder {
            machine: machine(&host),
            space: space(),
            began: began(process).unwrap_or_default(),
            token: hasher.finalize().to_hex()[..32].to_owned(),
            renewed: now(),
            beat: 0,
            host,
            process,
        }
    }

    /// Whether this process runs on the same machine.
    pub(super) fn is_of_this_machine(&self) -> bool {
        self.machine == machine(&host())
    }

    /// Whether it is known to have ended. It must be of this machine.
    pub(super) fn has_ended(&self) -> bool {
        !self.began.is_empty() && self.space == space() && began(self.process).as_ref() != Some(&self.began)
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "process {}", self.process)?;
        if self.is_of_this_machine() { Ok(()) } else { write!(f, " on {}", self.host) }
    }
}

/// Seconds since 1970.
pub(super) fn now() -> u64 {
    SystemTime::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_secs())
}

fn host() -> String {
    let told = fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let told = told.or_else(|| String::from_utf8(Command::new("hostname").output().ok()?.stdout).ok());
    told.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).unwrap_or_else(|| "?".to_owned())
}

/// What tells a machine from others, and from itself after another start: two may have one name.
fn machine(host: &str) -> String {
    fs::read_to_string("/proc/sys/kernel/random/boot_id").map_or(host.to_owned(), |id| id.trim().to_owned())
}

/// Processes in different containers of a machine may have the same number.
fn space() -> String {
    fs::read_link("/proc/self/ns/pid").map_or_else(|_| String::new(), |space| space.to_string_lossy().into_owned())
}

/// When a process began, in the machine's own ticks: what field 22 of its `stat` says. `None` where there is no such
/// process, or nobody says so.
fn began(process: u32) -> Option<String> {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // Field 2 is the name, in parentheses, and may have anything in it. A process that is dead but still listed writes
    // nothing.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace();
    let state = fields.next()?;
    (!["Z", "X"].contains(&state)).then(|| fields.nth(18).map(str::to_owned))?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_ended_is_told_from_one_that_lives() {
        let own = Holder::here();
        assert!(own.is_of_this_machine() && !own.has_ended());
        assert!(own.token != Holder::here().token);
        if cfg!(target_os = "linux") {
            let mut child = Command::new("sleep").arg("60").spawn().unwrap();
            let other = Holder { process: child.id(), began: began(child.id()).unwrap(), ..own.clone() };
            assert!(!other.has_ended());
            child.kill().unwrap();
            child.wait().unwrap();
            assert!(other.has_ended());
            // The number of another process that began later.
            assert!(Holder { began: "1".to_owned(), ..own }.has_ended());
        }
    }
}
