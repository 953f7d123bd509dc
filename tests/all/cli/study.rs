//! Monte-Carlo studies: the same answer however they are run.

use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{Finished, Folder};

/// A study of several blocks, with two anchors, of which the last is smaller than the others.
const STUDY: &str = r#"
[scene]
built_in = "rooms"
anchor = { sample = 3 }
[walk]
kind = "persistent"
step = 0.25
steps = 200
start = "visible"
[run]
traces = 5350
block = 250
[tallies]
limits = [5.0, 20.0]
"#;

fn study() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", STUDY);
    folder
}

/// The files of a run's answer.
fn answer(folder: &Folder, run: &str) -> Vec<u8> {
    folder.read(&format!("{run}/summary.json"))
}

fn json(folder: &Folder, path: &str) -> Value {
    serde_json::from_str(&folder.text(path)).unwrap()
}

#[test]
fn the_answer_is_the_same_on_all_engines_threads_and_shards() {
    let folder = study();
    folder.done("study run s.toml --out a --engine cpu");
    let truth = answer(&folder, "a");
    let summary = json(&folder, "a/summary.json");
    assert_eq!((summary["traces"].as_u64(), summary["blocks"].as_u64()), (Some(5350), Some(22)));
    assert!(summary["events"].as_u64().unwrap() > 1000 && !summary["obstacles"].as_array().unwrap().is_empty());
    for (out, engine) in
        [("reference", "reference"), ("gpu", "gpu --adapter software"), ("all", "gpu-rays --adapter software")]
    {
        folder.done(&format!("study run s.toml --out {out} --engine {engine}"));
        assert!(answer(&folder, out) == truth, "{engine}");
    }
    let [scene, by_reference, with_all] = ["a", "reference", "all"].map(|out| {
        let scene = json(&folder, &format!("{out}/run.json"))["scene"].take();
        [scene["vertices"].as_u64(), scene["remaining"][0].as_u64()]
    });
    assert!(scene[1] > Some(0) && scene[1] < scene[0], "{scene:?}");
    assert_eq!((by_reference, with_all), ([scene[0], None], [scene[0]; 2]));
    let one = Finished::of(folder.command("study run s.toml --out one").env("RAYON_NUM_THREADS", "1"));
    assert_eq!(one.code, Some(0), "{}", one.stderr);
    assert!(answer(&folder, "one") == truth, "one thread");

    for k in 0..3 {
        folder.done(&format!("study run s.toml --out k{k} --shard {k}/3"));
    }
    folder.done("study merge k2 k0 k1 --out whole");
    assert!(answer(&folder, "whole") == truth, "merged");
    // A merged study is a study like others.
    folder.done("study show whole");
    folder.refused(2, "study merge k0 k1 --out no", &["shard 2/3 is missing"]);
    folder.refused(2, "study merge k0 k2 --out no", &["shard 1/3 is missing"]);
    folder.refused(2, "study merge k0 k1 k1 k2 --out no", &["shard 1/3 is there twice"]);
    folder.done("study run s.toml --out q --shard 3/4");
    folder.refused(2, "study merge k0 k1 k2 q --out no", &["q: block 3 is in k0 too"]);
    folder.done("study run s.toml --out other --seed 2 --shard 1/3");
    assert!(answer(&folder, "other") != answer(&folder, "k1"));
    folder.refused(2, "study merge k0 other k2 --out no", &["another study"]);
    assert!(!folder.path("no").exists());
}

#[test]
fn a_study_killed_at_any_moment_goes_on_and_ends_the_same() {
    let folder = study();
    let long = STUDY.replace("5350", "60000");
    folder.write("long.toml", &long);
    folder.done("study run long.toml --out a --engine cpu");
    let mut run = "run long.toml --out b".to_owned();
    for (round, by_hand) in [true, false, true, false].into_iter().enumerate() {
        let mut command = folder.command(&format!("study {run} --engine cpu"));
        let mut child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let start = Instant::now();
        while !folder.path("b/state.bin").exists() && start.elapsed() < Duration::from_secs(60) {
            sleep(Duration::from_millis(5));
        }
        sleep(Duration::from_millis(60 * round as u64));
        if by_hand {
            std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
            let code = child.wait().unwrap().code();
            // Its first state is there once it listens. Later it may not have got so far, or be done.
            assert!(code == Some(4) || (round > 0 && [None, Some(0)].contains(&code)), "{code:?}");
        } else {
            child.kill().unwrap();
            child.wait().unwrap();
        }
        run = "resume b".to_owned();
    }
    folder.done("study resume b --engine cpu");
    assert!(answer(&folder, "b") == answer(&folder, "a"));
    // One that is done stays as it is.
    folder.done("study resume b --engine cpu");
    assert!(answer(&folder, "b") == answer(&folder, "a"));
}

