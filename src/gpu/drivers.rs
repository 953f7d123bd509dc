//! What the environment tells the Vulkan loader about drivers, and what is wrong with it: the loader passes over in
//! silence what it cannot read.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

/// The variables that say which drivers there are: of the first two, the loader takes the first that is set, and else
/// it looks for drivers where the system keeps them, to which it adds those of the last.
const INSTEAD: [&str; 2] = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"];
const BESIDE: &str = "VK_ADD_DRIVER_FILES";

/// Those that hide drivers by name.
const HIDING: [&str; 2] = ["VK_LOADER_DRIVERS_SELECT", "VK_LOADER_DRIVERS_DISABLE"];

/// A driver's description is some hundred bytes.
const LARGEST: u64 = 1 << 20;

/// What is wrong with the Vulkan drivers that the environment names (`VK_DRIVER_FILES`, or `VK_ICD_FILENAMES` where
/// that is not set; else `VK_ADD_DRIVER_FILES`), a sentence each: descriptions that are not there, or are none, and
/// libraries that are not there. Nothing where the environment names none.
pub fn driver_faults() -> Vec<String> {
    let variable = INSTEAD.into_iter().find(|name| std::env::var_os(name).is_some()).unwrap_or(BESIDE);
    std::env::var_os(variable).map_or_else(Vec::new, |value| faults(variable, &value))
}

/// What to say about the environment where an adapter is missing: the faults, or what narrows the choice.
pub(super) fn advice() -> String {
    let mut advice = driver_faults();
    let narrows = |name: &&str| std::env::var_os(name).is_some();
    if advice.is_empty() {
        advice.extend(INSTEAD.iter().find(|name| narrows(name)).map(|name| {
            format!(
                "the environment variable {name} is set, so the only Vulkan drivers that count are those that it names"
            )
        }));
    }
    advice.extend(
        HIDING
            .iter()
            .filter(|name| narrows(name))
            .map(|name| format!("the environment variable {name} is set, which hides Vulkan drivers")),
    );
    advice.into_iter().map(|sentence| sentence + ". ").collect()
}

fn faults(variable: &str, value: &OsStr) -> Vec<String> {
    let named: Vec<PathBuf> = std::env::split_paths(value).filter(|path| !path.as_os_str().is_empty()).collect();
    if named.is_empty() {
        // Added to what there is, nothing changes nothing.
        let instead = variable != BESIDE;
        return instead
            .then(|| format!("the environment variable {variable} is set but names no driver"))
            .into_iter()
            .collect();
    }
    named
        .iter()
        .filter_map(|path| Some(format!("the environment variable {variable} names {path:?}, {}", fault(path)?)))
        .collect()
}

/// What is wrong with a description, or a folder of them, as a relative clause.
fn fault(path: &Path) -> Option<String> {
    let about = match fs::metadata(path) {
        Ok(about) => about,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Some("which is not there".to_owned()),
        Err(error) => return Some(format!("which cannot be read: {error}")),
    };
    let is_json = |path: &Path| path.extension().is_some_and(|extension| extension == "json");
    if about.is_dir() {
        let entries = match fs::read_dir(path) {
            Ok(entries) => entries,
            Err(error) => return Some(format!("which cannot be read: {error}")),
        };
        let mut files: Vec<PathBuf> =
            entries.flatten().map(|entry| entry.path()).filter(|path| is_json(path)).collect();
        files.sort();
        if files.is_empty() {
            return Some("a folder without a description of a driver (.json)".to_owned());
        }
        return files.iter().find_map(|file| Some(format!("a folder with {file:?}, {}", described(file)?)));
    }
    if !is_json(path) {
        return Some("whose name does not end in .json: the Vulkan loader passes it over".to_owned());
    }
    described(path)
}

