//! Studies of walks that a tether holds back.

use std::fs;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::RowAccessor;
use serde_json::Value;

use super::{Finished, Folder};

/// Two anchors, 8 blocks, the last one smaller than the others.
fn study(at_tether: &str) -> String {
    format!(
        "[scene]\nbuilt_in = \"rooms\"\nanchor = {{ sample = 2 }}\n\
         [walk]\nkind = \"persistent\"\nstep = 0.4\nsteps = 60\ntether = 5.5\nat_tether = \"{at_tether}\"\n\
         [run]\ntraces = 300\nblock = 40\n[tallies]\nlimits = [5.5]\n[outputs]\npictures = false\n"
    )
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// However a study on a tether is computed, shared out and stopped, it has the same bytes.
#[test]
fn nothing_but_the_study_decides_what_it_says() {
    for at_tether in ["stay", "slide", "turn"] {
        let folder = Folder::new();
        folder.write("s.toml", study(at_tether));
        folder.done("study run s.toml --out a --engine reference");
        let truth = folder.text("a/summary.json");
        let is_true = |run: &str| assert!(folder.text(&format!("{run}/summary.json")) == truth, "{at_tether} {run}");
        folder.done("study run s.toml --out gpu --engine gpu --adapter software");
        is_true("gpu");
        let mut one = folder.command("study run s.toml --out one --engine cpu");
        assert_eq!(Finished::of(one.env("RAYON_NUM_THREADS", "1")).code, Some(0));
        is_true("one");
        for (k, part) in ["--blocks 0..3", "--blocks 3..8 --shard 0/2", "--blocks 3..8 --shard 1/2"].iter().enumerate()
        {
            folder.done(&format!("study run s.toml --out k{k} {part}"));
        }
        folder.done("study merge k2 k0 k1 --out whole");
        is_true("whole");
        // Stopped in between or before anything was done, as the machine has it.
        for seconds in ["0.1", "0.2", "0.4"] {
            let stopped = folder.run(&format!("study run s.toml --out stopped --resume --stop-after {seconds}s"));
            assert!(matches!(stopped.code, Some(0 | 4)), "{}", stopped.stderr);
        }
        folder.done("study run s.toml --out stopped --resume");
        is_true("stopped");
        // With more traces, after it was done.
        folder.done("study run s.toml --out more --count 90");
        folder.done("study run s.toml --out more --count 300 --resume");
        is_true("more");

        let summary = json(&truth);
        let tether = &summary["tether"];
        assert_eq!((number(&tether["length"]), &tether["at"]), (5.5, &Value::from(at_tether)));
        let share = number(&tether["held_back"]["value"]);
        assert!(share > 0.05 && number(&tether["held_back"]["error"]) < 0.05, "{tether}");
        assert_eq!(number(&summary["survival"][0]["curve"][60]["share"]["value"]), 1.0);
        assert!(number(&summary["scalars"][1]["max"]) <= 5.5);
    }
}

/// The rows of a study, the walks that it writes, and the ropes that others make of these.
#[test]
fn no_row_has_a_longer_rope() {
    for at_tether in ["stay", "slide", "turn"] {
        let folder = Folder::floor_plan(1, 1);
        let outputs = "traces = true\npoints = true\nsteps = true\npictures = false";
        let scene = study(at_tether).replace("built_in = \"rooms\"\nanchor = { sample = 2 }", "file = \"s.geojson\"");
        folder.write("s.toml", scene.replace("pictures = false", outputs));
        folder.done("study run s.toml --out a");
        let file = fs::File::open(folder.path("a/traces.parquet")).unwrap();
        let rows = SerializedFileReader::new(file).unwrap();
        let columns = rows.metadata().file_metadata().schema_descr().columns();
        let place = columns.iter().position(|column| column.name() == "max_length").unwrap();
        let rows = rows.get_row_iter(None).unwrap();
        let lengths: Vec<f64> = rows.map(|row| row.unwrap().get_double(place).unwrap()).collect();
        assert!(lengths.len() == 300 && lengths.iter().all(|&length| length <= 5.5), "{at_tether}: {lengths:?}");
        let close = lengths.iter().filter(|&&length| length > 5.5 * (1.0 - 1e-14)).count();
        assert_eq!(close > 0, at_tether == "slide", "{close}");
        folder.done("study replay a --trace 7 --points p.csv --steps steps.csv");
        folder.done("eval --scene s.geojson --traces p.csv --engine reference --out r.jsonl");
        assert_eq!(number(&json(&folder.text("r.jsonl"))["max_length"]), lengths[7]);
        let steps = folder.text("steps.csv");
        let place = steps.lines().next().unwrap().split(',').position(|name| name == "length").unwrap();
        let of = |line: &str| line.split(',').nth(place).unwrap().parse::<f64>().unwrap();
        assert_eq!(steps.lines().skip(1).map(of).fold(0.0, f64::max), lengths[7]);
    }
}

#[test]
fn tethers_are_swept_with_the_same_random_numbers() {
    let folder = Folder::new();
    folder.write("s.toml", study("stay") + "[sweep]\nwalk.tether = [3.0, 6.0, 1e9]\n");
    let told = folder.done("study run s.toml --out a").stdout;
    assert!(told.contains("steps held back by the tether, and walks that never were"), "{told}");
    let mut shares = vec![];
    for (i, length) in ["3.0", "6.0", "1e9"].iter().enumerate() {
        folder.write("one.toml", study("stay"));
        folder.done(&format!("study run one.toml --out one-{i} --set walk.tether={length}"));
        let summary = folder.text(&format!("one-{i}/summary.json"));
        assert!(summary == folder.text(&format!("a/point-00{i}/summary.json")));
        let tether = json(&summary)["tether"].clone();
        shares.push(["held_back", "never"].map(|name| number(&tether[name]["value"])));
        // Of a walk that is never held back there is no first time.
        assert_eq!(tether["first"].is_null(), i == 2);
    }
    let csv = folder.text("a/sweep.csv");
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| {
        let place = rows[0].iter().position(|column| *column == name).unwrap_or_else(|| panic!("{:?}", rows[0]));
        rows[1..].iter().map(|row| row[place]).collect::<Vec<_>>()
    };
    let numbers = |name: &str| column(name).iter().map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    assert_eq!(numbers("held_back"), shares.iter().map(|share| share[0]).collect::<Vec<_>>());
    assert_eq!(numbers("never_held_back"), shares.iter().map(|share| share[1]).collect::<Vec<_>>());
    assert!(shares[0][0] > shares[1][0] && shares[1][0] > 0.0 && shares[2] == [0.0, 1.0], "{shares:?}");
    assert!(column("first_held_back_mean")[2].is_empty() && numbers("held_back_error")[0] > 0.0);
    // A tether that is never taut is none; nor has a sweep without tethers such columns.
    folder.write(
        "f.toml",
        study("stay").replace("tether = 5.5\nat_tether = \"stay\"\n", "") + "[sweep]\nwalk.step = [0.4]\n",
    );
    folder.done("study run f.toml --out f");
    let free = json(&folder.text("f/point-000/summary.json"));
    assert!(
        free["tether"].is_null() && free["map"]["visited"].is_null() && !folder.text("f/sweep.csv").contains("held")
    );
    assert_eq!(free["scalars"], json(&folder.text("one-2/summary.json"))["scalars"]);
}

#[test]
fn what_a_tether_does_is_told() {
    let folder = Folder::new();
    folder.write("s.toml", study("turn").replace("pictures = false", "pictures = true"));
    let told = folder.done("study run s.toml --out a").stdout;
    let tether = json(&folder.text("a/summary.json"))["tether"].clone();
    let share = 100.0 * number(&tether["held_back"]["value"]);
    assert!(told.starts_with("a tether of 5.5 holds the walks back in "), "{told}");
    assert!(told.contains(&format!(", {share:.2} % were held back by the tether\n")), "{share} {told}");
    let never = 100.0 * number(&tether["never"]["value"]);
    assert!(told.contains(&format!("{never:.2} % of them never are  (")), "{told}");
    let median = tether["quantiles"].as_array().unwrap().iter().find(|q| number(&q["share"]) == 0.5).unwrap();
    let step = format!("{:.2}", number(&median["value"]["value"]));
    assert!(
        told.lines().any(|line| line.contains("50 % of them are held back by step") && line.contains(&step)),
        "{told}"
    );
    let page = folder.text("a/report.html");
    assert!(page.contains("<dt>steps held back by the tether</dt>") && page.contains("<dt>walks never held back</dt>"));
    assert!(page.contains("How many walks the tether has not held back yet, step by step"));
    assert!(folder.text("a/held-back.svg").contains("not held back yet"));
    assert!(folder.done("study show a").stdout.starts_with("a tether of 5.5 holds the walks back in "));
}

#[test]
fn tethers_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    for (from, to, parts) in [
        ("tether = 5.5", "tether = 0.0", ["s.toml: line 8: walk.tether: 0 is no length of a tether", "above 0"]),
        ("tether = 5.5\n", "", ["s.toml: line 8: walk.at_tether: there is no tether", "walk.tether"]),
        ("\"stay\"", "\"slip\"", ["s.toml: line 9: walk.at_tether: unknown variant", "did you mean"]),
        (
            "persistent",
            "waypoints",
            ["s.toml: line 9: walk.at_tether: only walks whose steps are", "uniform, gaussian or"],
        ),
        ("tether = 5.5", "tether = 0.1", ["all walks stand still", "the tether of 0.1; give a step shorter than 0.4"]),
    ] {
        folder.write("s.toml", study("stay").replacen(from, to, 1));
        folder.refused(2, "study run s.toml --out a", &parts);
    }
    // One that slides gets to the end of any tether.
    folder.write("s.toml", study("slide").replacen("5.5", "0.1", 1));
    folder.done("study run s.toml --out a");
    let summary = json(&folder.text("a/summary.json"));
    assert!(number(&summary["scalars"][1]["min"]) > 0.1 * (1.0 - 1e-14) && number(&summary["still"]) < 0.1);
}

