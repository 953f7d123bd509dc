//! What is fuzzed: a function for each target, which takes any bytes and must neither panic nor hang nor take much
//! memory. Fuzzers call them with what they make up, and `tests/all/corpus.rs` with what they have found.

pub(crate) mod engines;
mod recipe;
pub(crate) mod scenes;
mod studies;
mod traces;

use std::path::Path;

use tempfile::TempDir;

/// What is done with an input, in a folder that it may use.
type Body = fn(&[u8], &Path);

/// All targets by name. Each has a file in `fuzz_targets` and a folder in `corpus` of that name.
pub(crate) const TARGETS: [(&str, Body); 13] = [
    ("geojson", |input, folder| scenes::read("scene.geojson", input, folder)),
    ("wkt", |input, folder| scenes::read("scene.wkt", input, folder)),
    ("svg", |input, folder| scenes::read("scene.svg", input, folder)),
    ("dxf", |input, folder| scenes::read("scene.dxf", input, folder)),
    ("movingai", |input, folder| scenes::read("scene.map", input, folder)),
    ("ros_map", scenes::read_ros_map),
    ("csv", |input, folder| traces::read("traces.csv", input, folder)),
    ("parquet", |input, folder| traces::read("traces.parquet", input, folder)),
    ("study", studies::read),
    ("state", studies::load),
    ("results", studies::merge),
    ("cpu", |input, _| engines::cpu(input)),
    ("gpu", |input, _| engines::gpu(input)),
];

/// Does with `input` what target `name` does.
pub(crate) fn run(name: &str, input: &[u8]) {
    thread_local! {
        // One for all inputs, since most are done sooner than a folder is made.
        static FOLDER: TempDir = tempfile::tempdir().expect("a folder for files");
    }
    let (_, body) = TARGETS.iter().find(|target| target.0 == name).expect("a target of that name");
    FOLDER.with(|folder| body(input, folder.path()));
}