/// What is wrong with a description of a driver.
fn described(path: &Path) -> Option<String> {
    match fs::metadata(path) {
        Ok(about) if !about.is_file() => return Some("which is no file".to_owned()),
        Ok(about) if about.len() > LARGEST => {
            return Some("which is too large for the description of a driver".to_owned());
        }
        _ => {}
    }
    let text = match fs::read(path) {
        Ok(text) => text,
        Err(error) => return Some(format!("which cannot be read: {error}")),
    };
    let description: Value = match serde_json::from_slice(&text) {
        Ok(description) => description,
        Err(error) => return Some(format!("which is not JSON: {error}")),
    };
    if !description["file_format_version"].is_string() {
        return Some("which describes no driver: it has no \"file_format_version\"".to_owned());
    }
    let Some(library) = description["ICD"]["library_path"].as_str() else {
        return Some("which describes no driver: it has no \"ICD\" with a \"library_path\"".to_owned());
    };
    // A bare name is looked for wherever the system keeps libraries, which only the system knows.
    if !library.contains(['/', '\\']) {
        return None;
    }
    let place = path.parent().unwrap_or(Path::new("")).join(library);
    match fs::metadata(&place) {
        Ok(about) if about.is_file() => None,
        Ok(_) => Some(format!("whose library, {place:?}, is no file")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Some(format!("whose library, {place:?}, is not there"))
        }
        Err(error) => Some(format!("whose library, {place:?}, cannot be read: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_name_a_driver_wrongly_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| fs::write(path(name), text).unwrap();
        write("lib.so", "");
        fs::create_dir(path("empty")).unwrap();
        fs::create_dir(path("full")).unwrap();
        fs::create_dir(path("is.json")).unwrap();
        let description = |library: &str| {
            format!(
                r#"{{"file_format_version": "1.0.0", "ICD": {{"library_path": "{library}", "api_version": "1.1.0"}}}}"#
            )
        };
        write("good.json", &description("./lib.so"));
        write("bare.json", &description("libvulkan_lvp.so"));
        write("gone.json", &description("./gone.so"));
        write("folder.json", &description("./empty"));
        write("good.txt", &description("./lib.so"));
        write("text.json", "no JSON");
        write("old.json", r#"{"ICD": {"library_path": "./lib.so"}}"#);
        write("none.json", r#"{"file_format_version": "1.0.0", "ICD": {}}"#);
        write("full/gone.json", &description("./gone.so"));
        for (name, told) in [
            ("good.json", None),
            ("bare.json", None),
            ("missing.json", Some("missing.json\", which is not there")),
            ("gone.json", Some("gone.so\", is not there")),
            ("folder.json", Some("empty\", is no file")),
            ("good.txt", Some("does not end in .json")),
            ("text.json", Some("which is not JSON: expected ident at line 1 column 2")),
            ("old.json", Some("no \"file_format_version\"")),
            ("none.json", Some("no \"ICD\" with a \"library_path\"")),
            ("empty", Some("a folder without a description of a driver")),
            ("is.json", Some("a folder without a description of a driver")),
            ("full", Some("gone.so\", is not there")),
        ] {
            let found = faults("VK_DRIVER_FILES", path(name).as_os_str());
            match (told, &found[..]) {
                (None, []) => {}
                (Some(told), [fault]) => {
                    assert!(fault.starts_with("the environment variable VK_DRIVER_FILES names \""), "{fault}");
                    assert!(fault.contains(name) && fault.contains(told), "{told:?} is missing in {fault}");
                }
                _ => panic!("{name}: {found:?}"),
            }
        }
        // Of several, each that is wrong is named.
        let all = std::env::join_paths(["good.json", "missing.json", "gone.json"].map(path)).unwrap();
        assert_eq!(faults("VK_ICD_FILENAMES", &all).len(), 2);
        assert_eq!(faults("VK_DRIVER_FILES", OsStr::new("")).len(), 1);
        assert_eq!(faults("VK_ADD_DRIVER_FILES", OsStr::new("")).len(), 0);
    }
}
