//! `tautline tradeoff`: what it counts is checked, not what it times.

use serde_json::{Value, json};

use super::Folder;

/// Little work, all methods.
const SMALL: &str = "tradeoff --scene lattice-60 --step 0.3 --count 30 --steps 80 --stride 1,3 --simplify 0.2,1.5 --repeats 2 \
                     --seconds 0.03 --adapter software";

fn report(folder: &Folder, args: &str) -> Value {
    serde_json::from_str(&folder.done(&format!("{args} --json")).stdout).unwrap()
}

fn text<'a>(point: &'a Value, key: &str) -> &'a str {
    point[key].as_str().unwrap()
}

#[test]
fn every_method_runs_at_every_setting() {
    let report = report(&Folder::new(), SMALL);
    let points = report["points"].as_array().unwrap();
    let failed = report["failed"].as_array().unwrap();
    let methods = [
        "gpu certified",
        "gpu fast",
        "cpu certified",
        "funnel, every step",
        "funnel, final rope",
        "note, listing 1",
        "note, furthest",
    ];
    for method in methods {
        for setting in ["stride 1", "stride 3", "simplify 0.2", "simplify 1.5"] {
            let ran = points.iter().filter(|p| text(p, "method") == method && text(p, "setting") == setting).count();
            let is_meant = |f: &Value| f["setting"] == setting && [method, "all"].contains(&text(f, "method"));
            let is_explained = failed.iter().any(|f| is_meant(f) && !text(f, "why").is_empty());
            assert!(ran == 1 || (ran == 0 && is_explained), "{method}, {setting}");
        }
    }
    assert!(points.iter().any(|p| p["method"] == "reference" && p["setting"] == "stride 1"));
    for point in points {
        let [min, median, max] = ["min", "median", "max"].map(|key| point["ns_per_step"][key].as_f64().unwrap());
        assert!(0.0 < min && min <= median && median <= max, "{point}");
        let traces = point["traces"].as_u64().unwrap();
        assert!((1..=30).contains(&traces) && point["steps"].as_u64() == Some(80 * traces), "{point}");
        assert!(point["final_mismatch"].as_u64() <= Some(traces), "{point}");
        let [mean, worst] = ["mean", "max"].map(|key| point["length_error"][key].as_f64().unwrap());
        assert!(0.0 <= mean && mean <= worst, "{point}");
        assert!(point["mean_length"]["truth"].as_f64() > Some(0.0), "{point}");
        assert_eq!(point["event_mismatch"].is_null(), point["method"] == "funnel, final rope", "{point}");
        assert_eq!(point["mean_wraps"].is_null(), point["method"] == "funnel, final rope", "{point}");
    }
    assert_eq!((&report["traces"], &report["steps"], &report["n"]), (&json!(30), &json!(2400), &points[0]["n"]));
    assert!(report["vouched_by_reference"].as_u64() >= Some(1));
    assert!(!text(&report["environment"], "processor").is_empty());
}

#[test]
fn exact_methods_have_no_errors_and_the_note_has() {
    let report = report(&Folder::new(), SMALL);
    let exact: Vec<&Value> =
        report["points"].as_array().unwrap().iter().filter(|p| p["setting"] == "stride 1").collect();
    for point in &exact {
        let (method, wrong) = (text(point, "method"), point["final_mismatch"].as_u64().unwrap());
        match method {
            "note, listing 1" | "note, furthest" => assert!(wrong > 0, "{point}"),
            "gpu fast" => {}
            _ => assert_eq!((wrong, &point["length_error"]["max"]), (0, &json!(0.0)), "{point}"),
        }
        if method.ends_with("certified") || method == "reference" {
            assert_eq!(point["event_mismatch"], 0, "{point}");
            assert_eq!(point["mean_wraps"]["value"], point["mean_wraps"]["truth"], "{point}");
        }
    }
    // The fastest exact point is beaten by none in being right, so it, or one as right and faster, is marked.
    let marked = report["points"].as_array().unwrap().iter().filter(|p| p["pareto"] == true);
    assert!(marked.clone().any(|p| p["final_mismatch"] == 0));
    assert!(marked.clone().all(|p| !text(p, "method").starts_with("reference")));
}

