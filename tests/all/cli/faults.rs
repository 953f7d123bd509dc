//! Studies whose folder something happens to: two writers, flipped bits, files that are gone, kills, full disks.

use std::fs::{self, File};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::{Finished, Folder};

/// Small blocks, with rows.
const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
    [run]\ntraces = 600\nblock = 50\n[outputs]\ntraces = true\npictures = false\n";

/// Takes far longer than any test waits, one block of it at the very least.
const ENDLESS: &str = "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"waypoints\"\nstep = 0.25\nsteps = 20_000\n\
    [run]\ntraces = 1_000_000\nblock = 1000\n[outputs]\ntraces = true\n";

fn study() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", STUDY);
    folder.write("endless.toml", ENDLESS);
    folder
}

/// What two runs of one study have in common, to the byte.
fn answer(folder: &Folder, run: &str) -> [Vec<u8>; 2] {
    ["summary.json", "traces.parquet"].map(|name| folder.read(&format!("{run}/{name}")))
}

/// All that lies in a study's folder.
fn names(folder: &Folder, run: &str) -> Vec<String> {
    let entries = fs::read_dir(folder.path(run)).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn start(folder: &Folder, args: &str) -> Child {
    folder.command(args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for what a program in its first seconds does.
fn wait_for(child: &mut Child, what: impl Fn() -> bool) {
    while !what() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_folder_has_one_writer() {
    let folder = study();
    folder.done("study run s.toml --out done");
    let mut child = start(&folder, "study run endless.toml --out a");
    wait_for(&mut child, || folder.path("a/state.bin").exists());
    let process = format!("process {}", child.id());
    for args in
        ["study resume a", "study run s.toml --out a", "study run endless.toml --out a", "study merge done --out a"]
    {
        folder.refused(6, args, &["a is in use", &process]);
    }
    // Shards are not written to while they are read.
    folder.refused(6, "study merge done a --out b", &["a is in use", &process]);
    // Who only looks does not disturb.
    folder.done("study show a");
    assert!(!folder.path("b").exists());
    child.kill().unwrap();
    child.wait().unwrap();
    // The lock has gone with the process.
    let mut child = start(&folder, "study resume a");
    sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none());
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_run_that_is_repeated_goes_on() {
    let folder = study();
    folder.done("study run s.toml");
    let before = answer(&folder, "s-study");
    let told = folder.done("study run s.toml").stderr;
    assert!(told.contains("s-study holds the answer of this study already"), "{told}");
    assert!(answer(&folder, "s-study") == before && !folder.path("s-study-2").exists());
    // Another study does not take its place, and what is another is said.
    folder.refused(
        2,
        "study run s.toml --seed 2",
        &["s-study holds a study already", "run.seed is 1 there and 2 here"],
    );
    folder.refused(2, "study run s.toml --shard 0/2 --out s-study", &["shard 0/1, and not 0/2"]);
    folder.write("s.toml", STUDY.replace("step = 0.4", "step = 0.5"));
    folder.refused(2, "study run s.toml", &["walk.step is 0.4 there and 0.5 here", "study resume s-study", "--out"]);
    assert!(answer(&folder, "s-study") == before);
    // Nor does one take the place of files that are no study's.
    fs::create_dir(folder.path("mine")).unwrap();
    folder.write("mine/report.html", "mine");
    folder.refused(2, "study run s.toml --out mine", &["mine/report.html is there already"]);
    assert_eq!(names(&folder, "mine"), ["report.html"]);
    // Rows that are asked for later are computed.
    folder.write("s.toml", STUDY.replace("traces = true\n", ""));
    folder.done("study run s.toml --out later");
    assert!(!folder.path("later/traces.parquet").exists());
    folder.write("s.toml", STUDY);
    folder.done("study run s.toml --out later");
    assert!(answer(&folder, "later") == before);
}

#[test]
fn starts_that_fail_leave_no_folder() {
    let folder = Folder::floor_plan(50, 20);
    let given =
        "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\ntraces = 60\nblock = 20\n";
    folder.write("g.toml", given);
    folder.refused(2, "study run g.toml --out x/y --traces 60 --shard 2/3", &["the file holds 50"]);
    assert!(!folder.path("x").exists());
    let through = folder.text("t.csv").replacen("0,", "0,1e6,1e6\n0,", 1);
    folder.write("t.csv", through);
    folder.refused(2, "study run g.toml --out x/y --traces 50", &["trace 0"]);
    assert!(!folder.path("x").exists());
    fs::create_dir(folder.path("x")).unwrap();
    folder.refused(2, "study run g.toml --out x --traces 50", &["trace 0"]);
    assert!(names(&folder, "x").is_empty());
    folder.refused(2, "study run g.toml --out g.toml --traces 50", &["g.toml is there already and is no folder"]);
}

#[test]
fn no_flipped_bit_and_no_lost_file_gets_into_an_answer() {
    let folder = study();
    folder.done("study run s.toml --out a");
    let whole = answer(&folder, "a");
    let mut child = start(&folder, "study run endless.toml --out b");
    wait_for(&mut child, || folder.path("b/state.bin").exists());
    // A study that is done in part, with two files of rows: stopped twice.
    drop((child.kill(), child.wait()));
    for name in ["traces.parquet", "run.json", "summary.json", "study.json", "state.bin"] {
        let good = folder.read(&format!("a/{name}"));
        for i in 0..8 {
            let mut bad = good.clone();
            let at = bad.len() * (2 * i + 1) / 16;
            bad[at] ^= 1 << i;
            folder.write(&format!("a/{name}"), &bad);
            let finished = folder.run("study resume a");
            match name {
                // Of these there is no second copy: they are named, and what to do.
                "study.json" => {
                    finished.has_failed(2, name, &["a/study.json: ", "`tautline study run`"]);
                    folder.done("study run s.toml --out a");
                }
                "state.bin" => {
                    finished.has_failed(2, name, &["a/state.bin: ", "remove it"]);
                    fs::remove_file(folder.path("a/state.bin")).unwrap();
                    let told = folder.done("study resume a").stderr;
                    assert!(told.contains("no state was saved"), "{told}");
                }
                _ => assert_eq!(finished.code, Some(0), "{name} {at}: {}", finished.stderr),
            }
            if name == "traces.parquet" {
                assert!(finished.stderr.contains("its rows are computed again"), "{}", finished.stderr);
            }
            assert!(answer(&folder, "a") == whole, "{name} {at}");
        }
        fs::remove_file(folder.path(&format!("a/{name}"))).unwrap();
        let code = if name == "study.json" { 2 } else { 0 };
        assert_eq!(folder.run("study resume a").code, Some(code), "{name}");
        folder.done("study run s.toml --out a");
        assert!(answer(&folder, "a") == whole, "{name} is gone");
    }
}

#[test]
fn parts_that_are_damaged_or_gone_are_computed_again() {
    let folder = study();
    let long = STUDY.replace("traces = 600", "traces = 150_000").replace("steps = 60", "steps = 10");
    folder.write("s.toml", long);
    folder.done("study run s.toml --out a");
    let whole = answer(&folder, "a");
    let stop = |child: &mut Child, wait: u64| {
        wait_for(child, || folder.path("b/traces").exists());
        sleep(Duration::from_millis(wait));
        assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
        // It may not listen yet.
        let code = child.wait().unwrap().code();
        assert!([None, Some(4)].contains(&code), "{code:?}");
        names(&folder, "b/traces")
    };
    let mut parts = stop(&mut start(&folder, "study run s.toml --out b"), 50);
    // Each time it is stopped there is a part more, if it got as far as that.
    let mut wait = 50;
    while parts.len() < 3 {
        wait += 25;
        parts = stop(&mut start(&folder, "study resume b"), wait);
    }
    // One bit in the middle of the first, the whole of the second; and one that nobody knows.
    let first = format!("b/traces/{}", parts[0]);
    let mut bad = folder.read(&first);
    let middle = bad.len() / 2;
    bad[middle] ^= 4;
    folder.write(&first, bad);
    fs::remove_file(folder.path(&format!("b/traces/{}", parts[1]))).unwrap();
    fs::copy(folder.path(&format!("b/traces/{}", parts[2])), folder.path("b/traces/000000000001.parquet")).unwrap();
    let told = folder.done("study resume b").stderr;
    for part in &parts[..2] {
        assert!(told.contains(&format!("b/traces/{part}")), "{told}");
    }
    assert!(!told.contains(&parts[2]), "{told}");
    assert!(answer(&folder, "b") == whole);
    assert_eq!(names(&folder, "b"), names(&folder, "a"));
}

#[test]
fn shards_with_damaged_rows_are_not_merged() {
    let folder = study();
    folder.done("study run s.toml --out a");
    for k in 0..2 {
        folder.done(&format!("study run s.toml --out k{k} --shard {k}/2"));
    }
    let good = folder.read("k1/traces.parquet");
    for i in 0..8 {
        let mut bad = good.clone();
        let at = bad.len() * (2 * i + 1) / 16;
        bad[at] ^= 1 << i;
        folder.write("k1/traces.parquet", bad);
        folder.refused(2, "study merge k0 k1 --out m", &["k1/traces.parquet: ", "check sum", "study resume k1"]);
        assert!(!folder.path("m").exists());
    }
    folder.done("study resume k1");
    assert!(folder.read("k1/traces.parquet") == good);
    folder.done("study merge k0 k1 --out m");
    let merged = answer(&folder, "m");
    assert!(merged[0] == folder.read("a/summary.json"));
    // It can be said again, and nothing becomes another.
    folder.done("study merge k1 k0 --out m");
    assert!(answer(&folder, "m") == merged);
    folder.refused(2, "study merge k0 k1 --out k0", &["k0 is one of the shards"]);
}

#[test]
fn what_killed_runs_left_is_removed_and_an_old_answer_is_told() {
    let folder = study();
    folder.done("study run s.toml --out a");
    let there = names(&folder, "a");
    for name in ["a/.state.bin.Ab12Cd.tautline", "a/.summary.json.000000.tautline"] {
        folder.write(name, "left");
    }
    folder.write("a/summary.json", "{}\n");
    let told = folder.done("study show a").stderr;
    assert!(told.contains("a/summary.json does not hold this answer"), "{told}");
    folder.done("study resume a");
    assert_eq!(names(&folder, "a"), there);
    assert_eq!(folder.done("study show a").stderr, "");
    folder.write(".r.csv.Ab12Cd.tautline", "left");
    folder.done("eval --out r.csv");
    assert!(!folder.path(".r.csv.Ab12Cd.tautline").exists());
}

#[cfg(unix)]
#[test]
fn a_full_disk_ends_a_study_that_then_goes_on() {
    let folder = study();
    let long = STUDY.replace("traces = 600", "traces = 6000");
    folder.write("s.toml", long);
    folder.done("study run s.toml --out a");
    // Files of at most 32 KiB (64 KiB where the shell counts otherwise), as where no more room is left.
    let program = folder.command("");
    let mut shell = Command::new("sh");
    shell.current_dir(folder.path("")).args(["-c", r#"trap '' XFSZ; ulimit -f 64; exec "$0" "$@""#]);
    shell.arg(program.get_program()).args(["study", "run", "s.toml", "--out", "b"]);
    Finished::of(&mut shell).has_failed(1, "full", &["error: cannot write b/traces/", "File too large"]);
    assert!(names(&folder, "b").iter().all(|name| !name.starts_with('.')), "{:?}", names(&folder, "b"));
    folder.done("study resume b");
    assert!(answer(&folder, "b") == answer(&folder, "a"));
}

#[cfg(unix)]
#[test]
fn a_folder_that_was_moved_is_not_written_to_again() {
    let folder = study();
    // Blocks of a moment, without end.
    folder.write("endless.toml", ENDLESS.replace("20_000", "200"));
    let mut child = start(&folder, "study run endless.toml --out a");
    wait_for(&mut child, || fs::read_dir(folder.path("a/traces")).is_ok_and(|mut rows| rows.next().is_some()));
    fs::rename(folder.path("a"), folder.path("b")).unwrap();
    fs::create_dir(folder.path("a")).unwrap();
    folder.write("a/state.bin", "another's");
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let finished: Finished = child.wait_with_output().unwrap().into();
    assert_eq!(names(&folder, "a"), ["state.bin"]);
    assert_eq!(folder.text("a/state.bin"), "another's");
    File::open(folder.path("b/state.bin")).unwrap();
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
}
