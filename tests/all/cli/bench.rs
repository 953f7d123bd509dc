//! `tautline bench`: what it counts is checked, not what it times.

use serde_json::{Value, json};

use super::Folder;

/// Little work, all engines.
const SMALL: &str =
    "bench --scene random-40 --step 0.03 --count 6 --steps 60 --repeats 2 --seconds 0.03 --adapter software";

fn results(folder: &Folder, args: &str) -> Vec<Value> {
    let report: Value = serde_json::from_str(&folder.done(&format!("{args} --json")).stdout).unwrap();
    report["results"].as_array().unwrap().clone()
}

/// Fails unless `spread` is three positive numbers in order.
fn assert_spread(spread: &Value) {
    let [min, median, max] = ["min", "median", "max"].map(|key| spread[key].as_f64().unwrap());
    assert!(0.0 < min && min <= median && median <= max, "{spread}");
}

#[test]
fn all_engines_stand_side_by_side() {
    let rows = results(&Folder::new(), SMALL);
    let names: Vec<_> = rows.iter().map(|r| (r["engine"].as_str().unwrap(), r["variant"].as_str().unwrap())).collect();
    let expected = [
        ("gpu", "resident"),
        ("cpu", "windows"),
        ("gpu-windows", "windows"),
        ("gpu-rays", "all vertices"),
        ("gpu", "fast, windows"),
        ("funnel", "every step"),
        ("funnel", "final rope only"),
        ("note", "listing 1"),
        ("reference", "one by one"),
    ];
    assert_eq!(names, expected);
    for row in &rows {
        for (key, value) in [("scene", json!("random-40")), ("n", json!(80)), ("step", json!(0.03))] {
            assert_eq!(row[key], value, "{row}");
        }
        assert_eq!(row["batch"], 6, "{row}");
        match (row["engine"].as_str(), row["variant"].as_str()) {
            (Some("gpu-rays"), _) => assert_eq!(row["remaining"], 80, "{row}"),
            (Some("gpu" | "gpu-windows" | "cpu"), _) => {
                assert!((1..=80).contains(&row["remaining"].as_u64().unwrap()), "{row}")
            }
            _ => assert!(row["remaining"].is_null(), "{row}"),
        }
        let [traces, steps, threads] = ["traces", "steps", "threads"].map(|key| row[key].as_u64().unwrap());
        assert!((1..=6).contains(&traces) && (1..=60).contains(&steps) && threads > 0, "{row}");
        assert_spread(&row["ns_per_step"]);
        assert_spread(&row["relative"]["paired"]);
        for phase in ["queries", "upload", "kernel", "readback", "update"] {
            assert!(row["phases"][phase].as_f64() >= Some(0.0), "{row}");
        }
        let [rate, ns] = [&row["steps_per_second"], &row["ns_per_step"]["median"]].map(|v| v.as_f64().unwrap());
        assert!((rate * ns / 1e9 - 1.0).abs() < 1e-9, "{row}");
    }
}

#[test]
fn what_is_counted_is_what_engines_do() {
    let rows = results(&Folder::new(), SMALL);
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap();
    for row in &rows {
        let (engine, tests) = (row["engine"].as_str().unwrap(), number(row, "tests_per_step"));
        match (engine, row["variant"].as_str().unwrap()) {
            ("funnel", _) | ("gpu", "resident") => {
                assert!(tests == 0.0 && row["tests_avoided_per_step"].is_null() && row["tests_per_second"].is_null());
            }
            _ => {
                assert!((tests + number(row, "tests_avoided_per_step") - 81.0).abs() < 1e-9, "{row}");
                let per_second = tests * number(row, "steps_per_second");
                assert!((number(row, "tests_per_second") - per_second).abs() <= 1e-9 * per_second, "{row}");
            }
        }
        match engine {
            "note" => assert_eq!(tests, 80.0),
            "reference" | "gpu-rays" => {
                assert!((tests - 80.0 * (1.0 + number(row, "events_per_step"))).abs() < 1e-9, "{row}")
            }
            _ => {}
        }
        let share = &row["share_of_peak"];
        assert_eq!(share.as_f64().is_some_and(|share| share > 0.0), engine == "gpu-rays", "{row}");
        let promises = engine != "note" && row["precision"] != "fast";
        assert_eq!((row["precision"] == "certified", row["wrong_ropes"].is_null()), (promises, promises), "{row}");
        let per_second = number(row, "events_per_step") * number(row, "steps_per_second");
        assert!((number(row, "events_per_second") - per_second).abs() <= 1e-9 * per_second, "{row}");
    }
    // The same traces give the same events.
    let exact: Vec<_> = rows.iter().filter(|r| r["precision"] == "certified" && r["engine"] != "funnel").collect();
    assert_eq!(exact.len(), 5);
    for [one, other] in exact
        .windows(2)
        .map(|pair| [pair[0], pair[1]])
        .filter(|[a, b]| a["traces"] == b["traces"] && a["steps"] == b["steps"])
    {
        assert_eq!(one["events_per_step"], other["events_per_step"]);
    }
}

