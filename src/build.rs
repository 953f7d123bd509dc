//! Notes from which commit the program is built, so that what it writes can say so.

use std::process::Command;

/// What the program is made of; a change in any of these counts as a change of the commit.
const MADE_OF: [&str; 4] = ["src", "shaders", "Cargo.toml", "Cargo.lock"];

fn main() {
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).filter(|hash| !hash.is_empty());
    let status = [&["status", "--porcelain", "--"], &MADE_OF[..]].concat();
    let changed = git(&status).is_some_and(|files| !files.is_empty());
    // Without git, or outside of a repository, nobody knows.
    let commit = commit.map_or("unknown".to_owned(), |hash| hash + if changed { "-changed" } else { "" });
    println!("cargo::rustc-env=TAUTLINE_COMMIT={commit}");
    for path in MADE_OF {
        println!("cargo::rerun-if-changed={path}");
    }
    // Grows with each commit and each change of branch. A file that is not there would have all be built every time.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| std::path::Path::new(log).exists()) {
        println!("cargo::rerun-if-changed={log}");
    }
}

/// What git says, if it is there and content.
fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
