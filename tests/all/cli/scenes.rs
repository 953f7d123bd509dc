//! Scenes that cannot be read or have no place for the rope's fixed end.

use super::{EVAL, Folder};

/// One feature of kind `kind` after one that is all right.
fn second_feature(kind: &str, coordinates: &str) -> String {
    format!(
        r#"{{"type": "FeatureCollection", "features": [
            {{"type": "Feature", "properties": {{"role": "anchor"}},
              "geometry": {{"type": "Point", "coordinates": [0, 0]}}}},
            {{"type": "Feature", "properties": {{}},
              "geometry": {{"type": "{kind}", "coordinates": {coordinates}}}}}]}}"#
    )
}

/// Evaluation of the hand-made traces in a scene file of this name and text is refused.
fn refused(name: &str, text: &str, parts: &[&str]) {
    let folder = Folder::hand_made();
    folder.write(name, text);
    folder.refused(2, &EVAL.replace("s.geojson", name), parts);
}

#[test]
fn files_that_are_not_there_or_not_known() {
    let folder = Folder::hand_made();
    let eval = |scene: &str| EVAL.replace("s.geojson", scene);
    folder.refused(2, &eval("no.geojson"), &["cannot read no.geojson", "No such file"]);
    folder.refused(2, &eval("no.map"), &["cannot read no.map", "No such file"]);
    for name in ["s.shp", "s"] {
        folder.write(name, "walls");
        folder.refused(
            2,
            &eval(name),
            &[&format!("{name}: the extension"), "scenes", ".geojson, .json, .wkt, .svg, .dxf, .map, .yaml, .yml"],
        );
    }
    std::fs::create_dir(folder.path("folder.json")).unwrap();
    folder.refused(2, &eval("folder.json"), &["cannot read folder.json", "directory"]);
}

#[test]
fn broken_geojson_is_placed_by_line_and_column() {
    refused("a.geojson", "{\n \"type\": oops\n}", &["a.geojson: line 2, column 10: not GeoJSON"]);
    refused("a.json", "", &["a.json: line 1, column 0: not GeoJSON", "EOF"]);
    refused("a.json", "[1, 2]", &["a.json: ", "not GeoJSON"]);
    refused("a.json", r#"{"type": "Wall"}"#, &["a.json: line 1", "Wall", "expected one of", "FeatureCollection"]);
}

#[test]
fn faults_in_geojson_name_feature_and_position() {
    let large = ["s.geojson: feature 1, position 1: 1e200 is too large", "within 2^500"];
    refused("s.geojson", &second_feature("LineString", "[[0, 0], [1e200, 0]]"), &large);
    let small = ["s.geojson: feature 1, position 0: 1e-200 is too small", "0 or at least 2^-450"];
    refused("s.geojson", &second_feature("LineString", "[[0, 1e-200], [1, 0]]"), &small);
    let open = [
        "s.geojson: feature 1, ring 0: the ring is open: it starts at (1, 1) and ends at (2, 2)",
        "the last position must repeat the first",
    ];
    refused("s.geojson", &second_feature("Polygon", "[[[1, 1], [2, 1], [2, 2]]]"), &open);
    let one = ["s.geojson: feature 1: one position only", "two or more"];
    refused("s.geojson", &second_feature("LineString", "[[1, 1]]"), &one);
    // JSON has no such numbers; the line is that of the number.
    for (number, what) in [("NaN", "not GeoJSON"), ("Infinity", "not GeoJSON"), ("1e999", "number out of range")] {
        let text = second_feature("LineString", &format!("[[0, 0],\n[{number}, 0]]"));
        refused("s.geojson", &text, &["s.geojson: line 6", what]);
    }
}

#[test]
fn a_scene_has_one_anchor() {
    let missing = ["s.geojson: no anchor", "--anchor X,Y", "a Point with the property \"role\": \"anchor\""];
    refused("s.geojson", r#"{"type": "LineString", "coordinates": [[1, 0], [2, 0]]}"#, &missing);
    refused("s.map", "type octile\nheight 1\nwidth 2\nmap\n.@\n", &["s.map: no anchor", "--anchor X,Y"]);
    let two = second_feature("Point", "[1, 1]").replace("{}", r#"{"role": "anchor"}"#);
    refused("s.geojson", &two, &["s.geojson: feature 1: a second anchor; feature 0", "one at most"]);
    let line = second_feature("LineString", "[[1, 1], [2, 2]]").replace("{}", r#"{"role": "anchor"}"#);
    refused("s.geojson", &line, &["s.geojson: feature 1: role is anchor", "LineString", "must be a Point"]);
    let far = second_feature("LineString", "[[1, 0], [2, 0]]").replace("[0, 0]", "[1e200, 0]");
    refused("s.geojson", &far, &["s.geojson: feature 0: 1e200 is too large"]);
}

#[test]
fn anchors_given_are_checked_too() {
    let folder = Folder::hand_made();
    for wrong in ["1", "1,b", "1;2", "1,2,3", ","] {
        folder.refused(2, &format!("{EVAL} --anchor {wrong}"), &["--anchor", wrong, "two numbers", "such as 1.5,-2"]);
    }
    folder.refused(2, &format!("{EVAL} --anchor nan,0"), &["the anchor", "NaN is not a finite number"]);
    folder.refused(2, &format!("{EVAL} --anchor 0,inf"), &["the anchor", "inf is not a finite number"]);
    folder.refused(2, &format!("{EVAL} --anchor 1e200,0"), &["the anchor", "1e200 is too large"]);
}

#[test]
fn faults_in_grid_maps_name_line_and_column() {
    for (text, parts) in [
        ("", &["m.map: ", "the file ends", "type octile"][..]),
        ("type octile\nheight x\nwidth 2\nmap\n..\n", &["m.map: line 2: ", "\"x\"", "from 1 to 32768"]),
        ("type octile\nwidth 2\nheight 1\nmap\n..\n", &["m.map: line 2: ", "width 2", "height 512"]),
        ("type octile\nheight 1\nwidth 2\nmap\n.?\n", &["m.map: line 5, column 2: '?' is no cell", ". G S", "@ O T W"]),
        ("type octile\nheight 1\nwidth 2\nmap\n...\n", &["m.map: line 5, column 3: ", "3 cells", "width 2"]),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n", &["m.map: line 6: ", "after 1 row;", "height 2"]),
        ("type octile\nheight 1\nwidth 2\nmap\n..\n..\n", &["m.map: line 6: ", "after the last", "height 1"]),
    ] {
        refused("m.map", text, parts);
    }
}

#[test]
fn walls_of_no_length_are_told_of() {
    let folder = Folder::hand_made();
    folder.write("s.geojson", second_feature("LineString", "[[3, 4], [3, 4], [3, -4], [3, -4]]"));
    let done = folder.done(EVAL);
    assert!(done.stderr.contains("2 walls of zero length were dropped"), "{}", done.stderr);
}
