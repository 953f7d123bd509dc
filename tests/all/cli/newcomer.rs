//! What a newcomer stumbles over.

use std::fs;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;
use serde_json::{Value, json};

use super::{Finished, Folder};

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

const GIVEN: &str = "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n";

#[test]
fn a_study_of_given_traces_takes_all_of_the_file() {
    let folder = Folder::hand_made();
    folder.write("g.toml", GIVEN);
    folder.done("study run g.toml --out all");
    let summary = json_of(&folder.text("all/summary.json"));
    assert_eq!((&summary["traces"], &summary["study"]["run"]["traces"]), (&json!(4), &json!(4)));
    folder.write("n.toml", format!("{GIVEN}[run]\ntraces = 4\n"));
    folder.done("study run n.toml --out four");
    assert!(folder.read("four/summary.json") == folder.read("all/summary.json"), "said or not, they are the same");
    folder.done("study run g.toml --out two --count 2");
    assert_eq!(json_of(&folder.text("two/summary.json"))["traces"], 2);
    folder.done("study resume all");
    // What is wrong with the traces is said with the name of their file.
    for (rows, part) in [
        ("", "t.csv: there are no traces in it"),
        ("0,0,0\n0,5,0\n", "t.csv: trace 0, step 1: "),
        ("0,0,zero\n", "t.csv"),
    ] {
        folder.write("t.csv", format!("trace,x,y\n{rows}"));
        folder.refused(2, "study run g.toml --out no", &[part]);
    }
    fs::remove_file(folder.path("t.csv")).unwrap();
    folder.refused(2, "study run g.toml --out no", &["t.csv"]);
    // Walks are drawn as many as ever.
    folder.write("w.toml", "[scene]\nbuilt_in = \"rooms\"\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 1\n");
    assert!(folder.done("study run w.toml --dry-run").stdout.contains("10000 traces in 10 blocks"));
}

#[test]
fn marked_traces_stay_out_of_the_means() {
    let folder = Folder::hand_made();
    let eval = |traces: &str| format!("eval --scene s.geojson --traces {traces} --on-violation flag");
    let sound = json_of(&folder.done(&format!("{} --json", eval("t.csv"))).stdout);
    folder.write("m.csv", format!("{}8,0,0\n8,500,0\n8,500,400\n", folder.text("t.csv")));
    let mixed = json_of(&folder.done(&format!("{} --json --out m.jsonl", eval("m.csv"))).stdout);
    assert_eq!([&mixed["traces"], &mixed["violations"], &mixed["counted"]], [&json!(5), &json!(1), &json!(4)]);
    assert_eq!(mixed["steps"], json!(14));
    for name in ["length", "max_length", "depth", "max_depth", "wraps", "unwraps"] {
        assert_eq!(mixed[name], sound[name], "{name}");
    }
    // They are in the rows.
    assert!(folder.text("m.jsonl").lines().last().unwrap().contains("\"status\":\"violation\""));
    let table = folder.done(&eval("m.csv")).stdout;
    assert!(table.contains("crossing 1 trace crosses a wall and is marked; what follows leaves them out\n"), "{table}");
    assert!(table.contains("  over 4 traces "), "{table}");
    folder.write("v.csv", "trace,x,y\n8,0,0\n8,500,0\n");
    let none = json_of(&folder.done(&format!("{} --json", eval("v.csv"))).stdout);
    assert_eq!((&none["counted"], &none["length"], &none["depth"]), (&json!(0), &Value::Null, &Value::Null));
    let table = folder.done(&eval("v.csv")).stdout;
    assert!(table.contains("  greatest depth                     n/a         n/a         n/a\n"), "{table}");
}

