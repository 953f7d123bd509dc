//! Classes of ropes: a column of `eval`, a tally of studies, a filter of pictures, and two worked examples.

use std::fs;

use serde_json::{Value, json};

use super::Folder;

/// Two posts and a wall that touches a third one, the anchor west of them; seven traces that end in two places.
const SCENE: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"label": "post"}, "geometry": {"type": "LineString", "coordinates": [[2, -1], [2, 1]]}},
{"type": "Feature", "properties": {"label": "tee"}, "geometry": {"type": "LineString", "coordinates": [[5, -1], [5, 1]]}},
{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": [[5, 0.5], [6, 0.5]]}},
{"type": "Feature", "properties": {"role": "anchor"}, "geometry": {"type": "Point", "coordinates": [0, 0]}}
]}"#;

/// Each with the class that it must have, counted by hand: post is 0, tee and the wall at it are 2.
const WALKS: [(&str, &str); 7] = [
    ("1,2 3.5,2 3.5,-2", "o0^-1"),
    ("1,-2 3.5,-2", "e"),
    ("1,2 7,2 7,-2 3.5,-2", "o0^-1 o2^-1"),
    // Twice round the post, counter-clockwise, and once round the tee, clockwise.
    ("1,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 3.5,2 7,2 7,-2 3.5,-2", "o0^2 o2^-1"),
    // The same, with a way that it goes back.
    (
        "1,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 7,-2 7,2 7,-2 3.5,-2 3.5,2 7,2 7,-2 3.5,-2",
        "o0^2 o2^-1",
    ),
    // Round one, the other, back round the one and back round the other: wound about nothing, but not free.
    (
        "1,2 3.5,2 3.5,-2 1,-2 1,2 7,2 7,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 3.5,2 1,2 1,-2 3.5,-2 7,-2 7,2 3.5,2 3.5,-2",
        "o0^-2 o2^-1 o0^2 o2",
    ),
    ("1,2 3.5,2", "o0^-1"),
];

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("s.geojson", SCENE);
    folder.write("t.csv", rows(&WALKS.map(|(walk, _)| walk)));
    folder
}

fn rows(walks: &[&str]) -> String {
    let rows = walks
        .iter()
        .enumerate()
        .flat_map(|(trace, walk)| walk.split(' ').map(move |point| format!("{trace},{point}\n")).collect::<Vec<_>>());
    "trace,x,y\n".to_owned() + &rows.collect::<String>()
}

