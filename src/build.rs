//! Notes from which commit the program is built, so that what it writes can say so.

use std::path::Path;
use std::process::Command;

/// What the program is made of; a change in any of these counts as a change of the commit.
const MADE_OF: [&str; 4] = ["src", "shaders", "Cargo.toml", "Cargo.lock"];

/// What cargo puts into a packaged crate: the commit that it was packaged from.
const PACKAGED: &str = ".cargo_vcs_info.json";

fn main() {
    // A packaged crate may lie within some other repository.
    let commit = packaged().or_else(checked_out).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=TAUTLINE_COMMIT={commit}");
    for path in MADE_OF {
        println!("cargo::rerun-if-changed={path}");
    }
    // Grows with each commit and each change of branch. A file that is not there would have all be built every time.
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"]);
    for path in log.iter().map(String::as_str).chain([PACKAGED]).filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// The commit of a packaged crate, with `-changed` if the files were not those of the commit.
fn packaged() -> Option<String> {
    let info = std::fs::read_to_string(PACKAGED).ok()?;
    let (_, from) = info.split_once("\"sha1\"")?;
    let hash = from.split('"').nth(1).filter(|hash| hash.len() >= 12 && hash.bytes().all(|b| b.is_ascii_hexdigit()))?;
    Some(hash[..12].to_owned() + if info.contains("\"dirty\": true") { "-changed" } else { "" })
}

/// The same of a repository; `None` without git, or outside of one: nobody knows then.
fn checked_out() -> Option<String> {
    let hash = git(&["rev-parse", "--short=12", "HEAD"]).filter(|hash| !hash.is_empty())?;
    let status = [&["status", "--porcelain", "--"], &MADE_OF[..]].concat();
    let changed = git(&status).is_some_and(|files| !files.is_empty());
    Some(hash + if changed { "-changed" } else { "" })
}

/// What git says, if it is there and content.
fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
