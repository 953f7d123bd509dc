//! What fuzzing has found, and what it starts from: every file of the corpus goes through its target again.

use std::fs;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};

/// Shared with the fuzzers.
#[path = "../fuzz/bodies/mod.rs"]
pub(crate) mod bodies;

use bodies::{TARGETS, run};

/// What is in a folder beside this one, sorted.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz").join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_file_of_the_corpus_passes() {
    let target = |name: &'static str| {
        let files = files(&format!("corpus/{name}"));
        assert!(files.len() >= 5, "{name} has {} files", files.len());
        let fails = |file: &&PathBuf| {
            let input = fs::read(file).unwrap();
            catch_unwind(|| run(name, &input)).is_err()
        };
        files.iter().filter(fails).map(|file| file.display().to_string()).collect::<Vec<_>>()
    };
    let failed: Vec<String> = std::thread::scope(|scope| {
        let running = TARGETS.map(|(name, _)| scope.spawn(move || target(name)));
        running.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    assert!(failed.is_empty(), "what each of them says is above:\n{}", failed.join("\n"));
}

#[test]
fn every_target_has_its_fuzzer_and_its_corpus() {
    let mut names = TARGETS.map(|target| target.0);
    names.sort_unstable();
    let stems = |folder| files(folder).iter().map(|f| f.file_stem().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(stems("fuzz_targets"), names);
    assert_eq!(stems("corpus"), names);
    for (name, file) in names.iter().zip(files("fuzz_targets")) {
        assert!(fs::read_to_string(file).unwrap().contains(&format!("bodies::run({name:?}, input)")), "{name}");
    }
}
