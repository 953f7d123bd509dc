//! Studies that schedulers run: repeated, stopped, shared out, put together from whatever is there.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::study::rows;
use super::{Finished, Folder};

/// Two anchors, 24 blocks, the last one smaller than the others.
pub(super) const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\nanchor = { sample = 2 }\n\
    [walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
    [run]\ntraces = 950\nblock = 40\n[tallies]\nlimits = [5.0]\n[outputs]\npictures = false\n";

pub(super) fn study() -> Folder {
    let folder = Folder::new();
    folder.write("s.toml", STUDY);
    folder.write("long.toml", STUDY.replace("950", "120_000").replace("block = 40", "block = 400"));
    folder
}

pub(super) fn answer(folder: &Folder, run: &str) -> String {
    folder.text(&format!("{run}/summary.json"))
}

pub(super) fn start(folder: &Folder, args: &str) -> Child {
    folder.command(args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until a study is under way in that folder.
fn wait_for(folder: &Folder, child: &mut Child, run: &str) {
    // The lease of one that was stopped before may be there still.
    let process = Some(child.id());
    let is_held = || leases(folder, run).iter().any(|lease| holder(folder, run, lease) == process);
    while !folder.path(&format!("{run}/state.bin")).exists() || !is_held() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(5));
    }
}

pub(super) fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap().success());
}

/// The process that holds a lease, if it is there and written.
fn holder(folder: &Folder, run: &str, lease: &str) -> Option<u32> {
    let text = fs::read_to_string(folder.path(&format!("{run}/{lease}"))).ok()?;
    let holder: serde_json::Value = serde_json::from_str(&text).ok()?;
    holder["process"].as_u64()?.try_into().ok()
}

/// The leases in a study's folder.
fn leases(folder: &Folder, run: &str) -> Vec<String> {
    let names = fs::read_dir(folder.path(run)).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.starts_with("lease")).collect()
}

#[test]
fn a_command_can_be_repeated_whoever_calls_it() {
    let folder = study();
    folder.done("study run s.toml --out truth");
    let first = folder.done("study run s.toml --out a --resume");
    assert!(answer(&folder, "a") == answer(&folder, "truth") && leases(&folder, "a").is_empty());
    let written = fs::metadata(folder.path("a/state.bin")).unwrap().modified().unwrap();
    let again = folder.done("study run s.toml --out a --resume");
    assert_eq!(again.stdout.lines().last(), first.stdout.lines().last());
    assert_eq!(fs::metadata(folder.path("a/state.bin")).unwrap().modified().unwrap(), written, "it is left as it is");
    // What is missing comes again.
    fs::remove_file(folder.path("a/summary.json")).unwrap();
    folder.done("study run s.toml --out a --resume");
    assert!(answer(&folder, "a") == answer(&folder, "truth"));
    folder.refused(2, "study run s.toml --seed 2 --out a --resume", &["run.seed is 1 there and 2 here"]);
    folder.refused(2, "study run s.toml --shard 0/2 --out a --resume", &["shard 0/1, and not 0/2"]);
    // One that is done and missed its target says so each time.
    folder.write("u.toml", format!("{STUDY}[until]\nrelative_error = 1e-6\n"));
    for _ in 0..2 {
        assert_eq!(folder.run("study run u.toml --out u --resume").code, Some(5));
    }
}

