use super::*;

fn parse(text: &str) -> Result<Scene, Fault> {
    super::parse(text, &BTreeSet::new())
}

fn fault(text: &str) -> String {
    let fault = parse(text).unwrap_err();
    format!("{}: {}", fault.place, fault.what)
}

fn features(features: &[&str]) -> String {
    let all: Vec<String> = features
        .iter()
        .map(|f| match f.split_once('|') {
            Some((role, g)) => {
                format!(r#"{{"type":"Feature","properties":{{"role":"{role}"}},"geometry":{g}}}"#)
            }
            None => format!(r#"{{"type":"Feature","properties":null,"geometry":{f}}}"#),
        })
        .collect();
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, all.join(",\n"))
}

fn geometry(kind: &str, coordinates: &str) -> String {
    format!(r#"{{"type":"{kind}","coordinates":{coordinates}}}"#)
}

#[test]
fn every_kind_of_geometry_gives_its_walls() {
    for (kind, coordinates, walls) in [
        ("LineString", "[[0,0],[1,0],[2,1]]", 2),
        ("LineString", "[]", 0),
        ("MultiLineString", "[[[0,0],[1,0]],[[5,5],[6,6],[7,5]]]", 3),
        ("Polygon", "[[[0,0],[9,0],[9,9],[0,0]],[[2,1],[3,1],[3,2],[2,1]]]", 6),
        ("MultiPolygon", "[[[[0,0],[9,0],[9,9],[0,0]]],[[[20,1],[30,1],[30,2],[20,1]]]]", 6),
        ("Point", "[1,2]", 0),
        ("MultiPoint", "[[1,2],[3,4]]", 0),
    ] {
        let g = geometry(kind, coordinates);
        let collection = format!(r#"{{"type":"GeometryCollection","geometries":[{g},{g}]}}"#);
        let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{g}}}"#);
        for (text, times) in [(&g, 1), (&feature, 1), (&collection, 2), (&features(&[&g, "null", &g]), 2)] {
            let scene = parse(text).unwrap();
            assert_eq!((scene.walls().len(), scene.anchor()), (walls * times, None), "{text}");
        }
    }
}

#[test]
fn positions_are_read_exactly_and_altitude_is_passed_over() {
    let scene = parse(&geometry("LineString", "[[0.1,-2.2250738585072014e-100,7],[123456789012345678,1e23]]"));
    let scene = scene.unwrap();
    let [u, v] = scene.ends(0);
    assert_eq!([u.x, u.y, v.x, v.y], [0.1, -2.2250738585072014e-100, 123456789012345678.0, 1e23]);
}

#[test]
fn a_wall_of_zero_length_is_dropped_and_counted() {
    let scene = parse(&geometry("LineString", "[[0,0],[0,0],[1,0]]")).unwrap();
    assert_eq!((scene.walls().len(), scene.dropped()), (1, 1));
}

#[test]
fn the_anchor_is_the_point_that_has_the_role() {
    let point = geometry("Point", "[1.5,-2]");
    let anchor = format!("anchor|{point}");
    let scene = parse(&features(&[&point, &format!("tree|{point}"), &anchor])).unwrap();
    assert_eq!(scene.anchor(), Some(DVec2::new(1.5, -2.0)));
    let collection = format!(r#"anchor|{{"type":"GeometryCollection","geometries":[{point}]}}"#);
    assert!(parse(&features(&[&collection])).unwrap().anchor().is_some());

    let two = fault(&features(&[&anchor, &point, &anchor]));
    assert_eq!(two, "feature 2: a second anchor; feature 0 marks one already, and a scene has one at most");
    for (g, kind) in [(geometry("MultiPoint", "[[0,0]]"), "MultiPoint"), ("null".into(), "null")] {
        let what = fault(&features(&[&point, &format!("anchor|{g}")]));
        assert_eq!(what, format!("feature 1: role is anchor, but the geometry is {kind}; it must be a Point"));
    }
}

#[test]
fn faults_of_positions_name_their_place() {
    let g = |kind, coordinates| features(&["null", &geometry(kind, coordinates)]);
    let large = "is too large for exact products: coordinates must lie within 2^500 (3.27e150) of zero";
    let small = "is too small for exact products: coordinates must be 0 or at least 2^-450 (3.4e-136) in magnitude";
    let short = "a position of 1 number; it needs two, x and y";
    for (text, expected) in [
        (g("LineString", "[[0,0],[1e200,0]]"), format!("feature 1, position 1: 1e200 {large}")),
        (
            g("MultiLineString", "[[],[[0,1e-200],[0,1]]]"),
            format!("feature 1, line string 1, position 0: 1e-200 {small}"),
        ),
        (g("Polygon", "[[[0,0],[1],[0,0]]]"), format!("feature 1, ring 0, position 1: {short}")),
        (g("MultiPolygon", "[[[]],[[[0,0],[1]]]]"), format!("feature 1, polygon 1, ring 0, position 1: {short}")),
        (geometry("LineString", "[[0,0],[0,-1e300]]"), format!("position 1: -1e300 {large}")),
        (g("LineString", "[[0,0]]"), "feature 1: one position only; a line needs two or more".into()),
        (features(&["anchor|{\"type\":\"Point\",\"coordinates\":[1e200,0]}"]), format!("feature 0: 1e200 {large}")),
    ] {
        assert_eq!(fault(&text), expected);
    }
}

#[test]
fn an_open_ring_is_named() {
    let ring = geometry("MultiPolygon", "[[[[0,0],[1,0],[0,0]],[[0,0],[1,0],[1,1]]]]");
    let what = "the ring is open: it starts at (0, 0) and ends at (1, 1)";
    let expected = format!("feature 0, polygon 0, ring 1: {what}; the last position must repeat the first");
    assert_eq!(fault(&features(&[&ring])), expected);
}

#[test]
fn what_is_not_geojson_is_placed_by_line_and_column() {
    for (text, expected) in [
        ("", "line 1, column 0: not GeoJSON: EOF while parsing a value"),
        ("{\n \"type\": oops", "line 2, column 10: not GeoJSON: expected value"),
        ("[1, 2]", "not GeoJSON: "),
        (r#"{"type":"Wall"}"#, "line 1, column 14: not GeoJSON: unknown variant `Wall`"),
        (r#"{"type":"FeatureCollection"}"#, "not GeoJSON: missing field `features`"),
        (r#"{"type":"LineString","coordinates":[[0,1e999],[1,1]]}"#, "number out of range"),
        (r#"{"type":"LineString","coordinates":[[0,NaN],[1,1]]}"#, "line 1, column 40: not GeoJSON: expected value"),
        (r#"{"type":"LineString","coordinates":[[0,null],[1,1]]}"#, "line 1, column 43: not GeoJSON: invalid type"),
        (r#"{"type":"LineString","coordinates":[0,1]}"#, "not GeoJSON: "),
        (r#"{"type":"LineString"}"#, "not GeoJSON: "),
        (r#"{"type":"Point","coordinates":[]}"#, "A position must contain two or more"),
    ] {
        let what = fault(text);
        assert!(what.contains(expected), "{text}: {what}");
        assert!(!what.contains(" at line"), "{what}");
    }
    let deep = format!("{}{}", r#"{"type":"GeometryCollection","geometries":["#.repeat(500), "]}".repeat(500));
    assert!(fault(&deep).contains("recursion limit"));
}

#[test]
fn what_is_passed_over_is_counted() {
    let line = geometry("LineString", "[[1,0],[1,1]]");
    let notes = |list: &[&str]| parse(&features(list)).unwrap().notes().to_vec();
    assert_eq!(notes(&["null", &line, "null"]), ["features without a geometry (null), passed over: 2"]);
    let points = [geometry("Point", "[0,0]"), geometry("MultiPoint", "[[0,0],[1,1]]")];
    assert_eq!(notes(&[&points[0], &line, &points[1]]), ["points that mark no anchor, passed over: 3"]);
    assert!(notes(&[&line, "anchor|{\"type\":\"Point\",\"coordinates\":[0,0]}"]).is_empty());
}

#[test]
fn a_linear_ring_is_read() {
    let ring = geometry("LinearRing", "[[0,0],[1,0],[1,1],[0,0]]");
    let collection = format!(r#"{{"type":"GeometryCollection","geometries":[{ring},{ring}]}}"#);
    let feature = format!(r#"{{"type":"Feature","properties":{{}},"geometry":{ring}}}"#);
    for (text, walls) in [(&ring, 3), (&collection, 6), (&feature, 3), (&features(&[&collection, &ring]), 9)] {
        assert_eq!(parse(text).unwrap().walls().len(), walls, "{text}");
    }
    let exact = parse(&geometry("LinearRing", "[[0.1,-2.2250738585072014e-100,7],[123456789012345678,1e23]]")).unwrap();
    assert_eq!(exact.ends(0).map(|p| p.to_array()), [[0.1, -2.2250738585072014e-100], [123456789012345678.0, 1e23]]);
}

#[test]
fn a_feature_that_is_none_is_named() {
    let line = geometry("LineString", "[[1,0],[1,1]]");
    let empty = geometry("MultiPolygon", "[[]]");
    let what = fault(&features(&[&line, &geometry("LinearRing", "[[0,0],[1,1]]"), &empty]));
    assert!(what.starts_with("feature 2: not GeoJSON: ") && what.contains("MultiPolygon"), "{what}");
    assert!(what.ends_with("none may be an empty list in place of a polygon"), "{what}");
    for wrong in [geometry("Curve", "[]"), geometry("Point", "[]"), geometry("LineString", "3"), "{}".into()] {
        let what = fault(&features(&[&line, &wrong, &line]));
        assert!(what.starts_with("feature 1: not GeoJSON: "), "{what}");
    }
}

#[test]
fn properties_name_objects_and_their_layers() {
    let feature = |more: &str, properties: &str| {
        let line = geometry("LineString", "[[1,0],[1,1]]");
        format!(r#"{{"type":"Feature"{more},"properties":{properties},"geometry":{line}}}"#)
    };
    let object = |more: &str, properties: &str| {
        let scene = super::parse(&feature(more, properties), &BTreeSet::from(["kind", "Floor"])).unwrap();
        let object = scene.objects()[scene.object_of(0)].clone();
        (object.label.unwrap_or_default(), object.layers.join(";"))
    };
    for (more, properties, label, layers) in [
        ("", r#"{"label":"pillar 3","name":"n","id":"i"}"#, "pillar 3", ""),
        (r#","id":"f""#, r#"{"Name":"n","id":"i","Layer":"A-WALL"}"#, "n", "A-WALL"),
        (r#","id":"f""#, r#"{"id":"i","label":" "}"#, "f", ""),
        ("", r#"{"id":"i","label":null,"LAYER":7}"#, "i", "7"),
        (r#","id":12"#, r#"{"id":3,"layer":["a"]}"#, "", ""),
        ("", r#"{"name":12,"kind":"door","floor":2,"layer":"x"}"#, "12", "x;Floor=2;kind=door"),
        ("", "null", "", ""),
    ] {
        assert_eq!(object(more, properties), (label.to_owned(), layers.to_owned()), "{more} {properties}");
    }
}

#[test]
fn points_that_look_like_the_anchor_are_told_of() {
    let point = geometry("Point", "[1.5,-2]");
    let feature = |more: &str, properties: &str, geometry: &str| {
        format!(r#"{{"type":"Feature"{more},"properties":{{{properties}}},"geometry":{geometry}}}"#)
    };
    for (more, properties, how) in [
        ("", r#""role":"Anchor""#, r#""role": "Anchor""#),
        ("", r#""Role":"anchor""#, r#""Role": "anchor""#),
        ("", r#""name":"ANCHOR""#, r#""name": "ANCHOR""#),
        (r#","id":"anchor""#, "", "that id"),
    ] {
        let scene = parse(&feature(more, properties, &point)).unwrap();
        let note =
            format!("feature 0 is a point with {how} and is not taken for the anchor: that has \"role\": \"anchor\"");
        assert_eq!((scene.anchor(), &scene.notes()[0]), (None, &note));
    }
    let quiet =
        [feature("", r#""role":"tree""#, &point), feature("", r#""name":"anchor""#, &geometry("LineString", "[]"))];
    assert!(quiet.iter().all(|text| parse(text).unwrap().notes().iter().all(|note| !note.contains("anchor:"))));
}