#[test]
fn people_get_tables_and_a_diagram() {
    let folder = Folder::new();
    let shown = folder.done(&format!("{SMALL} --out d.svg"));
    let table = &shown.stdout;
    let has = |start: &str| table.lines().any(|line| line.starts_with(start));
    assert!(
        has("scene     lattice-60: ") && has("work      30 traces, 2,400 steps; 2 runs each, interleaved"),
        "{table}"
    );
    assert!(table.contains("note, listing 1") && table.contains("below 3/30") && has("* "), "{table}");
    assert!(has("the study's own answers") && has("what failed"), "{table}");
    assert!(!table.contains("--out FILE draws the diagram"));
    let svg = folder.text("d.svg");
    for name in
        ["note, listing 1", "gpu fast", "below 3/N", "green: less than the sample leaves open", "ns per trace-step"]
    {
        assert!(svg.contains(&format!(">{name}<")), "{name}");
    }
    roxmltree::Document::parse(&svg).unwrap();
    let few = "tradeoff --count 3 --steps 20 --repeats 1 --seconds 0.001 --engine cpu";
    assert!(folder.done(few).stdout.contains("--out FILE draws the diagram"));
    folder.done(&format!("{few} --out d.png"));
    assert!(folder.read("d.png").starts_with(b"\x89PNG"));
}

#[test]
fn traces_may_be_given() {
    let folder = Folder::hand_made();
    let report = report(
        &folder,
        "tradeoff --scene s.geojson --traces t.csv --engine cpu --engine funnel --repeats 1 --seconds 0.01",
    );
    assert_eq!((&report["traces"], &report["steps"]), (&json!(4), &json!(12)));
    assert!(report["points"].as_array().unwrap().iter().any(|p| p["engine"] == "funnel"));
    folder.write("bad.csv", "trace,x,y\n0,0,0\n0,5,0\n");
    folder.refused(
        2,
        "tradeoff --scene s.geojson --traces bad.csv --engine cpu",
        &["bad.csv", "trace 0, step 1", "crosses wall 0"],
    );
    folder.write("none.csv", "trace,x,y\n");
    folder.refused(2, "tradeoff --scene s.geojson --traces none.csv --engine cpu", &["none.csv", "no traces"]);
    folder.refused(2, "tradeoff --scene s.geojson --traces t.csv --steps 5 --engine cpu", &["--steps", "as they are"]);
}

#[test]
fn bad_usage_is_told_with_what_would_do() {
    let folder = Folder::hand_made();
    folder.refused(2, "tradeoff --count 0", &["--count", "0"]);
    folder.refused(2, "tradeoff --traces 30", &["--traces 30", "--count 30"]);
    folder.refused(2, "tradeoff --scene s.geojson --traces t.csv --count 5 --engine cpu", &["--count", "as they are"]);
    folder.refused(2, "tradeoff --traces no.csv", &["no.csv"]);
    for stride in ["0", "-2", "1.5", "x", "2,,3"] {
        folder.refused(2, &format!("tradeoff --stride={stride}"), &["--stride", "whole number from 1 to 4294967295"]);
    }
    for tolerance in ["0", "-1", "nan", "inf", "x"] {
        folder.refused(2, &format!("tradeoff --simplify={tolerance}"), &["--simplify", "number above 0"]);
    }
    folder.refused(2, "tradeoff --out d.html", &["d.html", ".svg or .png"]);
    folder.refused(2, "tradeoff --engine cpu --adapter software", &["--adapter goes with --engine gpu"]);
    folder.refused(3, "tradeoff --adapter NoSuchThing", &["\"NoSuchThing\""]);
    folder.refused(2, "tradeoff --scene foo", &["\"foo\"", "rooms"]);
}
