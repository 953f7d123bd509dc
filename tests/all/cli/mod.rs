//! The program as its users run it: arguments and files in; files, messages and exit codes out.

mod adapters;
mod batches;
mod bench;
mod by_obstacle;
mod chosen;
mod classes;
mod convert;
mod describe;
mod draw;
mod ends;
mod engines;
mod extremes;
mod faults;
mod friction;
mod newcomer;
mod outputs;
mod process;
mod queries;
mod reports;
mod results;
mod safety;
mod scenes;
mod schema;
mod steps;
mod study;
mod study_rule;
mod study_shared;
mod study_sweep;
mod tether;
mod traces;
mod trade;
mod tradeoff;
mod usage;
mod words;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use serde_json::json;
use tautline::example::{Walker, floor_plan, walks};
use tautline::scene::Model;
use tempfile::TempDir;

/// Two walls whose ends lie at whole distances from each other and from the anchor in the origin. Vertices 0 to 3 are
/// (3, 4), (3, -4), (6, 0) and (5.5, -9).
const SCENE: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[3, 4], [3, -4]]}},
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[6, 0], [5.5, -9]]}},
{"type": "Feature", "properties": {"role": "anchor"}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
]}
"#;

/// Trace 0 goes round both walls clockwise, 4 there and back, 5 round the first wall counter-clockwise, 7 stays put.
const TRACES: &str = "trace,x,y\n\
    0,0,0\n0,0,12\n0,5,12\n0,5,4\n0,11,4\n0,11,-12\n0,6,-12\n\
    4,0,12\n4,5,12\n4,5,4\n4,5,12\n4,0,12\n\
    5,0,-12\n5,5,-12\n5,5,-4\n\
    7,0,0\n";

/// Evaluates the files that [`Folder::hand_made`] writes, onto two that are there already.
const EVAL: &str = "eval --scene s.geojson --traces t.csv --out r.jsonl --events e.csv";

/// A folder of its own in which the program is run.
struct Folder(TempDir);

/// How a run ended.
struct Finished {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Folder {
    /// An empty folder.
    fn new() -> Self {
        Folder(tempfile::tempdir().unwrap())
    }

    /// [`SCENE`], [`TRACES`], and results and events of an earlier run.
    fn hand_made() -> Self {
        let folder = Folder::new();
        folder.write("s.geojson", SCENE);
        folder.write("t.csv", TRACES);
        folder.write("r.jsonl", "old results");
        folder.write("e.csv", "old events");
        folder
    }

    /// The floor plan as `s.geojson` and walks in it as `t.csv`.
    fn floor_plan(traces: u64, steps: usize) -> Self {
        let model = Model::new(floor_plan(), None).unwrap();
        let scene = model.scene();
        let walls: Vec<_> = (0..scene.walls().len()).map(|w| scene.ends(w).map(|p| p.to_array())).collect();
        let document = json!({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {}, "geometry": {"type": "MultiLineString", "coordinates": walls}},
            {"type": "Feature", "properties": {"role": "anchor"},
                "geometry": {"type": "Point", "coordinates": model.anchor().to_array()}},
        ]});
        let mut rows = "trace,x,y\n".to_owned();
        for trace in walks(&model, Walker { step: 0.25, steps, seed: 7 }, traces) {
            for p in &trace.points {
                writeln!(rows, "{},{},{}", trace.id, p.x, p.y).unwrap();
            }
        }
        let folder = Folder::new();
        folder.write("s.geojson", document.to_string());
        folder.write("t.csv", rows);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// Every file, hidden ones too, with its contents.
    fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let entries = fs::read_dir(self.0.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        entries.filter(|name| self.path(name).is_file()).map(|name| (name.clone(), self.read(&name))).collect()
    }

    /// The program in this folder with `args`, which are separated by spaces.
    fn command(&self, args: &str) -> Command {
        let mut command = Command::new(cargo_bin!("tautline"));
        command.current_dir(self.0.path()).args(args.split_whitespace());
        command
    }

    fn run(&self, args: &str) -> Finished {
        Finished::of(&mut self.command(args))
    }

    /// Runs a command that must succeed.
    fn done(&self, args: &str) -> Finished {
        let finished = self.run(args);
        assert_eq!(finished.code, Some(0), "{args}: {}", finished.stderr);
        finished
    }

    /// Runs a command that must fail with `code` and one error that has all `parts` in it, and that may leave nothing
    /// behind and nothing changed.
    fn refused(&self, code: i32, args: &str, parts: &[&str]) {
        let before = self.files();
        self.run(args).has_failed(code, args, parts);
        assert!(self.files() == before, "{args} left {:?} where there were {:?}", self.files().keys(), before.keys());
    }
}

impl Finished {
    /// Runs `command` to its end.
    fn of(command: &mut Command) -> Self {
        command.output().unwrap().into()
    }

    fn has_failed(&self, code: i32, what: &str, parts: &[&str]) {
        assert_eq!(self.code, Some(code), "{what}: {}{}", self.stdout, self.stderr);
        assert_eq!(self.stdout, "", "{what}");
        let errors = self.stderr.lines().filter(|line| line.starts_with("error:"));
        assert_eq!(errors.count(), 1, "{what}: {}", self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "{what}: {part:?} is missing in\n{}", self.stderr);
        }
    }
}

impl From<Output> for Finished {
    fn from(output: Output) -> Self {
        let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        Finished { code: output.status.code(), stdout, stderr }
    }
}
