//! Scenes of other formats, and `tautline convert`.

use tautline::scene::{Scene, read_scene};

use super::Folder;

const PLAN: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="20mm" height="10mm" viewBox="0 0 20 10" fill="none" stroke="black" stroke-width="0.1">
<rect width="20" height="10"/><circle cx="10" cy="5" r="2"/><circle id="anchor" cx="2" cy="0.1" r="1"/></svg>"#;

#[test]
fn a_drawing_becomes_geojson_and_well_known_text() {
    let folder = Folder::new();
    folder.write("p.svg", PLAN);
    let done = folder.done("convert --flatten 0.1 p.svg p.geojson");
    assert_eq!(done.stdout, "p.geojson: 16 walls, 16 vertices, anchor (2, 0.1)\n");
    let notes = "note: p.svg: a unit is 1 mm (the drawing is 20 mm wide, its viewBox 20); y points down, as in the file\n\
        note: p.svg: walls lie within 0.1 of the curves that they stand for (--flatten), and contacts there depend on it; curves: 1\n";
    assert_eq!(done.stderr, notes);
    assert_eq!(folder.done("convert p.geojson p.wkt").stderr, "");
    assert_eq!(folder.done("convert p.wkt q.json").stdout, "q.json: 16 walls, 16 vertices, anchor (2, 0.1)\n");
    // Well-known text does not remember that y points down.
    assert_eq!(folder.text("p.geojson").replace("\"y\":\"down\",", ""), folder.text("q.json"));
    // A finer drawing has more walls, and a file without an anchor none.
    assert!(folder.done("convert p.svg p.json --flatten 0.001").stdout.starts_with("p.json: 104 walls"));
    folder.write("m.map", "type octile\nheight 1\nwidth 2\nmap\n.@\n");
    assert_eq!(folder.done("convert m.map m.wkt").stdout, "m.wkt: 1 wall, 2 vertices, no anchor\n");
    assert_eq!(folder.text("m.wkt"), "LINESTRING (1.0 0.0, 1.0 1.0)\n");
}

#[test]
fn labels_layers_and_what_is_solid_are_kept() {
    let folder = Folder::new();
    folder.write("m.map", "type octile\nheight 4\nwidth 5\nmap\n.....\n.@@..\n.@..@\n....@\n");
    folder.write(
        "p.json",
        r#"{"type":"FeatureCollection","features":[
        {"type":"Feature","properties":{"name":"pillar 3","layer":"a"},"geometry":{"type":"MultiPolygon","coordinates":
            [[[[0,0],[4,0],[0,4],[0,0]],[[1,1],[2,1],[1,2],[1,1]]],[[[9,9],[8,9],[9,8],[9,9]]]]}},
        {"type":"Feature","properties":{"layer":"b"},"geometry":{"type":"LineString","coordinates":[[9,9],[20,1]]}}]}"#,
    );
    for (from, walls) in [("m.map", 8), ("p.json", 10)] {
        folder.done(&format!("convert {from} a.geojson"));
        folder.done("convert a.geojson b.geojson");
        let [first, second, third] =
            [from, "a.geojson", "b.geojson"].map(|name| read_scene(&folder.path(name)).unwrap());
        assert_eq!(first.walls().len(), walls);
        for again in [second, third] {
            assert_eq!(again.walls(), first.walls());
            for wall in 0..walls {
                assert_eq!(again.outline(wall), first.outline(wall));
                assert_eq!(again.objects()[again.object_of(wall)], first.objects()[first.object_of(wall)]);
                for other in 0..walls {
                    let is_one = |scene: &Scene| scene.object_of(wall) == scene.object_of(other);
                    assert_eq!(is_one(&again), is_one(&first), "{wall} {other}");
                }
            }
        }
    }
    let note = "note: a.wkt: well-known text has no place for labels, layers and what is solid; GeoJSON has\n";
    assert_eq!(folder.done("convert p.json a.wkt").stderr, note);
}

