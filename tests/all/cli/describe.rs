//! What `check` says of a scene, the choice of layers, labels, and warnings of anchors.

use std::path::Path;

use arrow_array::cast::AsArray;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::{Value, json};

use super::Folder;

/// A room, two pillars and a door, with labels in some of the ways in which files have them.
const HALL: &str = r#"{"type": "FeatureCollection", "features": [
{"type": "Feature", "properties": {"role": "anchor"}, "geometry": {"type": "Point", "coordinates": [1, 1]}},
{"type": "Feature", "properties": {"layer": "walls", "kind": "outer"}, "geometry": {"type": "LineString",
  "coordinates": [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]}},
{"type": "Feature", "properties": {"Layer": "pillars", "label": "pillar 3"}, "geometry": {"type": "Polygon",
  "coordinates": [[[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]]}},
{"type": "Feature", "id": "pillar 4", "properties": {"layer": "pillars"}, "geometry": {"type": "Polygon",
  "coordinates": [[[14, 4], [16, 4], [16, 6], [14, 6], [14, 4]]]}},
{"type": "Feature", "properties": {"kind": "inner", "name": "door"}, "geometry": {"type": "LineString",
  "coordinates": [[10, 0], [10, 3], [10, 3]]}},
{"type": "Feature", "properties": {}, "geometry": null}
]}"#;

/// Round pillar 3, and back to where it began.
const DRAG: &str = "trace,x,y\n0,1,1\n0,8,2\n0,8,8\n0,2,8\n0,2,3\n";

fn report(folder: &Folder, args: &str) -> Value {
    serde_json::from_str(&folder.done(args).stdout).unwrap()
}

fn hall() -> Folder {
    let folder = Folder::new();
    folder.write("hall.geojson", HALL);
    folder.write("drag.csv", DRAG);
    folder
}

