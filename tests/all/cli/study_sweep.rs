//! Sweeps of studies, and values given in place of the file's.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::{Finished, Folder};

/// Two anchors, 8 blocks, the last one smaller than the others.
const STUDY: &str = "[scene]\nbuilt_in = \"rooms\"\nanchor = { sample = 2 }\n\
    [walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\n\
    [run]\ntraces = 300\nblock = 40\n[tallies]\nlimits = [9.0, 2.0]\n[outputs]\npictures = false\n";

pub(super) const SWEEP: &str = "[sweep]\nwalk.step = [0.4, 0.6]\n\"walk.turn\" = [0.4, 0.8]\n";

const POINTS: [(&str, &str); 4] = [("0.4", "0.4"), ("0.4", "0.8"), ("0.6", "0.4"), ("0.6", "0.8")];

fn studies() -> Folder {
    let folder = Folder::new();
    folder.write("one.toml", STUDY);
    folder.write("s.toml", format!("{STUDY}{SWEEP}"));
    folder
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// What stands in a table of a sweep, by the names of the columns; "" for what is null.
pub(super) fn column(folder: &Folder, file: &str, name: &str) -> Vec<String> {
    let text = folder.text(file);
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let place = rows[0].iter().position(|column| *column == name).unwrap_or_else(|| panic!("no column {name}"));
    rows[1..].iter().map(|row| row[place].to_owned()).collect()
}

fn numbers(folder: &Folder, file: &str, name: &str) -> Vec<f64> {
    column(folder, file, name).iter().map(|x| x.parse().unwrap()).collect()
}

/// That two folders of a sweep say the same, byte for byte.
pub(super) fn same(folder: &Folder, one: &str, other: &str, points: usize) {
    for point in 0..points {
        let file = format!("point-{point:03}/summary.json");
        assert!(
            folder.read(&format!("{one}/{file}")) == folder.read(&format!("{other}/{file}")),
            "{one} {other} {file}"
        );
    }
    for file in ["sweep.csv", "sweep.parquet", "sweep.svg"] {
        assert!(
            folder.read(&format!("{one}/{file}")) == folder.read(&format!("{other}/{file}")),
            "{one} {other} {file}"
        );
    }
}

#[test]
fn a_value_that_is_set_stands_for_the_files() {
    let folder = studies();
    folder.write(
        "t.toml",
        STUDY.replace("0.4", "0.7").replace("\"persistent\"", "\"gaussian\"").replace("[9.0, 2.0]", "[3.0]"),
    );
    folder.done("study run t.toml --out truth");
    folder.done("study run one.toml --out a --set walk.step=0.7 --set walk.kind=gaussian --set tallies.limits=[3]");
    assert!(folder.read("a/summary.json") == folder.read("truth/summary.json"));
    // The last of several counts; a key that the file lacks may be given, and one that it needs.
    folder.write("t.toml", STUDY.replace("step = 0.4\n", ""));
    folder.done("study run t.toml --out b --set walk.step=9 --set walk.step=0.7 --set walk.kind=gaussian --set tallies.limits=[3]");
    assert!(folder.read("b/summary.json") == folder.read("truth/summary.json"));
    let told = folder.done("study run one.toml --dry-run --set run.traces=80").stdout;
    assert!(told.contains("80 traces in 2 blocks"), "{told}");
    assert!(folder.done("study run --dry-run --set run.traces=80").stdout.contains("80 traces"));
    for (set, parts) in [
        ("walk.stpe=2", &["error: --set: walk.stpe: unknown field `stpe`", "did you mean `step`?"][..]),
        ("wlak.step=2", &["error: --set: wlak: unknown field `wlak`", "did you mean `walk`?"]),
        ("walk.step=-1", &["error: --set: walk.step: -1 is no length of a step"]),
        ("walk.step=far", &["error: --set: walk.step: must be a number, such as 0.5, and is \"far\""]),
        ("walk.step.x=1", &["error: --set: walk.step: it is no table here, so it has no `x`"]),
        ("walk.step=1e-400", &["--set", "walk.step: 1e-400 is too small"]),
        ("walk.step=[1", &["--set", "walk.step: the value cannot be read as TOML"]),
        ("walk.step", &["--set", "KEY=VALUE"]),
        ("walk.step=1000", &["error: --set: walk.step: "]),
        ("scene.anchor=here", &["error: --set: scene.anchor must be [x, y]"]),
        ("scene.built_in=halls", &["error: --set: scene.built_in: no built-in scene is called \"halls\""]),
    ] {
        folder.refused(2, &format!("study run one.toml --out no --set {set}"), parts);
    }
    // What is wrong in the file is said to be there.
    folder.write("t.toml", STUDY.replace("steps = 60", "stesp = 60"));
    folder.refused(2, "study run t.toml --out no --set walk.step=2", &["t.toml: line 7: walk.stesp: unknown field"]);
}

#[test]
fn each_point_is_the_study_with_its_values_set() {
    let folder = studies();
    let told = folder.done("study run s.toml --out a").stdout;
    assert!(told.contains("4 studies, 4 with an answer") && told.contains("written to a"), "{told}");
    for (i, (step, turn)) in POINTS.iter().enumerate() {
        folder.done(&format!("study run one.toml --out {i} --set walk.step={step} --set walk.turn={turn}"));
        let point = format!("a/point-{i:03}");
        assert!(folder.read(&format!("{i}/summary.json")) == folder.read(&format!("{point}/summary.json")), "{point}");
        // Its folder is one like any other.
        folder.done(&format!("study show {point}"));
        folder.done(&format!("study replay {point} --trace 3"));
    }
    // The table says what the summaries do.
    assert_eq!(column(&folder, "a/sweep.csv", "point"), ["point-000", "point-001", "point-002", "point-003"]);
    assert_eq!(column(&folder, "a/sweep.csv", "walk.step"), ["0.4", "0.4", "0.6", "0.6"]);
    assert_eq!(column(&folder, "a/sweep.csv", "walk.turn"), ["0.4", "0.8", "0.4", "0.8"]);
    for (i, row) in (0..).zip(numbers(&folder, "a/sweep.csv", "max_length_mean")) {
        let summary = json(&folder.text(&format!("{i}/summary.json")));
        assert_eq!(Some(row), summary["scalars"][1]["mean"]["value"].as_f64());
        let at = |file: &str| numbers(&folder, "a/sweep.csv", file)[i as usize];
        assert_eq!(Some(at("max_length_q95_high")), summary["scalars"][1]["quantiles"][7]["value"]["high"].as_f64());
        let last = summary["survival"][1]["curve"].as_array().unwrap().last().unwrap().clone();
        assert_eq!(Some(at("within_9_low")), last["share"]["low"].as_f64());
        let first = numbers(&folder, "a/sweep.csv", "max_length_mean")[0];
        assert!((at("max_length_mean_difference") - (row - first)).abs() < 1e-12);
    }
    assert!(folder.text("a/sweep.svg").contains("walk.turn"));
    // What is shown is what was printed.
    let shown = folder.done("study show a").stdout;
    assert!(told.starts_with(&shown), "{shown}");
    let answer = json(&folder.done("study show a --json").stdout);
    assert_eq!(answer["points"][3]["values"], serde_json::json!([0.6, 0.8]));
    assert_eq!(answer["points"][3]["differences"]["errors_from"], "paired_blocks");
    // A list that is set stands for that of the file, however that writes its name.
    let told = folder.done("study run s.toml --dry-run --engine cpu --set sweep.walk.turn=[1.5]").stdout;
    assert!(told.contains("2 studies, from walk.step = 0.4, walk.turn = 1.5 to walk.step = 0.6"), "{told}");
    // With another point to compare with, only the differences are others.
    folder.done("study run s.toml --out a --set sweep.against=3");
    assert_eq!(numbers(&folder, "a/sweep.csv", "length_mean_difference")[3], 0.0);
    assert!(numbers(&folder, "a/sweep.csv", "length_mean_difference")[0] < 0.0);
}

#[test]
fn points_that_differ_in_nothing_that_is_counted_differ_by_nothing() {
    let folder = studies();
    folder.done("study run one.toml --out a --set sweep.tallies.ropes=[3,5] --set tallies.limits=[0,9,1000]");
    for name in ["length_mean", "max_depth_mean", "wraps_mean", "within_9"] {
        for part in ["", "_error", "_low", "_high"] {
            assert_eq!(
                numbers(&folder, "a/sweep.csv", &format!("{name}_difference{part}")),
                [0.0, 0.0],
                "{name}{part}"
            );
        }
    }
    // Where all ropes stay within a limit, or none, nothing says how sure that is.
    for limit in [0, 1000] {
        assert_eq!(numbers(&folder, "a/sweep.csv", &format!("within_{limit}_difference")), [0.0, 0.0]);
        assert_eq!(column(&folder, "a/sweep.csv", &format!("within_{limit}_difference_error")), ["", ""]);
    }
    // Nor does a single block.
    folder.done("study run one.toml --out b --set sweep.walk.step=[0.4,0.5] --set run.block=300");
    assert!(numbers(&folder, "b/sweep.csv", "length_mean_difference")[1] > 0.0);
    assert_eq!(column(&folder, "b/sweep.csv", "length_mean_difference_error"), ["", ""]);
}

/// Twice the scene with twice the step is the same walk twice as large: lengths are doubled, to the last bit, and depths
/// are the same.
#[test]
fn a_scene_twice_as_large_differs_by_the_lengths_themselves() {
    let folder = studies();
    for scale in [1, 2] {
        let walls = format!(
            "LINESTRING ({} {}, {} -{})\nLINESTRING ({} {}, -{} {})\n",
            3 * scale,
            4 * scale,
            3 * scale,
            4 * scale,
            5 * scale,
            9 * scale,
            6 * scale,
            8 * scale
        );
        folder.write(
            &format!("{scale}.wkt"),
            format!("{walls}LINESTRING (-{0} -{0}, {0} -{0})\nPOINT (0 0)\n", 16 * scale),
        );
    }
    let sweep = "[sweep]\nscene.file = [\"1.wkt\", \"2.wkt\"]\nwalk.step = [1.0, 2.0]\n";
    let study = STUDY.replace("built_in = \"rooms\"\nanchor = { sample = 2 }\n", "");
    folder.write("t.toml", format!("{study}{sweep}"));
    folder.done("study run t.toml --out a");
    let of = |name: &str| numbers(&folder, "a/sweep.csv", name);
    for name in ["length_mean", "max_length_mean"] {
        assert!(of(name)[0] > 1.0 && of(name)[3] == 2.0 * of(name)[0], "{name}");
        let difference = of(&format!("{name}_difference"))[3];
        assert!((difference - of(name)[0]).abs() <= 1e-13 * difference, "{name}: {difference}");
    }
    assert!(of("depth_mean")[0] > 0.1);
    for part in ["", "_error", "_low", "_high"] {
        assert_eq!(of(&format!("depth_mean_difference{part}"))[3], 0.0);
    }
    // What differs does so: other steps in the same scene.
    assert!(of("depth_mean_difference")[1].abs() > 0.0);
}

#[test]
fn a_sweep_that_is_stopped_goes_on() {
    let folder = studies();
    let long = "study run s.toml --set run.traces=12000 --set run.block=400";
    folder.done(&format!("{long} --out truth"));
    // Stopped at whatever point, by a time or a signal, and gone on with by either command.
    let on_one_thread = |args: &str| {
        let mut command = folder.command(args);
        command.env("RAYON_NUM_THREADS", "1");
        command
    };
    let mut command = on_one_thread(&format!("{long} --out a"));
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.path("a/point-001/state.bin").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    Finished::from(child.wait_with_output().unwrap()).has_failed(
        4,
        "a signal",
        &["go on with `tautline study resume a`"],
    );
    let told = folder.done("study status a").stdout;
    assert!(told.contains("sweep a: 1 of 4 studies done"), "{told}");
    assert!(told.contains("a/point-003") && folder.done("study show a").stdout.contains("with an answer"), "{told}");
    for run in ["study resume a", &format!("{long} --out a --resume")] {
        // A small part of what is left takes on one thread of a fast machine.
        let mut command = on_one_thread(&format!("{run} --stop-after 0.05s"));
        Finished::of(&mut command).has_failed(4, run, &["stopped"]);
    }
    folder.done("study resume a");
    same(&folder, "a", "truth", 4);
    // One that is done is told and left as it is.
    let written = fs::metadata(folder.path("a/point-002/state.bin")).unwrap().modified().unwrap();
    let told = folder.done(&format!("{long} --out a --resume"));
    assert!(told.stdout.contains("4 with an answer"));
    assert_eq!(fs::metadata(folder.path("a/point-002/state.bin")).unwrap().modified().unwrap(), written);
    // More traces are no other sweep.
    folder.refused(
        2,
        "study run s.toml --out a --set run.traces=13000 --set run.block=400",
        &["run.traces is 12000 there and 13000"],
    );
    folder.done("study run s.toml --out a --resume --set run.traces=13000 --set run.block=400");
    folder.done("study run s.toml --out more --set run.traces=13000 --set run.block=400");
    same(&folder, "a", "more", 4);
}

#[test]
fn parts_of_a_sweep_make_a_whole() {
    let folder = studies();
    folder.done("study run s.toml --out truth");
    for k in 0..3 {
        folder.done(&format!("study run s.toml --out k{k} --shard {k}/3"));
    }
    let told = folder.done("study merge k2 k0 k1 --out all").stdout;
    assert_eq!(
        told.replace("written to all", "written to truth"),
        folder.done("study show truth").stdout + "\nwritten to truth\n"
    );
    same(&folder, "all", "truth", 4);
    folder.refused(2, "study merge k0 k1 --out two", &["shard 2/3 is missing"]);
    assert!(!folder.path("two").exists());
    folder.done("study merge k0 k1 --partial --out some");
    assert!(folder.text("some/point-003/summary.json").contains("\"missing\""));
    folder.done("study merge some k2 --out some-more");
    same(&folder, "some-more", "truth", 4);
    // Ranges of blocks are parts too, and what none has begun is not there yet.
    folder.done("study run s.toml --out b --blocks 0..5");
    folder.done("study run s.toml --out c --blocks 5..8");
    fs::remove_dir_all(folder.path("b/point-003")).unwrap();
    folder.done("study merge b --partial --out first");
    assert_eq!(column(&folder, "first/sweep.csv", "traces"), ["200", "200", "200", "0"]);
    assert_eq!(column(&folder, "first/sweep.csv", "length_mean")[3], "");
    folder.done("study resume b");
    folder.done("study merge c b --out both");
    same(&folder, "both", "truth", 4);
    // Parts of another sweep, of none, and of this very folder.
    folder.done("study run s.toml --out other --shard 0/3 --set sweep.walk.step=[0.4]");
    folder.refused(
        2,
        "study merge k0 other --out no",
        &["other holds another sweep than k0: sweep.walk.step is [0.4] there and [0.4, 0.6] here"],
    );
    folder.done("study run one.toml --out one --shard 1/3");
    folder.refused(2, "study merge k0 one --out no", &["one/sweep.json"]);
    folder.refused(2, "study merge k0 k1 k2 --out k1", &["--out: k1 is one of the shards"]);
}

#[test]
fn what_is_wrong_with_a_sweep_is_named() {
    let folder = studies();
    let swept = |lines: &str| folder.write("t.toml", format!("{STUDY}[sweep]\n{lines}\n"));
    for (lines, parts) in [
        ("walk.step = []", &["t.toml: line 16: sweep.walk.step: the list is empty"][..]),
        ("walk.step = 0.5", &["line 16: sweep.walk.step: give a list of values, such as [0.5]"]),
        (
            "walk.stpe = [1.0]",
            &["line 16: sweep.walk.stpe: value 1 of 1: unknown field `stpe`", "did you mean `step`?"],
        ),
        (
            "walk.step = [0.5, 'far']",
            &["line 16: sweep.walk.step: value 2 of 2: must be a number, such as 0.5, and is \"far\""],
        ),
        ("walk.turn = [0.1]\nwalk.step = [0.5, 0.6, -2]", &["line 17: sweep.walk.step: value 3 of 3: -2 is no length"]),
        ("walk.step = [0.5, inf]", &["line 16: sweep.walk.step: value 2 of 2: it is not finite"]),
        ("walk.step = [0.5, 1e-400]", &["line 16: sweep.walk.step: 1e-400 is too small"]),
        ("walk.step = [1000.0]", &["line 16: sweep.walk.step: value 1 of 1: "]),
        ("scene.anchor = [[1.0, 1.0], 3]", &["line 16: sweep.scene.anchor: value 2 of 2: must be [x, y]"]),
        ("walk.step = [0.5, 0.50]", &["sweep: points 0 (walk.step = 0.5) and 1 (walk.step = 0.5) are one study"]),
        ("walk.step = [0.5]\nwalk = [{ kind = 'uniform' }]", &["line 17: duplicate key"]),
        ("\"walk.step\" = [0.5]\nwalk.step = [0.6]", &["sweep.walk.step: it is there twice"]),
        ("\"walk\" = [{ kind = 'uniform' }]\n\"walk.step\" = [0.6]", &["sweep.walk"]),
        ("against = 0", &["line 15: sweep: it names no key"]),
        ("walk.step = [0.5]\nagainst = 1", &["line 17: sweep.against: 1 is the number of no point; they are 0 to 0"]),
        ("swepe = [1]", &["line 16: sweep.swepe: value 1 of 1: unknown field `swepe`"]),
    ] {
        swept(lines);
        folder.refused(2, "study run t.toml --out no", parts);
        folder.refused(2, "study run t.toml --dry-run", parts);
    }
    let all = format!("{:?}", Vec::from_iter(1..=101));
    swept(&format!("run.seed = {all}\nrun.block = {all}"));
    folder.refused(
        2,
        "study run t.toml --out no",
        &["line 15: sweep: 101 times 101 points are too many; at most 10000"],
    );
    folder.refused(2, "study run s.toml --out no --set walk.step=2", &["sweep.walk.step: it is set by --set too"]);
    folder.refused(2, "study run s.toml --out no --set run.block=0", &["--set: run: `traces` and `block`"]);
    swept("run.seed = [1, 2]");
    folder.refused(
        2,
        "study run t.toml --out no --seed 3",
        &["--seed: the file sweeps run.seed; leave one of them out"],
    );
    folder.refused(2, "study run s.toml --out no --engine note", &["same events"]);
    // A file that is not of one study is told from one that is.
    folder.refused(2, "study script slurm none.toml", &["none.toml"]);
}

#[test]
fn folders_of_sweeps_hold_one_sweep() {
    let folder = studies();
    folder.done("study run s.toml --out a");
    folder.done("study run one.toml --out one");
    let truth = folder.text("a/sweep.csv");
    folder.refused(
        2,
        "study run s.toml --out a --set sweep.walk.step=[0.4]",
        &["a holds a study already, and another one: sweep.walk.step is [0.4, 0.6] there and [0.4] here"],
    );
    folder.refused(2, "study run s.toml --out a --seed 2", &["run.seed is 1 there and 2 here"]);
    folder.refused(2, "study run s.toml --out a --shard 0/2", &["shard 0/1, and not 0/2"]);
    folder.refused(2, "study run s.toml --out one", &["one/study.json is there already"]);
    folder.refused(2, "study run one.toml --out a", &["a/sweep.json is there already"]);
    folder.refused(2, "study replay a --trace 1", &["a is the folder of a sweep", "a/point-000"]);
    // A point that is damaged is named, and done again once it is removed; the others stand.
    let state = folder.read("a/point-002/state.bin");
    folder.write("a/point-002/state.bin", &state[..state.len() - 1]);
    for command in ["study show a", "study resume a", "study run s.toml --out a --resume"] {
        folder.refused(2, command, &["a/point-002/state.bin: damaged"]);
    }
    fs::remove_file(folder.path("a/point-002/state.bin")).unwrap();
    folder.done("study resume a");
    assert!(folder.text("a/sweep.csv") == truth);
    fs::remove_dir_all(folder.path("a/point-001")).unwrap();
    assert!(folder.done("study show a").stdout.contains("4 studies, 3 with an answer"));
    fs::remove_file(folder.path("a/sweep.csv")).unwrap();
    folder.done("study resume a");
    assert!(folder.text("a/sweep.csv") == truth);
    // Of what the sweep is, the study's own file has it written again.
    let known = folder.text("a/sweep.json");
    folder.write("a/sweep.json", known.replace("0.6", "0.7"));
    for command in ["study show a", "study resume a"] {
        folder.refused(2, command, &["a/sweep.json: damaged", "with the study's own file"]);
    }
    folder.done("study run s.toml --out a --resume");
    assert!(folder.text("a/sweep.json") == known && folder.text("a/sweep.csv") == truth);
    // With another file under that name the points know what they hold.
    folder.write("a/sweep.json", "{}");
    folder.refused(
        2,
        "study run s.toml --out a --set sweep.walk.step=[0.5,0.6]",
        &["a/point-000 holds a study already, and another one: walk.step is 0.4 there and 0.5 here"],
    );
}

#[test]
fn a_point_that_is_not_certain_enough_is_named() {
    let folder = studies();
    folder.write("u.toml", format!("{}[until]\nrelative_error = 0.05\n{SWEEP}", STUDY.replace("300", "4000")));
    // The third is the least certain.
    let told = folder.run("study run u.toml --out a --set until.relative_error=0.02 --count 1600");
    assert!(told.stdout.contains("written to a"));
    assert_eq!(told.code, Some(5), "{}", told.stderr);
    assert!(told.stderr.contains("asked for in point-002; more traces"), "{}", told.stderr);
    // Each ends where it does alone; the blocks that two have are compared.
    folder.done("study run u.toml --out b");
    let blocks = column(&folder, "b/sweep.csv", "blocks");
    assert!(blocks.iter().any(|count| *count != blocks[0]), "{blocks:?}");
    for k in 0..2 {
        folder.done(&format!("study run u.toml --out k{k} --shard {k}/2"));
    }
    folder.done("study merge k0 k1 --out all");
    same(&folder, "all", "b", 4);
}

#[test]
fn a_script_and_a_dry_run_know_sweeps() {
    let folder = studies();
    let told = folder.done("study run s.toml --dry-run --engine cpu").stdout;
    assert!(told.contains("the sweep is sound: 4 studies, from walk.step = 0.4, walk.turn = 0.4 to"), "{told}");
    folder.done("study script slurm s.toml --engine cpu --parts 3");
    let text = folder.text("s.slurm.sh");
    assert!(text.contains("study merge") && !text.contains("--enough"), "{text}");
}
