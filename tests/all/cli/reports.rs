//! What the commands print: tables for people, one JSON document for programs, and the rest on stderr.

use serde_json::{Value, json};

use super::Folder;

/// Stdout, which must be one JSON document and nothing else.
fn report(folder: &Folder, args: &str) -> Value {
    serde_json::from_str(&folder.done(args).stdout).unwrap()
}

#[test]
fn eval_alone_shows_the_example() {
    let folder = Folder::new();
    let shown = folder.done("eval");
    for part in [
        "the built-in floor plan: 467 walls with 503 ends, 466 of which a rope can turn at, anchor (24.3, 9.2)\n",
        "traces   4,000, 2,000,000 steps\n",
        "rope length at the end",
        "steps/s\n",
        "--out FILE writes",
    ] {
        assert!(shown.stdout.contains(part), "{part:?} is missing in\n{}", shown.stdout);
    }
    // What was chosen, on one line: nobody asked for an engine. A slow machine tells how far it is.
    let told = shown.stderr.lines().filter(|line| !line.starts_with("progress: "));
    assert!(shown.stderr.starts_with("engine: ") && told.count() == 1, "{}", shown.stderr);
    assert!(folder.files().is_empty());
}

#[test]
fn long_work_shows_no_bar_where_nobody_watches() {
    // The example takes the reference seconds; a bar would show after one, a line after ten.
    let shown = Folder::new().done("eval --engine reference");
    assert!(shown.stdout.contains("engine   reference (certified) on one thread\n"), "{}", shown.stdout);
    assert!(shown.stderr.lines().all(|line| line.starts_with("progress: ")), "{}", shown.stderr);
}

#[test]
fn eval_sums_up_in_a_table() {
    let shown = Folder::hand_made().done("eval --scene s.geojson --traces t.csv --engine reference").stdout;
    for line in [
        "scene    s.geojson: 2 walls with 4 ends, anchor (0, 0)",
        "traces   4, 12 steps",
        "events   4 wraps, 1 unwrap, 0.4167 a step",
        "  over all traces                   mean      median         max",
        "  rope length at the end           10.25       9.500       22.00",
        "  greatest rope length             12.25       13.00       23.00",
        "  depth at the end                0.7500      0.5000       2.000",
        "  greatest depth                   1.000       1.000       2.000",
    ] {
        assert!(shown.lines().any(|l| l == line), "{line:?} is missing in\n{shown}");
    }
}

#[test]
fn eval_sums_up_in_json() {
    let folder = Folder::hand_made();
    let report = report(&folder, "eval --scene s.geojson --traces t.csv --json --engine gpu --adapter software");
    let scene = |remaining: Value| {
        json!({
            "name": "s.geojson", "walls": 2, "vertices": 4, "remaining": remaining, "dropped": 0, "anchor": [0.0, 0.0],
        })
    };
    for (field, expected) in [
        ("scene", scene(json!(4))),
        ("engine", json!("gpu")),
        ("precision", json!("certified")),
        ("version", json!(env!("CARGO_PKG_VERSION"))),
        ("traces", json!(4)),
        ("steps", json!(12)),
        ("violations", json!(0)),
        ("counted", json!(4)),
        ("still", json!(0)),
        ("wraps", json!(4)),
        ("unwraps", json!(1)),
        ("length", json!({"mean": 10.25, "median": 9.5, "max": 22.0})),
        ("max_length", json!({"mean": 12.25, "median": 13.0, "max": 23.0})),
        ("depth", json!({"mean": 0.75, "median": 0.5, "max": 2.0})),
        ("max_depth", json!({"mean": 1.0, "median": 1.0, "max": 2.0})),
    ] {
        assert_eq!(report[field], expected, "{field}");
    }
    assert!(report["on"].as_str().unwrap().contains("software"), "{}", report["on"]);
    assert!(report["steps_per_second"].as_f64().unwrap() > 0.0);
    let by_reference = self::report(&folder, "eval --scene s.geojson --traces t.csv --json --engine reference");
    // Every wall end on each of 14 legs, 12 steps and two moves from the anchor, and again after each of the 5 events.
    let tests = 19 * by_reference["scene"]["vertices"].as_u64().unwrap();
    assert!(by_reference["tests"] == tests && by_reference["tests_per_second"].as_f64().unwrap() > 0.0);
    assert_eq!(by_reference["scene"], scene(Value::Null));
}

