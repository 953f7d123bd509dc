//! How the source is laid out: who may import from whom, and how long files and lines are.

mod imports;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use self::imports::{House, Imports, Module};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files under a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder is read") {
        let path = entry.expect("an entry is read").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// The files that can be reached from `from` along imports.
fn reached<'a>(imports: &'a Imports, from: &'a Module) -> BTreeSet<&'a Module> {
    let mut seen = BTreeSet::new();
    let mut next: Vec<&Module> = imports[from].keys().collect();
    while let Some(module) = next.pop() {
        if seen.insert(module) {
            next.extend(imports[module].keys());
        }
    }
    seen
}

#[test]
fn no_file_imports_from_itself_in_a_circle() {
    let imports = House::read(&root().join("src")).imports();
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = imports.keys().map(|m| (m, reached(&imports, m))).collect();
    let mut circles = String::new();
    for (module, from) in &imports {
        for (other, names) in from {
            if reached[other].contains(module) {
                let names = names.iter().cloned().collect::<Vec<_>>().join(", ");
                circles += &format!("  {} takes from {}: {names}\n", module.join("/"), other.join("/"));
            }
        }
    }
    assert!(circles.is_empty(), "in a circle:\n{circles}");
}

#[test]
fn rooms_print() {
    let imports = House::read(&root().join("src")).imports();
    let mut rooms: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (module, from) in &imports {
        for (other, names) in from {
            if module.first() != other.first() {
            rooms.entry(module.first().map_or("lib", |s| s)).or_default().insert(other.first().map_or("lib", |s| s)); } } }
    for (r, f) in &rooms { println!("{r}: {f:?}"); }
}