#[test]
fn what_schedulers_send_saves_and_stops() {
    let folder = study();
    folder.done("study run long.toml --out truth");
    for signal in ["USR1", "USR2", "XCPU"] {
        let mut child = start(&folder, "study run long.toml --out a --resume");
        wait_for(&folder, &mut child, "a");
        send(signal, &child);
        let finished: Finished = child.wait_with_output().unwrap().into();
        finished.has_failed(4, signal, &["stopped"]);
    }
    // One that is stopped as it takes its lease may leave it; on this machine nobody waits for that.
    folder.done("study run long.toml --out a --resume");
    assert!(answer(&folder, "a") == answer(&folder, "truth") && leases(&folder, "a").is_empty());
    // What is to be ignored is.
    let mut shell = Command::new("sh");
    let program = assert_cmd::cargo::cargo_bin!("tautline");
    shell.args(["-c", &format!("trap '' USR1; exec {} study run long.toml --out b", program.display())]);
    let mut child = shell.current_dir(folder.path("")).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for(&folder, &mut child, "b");
    send("USR1", &child);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// Small blocks and many steps, stopped again and again in the first moments: what is saved never becomes less, and the
/// end is that of one run.
#[test]
fn a_study_that_is_stopped_at_any_time_goes_forward() {
    let folder = Folder::new();
    let text = STUDY.replace("steps = 60", "steps = 1000").replace("block = 40", "block = 3");
    folder.write("s.toml", text.replace("[outputs]", "[outputs]\ntraces = true"));
    let run = "study run s.toml --engine cpu --resume --out";
    folder.done(&format!("{run} truth"));
    let (mut before, mut round) = (0, 0);
    loop {
        let mut child = start(&folder, &format!("{run} a"));
        // The first is stopped as soon as it can be, the others later and later.
        if round == 0 {
            wait_for(&folder, &mut child, "a");
        }
        sleep(Duration::from_millis(100 * round));
        send("TERM", &child);
        let finished: Finished = child.wait_with_output().unwrap().into();
        if finished.code == Some(0) {
            break;
        }
        finished.has_failed(4, "a stop", &["stopped"]);
        let saved = finished.stderr.split_once("stopped; ").and_then(|(_, rest)| rest.split_once(" of 950 traces"));
        let saved = saved.map_or(before, |(saved, _)| saved.parse::<u64>().unwrap());
        assert!(saved >= before, "{saved} after {before}");
        (before, round) = (saved, round + 1);
    }
    assert!(answer(&folder, "a") == answer(&folder, "truth") && before > 0, "{before}");
    assert!(rows(&folder, "a") == rows(&folder, "truth"));
}

#[test]
fn a_study_stops_before_its_time_is_over() {
    let folder = study();
    folder.done("study run long.toml --out truth --shard 1/2");
    let run = "study run long.toml --shard 1/2 --out a --resume";
    // A small part of what the shard takes on one thread of a fast machine.
    let mut command = folder.command(&format!("{run} --stop-after 0.05s"));
    Finished::of(command.env("RAYON_NUM_THREADS", "1")).has_failed(4, "a time", &["stopped"]);
    let at_once = |seconds: &str| {
        let mut command = folder.command(&format!("{run} --stop-before 5m"));
        let end = std::time::SystemTime::UNIX_EPOCH.elapsed().unwrap().as_secs() + 299;
        command.env("SLURM_JOB_END_TIME", if seconds.is_empty() { end.to_string() } else { seconds.to_owned() });
        Finished::of(&mut command)
    };
    at_once("").has_failed(4, "a job that is nearly over", &["stopped"]);
    at_once("soon").has_failed(2, "an end that is none", &["SLURM_JOB_END_TIME", "soon"]);
    // Without a job's end it is said that nobody knows it.
    let mut command = folder.command(&format!("{run} --stop-before 5m"));
    let told = Finished::of(command.env_remove("SLURM_JOB_END_TIME"));
    assert!(told.code == Some(0) && told.stderr.contains("note: --stop-before: "), "{}", told.stderr);
    assert!(answer(&folder, "a") == answer(&folder, "truth"));
}

#[test]
fn any_parts_make_a_whole_and_some_an_answer_that_says_so() {
    let folder = study();
    folder.done("study run s.toml --out truth");
    for (out, part) in
        [("a", "--blocks 0..5"), ("b", "--blocks 5..24 --shard 2@1-2"), ("c", "--blocks 5..24 --shard 0/2")]
    {
        folder.done(&format!("study run s.toml --out {out} {part}"));
    }
    folder.refused(2, "study merge a c --out all", &["blocks 6..7, 8..9, 10..11", "are missing, of 24"]);
    folder.refused(2, "study merge a c a b --out all", &["shard 0/1 of blocks 0..5 is there twice"]);
    folder.done("study run s.toml --out d --shard 1/24");
    folder.refused(2, "study merge a c d b --out all", &["d: block 1 is in a too"]);
    let told = folder.done("study merge a c --partial --out all").stdout;
    assert!(told.contains("put together from 15 blocks alone; missing are 6..7, 8..9"), "{told}");
    assert!(answer(&folder, "all").contains("\"missing\": \"6..7, 8..9, "));
    folder.refused(2, "study resume all", &["all holds an answer of some parts", "merge them again"]);
    folder.refused(2, "study run s.toml --out all --resume", &["all holds an answer of some parts"]);
    folder.done("study show all");
    // What is missing may be added to it, and the whole stands where a part stood.
    folder.done("study merge all b --out more");
    folder.done("study merge c b a --out all");
    assert!(answer(&folder, "all") == answer(&folder, "truth") && answer(&folder, "more") == answer(&folder, "truth"));
    // A part does not take the place of the whole.
    folder.done("study merge a c --partial --out all");
    assert!(answer(&folder, "all") == answer(&folder, "truth"));
    // A folder in which nothing was saved yet is nothing yet.
    fs::create_dir(folder.path("new")).unwrap();
    folder.done("study merge new a --partial --out some");
    for wrong in ["--blocks 5..5", "--blocks 5", "--shard 6/6", "--shard 7@1-6"] {
        folder.refused(2, &format!("study run s.toml --out no {wrong}"), &["such as"]);
    }
}

#[test]
fn a_shared_study_ends_with_the_block_with_which_one_run_ends() {
    let folder = study();
    folder.write("u.toml", format!("{}[until]\nrelative_error = 0.05\n", STUDY.replace("950", "8_000")));
    folder.done("study run u.toml --out truth");
    assert!(answer(&folder, "truth").contains("\"stopped\": \"relative_error\""));
    for k in 1..=3 {
        folder.done(&format!("study run u.toml --out k{k} --shard {k}@1-3"));
    }
    folder.done("study merge k3 k1 k2 --out all");
    assert!(answer(&folder, "all") == answer(&folder, "truth"));
    // The first blocks alone are enough, once they are there without a gap.
    let blocks: u64 =
        answer(&folder, "truth").split("\"blocks\": ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((5..150).contains(&blocks), "{blocks}");
    folder.done(&format!("study run u.toml --out first --blocks 0..{}", blocks + 1));
    folder.done("study merge first --out enough");
    assert!(answer(&folder, "enough") == answer(&folder, "truth"));
    folder.done("study run u.toml --out late --blocks 3..200");
    let told = folder.done("study merge late --partial --out some").stdout;
    assert!(told.contains("missing are 0..3\n"), "{told}");
    folder.done("study run u.toml --out early --blocks 0..3");
    folder.done("study merge some early --out enough2");
    assert!(answer(&folder, "enough2") == answer(&folder, "truth"));
}

#[test]
fn traces_are_raised_and_what_was_done_stays_done() {
    let folder = study();
    folder.write("t.toml", STUDY.replace("[outputs]", "[outputs]\ntraces = true"));
    folder.done("study run t.toml --count 2210 --out truth");
    for part in ["", "--shard 1/2"] {
        let out = format!("a{}", part.len());
        folder.done(&format!("study run t.toml --out {out} {part}"));
        folder.refused(2, &format!("study run t.toml --count 2210 --out {out} {part}"), &["run.traces is 950 there"]);
        folder.refused(2, &format!("study run t.toml --count 940 --out {out} --resume {part}"), &["run.traces is 950"]);
        let told = folder.done(&format!("study run t.toml --count 2210 --out {out} --resume {part}")).stderr;
        let held = if part.is_empty() { "holds 950 of 2210" } else { "holds 470 of " };
        assert!(told.contains(held), "{told}");
    }
    assert!(answer(&folder, "a0") == answer(&folder, "truth"));
    assert!(folder.read("a0/traces.parquet") == folder.read("truth/traces.parquet"));
    folder.done("study run t.toml --count 2210 --shard 0/2 --out b");
    folder.done("study merge a11 b --out all");
    assert!(answer(&folder, "all") == answer(&folder, "truth"));
}

#[test]
fn of_two_writers_one_waits_or_leaves() {
    let folder = study();
    folder.done("study run long.toml --out truth");
    let mut first = start(&folder, "study run long.toml --out a --resume");
    wait_for(&folder, &mut first, "a");
    // So that it is there until the others have seen it, however fast it is.
    send("STOP", &first);
    let process = format!("process {}", first.id());
    folder.run("study run long.toml --out a --resume").has_failed(6, "a second writer", &["a is in use", &process]);
    let second = start(&folder, "study run long.toml --out a --resume --wait 5m");
    sleep(Duration::from_millis(100));
    // However the first ends, the second goes on.
    first.kill().unwrap();
    first.wait().unwrap();
    let second: Finished = second.wait_with_output().unwrap().into();
    assert_eq!(second.code, Some(0), "{}", second.stderr);
    assert!(answer(&folder, "a") == answer(&folder, "truth") && leases(&folder, "a").is_empty());
    folder.run("study run s.toml --out b --wait 5").has_failed(2, "a time", &["90s, 55m or 2h"]);
}

#[test]
fn status_tells_of_many_folders_at_once() {
    let folder = study();
    folder.done("study run s.toml --out k1 --shard 1@1-3");
    folder.done("study run s.toml --out k2 --shard 2@1-3");
    folder.done("study run s.toml --seed 2 --out other");
    let mut child = start(&folder, "study run long.toml --out long");
    wait_for(&folder, &mut child, "long");
    fs::create_dir(folder.path("empty")).unwrap();
    let told = folder.done("study status k1 k2 other long empty").stdout;
    for part in [
        ": 16 of 24 blocks done, in 2 folders; missing: 2..3, 5..6, 8..9, ",
        ": 24 of 24 blocks done, in 1 folder\n",
        &format!("  process {} on ", child.id()),
        "empty/study.json: ",
        "8 of 8",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let status: serde_json::Value =
        serde_json::from_str(&folder.done("study status k1 k2 other long empty --json").stdout).unwrap();
    let studies = status["studies"].as_array().unwrap();
    assert_eq!((studies.len(), status["others"].as_array().unwrap().len()), (3, 1));
    let shared = studies.iter().find(|study| study["folders"].as_array().unwrap().len() == 2).unwrap();
    assert_eq!((shared["done"].as_u64(), shared["folders"][1]["shard"].as_str()), (Some(16), Some("1/3")));
    assert_eq!(shared["folders"][1]["stopped"], "complete");
    let long = studies.iter().find(|study| study["folders"][0]["folder"] == "long").unwrap();
    assert_eq!(long["folders"][0]["holder"]["process"], child.id());
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn scripts_are_written_once_and_say_how_many_parts_there_are() {
    let folder = study();
    folder.write("my study.toml", format!("{STUDY}[until]\nrelative_error = 0.05\n").replace("950", "40_000_000"));
    for scheduler in ["slurm", "parallel", "dask"] {
        let told = folder.done(&format!("study script {scheduler} s.toml --parts 7")).stdout;
        assert!(told.contains(": 7 parts; read it"), "{told}");
        folder.refused(2, &format!("study script {scheduler} s.toml"), &["it is there already"]);
        let mut command = folder.command(&format!("study script {scheduler}"));
        let finished = Finished::of(command.args(["my study.toml", "--to", &format!("x.{scheduler}")]));
        assert!(finished.stdout.contains(" parts; read it"), "{}{}", finished.stdout, finished.stderr);
        let text = folder.text(&format!("x.{scheduler}"));
        let is_left = |word: &str| !word.is_empty() && word.chars().all(|c| c.is_ascii_uppercase());
        assert!(!text.split('@').any(is_left), "{text}");
        let check = if scheduler == "dask" {
            Command::new("python3").args(["-m", "py_compile"]).arg(folder.path("x.dask")).status()
        } else {
            Command::new("bash").arg("-n").arg(folder.path(&format!("x.{scheduler}"))).status()
        };
        assert!(check.map_or(true, |status| status.success()), "{text}");
    }
    assert!(folder.done("study script slurm s.toml --to small.sh").stdout.contains(": 1 part;"));
}