#[test]
fn eval_says_how_many_wall_ends_are_tried() {
    let folder = Folder::hand_made();
    // A box round the anchor, and one out of reach.
    folder.write("room.wkt", "POLYGON ((-1 -1, 1 -1, 1 1, -1 1, -1 -1))\nPOLYGON ((8 8, 9 8, 9 9, 8 9, 8 8))");
    folder.write("in.csv", "trace,x,y\n0,0.5,0.5\n0,-0.5,0.25\n");
    for (args, tried) in [
        ("--scene s.geojson --traces t.csv", "2 walls with 4 ends, all of which are tried, anchor"),
        ("--scene room.wkt --anchor 0,0 --traces in.csv", "8 walls with 8 ends, 0 of which a rope can turn at, anchor"),
    ] {
        let shown = folder.done(&format!("eval {args} --engine cpu")).stdout;
        assert!(shown.contains(tried), "{tried:?} is missing in\n{shown}");
    }
}

#[test]
fn check_counts_what_is_there() {
    let folder = Folder::hand_made();
    folder.write("z.geojson", r#"{"type": "LineString", "coordinates": [[0, 0], [0, 0], [1, 0]]}"#);
    folder.write("v.csv", "trace,x,y\n0,0,12\n0,5,12\n3,1,0\n3,5,0\n");
    let scene = json!({
        "name": "s.geojson", "walls": 2, "vertices": 4, "dropped": 0, "solid": 0, "box": [[3.0, -9.0], [6.0, 4.0]],
        "unit": null, "y": "up", "layers": [], "labels": [], "anchor": [0.0, 0.0], "warnings": [], "notes": [],
    });
    let mut violation = report(&folder, "check --scene s.geojson --json --traces v.csv --on-violation flag");
    let violation = violation["traces"]["violations"][0].take();
    for (key, value) in [("trace", json!(3)), ("step", json!(1)), ("kind", json!("crosses")), ("wall", json!(0))] {
        assert_eq!(violation[key], value, "{violation}");
    }
    assert_eq!([&violation["from"], &violation["to"]], [&json!([1.0, 0.0]), &json!([5.0, 0.0])]);
    for (traces, counted) in [
        ("", Value::Null),
        ("--traces t.csv", json!({"traces": 4, "steps": 12, "violations": []})),
        ("--traces v.csv --on-violation flag", json!({"traces": 2, "steps": 2, "violations": [violation]})),
    ] {
        let found = report(&folder, &format!("check --scene s.geojson --json {traces}"));
        assert_eq!(found, json!({"scene": scene, "traces": counted}), "{traces}");
    }
    let shown = folder.done("check --scene s.geojson --traces t.csv").stdout;
    assert!(shown.contains("s.geojson: 2 walls, 4 vertices, anchor (0, 0)\n"), "{shown}");
    assert!(shown.contains("4, 12 steps; 0 of the traces cross walls\n"), "{shown}");
    let shown = folder.done("check --scene z.geojson --anchor 3,0").stdout;
    assert!(shown.contains("1 wall, 2 vertices, anchor (3, 0)\n"), "{shown}");
    assert!(shown.contains("1 wall of zero length was dropped\n") && !shown.contains("traces"), "{shown}");
    let shown = folder.done("check").stdout;
    assert!(shown.contains("the built-in floor plan: 467 walls") && shown.contains("4000, 2000000 steps"), "{shown}");
}

#[test]
fn check_refuses_what_eval_refuses() {
    let folder = Folder::hand_made();
    folder.write("v.csv", "trace,x,y\n3,1,0\n3,5,0\n");
    folder.refused(2, "check --scene s.geojson --traces v.csv", &["v.csv: trace 3, step 1: ", "crosses wall 0"]);
    folder.refused(2, "check --scene s.wkb", &["s.wkb", ".geojson, .json, .wkt, .svg, .dxf, .map, .yaml, .yml"]);
    folder.refused(2, "check --traces t.csv", &["--traces needs --scene"]);
    folder.refused(2, "check --scene s.geojson --anchor nan,1", &["NaN is not a finite number"]);
}

#[test]
fn adapters_lists_the_software_adapter() {
    let folder = Folder::new();
    let report = report(&folder, "adapters --json");
    let adapters = report["adapters"].as_array().unwrap();
    let software = adapters.iter().find(|a| a["type"] == "software").expect("a software adapter must be installed");
    let shown = folder.done("adapters");
    assert_eq!(shown.stderr, "");
    let header: Vec<_> = shown.stdout.lines().next().unwrap().split_whitespace().collect();
    assert_eq!(header, ["number", "adapter", "type", "backend", "driver"]);
    let [name, backend, driver] = ["name", "backend", "driver"].map(|field| software[field].as_str().unwrap());
    assert!(!name.is_empty() && ["vulkan", "metal", "dx12"].contains(&backend) && !driver.is_empty(), "{software}");
    let (number, line) = shown
        .stdout
        .lines()
        .find_map(|line| line.trim_start().split_once("  ").filter(|l| l.1.starts_with(name)))
        .unwrap();
    assert_eq!(json!(number.parse::<u64>().unwrap()), software["number"]);
    assert_eq!(line[name.len()..].split_whitespace().take(2).collect::<Vec<_>>(), ["software", backend]);
    assert!(line.ends_with(driver), "{line}");
    let taken = software["memory"]["taken"].as_u64().unwrap();
    assert!(shown.stdout.contains(&format!("traces take at most {} MiB at once (--gpu-memory)", taken >> 20)));
    let real = adapters.iter().any(|a| ["discrete", "integrated", "virtual"].contains(&a["type"].as_str().unwrap()));
    assert_eq!(shown.stdout.contains("no real GPU"), !real, "{}", shown.stdout);
}

#[test]
fn help_and_version_go_to_stdout() {
    let folder = Folder::new();
    let version = folder.done("--version");
    assert_eq!(version.stdout, concat!("tautline ", env!("CARGO_PKG_VERSION"), "\n"));
    for (args, parts) in [
        ("--help", &["eval", "check", "adapters", "Exit codes: 0 done; 1 internal error; 2 bad input or usage"][..]),
        (
            "eval --help",
            &["--scene", "--traces", "--out", "--events", "--engine", "reference", "--adapter", "--on-violation"],
        ),
        ("check --help", &["--scene", "--traces", "--anchor", "--json"]),
        ("adapters --help", &["--json"]),
    ] {
        let help = folder.done(args);
        assert_eq!(help.stderr, "", "{args}");
        for part in parts {
            assert!(help.stdout.contains(part), "{args}: {part:?} is missing in\n{}", help.stdout);
        }
    }
}

#[test]
fn shells_complete_and_manual_pages_name_all_commands() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.done(&format!("completions {shell}")).stdout;
        assert!(script.contains("tautline") && script.contains("on-violation"), "{shell}: {script}");
    }
    folder.refused(2, "completions tcsh", &["tcsh", "bash"]);
    folder.done("man man");
    let page = |name: &str| folder.text(&format!("man/tautline{name}.1"));
    for (name, part) in [("", "tautline\\-eval(1)"), ("-eval", "on\\-violation"), ("-study-run", "dry\\-run")] {
        assert!(page(name).contains(part), "{name}: {}", page(name));
    }
    folder.write("file", "");
    folder.refused(2, "man file", &["cannot make the folder file"]);
}