#[test]
fn states_that_are_damaged_or_foreign_are_refused() {
    let folder = study();
    folder.done("study run s.toml --out a --count 500");
    let state = folder.read("a/state.bin");
    let mut flipped = state.clone();
    let middle = state.len() / 2;
    flipped[middle] ^= 1;
    let other = "tautline study state 9\n".as_bytes().to_vec();
    for (bytes, why) in [
        (flipped, "check sum"),
        (state[..30].to_vec(), "ends too early"),
        (state[..state.len() - 1].to_vec(), "check sum"),
        (Vec::new(), "not the state of a study"),
        (other, "another version"),
    ] {
        folder.write("a/state.bin", bytes);
        folder.refused(2, "study resume a", &["a/state.bin: ", why]);
        folder.refused(2, "study show a", &["a/state.bin: ", why]);
    }
    folder.write("a/state.bin", &state);
    let changed = folder.text("a/study.json").replace("\"seed\": 1", "\"seed\": 2");
    folder.write("a/study.json", changed);
    folder.refused(2, "study resume a", &["another study"]);
    folder.refused(2, "study run s.toml --out a", &["holds a study already", "study resume a"]);
}

#[test]
fn a_study_ends_when_it_is_certain_enough() {
    let folder = study();
    folder.write("u.toml", format!("{STUDY}[until]\nrelative_error = 0.02\n"));
    folder.done("study run u.toml --out a --engine cpu");
    folder.done("study run u.toml --out b --engine reference");
    assert!(answer(&folder, "a") == answer(&folder, "b"));
    let summary = json(&folder, "a/summary.json");
    assert_eq!(summary["stopped"], "relative_error");
    let traces = summary["traces"].as_u64().unwrap();
    assert!(traces < 5350 && traces.is_multiple_of(250), "{traces}");
    let mean = &summary["scalars"][1]["mean"];
    let [value, high] = ["value", "high"].map(|k| mean[k].as_f64().unwrap());
    assert!(high - value <= 0.02 * value);
    // One block less was not enough.
    let short = folder.run(&format!("study run u.toml --out c --traces {}", traces - 250));
    assert_eq!(short.code, Some(5), "{}", short.stderr);
    assert!(short.stderr.contains("relative_error") && folder.path("c/summary.json").exists());
    folder.write("v.toml", format!("{STUDY}[until]\nseconds = 5\n"));
    // What the clock ends is not shared out, by whatever name, and no script is written that would try.
    for share in ["run v.toml --out d --shard 0/2", "run v.toml --out d --blocks 0..3", "script slurm v.toml"] {
        folder.refused(2, &format!("study {share}"), &["v.toml", "until.seconds: how far", "--stop-after"]);
    }
    folder.write("s.toml", format!("{STUDY}[until]\nseconds = 5\n[sweep]\nwalk.step = [0.3, 0.4]\n"));
    for share in ["run s.toml --out d --shard 0/2", "script parallel s.toml"] {
        folder.refused(2, &format!("study {share}"), &["s.toml", "until.seconds: how far"]);
    }
    assert!(!folder.path("d").exists());
}

/// Trace and length of each row of `traces.parquet`.
pub(super) fn rows(folder: &Folder, run: &str) -> Vec<(u64, f64)> {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;
    assert!(!folder.path(run).join("traces").exists(), "the parts are still there");
    let file = std::fs::File::open(folder.path(run).join("traces.parquet")).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
    let note = |key| notes.iter().find(|note| note.key == key).and_then(|note| note.value.clone()).unwrap();
    assert_eq!((note("tautline.seed").as_str(), note("tautline.version").as_str()), ("1", env!("CARGO_PKG_VERSION")));
    let summary = json(folder, &format!("{run}/summary.json"));
    assert_eq!(summary["identity"], note("tautline.study"));
    let rows = reader.get_row_iter(None).unwrap().map(Result::unwrap);
    rows.map(|row| (row.get_ulong(0).unwrap(), row.get_double(3).unwrap())).collect()
}

#[test]
fn rows_are_whole_after_a_stop() {
    let folder = study();
    folder.write("t.toml", format!("{}[outputs]\ntraces = true\npictures = false\n", STUDY.replace("5350", "40000")));
    folder.done("study run t.toml --out a");
    let whole = rows(&folder, "a");
    assert!(whole.iter().map(|row| row.0).eq(0..40_000));
    let mut child =
        folder.command("study run t.toml --out b").stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    while !folder.path("b/traces").exists() {
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(100));
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    child.wait().unwrap();
    folder.done("study resume b");
    assert!(rows(&folder, "b") == whole);
    // One that is done stays as it is.
    folder.done("study resume b");
    assert!(rows(&folder, "b") == whole);
    for k in 0..2 {
        folder.done(&format!("study run t.toml --out k{k} --shard {k}/2"));
    }
    folder.done("study merge k0 k1 --out merged");
    assert!(rows(&folder, "merged") == whole);
    let mean = whole.iter().map(|row| row.1).sum::<f64>() / 40_000.0;
    let told = json(&folder, "a/summary.json")["scalars"][0]["mean"]["value"].as_f64().unwrap();
    assert!((mean - told).abs() < 1e-9 * mean);
}

