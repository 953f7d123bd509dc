//! `--stride` and `--simplify`: named in what is reported, nothing without them, the same on all engines.

use serde_json::{Value, json};

use super::Folder;

fn report(folder: &Folder, args: &str) -> Value {
    serde_json::from_str(&folder.done(&format!("{args} --json")).stdout).unwrap()
}

#[test]
fn nothing_is_traded_unless_asked_for() {
    let folder = Folder::floor_plan(50, 200);
    let eval = "eval --scene s.geojson --traces t.csv --engine cpu";
    let plain = report(&folder, &format!("{eval} --out a.jsonl --events ae.jsonl"));
    assert_eq!(plain["traded"], Value::Null);
    let stride_1 = report(&folder, &format!("{eval} --stride 1 --out b.jsonl --events be.jsonl"));
    assert_eq!(stride_1["traded"], Value::Null);
    assert!(folder.read("a.jsonl") == folder.read("b.jsonl") && folder.read("ae.jsonl") == folder.read("be.jsonl"));
    assert!(!folder.done(eval).stdout.contains("traded"));
}

#[test]
fn a_stride_is_named_and_its_jumps_are_counted() {
    let folder = Folder::floor_plan(50, 200);
    let eval = "eval --scene s.geojson --traces t.csv --stride 7";
    let traded = report(&folder, &format!("{eval} --engine cpu --out a.jsonl --events ae.jsonl"));
    let jumps = traded["traded"]["jumps"].as_u64().unwrap();
    // 29 longer steps a trace, of which some lead through a wall.
    assert!(jumps > 0 && jumps < 50 * 29, "{traded}");
    assert_eq!((&traded["traded"]["stride"], &traded["traded"]["simplify"]), (&json!(7), &Value::Null));
    // Those are walked as given, so no trace crosses a wall.
    assert_eq!((&traded["violations"], &traded["traded"]["crossing_steps"]), (&json!(0), &json!(0)));
    // Steps are those of the traces as given.
    assert_eq!((&traded["traces"], &traded["steps"]), (&json!(50), &json!(50 * 200)));
    let table = folder.done(eval).stdout;
    let line = table.lines().find(|line| line.starts_with("traded   ")).unwrap();
    assert!(line.contains("of every 7 points one") && line.contains("longer steps would touch a wall"), "{line}");
    let mut other = 0;
    for line in folder.text("ae.jsonl").lines() {
        let step = serde_json::from_str::<Value>(line).unwrap()["step"].as_u64().unwrap();
        assert!(step <= 200);
        other += usize::from(!step.is_multiple_of(7) && step != 200);
    }
    // Only steps that were walked as given are none of the seventh.
    assert!(other <= 7 * jumps as usize);
    for engine in ["reference", "gpu --adapter software", "gpu-rays --adapter software"] {
        folder.done(&format!("{eval} --engine {engine} --out b.jsonl --events be.jsonl"));
        assert!(folder.read("a.jsonl") == folder.read("b.jsonl"), "{engine}");
        assert!(folder.read("ae.jsonl") == folder.read("be.jsonl"), "{engine}");
    }
}

/// A square with a tooth that sticks out of its side by 0.3, and a fence that is bent by as much.
const TOOTH: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates":
    [[[2, -2], [4, -2], [4, 2], [2, 2], [2, 0.5], [1.7, 0], [2, -0.5], [2, -2]]]}},
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[-3, -2], [-3.3, 0], [-3, 2]]}},
{"type": "Feature", "properties": {"role": "anchor"}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
]}
"#;