#[test]
fn steps_that_stand_still_or_meet_walls_are_told() {
    let folder = Folder::hand_made();
    // A tight room, so that many steps meet a wall; and one trace with three steps of which one stands still.
    folder.write("room.wkt", "LINESTRING (0 0, 4 0, 4 3, 0 3, 0 0)\nPOINT (1 1)\n");
    let mut shares = vec![];
    for (at_walls, words) in [
        ("redraw", "were drawn again at walls"),
        ("reject", "were not taken at walls"),
        ("reflect", "were thrown back"),
    ] {
        folder.write(
            "w.toml",
            format!(
                "[scene]\nfile = \"room.wkt\"\n[walk]\nkind = \"uniform\"\nstep = 1.0\nsteps = 200\n\
                 at_walls = \"{at_walls}\"\n[run]\ntraces = 50\n"
            ),
        );
        let out = format!("out-{at_walls}");
        let shown = folder.done(&format!("study run w.toml --out {out}")).stdout;
        let summary = json_of(&folder.text(&format!("{out}/summary.json")));
        let [still, met] = ["still", "at_walls"].map(|name| summary[name].as_f64().unwrap());
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let line = format!("{} of the steps stood still, {} {words}", percent(still), percent(met));
        assert!(shown.contains(&line), "{line}\n{shown}");
        let page = folder.text(&format!("{out}/report.html"));
        assert!(page.contains("<dt>steps that stood still</dt>") && page.contains(" at walls</dt>"));
        // Each step is as it is in the points.
        let mut stood = 0;
        for trace in 0..50 {
            folder.done(&format!("study replay {out} --trace {trace} --points p.csv"));
            let points: Vec<String> = folder.text("p.csv").lines().skip(1).map(str::to_owned).collect();
            stood += points.windows(2).filter(|pair| pair[0] == pair[1]).count();
        }
        assert_eq!(still, stood as f64 / 10_000.0, "{at_walls}");
        shares.push([still, met]);
    }
    let [redraw, reject, reflect] = shares[..] else { unreachable!() };
    assert_eq!(reject[0], reject[1], "what is not taken stands still");
    assert!(redraw[0] < 0.01 && redraw[1] > 0.1 && reject[1] > 0.1 && reflect[1] > 0.1, "{shares:?}");
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,0\n0,1,0\n0,2,0\n");
    folder.write("g.toml", GIVEN);
    assert!(folder.done("study run g.toml --out g").stdout.contains("33.33 % of the steps stood still\n"));
    assert_eq!(json_of(&folder.text("g/summary.json"))["at_walls"], Value::Null);
    let eval = "eval --scene s.geojson --traces t.csv";
    assert!(folder.done(eval).stdout.contains("traces   1, 3 steps, 1 of which stand still\n"));
    assert_eq!(json_of(&folder.done(&format!("{eval} --json")).stdout)["still"], 1);
}

#[test]
fn walks_that_cannot_move_are_refused_with_the_numbers() {
    let folder = Folder::new();
    folder.write(
        "box.wkt",
        "LINESTRING (0 0, 90 0, 90 60, 0 60, 0 0)\nLINESTRING (1 1, 2 1, 2 2, 1 2, 1 1)\nPOINT (1.5 1.5)\n",
    );
    let study = |kind: &str, step: &str, more: &str| {
        folder.write(
            "s.toml",
            format!(
                "[scene]\nfile = \"box.wkt\"\n[walk]\nkind = \"{kind}\"\nstep = {step}\nsteps = 20\n{more}\n[run]\ntraces = 50\n"
            ),
        );
    };
    for kind in ["uniform", "persistent"] {
        for at_walls in ["redraw", "reject", "reflect"] {
            study(kind, "50.0", &format!("at_walls = \"{at_walls}\""));
            for run in ["study run s.toml --out no", "study run s.toml --dry-run"] {
                let parts =
                    ["all walks stand still", "none of the 100 steps of the first 5 traces", "(1.5, 1.5)", "than 50"];
                folder.refused(2, run, &parts);
            }
            assert!(!folder.path("no").exists());
        }
    }
    for kind in ["uniform", "gaussian", "persistent", "waypoints"] {
        study(kind, "90.5", "");
        folder.refused(
            2,
            "study run s.toml --out no",
            &["walk.step: a step of 90.5 is wider than the scene", "90 by 60"],
        );
    }
    study("uniform", "0.3", "");
    folder.done("study run s.toml --out yes");
}

/// The program, where everyone can run it.
fn for_everyone(folder: &Folder) -> std::path::PathBuf {
    let program = folder.path("tautline");
    fs::copy(cargo_bin!("tautline"), &program).unwrap();
    program
}

