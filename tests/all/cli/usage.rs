//! Arguments that do not fit together, and outputs that cannot be.

use super::{EVAL, Finished, Folder};

#[test]
fn scene_and_traces_go_together() {
    let folder = Folder::hand_made();
    folder.refused(2, "eval --scene s.geojson --out r.jsonl", &["--scene needs --traces", ".csv", ".parquet"]);
    folder.refused(2, "eval --traces t.csv --out r.jsonl", &["--traces needs --scene"]);
}

#[test]
fn outputs_must_be_files_of_a_known_kind() {
    let folder = Folder::hand_made();
    let all = ".jsonl, .csv or .parquet";
    folder.refused(2, &EVAL.replace("r.jsonl", "r.json"), &["r.json: the extension", all]);
    folder.refused(2, &EVAL.replace("r.jsonl", "r"), &["r: the extension", all]);
    folder.refused(2, &EVAL.replace("e.csv", "e.txt"), &["e.txt: the extension", all]);
    folder.refused(2, &EVAL.replace("r.jsonl", "no/r.jsonl"), &["cannot write no/r.jsonl", "folder no does not exist"]);
    folder.refused(2, &EVAL.replace("e.csv", "t.csv/e.csv"), &["cannot write t.csv/e.csv", "is not a folder"]);
    std::fs::create_dir(folder.path("folder.csv")).unwrap();
    folder.refused(2, &EVAL.replace("e.csv", "folder.csv"), &["cannot write folder.csv", "not a regular file"]);
}

#[test]
fn no_output_replaces_another_file_of_the_same_run() {
    let folder = Folder::hand_made();
    let absolute = folder.path("r.jsonl");
    for events in ["r.jsonl", "./r.jsonl", absolute.to_str().unwrap()] {
        folder.refused(2, &EVAL.replace("e.csv", events), &["--out and --events name the same file", "r.jsonl"]);
    }
    // Neither is there yet.
    folder.refused(2, &EVAL.replace("r.jsonl", "new.csv").replace("e.csv", "./new.csv"), &["the same file", "new.csv"]);
    folder.refused(2, &EVAL.replace("e.csv", "./t.csv"), &["--traces and --events name the same file", "t.csv"]);
    folder.refused(2, &EVAL.replace("r.jsonl", "t.csv"), &["--traces and --out name the same file", "t.csv"]);
}

#[test]
fn unknown_arguments_are_answered_with_the_known_ones() {
    let folder = Folder::hand_made();
    let engines = ["abacus", "--engine", "auto", "gpu", "cpu", "reference", "funnel", "note"];
    folder.refused(2, &format!("{EVAL} --engine abacus"), &engines);
    folder.refused(2, &format!("{EVAL} --on-violation ignore"), &["ignore", "error", "flag"]);
    folder.refused(
        2,
        &format!("{EVAL} --engine cpu --adapter software"),
        &["--adapter goes with --engine gpu or auto"],
    );
    folder.refused(2, &format!("{EVAL} --engine cpu --gpu-memory 1G"), &["--gpu-memory goes with --engine gpu"]);
    for size in ["0M", "12", "M", "1.5G", "12parsecs", "99999999999999999999T"] {
        let fault = [size, "--gpu-memory", "a number of bytes from 1 up, with a unit, such as 512M or 2G"];
        folder.refused(2, &format!("{EVAL} --engine gpu --gpu-memory {size}"), &fault);
    }
    for engine in ["cpu", "reference", "funnel", "note"] {
        let fault = ["precision fast is one of the engine gpu", "--engine gpu"];
        folder.refused(2, &format!("{EVAL} --engine {engine} --precision fast"), &fault);
    }
    folder.refused(2, &format!("{EVAL} --precision exact"), &["exact", "certified", "fast"]);
    folder.refused(2, "evaluate", &["evaluate", "eval"]);
    folder.refused(2, "eval --trace t.csv", &["--trace", "--traces"]);
}

#[test]
fn an_adapter_that_is_not_there_is_answered_with_those_that_are() {
    let folder = Folder::hand_made();
    let listed = folder.done("adapters --json").stdout;
    let listed: serde_json::Value = serde_json::from_str(&listed).unwrap();
    let there = listed["adapters"][0]["name"].as_str().unwrap();
    let parts = ["\"NoSuchThing\"", there, "software", "apt-get install mesa-vulkan-drivers", "dnf install"];
    for engine in ["", "--engine gpu", "--engine auto"] {
        folder.refused(3, &format!("{EVAL} --adapter NoSuchThing {engine}"), &parts);
    }
}

#[test]
fn an_adapter_without_a_name_is_none() {
    let folder = Folder::hand_made();
    for command in [EVAL, "study run", "bench", "tradeoff"] {
        for name in ["", " "] {
            let mut asked = folder.command(command);
            Finished::of(asked.args(["--adapter", name])).has_failed(2, command, &["--adapter", "`tautline adapters`"]);
        }
    }
}

#[test]
fn an_adapter_is_found_by_part_of_its_name() {
    let folder = Folder::hand_made();
    let listed: serde_json::Value = serde_json::from_str(&folder.done("adapters --json").stdout).unwrap();
    let there = listed["adapters"][0]["name"].as_str().unwrap();
    let part = there.split_whitespace().next().unwrap().to_uppercase();
    let done = folder.done(&format!("{EVAL} --adapter {part}"));
    assert!(done.stderr.starts_with("engine: gpu on ") && done.stderr.contains(there), "{}", done.stderr);
}
