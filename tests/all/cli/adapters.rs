//! Which GPU is taken: by name, number and kind, and what the environment says of drivers.

use std::path::PathBuf;

use serde_json::Value;
use tautline::gpu::{AdapterChoice, Device};

use super::{EVAL, Finished, Folder};

/// The adapters, as the program lists them with these variables of the environment.
fn listed(folder: &Folder, environment: &[(&str, &str)]) -> Value {
    let mut command = folder.command("adapters --json");
    let listed = Finished::of(command.envs(environment.iter().copied()));
    assert_eq!(listed.code, Some(0), "{}", listed.stderr);
    serde_json::from_str(&listed.stdout).unwrap()
}

/// The descriptions of the drivers of the software adapter that is tested on.
fn software_driver() -> PathBuf {
    let named = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].into_iter().find_map(std::env::var_os);
    if let Some(path) = named.as_ref().and_then(|value| std::env::split_paths(value).next()) {
        return path;
    }
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let mut files = files.map(|entry| entry.path());
    files
        .find(|path| path.file_name().unwrap().to_string_lossy().starts_with("lvp_icd"))
        .expect("lavapipe's description")
}

#[test]
#[cfg(target_os = "linux")]
fn two_adapters_of_one_name_are_told_apart() {
    let folder = Folder::hand_made();
    let driver = software_driver();
    // The same driver twice: its library must be named in full from elsewhere.
    let mut description: Value = serde_json::from_slice(&std::fs::read(&driver).unwrap()).unwrap();
    let library = description["ICD"]["library_path"].as_str().unwrap();
    if library.contains('/') {
        description["ICD"]["library_path"] = driver.parent().unwrap().join(library).to_str().unwrap().into();
    }
    folder.write("copy.json", description.to_string());
    let both = std::env::join_paths([driver, folder.path("copy.json")]).unwrap();
    let both = [("VK_DRIVER_FILES", both.to_str().unwrap())];
    let report = listed(&folder, &both);
    let [first, second] = [0, 1].map(|i| report["adapters"][i].clone());
    assert_eq!(
        (&first["name"], first["number"].as_u64(), second["number"].as_u64()),
        (&second["name"], Some(0), Some(1))
    );
    let name = first["name"].as_str().unwrap();
    let part = name.split_whitespace().next().unwrap();
    let run = |adapter: &str| {
        let mut command = folder.command(&format!("{EVAL} --adapter {adapter}"));
        Finished::of(command.envs(both))
    };
    for number in ["0", "1"] {
        let done = run(number);
        assert_eq!(done.code, Some(0), "{}", done.stderr);
        assert!(!done.stderr.contains("note:"), "{}", done.stderr);
    }
    let done = run(part);
    assert!(
        done.stderr.contains("this is number 0") && done.stderr.contains(&format!("takes 1: {name}")),
        "{}",
        done.stderr
    );
    // Of two, there is no third.
    run("2").has_failed(3, "number 2", &["\"2\"", &format!("number 0, {name}"), &format!("number 1, {name}")]);
}

#[test]
fn software_means_lavapipe_or_says_what_was_taken() {
    let folder = Folder::hand_made();
    let device = Device::open(&AdapterChoice::Software).unwrap();
    let done = folder.done(&format!("{EVAL} --adapter software"));
    let taken = format!("engine: gpu on {}\n", device.summary());
    assert!(done.stderr.starts_with(&taken), "{}", done.stderr);
    let note = format!("note: Mesa's lavapipe is not here, so the software adapter is {}\n", device.summary().name);
    assert_eq!(done.stderr.contains(&note), !device.summary().name.starts_with("llvmpipe"), "{}", done.stderr);
}

#[test]
#[cfg(target_os = "linux")]
fn drivers_that_the_environment_names_wrongly_are_told() {
    let folder = Folder::hand_made();
    folder.write(
        "gone.json",
        r#"{"file_format_version": "1.0.0", "ICD": {"library_path": "./no.so", "api_version": "1.1.0"}}"#,
    );
    folder.write("text.json", "no JSON");
    for (file, told) in [
        ("nowhere.json", "which is not there"),
        ("text.json", "which is not JSON"),
        ("gone.json", "no.so\", is not there"),
    ] {
        for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            let path = folder.path(file);
            let command = |args: &str| {
                let mut command = folder.command(args);
                command.env_remove("VK_DRIVER_FILES").env(variable, &path);
                Finished::of(&mut command)
            };
            let parts = [&format!("the environment variable {variable} names {path:?}"), told];
            command(&format!("{EVAL} --engine gpu")).has_failed(3, file, &parts);
            let shown = command("adapters");
            assert_eq!(shown.code, Some(0));
            assert!(parts.iter().all(|part| shown.stdout.contains(*part)), "{}", shown.stdout);
            let report: Value = serde_json::from_str(&command("adapters --json").stdout).unwrap();
            assert_eq!(report["adapters"], serde_json::json!([]));
            let faults = report["driver_faults"].as_array().unwrap();
            assert!(faults.len() == 1 && faults[0].as_str().unwrap().contains(told), "{report}");
            // Whoever asks for no GPU is told why there is none.
            let done = command(EVAL);
            assert!(done.code == Some(0) && done.stderr.contains("engine: cpu, since there is no real GPU here, and "));
            assert!(done.stderr.contains(told), "{}", done.stderr);
        }
    }
    // One that is wrong beside one that is right.
    let both = std::env::join_paths([software_driver(), folder.path("nowhere.json")]).unwrap();
    let mut command = folder.command(&format!("{EVAL} --engine gpu"));
    let done = Finished::of(command.env("VK_DRIVER_FILES", both));
    assert!(done.code == Some(0) && done.stderr.contains("warning: the environment variable"), "{}", done.stderr);
    // And one that is right, but not what was asked for.
    let mut command = folder.command(&format!("{EVAL} --adapter NoSuchThing"));
    let refused = Finished::of(command.env("VK_DRIVER_FILES", software_driver()));
    refused.has_failed(
        3,
        "another",
        &["VK_DRIVER_FILES is set, so the only Vulkan drivers that count are those that it names"],
    );
}