#[test]
fn one_trace_is_replayed() {
    let folder = study();
    folder.done("study run s.toml --out a --count 500");
    let told = folder.done("study replay a --trace 7 --events e.jsonl").stdout;
    assert!(told.starts_with("trace 7: 200 steps, "), "{told}");
    let events = folder.text("e.jsonl").lines().count();
    assert!(told.contains(&format!(" {events} events")), "{told} {events}");
    folder.refused(2, "study replay a --trace 500", &["0 to 499"]);

    folder.done("study replay a --trace 7 --draw d.svg --step 150");
    assert!(folder.text("d.svg").contains("Trace 7 after step 150 of 200"));
    folder.done("study replay a --trace 7 --draw d.html");
    assert!(folder.text("d.html").contains("<script>"));
    folder.refused(2, "study replay a --trace 7 --draw d.gif --events f.jsonl", &["d.gif: the extension"]);
    folder.refused(2, "study replay a --trace 7 --step 3", &["--draw"]);
    folder.refused(2, "study replay a --trace 7 --draw e.svg --step 201", &["trace 7 ends with step 200"]);
}

#[test]
fn the_precision_belongs_to_a_study() {
    let folder = study();
    let text = STUDY.replace("traces = 5350", "traces = 500\nprecision = \"fast\"");
    folder.write("f.toml", &text);
    folder.done("study run f.toml --out a --adapter software");
    folder.done("study run s.toml --count 500 --precision fast --out b --engine gpu --adapter software");
    folder.done("study run f.toml --precision certified --out c --engine cpu");
    folder.done("study run s.toml --count 500 --out d --engine cpu");
    let precision = |run: &str| {
        let [answer, cost] = ["summary", "run"].map(|name| json(&folder, &format!("{run}/{name}.json")));
        assert_eq!(answer["study"]["run"]["precision"], cost["precision"]);
        (cost["precision"].as_str().unwrap().to_owned(), answer["identity"].clone())
    };
    let [a, b, c, d] = ["a", "b", "c", "d"].map(precision);
    assert_eq!(["fast", "certified"], [&*a.0, &*c.0]);
    assert!(a == b && c == d && a.1 != c.1, "{a:?} {b:?} {c:?} {d:?}");
    assert!(answer(&folder, "a") == answer(&folder, "b") && answer(&folder, "c") == answer(&folder, "d"));
    assert!(folder.done("study replay a --trace 7").stdout.starts_with("trace 7: 200 steps, "));
    // What was begun with one precision goes on with that.
    folder.refused(2, "study resume a --precision certified", &["begun with precision fast"]);
    folder.refused(2, "study resume a --engine cpu", &["precision fast is one of the engine gpu"]);
    folder.refused(2, "study run f.toml --out no --engine cpu", &["precision fast is one of the engine gpu"]);
    assert!(!folder.path("no").exists());
    folder.write("wrong.toml", text.replace("\"fast\"", "\"exact\""));
    folder.refused(2, "study run wrong.toml --out no", &["line ", "exact", "certified", "fast"]);
}

#[test]
fn given_traces_are_studied_too() {
    let folder = Folder::floor_plan(700, 50);
    folder.write(
        "g.toml",
        "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\ntraces = 700\nblock = 64\n",
    );
    folder.done("study run g.toml --out a");
    for k in 0..2 {
        folder.done(&format!("study run g.toml --out k{k} --shard {k}/2"));
    }
    folder.done("study merge k0 k1 --out b");
    assert!(answer(&folder, "a") == answer(&folder, "b"));
    assert_eq!(json(&folder, "a/summary.json")["traces"], 700);
    let results = folder.done("eval --scene s.geojson --traces t.csv --json").stdout;
    let report: Value = serde_json::from_str(&results).unwrap();
    let mean = json(&folder, "a/summary.json")["scalars"][0]["mean"]["value"].as_f64().unwrap();
    assert!((report["length"]["mean"].as_f64().unwrap() - mean).abs() < 1e-9 * mean);
    folder.refused(2, "study run g.toml --out c --count 701", &["t.csv: ", "the file holds 700"]);
    folder.refused(2, "study run g.toml --out d --count 9000 --shard 3/4", &["t.csv: ", "the file holds 700"]);
}