#[test]
fn what_cannot_be_converted_changes_nothing() {
    let folder = Folder::new();
    folder.write("p.svg", PLAN);
    folder.write("bad.svg", PLAN.replace("r=\"2\"", "r=\"two\""));
    folder.write("old.wkt", "POINT (7 7)");
    let length = ["bad.svg: line 2: <circle>: r is \"two\"; it must be a length such as 12.5, 12.5mm or 50%"];
    folder.refused(2, "convert bad.svg old.wkt", &length);
    folder.refused(2, "convert p.svg p.dxf", &["p.dxf: the extension", "written as .geojson, .json or .wkt"]);
    folder.refused(2, "convert no.svg old.wkt", &["cannot read no.svg"]);
    folder.refused(2, "convert p.svg no/p.wkt", &["cannot write no/p.wkt: the folder no does not exist"]);
    folder.refused(2, "convert p.svg", &["<OUT>"]);
    folder.refused(
        2,
        "convert --flatten 1e-30 p.svg old.wkt",
        &["p.svg: within 1e-30", "give a larger tolerance (--flatten)"],
    );
    for tolerance in ["0", "-1", "nan", "inf", "x"] {
        let args = format!("convert --flatten={tolerance} p.svg old.wkt");
        folder.refused(2, &args, &["--flatten", "give a number above 0, such as 0.01"]);
    }
    folder.refused(2, "convert --unknown maybe p.svg old.wkt", &["--unknown", "free, blocked"]);
}

#[test]
fn every_format_is_evaluated_as_its_conversion_is() {
    let folder = Folder::new();
    folder.write("p.svg", PLAN);
    folder.write("t.csv", "trace,x,y\n0,2,1\n0,10,1\n0,18,5\n0,10,9\n0,2,9\n0,2,1\n");
    folder.done("convert p.svg p.geojson");
    let eval = |scene: &str, out: &str| {
        folder.done(&format!("eval --scene {scene} --traces t.csv --out {out}.jsonl --events {out}.csv --engine cpu"));
        (folder.text(&format!("{out}.jsonl")), folder.text(&format!("{out}.csv")))
    };
    let drawn = eval("p.svg", "a");
    assert_eq!(drawn, eval("p.geojson", "b"));
    assert!(drawn.1.lines().count() > 10, "the rope goes round the pillar: {}", drawn.1);
}

#[test]
fn check_lists_what_a_reader_has_to_say() {
    let folder = Folder::new();
    folder.write("p.svg", PLAN.replace("</svg>", "<text>hall</text></svg>"));
    let done = folder.done("check --scene p.svg --json");
    let report: serde_json::Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(report["scene"]["notes"][2], "passed over: 1 text");
    assert_eq!(report["scene"]["anchor"], serde_json::json!([2.0, 0.1]));
    folder.write("d.wkt", "SRID=4326;LINESTRING (13.4 52.5, 13.5 52.6)");
    let degrees = folder.done("check --scene d.wkt --anchor 13,52");
    assert!(
        degrees.stderr.contains("note: d.wkt: these coordinates look like longitude and latitude"),
        "{}",
        degrees.stderr
    );
    for (name, text, how) in [
        ("a.svg", "<svg><path d='M1,2h3'/></svg>", "or give an element the id \"anchor\""),
        ("a.wkt", "LINESTRING (0 0, 1 1)", "or put one POINT into the file"),
        ("a.dxf", "0\nSECTION\n0\nENDSEC\n0\nEOF\n", "or put a POINT on a layer called anchor"),
    ] {
        folder.write(name, text);
        let shown = folder.done(&format!("check --scene {name}")).stdout;
        let expected = format!("no anchor\n        to tie a rope, give --anchor X,Y, {how}\n");
        assert!(shown.contains(&expected), "{shown}");
        folder.write("t.csv", "trace,x,y\n0,1,1\n");
        let eval = format!("eval --scene {name} --traces t.csv");
        folder.refused(2, &eval, &[&format!("{name}: no anchor; give --anchor X,Y, {how}")]);
    }
}