#[test]
fn check_describes_a_scene_with_an_anchor_and_without() {
    let folder = hall();
    let shown = folder.done("check --scene hall.geojson");
    let expected = "\
scene   hall.geojson: 13 walls, 14 vertices, anchor (1, 1)
        1 wall of zero length was dropped
box     (0, 0) to (20, 10); y points up
unit    the file's own
solid   8 of the walls are the border of something solid
layers  pillars: 8 walls
        walls: 4 walls
labels  door: 1 wall
        pillar 3: 4 walls
        pillar 4: 4 walls
";
    assert_eq!(shown.stdout, expected);
    assert_eq!(shown.stderr, "note: hall.geojson: features without a geometry (null), passed over: 1\n");
    let scene = json!({
        "name": "hall.geojson", "walls": 13, "vertices": 14, "dropped": 1, "solid": 8,
        "box": [[0.0, 0.0], [20.0, 10.0]], "unit": null, "y": "up",
        "layers": [{"name": "pillars", "walls": 8}, {"name": "walls", "walls": 4}],
        "labels": [{"label": "door", "walls": 1}, {"label": "pillar 3", "walls": 4}, {"label": "pillar 4", "walls": 4}],
        "anchor": [1.0, 1.0], "warnings": [], "notes": ["features without a geometry (null), passed over: 1"],
    });
    assert_eq!(report(&folder, "check --scene hall.geojson --json"), json!({"scene": scene, "traces": null}));

    folder.write("bare.geojson", HALL.replace("anchor", "tree"));
    let bare = folder.done("check --scene bare.geojson");
    let how = "to tie a rope, give --anchor X,Y, or put a Point with the property \"role\": \"anchor\" into the file";
    assert_eq!(
        bare.stdout,
        expected.replace("hall", "bare").replace("anchor (1, 1)\n", &format!("no anchor\n        {how}\n"))
    );
    let found = report(&folder, "check --scene bare.geojson --json");
    assert_eq!((&found["scene"]["anchor"], &found["scene"]["walls"]), (&Value::Null, &json!(13)));
    assert_eq!(report(&folder, "check --scene bare.geojson --json --anchor 1,1")["scene"]["anchor"], json!([1.0, 1.0]));
    // A drawing says what its unit is.
    folder.write("p.svg", r#"<svg width="20mm" height="10mm" viewBox="0 0 20 10"><path d="M1,2h3"/></svg>"#);
    let drawing = report(&folder, "check --scene p.svg --json");
    let unit = drawing["scene"]["unit"].as_str().unwrap();
    assert!(unit.starts_with("1 mm") && drawing["scene"]["y"] == "down", "{drawing}");
    folder.write("none.wkt", "POINT (0 0)");
    assert_eq!(report(&folder, "check --scene none.wkt --json")["scene"]["box"], Value::Null);
}

#[test]
fn check_draws_the_scene() {
    let folder = hall();
    folder.write("bare.geojson", HALL.replace("anchor", "tree"));
    for scene in ["hall.geojson", "bare.geojson"] {
        let shown = folder.done(&format!("check --scene {scene} --picture p.svg")).stdout;
        assert!(shown.ends_with("picture p.svg\n"), "{shown}");
        assert!(folder.text("p.svg").starts_with("<svg"));
        // What is printed is one document.
        report(&folder, &format!("check --scene {scene} --picture p.png --json"));
        assert!(folder.read("p.png").starts_with(b"\x89PNG"));
    }
    folder.refused(2, "check --scene hall.geojson --picture p.html", &["--picture: p.html", "as .svg or .png"]);
    folder.refused(2, "check --scene hall.geojson --picture p.gif", &["p.gif: the extension"]);
    folder.refused(2, "check --scene no.geojson --picture q.svg", &["cannot read no.geojson"]);
}

#[test]
fn layers_are_chosen_wherever_a_scene_is_read() {
    let folder = hall();
    let walls = |options: &str| {
        let found = report(&folder, &format!("check --scene hall.geojson --json {options}"));
        found["scene"]["walls"].as_u64().unwrap()
    };
    for (options, expected) in [
        ("", 13),
        ("--layer walls", 4),
        ("--layer walls --layer pillars", 12),
        ("--without-layer pillars", 5),
        ("--layer kind=inner", 1),
        ("--layer pillars --without-layer walls", 8),
        ("--without-layer Kind=outer --without-layer pillars", 1),
    ] {
        assert_eq!(walls(options), expected, "{options}");
    }
    let refused = |args: &str| {
        let parts =
            ["hall.geojson: no layer \"pillar\"; did you mean \"pillars\"? the layers are \"pillars\", \"walls\""];
        folder.refused(2, args, &parts);
    };
    refused("check --scene hall.geojson --layer pillar");
    refused("eval --scene hall.geojson --traces drag.csv --without-layer pillar");
    refused("convert hall.geojson h.wkt --layer pillar");
    refused("bench --scene hall.geojson --layer pillar");
    refused("tradeoff --scene hall.geojson --layer pillar");
    refused("draw --scene hall.geojson --layer pillar --out h.svg");
    folder.refused(
        2,
        "check --scene hall.geojson --layer kind=x",
        &["no layer \"kind=x\"", "\"kind=inner\", \"kind=outer\""],
    );
    folder.write("m.map", "type octile\nheight 1\nwidth 2\nmap\n.@\n");
    folder.refused(
        2,
        "check --scene m.map --layer walls",
        &["m.map: no layer \"walls\": nothing in this file lies in a layer"],
    );

    let study = "[scene]\nfile = \"hall.geojson\"\nlayers = [\"pillars\", \"walls\"]\nwithout_layers = [\"walls\"]\n\
        [walk]\nkind = \"uniform\"\nstep = 1.0\nsteps = 20\n[run]\ntraces = 20\nblock = 10\n";
    folder.write("s.toml", study);
    let shown = folder.done("study run s.toml --engine cpu --dry-run");
    assert!(shown.stdout.contains(" 8 walls,"), "{}", shown.stdout);
    let note = "note: hall.geojson: 8 of 13 walls are taken, of the layers pillars, walls, without walls\n";
    assert!(shown.stderr.contains(note), "{}", shown.stderr);
    folder.write("s.toml", study.replace("\"pillars\"", "\"pillar\""));
    folder.refused(2, "study run s.toml", &["scene.file: ", "no layer \"pillar\"; did you mean \"pillars\"?"]);
}

#[test]
fn things_keep_their_names() {
    let folder = hall();
    let eval = "eval --scene hall.geojson --traces drag.csv --engine cpu";
    let shown = folder.done(eval).stdout;
    let expected = format!("  {:50}{:>12}\n  {:50}{:>12}\n", "touched by ropes at the end", "traces", "pillar 3", 1);
    assert!(shown.contains(&expected), "{shown}");
    folder.done(&format!("{eval} --out r.jsonl --events e.csv"));
    assert!(folder.text("r.jsonl").contains("\"labels\":[\"pillar 3\""), "{}", folder.text("r.jsonl"));
    let events = folder.text("e.csv");
    assert!(
        events.starts_with("trace,step,kind,vertex,x,y,side,label\n") && events.contains(",left,pillar 3\n"),
        "{events}"
    );
    assert_eq!(report(&folder, &format!("{eval} --json"))["touched"], json!([{"label": "pillar 3", "traces": 1}]));

    folder.write(
        "s.toml",
        "[scene]\nfile = \"hall.geojson\"\n[walk]\nkind = \"given\"\nfile = \"drag.csv\"\n[run]\ntraces = 1\nblock = 1\n\
        [outputs]\ntraces = true\n",
    );
    let shown = folder.done("study run s.toml --engine cpu --out s").stdout;
    assert!(shown.contains("  round pillar 3, pillar 3"), "{shown}");
    let summary: Value = serde_json::from_str(&folder.text("s/summary.json")).unwrap();
    let labels = summary["ropes"][0]["labels"].as_array().unwrap();
    assert_eq!(labels.len(), summary["ropes"][0]["wraps"].as_array().unwrap().len());
    assert!(labels.iter().all(|label| label == "pillar 3") && !labels.is_empty(), "{summary}");
    for contact in summary["contacts"].as_array().unwrap() {
        assert_eq!(contact["label"], "pillar 3");
    }
    assert!(folder.text("s/report.html").contains("pillar 3 (6, 4) left"));
    let file = std::fs::File::open(folder.path("s/traces.parquet")).unwrap();
    let mut batches = ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap();
    let row = batches.next().unwrap().unwrap();
    let found = row.column_by_name("labels").unwrap().as_list::<i32>().value(0);
    let found: Vec<Option<&str>> = found.as_string::<i32>().iter().collect();
    assert_eq!(found, vec![Some("pillar 3"); labels.len()]);
}

#[test]
fn what_a_file_leaves_open_is_said_in_a_study() {
    let folder = hall();
    folder.write(
        "round.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg"><circle cx="5" cy="5" r="4" fill="black"/></svg>"#,
    );
    folder.write(
        "map.yaml",
        "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n",
    );
    folder.write("map.pgm", "P2\n5 2\n255\n205 254 254 254 0\n205 254 254 254 0\n");
    let walls = |file: &str, line: &str| {
        folder.write(
            "o.toml",
            format!(
                "[scene]\nfile = \"{file}\"\nanchor = [2.5, 0.5]\n{line}\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 9\n\
                [run]\ntraces = 9\nblock = 9\n"
            ),
        );
        let shown = folder.done("study run o.toml --engine cpu --dry-run").stdout;
        let before = shown.split(" wall").next().unwrap();
        before.rsplit(' ').next().unwrap().parse::<usize>().unwrap()
    };
    for (file, line, options) in [
        ("round.svg", "", ""),
        ("round.svg", "flatten = 0.5", "--flatten 0.5"),
        ("round.svg", "flatten = 0.01", "--flatten 0.01"),
        ("map.yaml", "", ""),
        ("map.yaml", "unknown = \"blocked\"", "--unknown blocked"),
    ] {
        let found = report(&folder, &format!("check --scene {file} --json {options}"));
        assert_eq!(walls(file, line), found["scene"]["walls"].as_u64().unwrap() as usize, "{file} {line}");
    }
    assert!(walls("round.svg", "flatten = 0.5") < walls("round.svg", "flatten = 0.01"));
    assert!(walls("map.yaml", "") < walls("map.yaml", "unknown = \"blocked\""));
    for (line, parts) in [
        ("flatten = 0", ["line 4", "scene.flatten: 0 is no tolerance"]),
        ("unknown = \"wall\"", ["line 4", "`free` or `blocked`"]),
    ] {
        folder.write("o.toml", format!("[scene]\nfile = \"round.svg\"\nanchor = [0, 0]\n{line}\n[walk]\nkind = \"uniform\"\nstep = 1\nsteps = 9\n"));
        folder.refused(2, "study run o.toml", &parts);
    }
}

#[test]
fn anchors_where_they_were_hardly_meant_to_be_are_told_of() {
    let folder = hall();
    let warning = |args: &str| {
        let stderr = folder.done(args).stderr;
        stderr.lines().find_map(|line| Some(line.strip_prefix("warning: ")?.to_owned())).unwrap_or_default()
    };
    assert_eq!(warning("check --scene hall.geojson"), "");
    let inside = "hall.geojson: the anchor (5, 5) lies inside of \"pillar 3\", which is solid: a polygon, a filled shape or a \
        blocked cell";
    folder.write("still.csv", "trace,x,y\n0,5,5\n");
    assert_eq!(warning("check --scene hall.geojson --anchor 5,5"), inside);
    let far = "hall.geojson: the anchor (500, 5) lies far outside of the walls: 480 away from the box round them, which is 20 by 10";
    assert_eq!(warning("check --scene hall.geojson --anchor 500,5"), far);
    folder.write(
        "pocket.wkt",
        "LINESTRING (0 0, 9 0, 9 9, 0 9, 0 0)\nLINESTRING (1 1, 2 1, 2 2, 1 2, 1 1)\nPOINT (1.5 1.5)",
    );
    folder.write("p.csv", "trace,x,y\n0,1.5,1.5\n0,1.2,1.5\n");
    let pocket = "pocket.wkt: the anchor (1.5, 1.5) is closed in by walls: what can be reached from it is 1.23 % of the box round \
        all walls";
    folder.write(
        "p.toml",
        "[scene]\nfile = \"pocket.wkt\"\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 9\n[run]\ntraces = 9\nblock = 9\n",
    );
    for args in [
        "check --scene pocket.wkt",
        "eval --scene pocket.wkt --traces p.csv --engine cpu",
        "study run p.toml --engine cpu --dry-run",
    ] {
        assert_eq!(warning(args), pocket, "{args}");
    }
    assert_eq!(report(&folder, "check --scene pocket.wkt --json")["scene"]["warnings"][0], pocket[12..]);
    // A point that was meant to be the anchor is none.
    folder.write("a.geojson", HALL.replace("\"anchor\"", "\"Anchor\""));
    let shown = folder.done("check --scene a.geojson");
    assert!(shown.stdout.contains("no anchor\n"), "{}", shown.stdout);
    assert!(shown.stderr.contains("feature 0 is a point with \"role\": \"Anchor\" and is not taken for the anchor"));
}

#[test]
fn maps_are_those_of_nav2_or_of_ros_1() {
    let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/maps");
    let folder = Folder::new();
    for entry in std::fs::read_dir(maps).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.path(path.file_name().unwrap().to_str().unwrap())).unwrap();
    }
    for (name, today, of_old) in [("la", 4, 4), ("rgba_09", 4, 0), ("scale1", 4, 0), ("negno", 4, 4)] {
        for (ros, walls) in [("", today), ("--ros 2", today), ("--ros 1", of_old)] {
            let found = report(&folder, &format!("check --scene {name}.yaml --json {ros}"));
            assert_eq!(found["scene"]["walls"], walls, "{name} {ros}");
            let notes = found["scene"]["notes"].to_string();
            let followed =
                if ros == "--ros 1" { "map_server of ROS 1 has it" } else { "nav2's map_server of ROS 2 has it" };
            assert!(notes.contains(followed), "{notes}");
            assert_eq!(notes.contains("none of the 80 cells counts as occupied, so there are no walls"), walls == 0);
        }
    }
    folder.refused(2, "check --scene la.yaml --ros 3", &["--ros", "give 1 or 2"]);
    let study = |ros: &str| {
        folder.write(
            "s.toml",
            format!(
                "[scene]\nfile = \"rgba_09.yaml\"\nanchor = [0.1, 0.1]\n{ros}\n[walk]\nkind = \"uniform\"\nstep = 0.1\nsteps = 9\n"
            ),
        );
    };
    study("ros = 2");
    assert!(folder.done("study run s.toml --engine cpu --dry-run").stdout.contains(" 4 walls,"));
    study("ros = 1");
    assert!(folder.run("study run s.toml --engine cpu --dry-run").stderr.contains("no area"));
}