#[test]
fn the_environment_is_told() {
    let folder = Folder::new();
    let args = "bench --scene lattice-30 --count 2 --steps 20 --repeats 1 --seconds 0.01 --seed 9";
    let report =
        |more: &str| -> Value { serde_json::from_str(&folder.done(&format!("{args} --json {more}")).stdout).unwrap() };
    let without = report("--engine cpu --engine note");
    let environment = &without["environment"];
    assert_eq!((&environment["version"], &environment["seed"]), (&json!(env!("CARGO_PKG_VERSION")), &json!(9)));
    assert!(environment["os"].as_str().unwrap().starts_with(std::env::consts::OS));
    assert!(environment["threads"].as_u64() > Some(0) && !environment["processor"].as_str().unwrap().is_empty());
    assert_eq!((&environment["adapter"], &environment["driver"]), (&Value::Null, &Value::Null));
    assert_eq!((without["results"].as_array().unwrap().len(), &without["skipped"]), (2, &json!([])));
    let with = report("--engine gpu --adapter software");
    assert_eq!(with["environment"]["adapter_type"], "software");
    assert!(!with["environment"]["adapter"].as_str().unwrap().is_empty());
    // No baseline, no ratio to it.
    assert!(with["results"].as_array().unwrap().iter().all(|row| row["relative"].is_null()));
}

#[test]
fn people_get_tables() {
    let shown = Folder::new().done(SMALL);
    assert!(shown.stderr.starts_with("engine: gpu on ") && shown.stderr.lines().count() == 1, "{}", shown.stderr);
    let lines: Vec<&str> = shown.stdout.lines().collect();
    assert!(lines.contains(&"scene     random-40: 80 wall ends; steps of about 0.03000"), "{}", shown.stdout);
    assert!(lines.contains(&"work      6 traces of 60 steps, seed 1; 2 runs each, interleaved"), "{}", shown.stdout);
    let starting = |start: &str| lines.iter().filter(|line| line.starts_with(start)).count();
    // One row in the table of rates and one in that of counts, besides that of phases.
    for (start, rows) in [("cpu ", 2), ("note ", 2), ("reference ", 2), ("funnel ", 2), ("engine ", 2)] {
        assert!(starting(start) >= rows, "{start}: {}", shown.stdout);
    }
    assert!(lines.iter().any(|line| line.starts_with("gpu-windows ") && line.contains("windows to 256")));
}