#[test]
fn faults_in_a_study_are_named() {
    let folder = study();
    for (from, to, parts) in [
        ("steps = 200", "stpes = 200", ["s.toml: line 8: walk.stpes: ", "did you mean `steps`?"]),
        ("\"rooms\"", "\"romms\"", ["s.toml: line 3: scene.built_in", "romms"]),
        ("step = 0.25", "step = -1.0", ["s.toml: line 7: walk.step", "-1 is no length"]),
        ("block = 250", "block = 0", ["s.toml: line 10: run", "at least 1"]),
        ("sample = 3", "sample = 0", ["anchor", "1 to 1024"]),
    ] {
        folder.write("s.toml", STUDY.replacen(from, to, 1));
        folder.refused(2, "study run s.toml --out a", &parts);
    }
    folder.refused(2, "study run no.toml", &["no.toml"]);
    folder.refused(2, "study resume no", &["no/study.json"]);
    folder.refused(2, "study run s.toml --shard 3/3", &["K/N"]);
    folder.write("s.toml", STUDY);
    let told = folder.done("study run s.toml --dry-run").stdout;
    assert!(told.contains("5350 traces in 22 blocks"), "{told}");
    folder.done("study init new.toml");
    folder.refused(2, "study init new.toml", &["new.toml"]);
    folder.done("study run new.toml --count 100 --out b");
    assert!(folder.done("study schema").stdout.contains("\"walk\""));
}

#[test]
fn anchors_are_sampled_where_the_scene_marks_one() {
    let folder = Folder::new();
    folder.write("w.wkt", "LINESTRING (1 1, 2 2)");
    let text =
        "[scene]\nfile = \"w.wkt\"\nanchor = { sample = 3 }\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 9\n";
    folder.write("w.toml", text);
    let says = ["w.toml: line 3: scene.anchor: anchors are sampled in the free space", "it marks none: mark one"];
    folder.refused(2, "study run w.toml", &says);
    folder.write("w.wkt", "GEOMETRYCOLLECTION (LINESTRING (1 1, 2 2), POINT (1.5 1))");
    folder.done("study run w.toml --count 20");
}

#[test]
fn a_rope_that_winds_is_about_a_wall_end_no_more_than_always() {
    let folder = Folder::new();
    folder.write("speck.wkt", "LINESTRING (-0.1 0, 0.1 0)\nPOINT (-3 0)\n");
    let points = (0..=80).map(|i| glam::DVec2::from_angle(std::f64::consts::PI * (1.0 + f64::from(i) / 4.0)) * 2.0);
    let rows: String = points.map(|p| format!("0,{},{}\n", p.x, p.y)).collect();
    folder.write("t.csv", format!("trace,x,y\n{rows}"));
    folder.write(
        "g.toml",
        "[scene]\nfile = \"speck.wkt\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\ntraces = 1\n",
    );
    folder.done("study run g.toml --out a");
    let summary = json(&folder, "a/summary.json");
    assert!(summary["scalars"][2]["max"].as_f64().unwrap() > 15.0, "the rope winds");
    for contact in summary["contacts"].as_array().unwrap() {
        let share = contact["share"]["value"].as_f64().unwrap();
        assert!(share > 0.5 && share < 1.0, "{contact}");
    }
    folder.done("study replay a --trace 0 --events e.csv");
    folder.refused(2, "study replay a --trace 0 --draw a/survival.svg", &["a/survival.svg is in the study's folder"]);
}

#[test]
fn studies_that_would_mislead_or_burst_are_refused() {
    let folder = study();
    for engine in ["note", "funnel"] {
        folder.refused(2, &format!("study run s.toml --engine {engine} --dry-run"), &[engine, "same events"]);
    }
    for (from, to, parts) in [
        ("steps = ", "steps = 2147483646 # ", &["walk.steps", "memory"][..]),
        ("block = ", "block = 4294967295 # ", &["run.block", "memory"]),
        ("traces = ", "traces = 9223372036854775807 # ", &["run.traces", "at most"]),
        ("[tallies]", "[tallies]\nbin = 1e-300", &["tallies.bin", "narrow"]),
    ] {
        assert!(STUDY.contains(from), "{from}");
        folder.write("burst.toml", STUDY.replacen(from, to, 1));
        folder.refused(2, "study run burst.toml --out b", parts);
        assert!(!folder.path("b").exists());
    }
    folder.write("stuck.toml", STUDY.replacen("step = ", "step = 1e9 # ", 1));
    folder.refused(2, "study run stuck.toml --out c --count 10", &["walk.step: a step of 1000000000 is wider", " by "]);
    assert!(!folder.path("c").exists());
}