#[cfg(unix)]
#[test]
fn no_permission_has_one_exit_code() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;

    let folder = Folder::hand_made();
    let program = for_everyone(&folder);
    fs::create_dir(folder.path("locked")).unwrap();
    folder.write("locked/secret.csv", super::TRACES);
    folder.write("locked/secret.geojson", super::SCENE);
    folder.write("locked/secret.toml", GIVEN);
    for (name, mode) in [("", 0o755), ("locked", 0o555)] {
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(mode)).unwrap();
    }
    for name in ["locked/secret.csv", "locked/secret.geojson", "locked/secret.toml"] {
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(0o0)).unwrap();
    }
    // Permissions do not bind the root user.
    let is_root = fs::metadata(folder.path("")).unwrap().uid() == 0;
    let eval = "eval --scene s.geojson --traces t.csv";
    let commands = [
        format!("{eval} --out locked/r.csv"),
        format!("{eval} --events locked/e.parquet"),
        "eval --scene s.geojson --traces locked/secret.csv".into(),
        "eval --scene locked/secret.geojson --traces t.csv".into(),
        "check --scene locked/secret.geojson".into(),
        "convert s.geojson locked/s.wkt".into(),
        "convert locked/secret.geojson s.wkt".into(),
        "draw --scene s.geojson --traces t.csv --out locked/d.svg".into(),
        "draw --gallery locked/gallery".into(),
        "study init locked/new.toml".into(),
        "study run locked/secret.toml".into(),
        "study run --count 10 --out locked/study".into(),
        "study resume locked".into(),
        "tradeoff --count 2 --steps 2 --repeats 1 --seconds 0.001 --engine cpu --out locked/t.svg".into(),
        "man locked".into(),
        "man locked/man".into(),
        "bench --scene locked/secret.geojson".into(),
    ];
    for args in commands {
        let mut command = Command::new(&program);
        command.current_dir(folder.path("")).args(args.split_whitespace());
        if is_root {
            command.uid(65534).gid(65534);
        }
        Finished::of(&mut command).has_failed(2, &args, &["locked"]);
    }
}

#[cfg(unix)]
#[test]
fn examples_of_man_and_completions_work_in_a_fresh_home() {
    let folder = Folder::new();
    for_everyone(&folder);
    fs::create_dir(folder.path("home")).unwrap();
    let home = folder.path("home");
    for (command, made) in [
        (
            "completions",
            &[
                ".local/share/bash-completion/completions/tautline",
                ".zfunc/_tautline",
                ".config/fish/completions/tautline.fish",
            ][..],
        ),
        ("man", &[".local/share/man/man1/tautline.1"]),
    ] {
        let help = folder.done(&format!("{command} --help")).stdout;
        let examples = help.lines().skip_while(|line| *line != "Examples:").skip(1);
        for line in examples.take_while(|line| line.starts_with("  ")) {
            let line = line.trim().split("   ").next().unwrap();
            let mut shell = Command::new("sh");
            shell.args(["-c", line]).current_dir(&home).env("HOME", &home);
            shell.env("PATH", format!("{}:{}", folder.path("").display(), std::env::var("PATH").unwrap()));
            let finished = Finished::of(&mut shell);
            assert_eq!(finished.code, Some(0), "{line}: {}", finished.stderr);
        }
        for file in made {
            assert!(fs::metadata(home.join(file)).unwrap().len() > 100, "{file}");
        }
    }
}

#[test]
fn help_offers_what_is_taken() {
    let folder = Folder::hand_made();
    for command in ["study run", "study resume"] {
        for (help, is_long) in [("-h", false), ("--help", true)] {
            let help = folder.done(&format!("{command} {help}")).stdout;
            assert!(["auto", "gpu", "cpu", "reference"].iter().all(|name| help.contains(name)), "{help}");
            assert!(!help.contains("funnel") && !help.contains("note"), "{command}, {is_long}: {help}");
        }
    }
    // All that is offered is taken, and nothing else.
    for engine in ["auto", "cpu", "reference"] {
        folder.done(&format!("study run --dry-run --count 5 --engine {engine}"));
    }
    for engine in ["funnel", "note"] {
        folder.refused(2, &format!("study run --dry-run --count 5 --engine {engine}"), &[engine, "same events"]);
    }
    assert!(folder.done("eval --help").stdout.contains("funnel"));
    folder.refused(2, "study run --engine nonsense", &["nonsense", "auto", "reference"]);
    // One meaning: traces are a file, and counts are counts.
    for command in ["study run", "bench", "tradeoff", "eval", "check", "draw"] {
        let help = folder.done(&format!("{command} --help")).stdout;
        for line in help.lines().filter(|line| line.trim_start().starts_with("--traces")) {
            assert!(line.contains("--traces <FILE>"), "{command}: {line}");
        }
    }
    folder.done("study run --dry-run --count 5");
}

#[test]
fn the_repository_takes_no_example_study_and_examples_leave_nothing() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let ignored = fs::read_to_string(root.join(".gitignore")).unwrap();
    assert!(ignored.lines().any(|line| line == "/example-study*/"), "{ignored}");
    let mut folders = vec![root.join("src")];
    let mut seen = 0;
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            seen += 1;
            let text = fs::read_to_string(&path).unwrap_or_default();
            let said = text.lines().find(|line| line.trim_start().starts_with("///") && line.contains("env::temp_dir"));
            assert_eq!(said, None, "{}: an example that leaves a file behind", path.display());
        }
    }
    assert!(seen > 200, "{seen}");
}