#[test]
fn sweeps_have_a_row_a_value_and_engine() {
    let folder = Folder::new();
    let args = "bench --count 2 --steps 10 --repeats 1 --seconds 0.002 --engine cpu --engine note";
    let swept = |sweep: &str, key: &str| -> Vec<f64> {
        let rows = results(&folder, &format!("{args} --sweep {sweep}"));
        let engines: Vec<_> = rows.iter().map(|r| r["engine"].as_str().unwrap()).collect();
        assert_eq!(engines, ["cpu", "note"].repeat(rows.len() / 2));
        rows.iter().step_by(2).map(|row| row[key].as_f64().unwrap()).collect()
    };
    assert_eq!(swept("batch", "batch"), [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0]);
    assert_eq!(swept("window", "window"), [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0]);
    let steps = swept("step", "step");
    assert_eq!((steps.len(), steps[2]), (4, 0.01));
    let rows = results(&folder, &format!("{args} --sweep n --engine note"));
    let notes: Vec<_> = rows.iter().filter(|row| row["engine"] == "note").collect();
    let n: Vec<_> = notes.iter().map(|row| row["n"].as_u64().unwrap()).collect();
    assert_eq!(n, [100, 320, 1000, 3200, 10_000, 34_706]);
    for row in notes {
        // Steps shrink as the distances between walls do; the note tests every vertex at every step.
        let (n, step) = (row["n"].as_f64().unwrap(), row["step"].as_f64().unwrap());
        assert!(
            (step * (n / 1000.0).sqrt() - 0.01).abs() < 1e-12 && row["tests_per_step"] == row["n"].as_f64().unwrap()
        );
    }
    let table = folder.done(&format!("{args} --sweep step")).stdout;
    assert!(table.lines().any(|line| line.starts_with("step ") && line.contains("x note")), "{table}");
}

#[test]
fn scenes_may_be_files() {
    let folder = Folder::hand_made();
    let args = "bench --count 3 --steps 30 --repeats 1 --seconds 0.01 --engine cpu --engine reference";
    let rows = results(&folder, &format!("{args} --scene s.geojson"));
    assert_eq!((&rows[0]["scene"], &rows[0]["n"]), (&json!("s.geojson"), &json!(4)));
    // The anchor and four ends span 6 by 13, and there are two walls.
    let step = 0.1 * (6.0 * 13.0 / 2.0f64).sqrt();
    assert!((rows[0]["step"].as_f64().unwrap() - step).abs() < 1e-12, "{}", rows[0]);
    let rows = results(&folder, &format!("{args} --scene s.geojson --anchor 1,1 --step 0.5"));
    assert_eq!(rows[1]["step"], 0.5);
}

#[test]
fn bad_usage_is_told_with_what_would_do() {
    let folder = Folder::hand_made();
    let all = ["random-M", "lattice-M", "rooms"];
    folder.refused(2, "bench --scene foo", &[&["\"foo\"", "no file of that name"][..], &all].concat());
    folder.refused(2, "bench --scene random-x", &["random-x: \"x\" is no number of walls", "1 to 1,000,000"]);
    folder.refused(2, "bench --scene lattice-0", &["lattice-0: \"0\" is no number of walls", "such as lattice-500"]);
    folder.refused(2, "bench --scene no.geojson", &["no.geojson"]);
    folder.refused(2, "bench --scene t.csv", &["t.csv", ".geojson", ".map"]);
    folder.refused(2, "bench --scene s.geojson --anchor nan,1", &["NaN is not a finite number"]);
    folder.refused(2, "bench --scene s.geojson --anchor 3", &["--anchor", "such as 1.5,-2"]);
    folder.refused(2, "bench --scene rooms --anchor 1,1", &["--anchor goes with a scene file"]);
    folder.refused(2, "bench --scene rooms --sweep n", &["rooms", "a sweep over n goes through scenes random-M"]);
    folder.refused(2, "bench --sweep m", &["m", "batch", "step", "window"]);
    for step in ["0", "-1", "nan", "inf", "1e-320", "1e30", "x"] {
        folder.refused(2, &format!("bench --step={step}"), &["--step", "a number from 1e-9 to 1e9"]);
    }
    for option in ["--count", "--steps", "--repeats", "--window"] {
        folder.refused(2, &format!("bench {option} 0"), &[option, "0"]);
    }
    folder.refused(2, "bench --engine auto", &["auto", "gpu", "cpu", "funnel", "note", "reference"]);
    folder.refused(2, "bench --engine cpu --adapter software", &["--adapter goes with --engine gpu"]);
    folder.refused(3, "bench --adapter NoSuchThing", &["\"NoSuchThing\""]);
}