/// What stands in docs/examples/vacuum.md is what the program says, and its picture what it draws.
#[test]
fn the_vacuum_robot_does_as_its_page_says() {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples");
    let page = fs::read_to_string(format!("{docs}/vacuum.md")).unwrap();
    let folder = Folder::new();
    let mut told = String::new();
    let commands = page.lines().filter_map(|line| line.strip_prefix("    tautline "));
    for (i, command) in commands.enumerate() {
        let command = command.replace("docs/examples/", &format!("{docs}/")).replace(" --out cables", "");
        told += &folder.done(&format!("{command} --out {i} --engine cpu")).stdout;
    }
    let told: Vec<&str> = told.lines().map(str::trim_end).collect();
    let quoted =
        page.lines().filter_map(|line| line.strip_prefix("    ")).filter(|line| !line.starts_with("tautline "));
    let missing: Vec<&str> = quoted.clone().filter(|line| !told.contains(line)).collect();
    assert!(quoted.count() > 10 && missing.is_empty(), "{missing:#?} are not among {told:#?}");
    let visited = json(&folder.text("0/summary.json"))["map"]["visited"].clone();
    let [inner, area] = ["inner", "area"].map(|name| number(&visited[name]));
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(&format!("Between {inner:.2} and {area:.2} square metres were visited")), "{visited}");
    assert!(
        folder.text("0/length-map.svg") == fs::read_to_string(format!("{docs}/vacuum.svg")).unwrap(),
        "another picture; `tautline study run docs/examples/vacuum.toml --out DIR` makes DIR/length-map.svg, which is \
         docs/examples/vacuum.svg"
    );
}
