//! How the source is laid out: who may import from whom, and how long files and lines are.

mod imports;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use self::imports::{House, Imports, Module};

/// How long files and lines may be.
const LINES: usize = 400;
const COLUMNS: usize = 120;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files in Rust and all shaders under a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder is read") {
        let path = entry.expect("an entry is read").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "wgsl") {
            found.push(path);
        }
    }
    found
}

fn imports() -> Imports {
    House::read(&root().join("src")).imports()
}

/// The rooms of docs/architecture.md, from the ground floor up.
fn rooms() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("docs/architecture.md")).expect("docs/architecture.md");
    let section = text.split("\n## ").find(|section| section.starts_with("Rooms\n")).expect("a section on rooms");
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    rows.map(|(room, _)| room.to_owned()).collect()
}

/// The files that can be reached from `from` along imports.
fn reached<'a>(imports: &'a Imports, from: &Module) -> BTreeSet<&'a Module> {
    let mut seen = BTreeSet::new();
    let mut next: Vec<&Module> = imports[from].keys().collect();
    while let Some(module) = next.pop() {
        if seen.insert(module) {
            next.extend(imports[module].keys());
        }
    }
    seen
}

/// A line for each import that is at fault.
fn told(imports: &Imports, is_fault: impl Fn(&Module, &Module) -> bool) -> String {
    let mut told = String::new();
    for (module, from) in imports {
        for (other, names) in from.iter().filter(|(other, _)| is_fault(module, other)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            told += &format!("  {} takes {} from {}\n", module.join("/"), names.join(", "), other.join("/"));
        }
    }
    told
}

#[test]
fn no_file_imports_from_itself_by_way_of_others() {
    let imports = imports();
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = imports.keys().map(|m| (m, reached(&imports, m))).collect();
    let circles = told(&imports, |module, other| reached[other].contains(module));
    assert!(circles.is_empty(), "circles among files:\n{circles}");
}

#[test]
fn rooms_import_only_from_rooms_before_them() {
    let (imports, rooms) = (imports(), rooms());
    let there: BTreeSet<&String> = imports.keys().filter_map(|module| module.first()).collect();
    let listed: BTreeSet<&String> = rooms.iter().collect();
    assert_eq!(there, listed, "docs/architecture.md lists other rooms than there are");
    let floor = |module: &Module| rooms.iter().position(|room| Some(room) == module.first());
    // What the library passes on at its root has no floor.
    let upwards = told(&imports, |module, other| floor(module).is_some() && floor(other) > floor(module));
    assert!(upwards.is_empty(), "imports from rooms that come later:\n{upwards}");
}

#[test]
fn files_and_lines_are_short() {
    let mut faults = String::new();
    for path in [sources(&root().join("src")), sources(&root().join("shaders"))].concat() {
        let text = std::fs::read_to_string(&path).expect("a source file is read");
        let path = path.strip_prefix(root()).expect("under the root").display().to_string();
        if text.lines().count() > LINES {
            faults += &format!("  {path}: {} lines\n", text.lines().count());
        }
        for (i, line) in text.lines().enumerate().filter(|(_, line)| line.chars().count() > COLUMNS) {
            faults += &format!("  {path}:{}: {} columns\n", i + 1, line.chars().count());
        }
    }
    assert!(faults.is_empty(), "longer than {LINES} lines or {COLUMNS} columns:\n{faults}");
}
