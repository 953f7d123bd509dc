//! Drawings as a whole, and each kind of entity.

use super::*;

/// Entities as words: `LINE 10=1 20=2`. Blocks come first, as `name: entities`.
pub(super) fn file(before: &str, blocks: &[(&str, &str)], entities: &str) -> String {
    let groups = |words: &str| {
        let pairs = words.split_whitespace().map(|word| match word.split_once('=') {
            Some((code, value)) => format!("{code}\n{value}\n"),
            None => format!("0\n{word}\n"),
        });
        pairs.collect::<String>()
    };
    let blocks: String = blocks.iter().map(|(n, e)| groups(&format!("BLOCK {n} {e} ENDBLK"))).collect();
    let section = |name: &str, inside: String| format!("0\nSECTION\n2\n{name}\n{inside}0\nENDSEC\n");
    let all = [section("BLOCKS", blocks), section("ENTITIES", groups(entities))].concat();
    format!("{}{all}0\nEOF\n", groups(before))
}

pub(super) fn parsed(text: &str) -> Result<Scene, String> {
    parse(text.as_bytes(), Some(0.01)).map_err(|fault| format!("{}: {}", fault.place, fault.what))
}

pub(super) fn walls_of(scene: &Scene) -> Vec<[f64; 4]> {
    (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
}

pub(super) fn walls(blocks: &[(&str, &str)], entities: &str) -> Vec<[f64; 4]> {
    walls_of(&parsed(&file("", blocks, entities)).unwrap_or_else(|what| panic!("{entities}: {what}")))
}

const LINE: &str = "LINE 10=1 20=2 11=3 21=5";

/// That all walls' ends lie on a circle, and where the first and the last one end.
pub(super) fn on_circle(walls: &[[f64; 4]], centre: [f64; 2], radius: f64) -> [[f64; 2]; 2] {
    for w in walls {
        for [x, y] in [[w[0], w[1]], [w[2], w[3]]] {
            let off = (x - centre[0]).hypot(y - centre[1]) - radius;
            assert!(off.abs() < 1e-12 * (1.0 + radius), "{w:?} is {off} off");
        }
    }
    let last = walls[walls.len() - 1];
    [[walls[0][0], walls[0][1]], [last[2], last[3]]]
}

#[test]
fn every_kind_of_entity_gives_its_walls() {
    assert_eq!(walls(&[], LINE), [[1., 2., 3., 5.]]);
    let corners = "10=0 20=0 10=4 20=0 10=4 20=3";
    assert_eq!(walls(&[], &format!("LWPOLYLINE {corners}")), [[0., 0., 4., 0.], [4., 0., 4., 3.]]);
    assert_eq!(walls(&[], &format!("LWPOLYLINE 70=1 {corners}"))[2], [4., 3., 0., 0.]);
    let vertices = "VERTEX 10=0 20=0 VERTEX 70=16 10=7 20=7 VERTEX 10=4 20=0 VERTEX 10=4 20=3 SEQEND";
    assert_eq!(walls(&[], &format!("POLYLINE 70=1 {vertices} {LINE}")).len(), 4);
    let [from, to] = on_circle(&walls(&[], "CIRCLE 10=1 20=2 40=3"), [1., 2.], 3.);
    assert_eq!((from, to), ([4., 2.], [4., 2.]));
    let [from, to] = on_circle(&walls(&[], "ARC 10=1 20=2 40=3 50=270 51=90"), [1., 2.], 3.);
    assert_eq!((from, to), ([1., -1.], [1., 5.]));
    assert!(walls(&[], "ARC 10=1 20=2 40=3 50=270 51=90").iter().all(|w| w[0] >= 1.0));
    let ellipse = walls(&[], "ELLIPSE 10=1 20=2 11=0 21=4 40=0.5 41=0 42=6.283185307179586");
    let round: Vec<_> =
        ellipse.iter().map(|w| [(w[0] - 1.0) * 2.0, w[1] - 2.0, (w[2] - 1.0) * 2.0, w[3] - 2.0]).collect();
    let [from, to] = on_circle(&round, [0., 0.], 4.);
    assert_eq!((from, to), ([0., 4.], [0., 4.]));
    // A cubic over one span is the Bezier curve of its control points: half way it is at (3, 3).
    let spline = "SPLINE 70=8 71=3 40=0 40=0 40=0 40=0 40=1 40=1 40=1 40=1 10=0 20=0 10=2 20=4 10=4 20=4 10=6 20=0";
    let spline = walls(&[], spline);
    assert_eq!((spline[0][..2].to_vec(), spline[spline.len() - 1][2..].to_vec()), (vec![0., 0.], vec![6., 0.]));
    assert!(spline.iter().any(|w| w[..2] == [3.0, 3.0]), "{spline:?}");
}

#[test]
fn bulges_are_arcs_to_the_right_of_their_chord() {
    // A half circle, counter-clockwise from (0, 0) to (2, 0), lies below its chord; the other way it lies above.
    for (bulge, below) in [(1.0, true), (-1.0, false)] {
        let arc = walls(&[], &format!("LWPOLYLINE 10=0 20=0 42={bulge} 10=2 20=0"));
        assert_eq!(on_circle(&arc, [1., 0.], 1.), [[0., 0.], [2., 0.]]);
        assert!(arc[1..].iter().all(|w| (w[1] < 0.0) == below), "{arc:?}");
    }
    // A quarter: the tangent of a sixteenth of a turn.
    let arc = walls(&[], "LWPOLYLINE 70=1 10=1 20=0 42=0.41421356237309503 10=0 20=1");
    assert_eq!(on_circle(&arc[..arc.len() - 1], [0., 0.], 1.), [[1., 0.], [0., 1.]]);
    assert_eq!(walls(&[], "LWPOLYLINE 10=0 20=0 42=1e-12 10=2 20=0"), [[0., 0., 2., 0.]]);
}

#[test]
fn blocks_are_placed_turned_scaled_and_repeated() {
    let blocks = [
        ("2=A 10=1 20=2", LINE),
        ("2=b", "INSERT 2=a 10=10 20=0 INSERT 2=A 10=0 20=0 41=-1"),
        ("2=attributes", "INSERT 2=A 66=1 10=0 20=0 ATTRIB 1=x SEQEND"),
    ];
    assert_eq!(walls(&blocks, "INSERT 2=a 10=5 20=5"), [[5., 5., 7., 8.]]);
    assert_eq!(walls(&blocks, "INSERT 2=a 10=5 20=5 50=90"), [[5., 5., 2., 7.]]);
    assert_eq!(walls(&blocks, "INSERT 2=a 10=5 20=5 41=2 42=-1"), [[5., 5., 9., 2.]]);
    assert_eq!(walls(&blocks, "INSERT 2=B 10=0 20=1"), [[10., 1., 12., 4.], [0., 1., -2., 4.]]);
    assert_eq!(walls(&blocks, &format!("INSERT 2=attributes 10=0 20=0 {LINE}")).len(), 2);
    let array = walls(&blocks, "INSERT 2=a 10=0 20=0 70=2 71=3 44=10 45=100");
    assert_eq!(
        array.iter().map(|w| [w[0], w[1]]).collect::<Vec<_>>(),
        [[0., 0.], [10., 0.], [0., 100.], [10., 100.], [0., 200.], [10., 200.]]
    );
}

#[test]
fn what_is_seen_from_below_is_mirrored() {
    assert_eq!(walls(&[], "LWPOLYLINE 230=-1 10=1 20=2 10=3 20=5"), [[-1., 2., -3., 5.]]);
    assert_eq!(walls(&[("2=A", LINE)], "INSERT 2=A 230=-1 10=1 20=0"), [[-2., 2., -4., 5.]]);
    assert_eq!(walls(&[], &format!("{LINE} 230=-1")), [[1., 2., 3., 5.]]);
    let what = parsed(&file("", &[], "CIRCLE 10=0 20=0 40=1 210=1 220=0 230=0")).unwrap_err();
    assert!(what.contains("CIRCLE: lies askew in space, normal to (1, 0, 0)"), "{what}");
}

#[test]
fn hidden_things_are_no_walls_and_others_are_counted() {
    let layers = "SECTION 2=TABLES LAYER 2=Off 62=-7 LAYER 2=ice 70=1 LAYER 2=on 62=7 ENDSEC";
    let blocks = [("2=A", "LINE 8=0 10=1 20=2 11=3 21=5 LINE 8=on 10=1 20=2 11=3 21=6")];
    let shown = "LINE 8=on 10=1 20=2 11=3 21=5";
    let hidden = "LINE 8=off 10=0 LINE 8=ICE 10=0 LINE 60=1 LINE 67=1";
    let text = "TEXT 1=x HATCH TEXT 1=y POINT 10=0 20=0";
    let scene = parsed(&file(layers, &blocks, &format!("{shown} {hidden} {text} INSERT 2=A 8=on 10=0 20=0"))).unwrap();
    assert_eq!(scene.walls().len(), 3);
    let notes = [
        "the drawing does not say what a unit is (no $INSUNITS)",
        "hidden entities, which are no walls: 4",
        "passed over: 1 HATCH with a pattern, 2 TEXT",
    ];
    assert_eq!(scene.notes(), notes);
}

#[test]
fn a_layer_that_is_off_hides_what_lies_on_it_and_a_frozen_one_what_is_inserted_there() {
    let layers = "SECTION 2=TABLES LAYER 2=off 62=-7 LAYER 2=ice 70=1 LAYER 2=both 62=-1 70=5 ENDSEC";
    let on = |layer: &str, x: f64| format!("LINE 8={layer} 10={x} 20=0 11={x} 21=1");
    let room = [on("walls", 1.0), on("0", 2.0), on("off", 3.0), on("ice", 4.0)].join(" ");
    let insert = |block: &str, layer: &str| format!("INSERT 2={block} 8={layer} 10=0 20=0");
    let nested = |layer: &str| format!("{} {}", insert("room", layer), on("0", 9.0));
    let blocks = [
        ("2=room", room.as_str()),
        ("2=plain", &nested("0")),
        ("2=dark", &nested("off")),
        ("2=cold", &nested("ice")),
        ("2=seen", &nested("walls")),
    ];
    let shown = |block: &str, layer: &str| {
        let scene = parsed(&file(layers, &blocks, &insert(block, layer))).unwrap();
        walls_of(&scene).iter().map(|w| w[0]).collect::<Vec<_>>()
    };
    assert_eq!(shown("room", "walls"), [1., 2.]);
    assert_eq!(shown("room", "0"), [1., 2.]);
    // What lies on layer 0 of a block lies on the layer of its insert.
    assert_eq!(shown("room", "off"), [1.]);
    assert!(shown("room", "ice").is_empty() && shown("room", "both").is_empty());
    assert_eq!(shown("plain", "off"), [1.]);
    assert_eq!(shown("dark", "walls"), [1., 9.]);
    assert_eq!(shown("cold", "walls"), [9.]);
    assert_eq!(shown("seen", "off"), [1., 2.]);
    assert!(shown("seen", "ICE").is_empty());
    let invisible = parsed(&file(layers, &blocks, &(insert("room", "off") + " 60=1"))).unwrap();
    assert!(invisible.walls().is_empty());
}

#[test]
fn what_has_no_extent_is_dropped_and_counted() {
    let nothing = [
        "CIRCLE 10=1 20=1 40=0",
        "ARC 10=1 20=1 40=0.0 50=0 51=90",
        "ELLIPSE 10=1 20=2 11=0 21=0 40=0.5",
        "ELLIPSE 10=1 20=2 11=1 21=0 40=0",
        "LWPOLYLINE 90=0",
        "LWPOLYLINE 90=1 10=1 20=1",
        "POLYLINE SEQEND",
        "LINE 10=1 20=2 11=1 21=2",
        "SPLINE 71=1 40=1 40=1 40=1 40=1 10=0 20=0 10=1 20=1",
        "INSERT 2=A 10=0 20=0 41=0",
        "INSERT 2=A 10=0 20=0 41=0 42=0",
        "3DFACE 10=1 20=1 11=1 21=1 12=1 22=1",
    ];
    for entity in nothing {
        let scene = parsed(&file("", &[("2=A", LINE)], &format!("{LINE} {entity}"))).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((scene.walls().len(), scene.dropped()), (1, 1), "{entity}");
    }
}

#[test]
fn painted_areas_are_solid_walls() {
    // The corners of a SOLID come along two opposite sides.
    let solid = "10=0 20=0 11=4 21=0 12=0 22=3 13=4 23=3";
    let square = [[0., 0., 4., 0.], [4., 0., 4., 3.], [4., 3., 0., 3.], [0., 3., 0., 0.]];
    assert_eq!(walls(&[], &format!("SOLID {solid}")), square);
    assert_eq!(walls(&[], &format!("TRACE {solid}")), square);
    let triangle = [[0., 0., 4., 0.], [4., 0., 0., 3.], [0., 3., 0., 0.]];
    assert_eq!(walls(&[], "SOLID 10=0 20=0 11=4 21=0 12=0 22=3"), triangle);
    assert_eq!(walls(&[], "SOLID 10=0 20=0 11=4 21=0 12=0 22=3 13=0 23=3"), triangle);
    assert_eq!(walls(&[], "SOLID 230=-1 10=0 20=0 11=4 21=0 12=0 22=3")[0], [0., 0., -4., 0.]);
    // Those of a face in space go round, and some of its sides are not seen.
    let face = "3DFACE 10=0 20=0 11=4 21=0 12=4 22=3 13=0 23=3";
    assert_eq!(walls(&[], face), square);
    assert_eq!(walls(&[], &format!("{face} 70=5")), [square[1], square[3]]);
    assert_eq!(walls(&[], "3DFACE 10=0 20=0 11=4 21=0 12=0 22=3 13=0 23=3"), triangle);
    let unseen = parsed(&file("", &[], &format!("{face} 70=15"))).unwrap();
    assert_eq!((unseen.walls().len(), unseen.dropped(), unseen.notes().len()), (0, 0, 2));
    let inside = |entities: &str| {
        let scene = parsed(&file("", &[], entities)).unwrap();
        scene.objects()[scene.object_of(0)].inside
    };
    assert_eq!(inside(&format!("SOLID {solid}")), Inside::EvenOdd);
    assert_eq!(inside(&format!("SOLID {solid} POINT 8=anchor 10=1 20=1")), Inside::Free);
    assert_eq!(inside(&format!("SOLID {solid} POINT 8=anchor 10=0 20=1")), Inside::EvenOdd);
    // A closed line may be the border of a room as well.
    assert_eq!(inside("LWPOLYLINE 70=1 10=0 20=0 10=4 20=0 10=4 20=3"), Inside::Free);
    assert_eq!(inside(face), Inside::Free);
}

#[test]
fn entities_keep_their_layer_and_the_name_of_their_block() {
    let blocks = [("2=A", LINE), ("2=B", "INSERT 2=A 8=inner 10=0 20=0"), ("2=*U7", LINE)];
    let of = |entities: &str| {
        let scene = parsed(&file("", &blocks, entities)).unwrap();
        let object = scene.objects()[scene.object_of(0)].clone();
        (object.label.unwrap_or_default(), object.layers.join("/"))
    };
    let both = |label: &str, layer: &str| (label.to_string(), layer.to_string());
    assert_eq!(of(&format!("TEXT {LINE}")), both("", "0"));
    assert_eq!(of(&format!("{LINE} 8=Walls")), both("", "Walls"));
    assert_eq!(of("INSERT 2=A 8=doors 10=0 20=0"), both("A", "doors"));
    assert_eq!(of("INSERT 2=B 8=doors 10=0 20=0"), both("A", "inner"));
    assert_eq!(of("INSERT 2=*U7 8=doors 10=0 20=0"), both("", "doors"));
}

/// What is said of a drawing beside its unit and its curves.
fn notes(blocks: &[(&str, &str)], entities: &str, after: &str) -> Vec<String> {
    let text = file("", blocks, entities).replace("0\nEOF\n", "");
    let groups = |words: &str| {
        let pairs = words.split_whitespace().map(|word| match word.split_once('=') {
            Some((code, value)) => format!("{code}\n{value}\n"),
            None => format!("0\n{word}\n"),
        });
        pairs.collect::<String>()
    };
    let scene = parsed(&format!("{text}{}0\nEOF\n", groups(after))).unwrap();
    scene.notes()[1..].iter().filter(|note| !note.starts_with("walls lie within")).cloned().collect()
}

#[test]
fn clips_and_other_files_are_told_of() {
    let blocks =
        [("2=A", LINE), ("2=plan 70=4 1=site/plan.dwg", ""), ("2=over 70=12", ""), ("2=bound 70=4 1=x.dwg", LINE)];
    let insert = "INSERT 2=A 102={ACAD_XDICTIONARY 360=36 102=} 10=0 20=0";
    let objects = |on: &str| {
        let dictionaries = "DICTIONARY 5=36 3=ACAD_FILTER 350=37 DICTIONARY 5=37 3=SPATIAL 360=38";
        format!("SECTION 2=OBJECTS {dictionaries} SPATIAL_FILTER 5=38 70=2 {on} ENDSEC")
    };
    let note =
        |count: usize| vec![format!("clips of inserted blocks (XCLIP) cut no walls; inserts taken whole: {count}")];
    assert_eq!(notes(&blocks, insert, &objects("71=1")), note(1));
    assert_eq!(notes(&blocks, &format!("{insert} {insert} INSERT 2=A 10=0 20=0"), &objects("")), note(2));
    assert_eq!(notes(&blocks, insert, &objects("71=0")), [""; 0]);
    assert_eq!(notes(&blocks, insert, ""), [""; 0]);
    let twice = "INSERT 2=plan 10=0 20=0 INSERT 2=PLAN 10=9 20=0 INSERT 2=over 10=0 20=0 INSERT 2=bound 10=0 20=0";
    let missing = "what lies in other files is missing; inserts of external references: 1 over, 2 site/plan.dwg";
    assert_eq!(notes(&blocks, twice, ""), [missing]);
}

#[test]
fn widths_of_polylines_are_told_of() {
    let wide = |count: usize, widest: f64| {
        [format!("walls are the middle of polylines, whose widest is {widest} wide; polylines with a width: {count}")]
    };
    let line = "10=0 20=0 10=4 20=0";
    assert_eq!(notes(&[], &format!("LWPOLYLINE 43=2 {line} LWPOLYLINE 43=0 {line}"), ""), wide(1, 2.0));
    assert_eq!(notes(&[], "LWPOLYLINE 10=0 20=0 40=0 41=3 10=4 20=0 40=0 41=0", ""), wide(1, 3.0));
    let old = "POLYLINE 40=0.5 41=0.5 VERTEX 10=0 20=0 VERTEX 10=1 20=0 SEQEND";
    let vertex = "POLYLINE VERTEX 10=0 20=0 40=1.5 VERTEX 10=1 20=0 SEQEND";
    assert_eq!(notes(&[], &format!("{old} {vertex}"), ""), wide(2, 1.5));
    let block = [("2=A", "LWPOLYLINE 43=2 10=0 20=0 10=4 20=0")];
    assert_eq!(notes(&block, "INSERT 2=A 10=0 20=0 41=10 42=-10", ""), wide(1, 20.0));
    // Widths are those of polylines alone: this is a radius.
    assert_eq!(notes(&[], "CIRCLE 10=0 20=0 40=2", ""), [""; 0]);
}

#[test]
fn what_nearly_marks_the_anchor_is_told_of() {
    let right = "; what marks the anchor is a POINT on the layer \"anchor\"";
    let point = "POINT 8=Anchors 10=0 20=0";
    assert_eq!(notes(&[], point, ""), [format!("POINT in line 12 lies on the layer \"Anchors\"{right}")]);
    let block = [("2=ANCHOR", LINE)];
    let expected = format!("INSERT in line 28 is of the block \"ANCHOR\"{right}");
    assert_eq!(notes(&block, "INSERT 2=ANCHOR 10=0 20=0", ""), [expected]);
    assert_eq!(notes(&[], &format!("{point} POINT 8=anchor 10=1 20=1"), ""), [""; 0]);
}

#[test]
fn units_are_told() {
    let unit = |header: &str| {
        parsed(&file(&format!("SECTION 2=HEADER {header} ENDSEC"), &[], LINE)).unwrap().notes()[0].clone()
    };
    assert_eq!(unit("9=$ACADVER 1=AC1024 9=$INSUNITS 70=4"), "a unit is 1 mm ($INSUNITS 4)");
    assert_eq!(unit("9=$INSUNITS 70=6"), "a unit is 1 m ($INSUNITS 6)");
    assert_eq!(unit("9=$INSUNITS 70=0"), "the drawing does not say what a unit is ($INSUNITS 0)");
}

#[test]
fn a_point_on_the_layer_anchor_is_the_anchor() {
    let point = "POINT 8=Anchor 10=0.1 20=7";
    let anchor = |blocks: &[(&str, &str)], entities: &str| parsed(&file("", blocks, entities)).map(|s| s.anchor());
    assert_eq!(anchor(&[], &format!("{LINE} POINT 10=1 20=1 {point}")), Ok(Some(DVec2::new(0.1, 7.0))));
    assert_eq!(anchor(&[("2=A", point)], "INSERT 2=A 10=0 20=1"), Ok(Some(DVec2::new(0.1, 8.0))));
    // What lies on layer 0 of a block is on the layer of what inserts it.
    let block = [("2=A", "POINT 10=0 20=1")];
    assert_eq!(anchor(&block, "INSERT 2=A 8=anchor 10=0 20=1"), Ok(Some(DVec2::new(0.0, 2.0))));
    assert_eq!(anchor(&block, "INSERT 2=A 8=walls 10=0 20=1"), Ok(None));
    let two = anchor(&[], &format!("{point} {point}")).unwrap_err();
    assert_eq!(two, "line 20: POINT: a second anchor; that of line 12 marks one already, and a scene has one at most");
    let circle = anchor(&[], "CIRCLE 8=anchor 10=0 20=0 40=1").unwrap_err();
    assert_eq!(circle, "line 12: CIRCLE: lies on the layer anchor, which is for one POINT, the anchor");
}

#[test]
fn faults_name_line_and_entity() {
    let knots = "40=0 40=0 40=0 40=0 40=1 40=1 40=1 40=1";
    let points = "10=0 20=0 10=2 20=4 10=4 20=4 10=6 20=0";
    for (entities, expected) in [
        ("LINE 10=1 20=2 11=3", "line 12: LINE: no number with the group code 21"),
        ("LINE 10=1 20=x", "line 12: LINE: group code 20 has the value \"x\"; it must be a number"),
        ("LINE 10=nan 20=0 11=1 21=1", "line 12: LINE: NaN is not a finite number"),
        ("LINE 10=1e200 20=0 11=1 21=1", "line 12: LINE: 1e200 is too large for exact products"),
        ("LINE 67=x", "line 12: LINE: group code 67 has the value \"x\"; it must be a whole number"),
        ("CIRCLE 10=0 20=0 40=-1", "line 12: CIRCLE: radius -1; it must not be negative"),
        ("SOLID 10=0 20=0 11=1 21=1", "line 12: SOLID: no number with the group code 12"),
        ("LWPOLYLINE 10=0 10=1 20=3", "line 12: LWPOLYLINE: corner 0 has an x but no y"),
        ("POLYLINE 70=64 SEQEND", "line 12: POLYLINE: is a mesh in space; explode it into lines"),
        ("INSERT 2=no 10=0 20=0", "line 12: INSERT: the drawing has no block \"no\""),
        (
            &format!("SPLINE 71=3 {knots} 41=1 41=2 {points}"),
            "line 12: SPLINE: has weights that differ (a rational spline)",
        ),
        (&format!("SPLINE 71=3 {knots} 11=0 21=0"), "line 12: SPLINE: has no control points; make a polyline of it"),
        (&format!("SPLINE 71=2 {knots} {points}"), "line 12: SPLINE: 8 knots for 4 control points; degree 2 needs"),
        (&format!("SPLINE 71=-3 {knots} {points}"), "line 12: SPLINE: degree 0; it must be from 1 to 11"),
    ] {
        let what = parsed(&file("", &[], entities)).unwrap_err();
        assert!(what.contains(expected), "{entities}: {what}");
    }
    let itself = parsed(&file("", &[("2=A", "INSERT 2=a 10=0 20=0")], "INSERT 2=A 10=0 20=0")).unwrap_err();
    assert!(itself.contains("INSERT: blocks lie in each other more than 64 deep"), "{itself}");
    assert!(parsed("AutoCAD Binary DXF\r\n\u{1a}\0").unwrap_err().contains("save the drawing as ASCII DXF"));
}

#[test]
fn drawings_that_blow_up_are_refused() {
    let names: Vec<(String, String)> = (1..40)
        .map(|i| (format!("2=B{i}"), format!("INSERT 2=B{0} 10=0 20=0 INSERT 2=B{0} 10=1 20=0", i - 1)))
        .collect();
    let mut blocks = vec![("2=B0", LINE)];
    blocks.extend(names.iter().map(|(n, e)| (n.as_str(), e.as_str())));
    let what = parsed(&file("", &blocks, "INSERT 2=B39 10=0 20=0")).unwrap_err();
    assert!(what.contains("with all that is inserted again and again, the drawing is too large"), "{what}");
    let array = "INSERT 2=E 10=0 20=0 70=1000000000 71=1000000000";
    let what = parsed(&file("", &[("2=E", "")], array)).unwrap_err();
    assert!(what.contains("the drawing is too large"), "{what}");
}