fn lines(folder: &Folder, name: &str) -> Vec<Value> {
    folder.text(name).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn classes_are_those_counted_by_hand() {
    let folder = folder();
    folder.done("eval --scene s.geojson --traces t.csv --class --out r.jsonl");
    let rows = lines(&folder, "r.jsonl");
    let found: Vec<&str> = rows.iter().map(|row| row["class"].as_str().unwrap()).collect();
    assert_eq!(found, WALKS.map(|(_, class)| class));
    assert_eq!(rows[3]["windings"], json!([{"obstacle": 0, "turns": 2}, {"obstacle": 2, "turns": -1}]));
    assert_eq!((&rows[1]["windings"], &rows[5]["windings"]), (&json!([]), &json!([])));
    // Without the option the rows are what they were.
    folder.done("eval --scene s.geojson --traces t.csv --out plain.jsonl");
    let mut without = rows;
    without
        .iter_mut()
        .for_each(|row| drop(row.as_object_mut().map(|row| (row.remove("class"), row.remove("windings")))));
    assert_eq!(without, lines(&folder, "plain.jsonl"));

    folder.done("eval --scene s.geojson --traces t.csv --class --out r.csv");
    let csv = folder.text("r.csv");
    assert!(csv.lines().next().unwrap().ends_with(",labels,class,windings"));
    assert!(csv.lines().nth(4).unwrap().ends_with(",o0^2 o2^-1,0 2;2 -1"), "{csv}");
}

#[test]
fn a_class_is_as_the_picture_shows_it() {
    let folder = folder();
    folder.write("down.geojson", SCENE.replacen("{", "{\"y\": \"down\", ", 1));
    folder.done("eval --scene down.geojson --traces t.csv --class --out r.jsonl");
    let rows = lines(&folder, "r.jsonl");
    assert_eq!((&rows[0]["class"], &rows[3]["class"]), (&json!("o0"), &json!("o0^-2 o2")));
    assert_eq!(rows[3]["windings"], json!([{"obstacle": 0, "turns": -2}, {"obstacle": 2, "turns": 1}]));
    let told = folder.done("draw --scene down.geojson --traces t.csv --class o0 --out p.svg").stderr;
    assert!(told.contains("class o0: 2 of 7 traces"), "{told}");
}

#[test]
fn all_engines_give_the_same_bytes_and_those_that_cannot_are_refused() {
    let folder = Folder::floor_plan(300, 400);
    for kind in ["jsonl", "csv", "parquet"] {
        for (name, engine) in [("a", "reference"), ("b", "cpu"), ("c", "gpu --adapter software")] {
            let args = format!("eval --scene s.geojson --traces t.csv --class --engine {engine} --out {name}.{kind}");
            folder.done(&args);
            assert!(folder.read(&format!("{name}.{kind}")) == folder.read(&format!("a.{kind}")), "{engine} {kind}");
        }
        let mut one =
            folder.command(&format!("eval --scene s.geojson --traces t.csv --class --engine cpu --out d.{kind}"));
        assert!(one.env("RAYON_NUM_THREADS", "1").output().unwrap().status.success());
        assert!(folder.read(&format!("d.{kind}")) == folder.read(&format!("a.{kind}")), "{kind}");
    }
    let eval = "eval --scene s.geojson --traces t.csv --class";
    folder.refused(2, &format!("{eval} --engine funnel --out e.csv"), &["--class: the engine funnel", "--engine cpu"]);
    folder.refused(2, eval, &["--out <FILE>"]);
}

#[test]
fn traces_that_cross_walls_have_no_class() {
    let folder = folder();
    folder.write("t.csv", rows(&["1,0 3,0 3,2", "1,2 3.5,2"]));
    for (kind, end) in [("csv", ",,"), ("jsonl", r#""class":null,"windings":null}"#)] {
        folder.done(&format!("eval --scene s.geojson --traces t.csv --on-violation flag --class --out r.{kind}"));
        let text = folder.text(&format!("r.{kind}"));
        assert!(text.lines().any(|line| line.contains("violation") && line.ends_with(end)), "{text}");
    }
    folder.done("eval --scene s.geojson --traces t.csv --on-violation flag --class --out r.parquet");
    let draw = "draw --scene s.geojson --traces t.csv --on-violation flag";
    folder.refused(2, &format!("{draw} --same-class 0 --out p.svg"), &["--same-class 0:", "so it has no class"]);
    folder.done(&format!("{draw} --same-class 1 --out p.svg"));
}

#[test]
fn ropes_whose_ends_both_move_have_no_class_yet() {
    let folder = folder();
    folder.write("t.csv", "trace,x,y,bx,by\n0,1,2,0,0\n0,3.5,2,0,1\n");
    let refused = |args: &str, option: &str| {
        folder.refused(2, &format!("{args} --scene s.geojson --traces t.csv"), &[option, "here the anchor moves"]);
    };
    refused("eval --class --out r.csv", "--class");
    refused("draw --class e --out p.svg", "--class");
    refused("draw --same-class 0 --out p.svg", "--same-class");
}

#[test]
fn pictures_show_the_traces_of_one_class() {
    let folder = folder();
    let draw = |args: &str| folder.done(&format!("draw --scene s.geojson --traces t.csv {args}"));
    let told = draw("--same-class 3 --out a.svg").stderr;
    assert!(told.contains("class o0^2 o2^-1: 2 of 7 traces"), "{told}");
    draw("--trace 3,4 --out b.svg");
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    draw("--class o0^-1 --out a.svg");
    draw("--trace 0,6 --out b.svg");
    assert!(folder.read("a.svg") == folder.read("b.svg"));
    // More of them than a picture holds, and the one asked for is the last.
    folder.write("t.csv", rows(&["1,2 3.5,2"; 9]));
    let told = draw("--same-class 8 --out a.svg").stderr;
    assert!(told.contains("class o0^-1: 9 of 9 traces, of which 6 are drawn"), "{told}");
    draw("--trace 0,1,2,3,4,8 --out b.svg");
    assert!(folder.read("a.svg") == folder.read("b.svg"));

    let draw = "draw --scene s.geojson --traces t.csv --out p.svg";
    folder.refused(2, &format!("{draw} --class o9"), &["none of the 9 traces has a rope of class o9"]);
    folder.refused(2, &format!("{draw} --class 9"), &["\"9\" is no letter of a class", "o12^-1"]);
    folder.refused(2, &format!("{draw} --same-class 9"), &["there is no trace 9; its traces have numbers from 0 to 8"]);
    folder.refused(2, &format!("{draw} --same-class 1 --trace 1"), &["cannot be used with"]);
    folder.refused(2, "draw --scene s.geojson --class e --out p.svg", &["--class needs --traces"]);
}

fn study(tallies: &str) -> String {
    format!(
        "[scene]\nfile = \"s.geojson\"\n[walk]\nkind = \"given\"\nfile = \"t.csv\"\n[run]\nblock = 2\n\
         [tallies]\n{tallies}"
    )
}

fn summary(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&folder.text(&format!("{name}/summary.json"))).unwrap()
}

#[test]
fn studies_count_classes_however_they_are_shared_out() {
    let folder = folder();
    folder.write("s.toml", study("classes = 3\n"));
    let told = folder.done("study run s.toml --out all").stdout;
    for line in
        ["5 homotopy classes of ropes at the end", "  o0^-1", "  o0                       is post (2.000, 1.000)"]
    {
        assert!(told.contains(line), "{line:?} is missing in\n{told}");
    }
    let whole = summary(&folder, "all");
    let found = &whole["classes"];
    assert_eq!((&found["distinct"], &found["is_complete"]), (&json!(5), &json!(true)));
    let classes: Vec<_> = found["classes"].as_array().unwrap().iter().map(|c| (&c["class"], &c["count"])).collect();
    let expected = [("o0^-1", 2), ("o0^2 o2^-1", 2), ("e", 1)].map(|(class, count)| (json!(class), json!(count)));
    assert_eq!(classes, expected.iter().map(|(class, count)| (class, count)).collect::<Vec<_>>());
    let share = &found["classes"][0]["share"];
    assert!((share["value"].as_f64().unwrap() - 2.0 / 7.0).abs() < 1e-15 && share["low"].as_f64().unwrap() < 2.0 / 7.0);
    assert_eq!(
        found["obstacles"],
        json!([{"obstacle": 0, "at": [2.0, 1.0], "label": "post"}, {"obstacle": 2, "at": [5.0, 1.0], "label": "tee"}])
    );
    assert!(folder.text("all/report.html").contains("Commonest homotopy classes at the end"));
    (0..3).for_each(|k| drop(folder.done(&format!("study run s.toml --shard {k}/3 --out part{k}"))));
    for (i, order) in ["0 1 2", "2 0 1"].iter().enumerate() {
        let parts = order.split(' ').map(|k| format!("part{k} ")).collect::<String>();
        folder.done(&format!("study merge {parts}--out m{i}"));
        assert!(folder.read(&format!("m{i}/summary.json")) == folder.read("all/summary.json"), "{order}");
    }

    // Without it nothing of it is said or counted, and with it everything else stays.
    folder.write("plain.toml", study(""));
    folder.done("study run plain.toml --out plain");
    let plain = summary(&folder, "plain");
    assert!(plain.get("classes").is_none() && plain["study"]["tallies"].get("classes").is_none());
    let mut rest = whole;
    rest.as_object_mut().unwrap().remove("classes");
    rest["study"]["tallies"].as_object_mut().unwrap().remove("classes");
    rest["identity"] = plain["identity"].clone();
    assert_eq!(rest, plain);
}

/// What the pages of the examples say is what the program says, and their pictures what it draws.
#[test]
fn divers_and_surgeons_do_as_their_pages_say() {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/examples");
    let kept = |name: &str| fs::read_to_string(format!("{docs}/{name}")).unwrap();
    let folder = Folder::new();
    let inputs = ["cave.geojson", "dives.csv", "bones.geojson", "needle.csv"];
    inputs.iter().for_each(|name| folder.write(name, kept(name)));
    let page = |name: &str, commands: usize| {
        let page = kept(name);
        let found: Vec<&str> = page.lines().filter_map(|line| line.strip_prefix("    tautline ")).collect();
        assert_eq!(found.len(), commands, "{name}");
        found.iter().for_each(|command| drop(folder.done(command)));
        page
    };
    let says = |page: &str, line: &str| assert!(page.contains(&format!("\n    {line}\n")), "no page says {line:?}");
    // Of each rope its trace, its length and the last fields.
    let ropes = |name: &str| -> Vec<(String, f64, String, String)> {
        let text = folder.text(name);
        let row = |line: &str| {
            let mut last = line.rsplitn(3, ',');
            let (windings, class) = (last.next().unwrap(), last.next().unwrap());
            let fields: Vec<&str> = line.split(',').collect();
            (fields[0].to_owned(), fields[3].parse().unwrap(), class.to_owned(), windings.to_owned())
        };
        text.lines().skip(1).map(row).collect()
    };

    let diver = page("diver.md", 3);
    for (trace, length, class, windings) in ropes("lines.csv") {
        says(&diver, format!("{trace}  {length:<6.3}  {class:<13}  {windings}").trim_end());
    }
    let suture = page("suture.md", 2);
    for (trace, length, class, _) in ropes("threads.csv") {
        says(&suture, &format!("{trace}  {length:.3}  {class}"));
    }
    let felt = folder.text("feel.csv");
    for row in felt.lines().filter(|row| row.starts_with("0,4,") || row.starts_with("0,10,")) {
        let f: Vec<&str> = row.split(',').collect();
        let [length, pull_x, pull_y] = [4, 7, 8].map(|i| f[i].parse::<f64>().unwrap());
        says(&suture, &format!("{:<2}  {:<4}  {:<4}  {length:.3}  {pull_x:.3}  {pull_y:.3}", f[1], f[2], f[3]));
    }
    let last: Vec<Vec<&str>> = ["0,12,", "1,13,"]
        .iter()
        .filter_map(|start| felt.lines().find(|row| row.starts_with(start)))
        .map(|row| row.split(',').collect())
        .collect();
    assert!(last.len() == 2 && last[0][7..9] == last[1][7..9]);
    for name in ["diver-0.svg", "diver-2.svg", "suture.svg"] {
        assert!(folder.text(name) == kept(name), "docs/examples/{name} is not what its command draws");
    }
}