#[test]
fn simplified_walls_are_named_and_what_crosses_them_is_counted() {
    let folder = Folder::new();
    folder.write("s.geojson", TOOTH);
    // Trace 0 goes over the square; trace 1 into the fence's bend, where the simplified fence stands, and out again.
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,2.5\n0,5,2.5\n0,5,0\n1,0,0\n1,-3.2,0\n1,-2,0.5\n");
    let eval = "eval --scene s.geojson --traces t.csv --engine cpu";
    let exact = report(&folder, &format!("{eval} --out a.jsonl"));
    assert_eq!((&exact["violations"], &exact["traded"]), (&json!(0), &Value::Null));
    let traded = report(&folder, &format!("{eval} --simplify 0.4 --out b.jsonl"));
    // The tooth's point and the bend are gone.
    assert_eq!((&traded["scene"]["vertices"], &traded["traded"]["vertices_left"]), (&json!(10), &json!(8)));
    let counts = ["crossing_traces", "crossing_steps", "jumps"].map(|key| traded["traded"][key].as_u64().unwrap());
    assert_eq!(counts, [1, 2, 0], "{traded}");
    let rows: Vec<Value> = folder.text("b.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((&rows[0]["status"], &rows[1]["status"]), (&json!("ok"), &json!("violation")));
    let table = folder.done(&format!("{eval} --simplify 0.4")).stdout;
    assert!(
        table.contains("walls simplified by at most 0.4, 8 of 10 wall ends left (1 trace crosses one, in 2 steps)")
    );
    // Less than the tooth is high leaves all as it is.
    folder.done(&format!("{eval} --simplify 0.1 --out c.jsonl"));
    assert!(folder.read("c.jsonl") == folder.read("a.jsonl"));
}

#[test]
fn traces_that_break_the_rules_as_given_are_refused_whatever_is_traded() {
    let folder = Folder::new();
    folder.write("s.geojson", TOOTH);
    // Trace 1 goes through the fence's bend and back.
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,2.5\n1,0,0\n1,-3.5,0.1\n1,-2,0.5\n");
    let eval = "eval --scene s.geojson --traces t.csv --engine cpu";
    folder.write("s.toml", "[scene]\nfile = 's.geojson'\n[walk]\nkind = 'given'\nfile = 't.csv'\n[run]\ntraces = 2\n");
    for trade in ["", "--stride 2", "--simplify 0.4", "--simplify 1e-300", "--stride 2 --simplify 0.4"] {
        folder.refused(2, &format!("{eval} {trade}"), &["t.csv: trace 1, step 1", "crosses wall"]);
        folder.refused(2, &format!("study run s.toml {trade} --out no"), &["trace 1, step 1", "crosses wall"]);
        let flagged = folder.done(&format!("{eval} {trade} --on-violation flag --out f.jsonl"));
        assert!(flagged.stderr.contains("trace 1, step 1") && flagged.stdout.contains("crossing 1 trace crosses"));
        let rows: Vec<Value> = folder.text("f.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!((&rows[0]["status"], &rows[1]["status"]), (&json!("ok"), &json!("violation")), "{trade}");
        assert!(!folder.path("no").exists(), "a failed start leaves no folder");
    }
}

#[test]
fn parquet_results_say_what_was_traded() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    let folder = Folder::new();
    folder.write("s.geojson", TOOTH);
    folder.write("t.csv", "trace,x,y\n0,0,0\n0,1,2.5\n0,5,2.5\n");
    let notes = |options: &str| -> Vec<(String, String)> {
        folder.done(&format!("eval --scene s.geojson --traces t.csv {options} --out r.parquet"));
        let file = SerializedFileReader::new(std::fs::File::open(folder.path("r.parquet")).unwrap()).unwrap();
        let all = file.metadata().file_metadata().key_value_metadata().cloned().unwrap_or_default();
        all.into_iter().map(|note| (note.key, note.value.unwrap())).collect()
    };
    assert_eq!(notes("--engine cpu"), []);
    let named = |pairs: &[(&str, &str)]| pairs.iter().map(|&(k, v)| (k.to_owned(), v.to_owned())).collect::<Vec<_>>();
    assert_eq!(
        notes("--engine cpu --stride 2 --simplify 0.25"),
        named(&[("tautline.stride", "2"), ("tautline.simplify", "0.25")])
    );
    assert_eq!(notes("--precision fast --adapter software"), named(&[("tautline.precision", "fast")]));
}

const STUDY: &str = r#"
[scene]
file = "s.geojson"
[walk]
kind = "persistent"
step = 0.2
steps = 120
[run]
traces = 900
block = 100
"#;

#[test]
fn studies_trade_alike_however_they_are_run() {
    let folder = Folder::new();
    folder.write("s.geojson", TOOTH);
    folder.write("s.toml", STUDY);
    folder.write("traded.toml", format!("{STUDY}stride = 5\nsimplify = 0.4\n"));
    let answer = |run: &str| -> Value { serde_json::from_str(&folder.text(&format!("{run}/summary.json"))).unwrap() };
    folder.done("study run s.toml --out exact --engine cpu");
    let exact = answer("exact");
    assert!(exact["traded"].is_null() && exact["study"]["run"]["stride"].is_null());

    folder.done("study run traded.toml --out a --engine cpu");
    let traded = answer("a");
    assert_eq!((&traded["study"]["run"]["stride"], &traded["study"]["run"]["simplify"]), (&json!(5), &json!(0.4)));
    assert_eq!((&traded["traded"]["vertices"], &traded["traded"]["vertices_left"]), (&json!(10), &json!(8)));
    assert!(traded["traded"]["jumps"].as_u64() > Some(0), "{}", traded["traded"]);
    // The same traces, with all their steps.
    assert_eq!((&traded["traces"], &traded["steps"]), (&exact["traces"], &exact["steps"]));
    assert_ne!(traded["identity"], exact["identity"]);
    // The map covers the scene as it is.
    for key in ["low", "cell", "columns", "rows"] {
        assert_eq!(traded["map"][key], exact["map"][key], "{key}");
    }
    let same =
        |run: &str| assert!(folder.read(&format!("{run}/summary.json")) == folder.read("a/summary.json"), "{run}");
    folder.done("study run s.toml --stride 5 --simplify 0.4 --out options --engine reference");
    same("options");
    folder.done("study run traded.toml --out gpu --engine gpu --adapter software");
    same("gpu");
    for k in 0..2 {
        folder.done(&format!("study run traded.toml --out k{k} --shard {k}/2"));
    }
    folder.done("study merge k0 k1 --out whole");
    same("whole");
    let shown = folder.done("study show a").stdout;
    assert!(shown.contains("traded: of every 5 points one") && shown.contains("8 of 10 wall ends left"), "{shown}");
    assert!(folder.text("a/report.html").contains("wall ends left"));
    folder.done("study replay a --trace 3 --draw r.svg --events e.jsonl");
    assert!(folder.text("r.svg").starts_with("<svg"));
    assert!(folder.done("study run traded.toml --dry-run").stdout.contains("the study is sound"));
}

#[test]
fn bad_values_are_refused() {
    let folder = Folder::hand_made();
    folder.write("s.toml", STUDY);
    let eval = "eval --scene s.geojson --traces t.csv";
    for command in [eval, "study run s.toml"] {
        for stride in ["0", "-1", "1.5", "x"] {
            folder.refused(
                2,
                &format!("{command} --stride={stride}"),
                &["--stride", "whole number from 1 to 4294967295"],
            );
        }
        for tolerance in ["0", "-1", "nan", "inf", "x"] {
            folder.refused(2, &format!("{command} --simplify={tolerance}"), &["--simplify", "number above 0"]);
        }
    }
    folder.write("zero.toml", format!("{STUDY}stride = 0\n"));
    folder.refused(2, "study run zero.toml", &["run.stride", "at least 1"]);
    folder.write("minus.toml", format!("{STUDY}simplify = -1.0\n"));
    folder.refused(2, "study run minus.toml", &["run.simplify", "above 0"]);
}
