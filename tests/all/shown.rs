//! Drawings as their own programs show them: files in which something was lost, bent or let through.

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Engine, Job, Reference};
use tautline::scene::{Inside, Model, Scene, SceneOptions, read_scene, read_scene_with};
use tautline::trace::{Trace, ViolationKind, settle};

fn read(name: &str) -> Result<Scene, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/formats").join(name);
    read_scene(&path).map_err(|e| e.to_string())
}

fn scene(name: &str) -> Scene {
    read(name).unwrap_or_else(|e| panic!("{e}"))
}

fn walls(scene: &Scene) -> Vec<[f64; 4]> {
    (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
}

fn says(scene: &Scene, note: &str) -> bool {
    scene.notes().iter().any(|n| n == note)
}

#[test]
fn a_flat_bow_is_as_large_as_it_is_seen() {
    // A wall that bends by less than a millimetre is an arc of a circle of 40 km.
    for (name, curves) in
        [("bow.svg", 2), ("bow_ref.svg", 1), ("bow_arc.dxf", 2), ("bow_min.dxf", 2), ("bow_ref.dxf", 1)]
    {
        let room = scene(name);
        let note = format!(
            "walls lie within 0.005 of the curves that they stand for (--flatten), and contacts there depend on it; curves: {curves}"
        );
        // Alone, the arc and the pillar reach from 0 to 10.
        assert!(says(&room, &note), "{name}: {:?}", room.notes());
        let centre = DVec2::new(7.0, 3.0);
        let on = |p: &&DVec2| (p.distance(centre) - 0.3).abs() < 1e-9;
        assert!(room.vertices().iter().filter(on).count() >= 12, "{name}");
    }
}

#[test]
fn a_trace_that_ends_in_the_pillar_is_told_of() {
    // Its second point lies in the round pillar, but beside the square with its corners on the pillar.
    let points = [[5.0, 5.0], [7.2, 3.2], [8.0, 4.0]].map(DVec2::from);
    for name in ["bow.svg", "bow_arc.dxf"] {
        let model = Model::new(scene(name), None).unwrap();
        let settled = settle(&model, &Trace { id: 0, points: points.to_vec() });
        let violation = settled.violation().unwrap_or_else(|| panic!("{name}: nothing is told"));
        assert_eq!(violation.step, 1, "{name}");
        assert!(violation.ends.iter().all(|p| (p.distance(DVec2::new(7.0, 3.0)) - 0.3).abs() < 1e-9), "{name}");
    }
}

#[test]
fn the_anchor_is_the_middle_of_what_is_seen() {
    let anchor = scene("anchorarc.svg").anchor().unwrap();
    // The arc's height over its chord of 2.
    let height = 40.0 - (40.0f64 * 40.0 - 1.0).sqrt();
    assert!((anchor - DVec2::new(51.0, 50.0 - height / 2.0)).abs().max_element() < 1e-12, "{anchor}");
}

#[test]
fn layers_that_are_off_or_frozen() {
    let line = [-1., -1., 6., -1.];
    let room = [[0., 0., 4., 0.], [4., 0., 4., 3.], [4., 3., 0., 3.], [0., 3., 0., 0.]];
    for name in ["insert_off.dxf", "insert_off_min.dxf"] {
        let found = walls(&scene(name));
        assert_eq!((found.len(), found.contains(&line)), (5, true), "{name}");
        assert!(room.iter().all(|wall| found.contains(wall)), "{name}: {found:?}");
    }
    assert_eq!(walls(&scene("insert_frozen.dxf")), [line]);
}

#[test]
fn clips_and_external_references_are_told_of() {
    let clipped = scene("xclip.dxf");
    assert!(says(&clipped, "clips of inserted blocks (XCLIP) cut no walls; inserts taken whole: 1"));
    let note = "what lies in other files is missing; inserts of external references: 1 plan.dxf";
    assert!(says(&scene("xref.dxf"), note));
}

#[test]
fn a_circle_without_radius_is_dropped_and_counted() {
    let found = scene("zerocircle.dxf");
    assert_eq!((walls(&found), found.dropped()), (vec![[0., 9., 3., 9.]], 1));
}

#[test]
fn filled_boxes_and_wide_lines() {
    let boxes = scene("dia-box-is-solid.dxf");
    let found = walls(&boxes);
    for wall in [[6., -2., 9., -2.], [9., -2., 9., -6.], [9., -6., 6., -6.], [6., -6., 6., -2.]] {
        assert!(found.contains(&wall), "{wall:?}");
    }
    let solid = boxes.objects().iter().filter(|object| object.inside == Inside::EvenOdd).count();
    assert_eq!(solid, 3);
    let note = "walls are the middle of polylines, whose widest is 2 wide; polylines with a width: 1";
    assert!(says(&scene("wide.dxf"), note));
}

/// How long the rope is in the end.
fn rope(scene: &Scene, anchor: [f64; 2], points: &[[f64; 2]]) -> f64 {
    let model = Arc::new(Model::new(scene.clone(), Some(anchor.into())).unwrap());
    let settled = settle(&model, &Trace { id: 0, points: points.iter().copied().map(DVec2::from).collect() });
    assert_eq!(settled.violation(), None);
    let records = Reference::new(model).evaluate(&[settled], &Job::new()).unwrap();
    records[0].length
}

#[test]
fn a_rope_goes_round_a_hatched_pillar() {
    // ogr2ogr writes polygons as hatches; a pillar may be drawn as a line, too, before it is hatched.
    for name in ["ogr2ogr.dxf", "hatch_min.dxf", "hatch_outlined.dxf"] {
        let room = scene(name);
        for (from, to) in [([1.0, 2.0], [4.0, 1.0]), ([4.0, 1.0], [1.0, 2.0])] {
            assert_eq!(rope(&room, from, &[[1.0, 1.0], to]), 4.0, "{name}");
        }
        let model = Model::new(room, Some(DVec2::new(2.0, 2.0))).unwrap();
        let settled = settle(&model, &Trace { id: 0, points: vec![DVec2::new(2.0, 1.5)] });
        assert_eq!(settled.violation().map(|v| v.kind), Some(ViolationKind::EntersSolid), "{name}");
    }
    // The yard is a hole: a rope that is tied on its border goes on within it.
    assert_eq!(rope(&scene("ogr2ogr.dxf"), [12.0, 2.0], &[[12.0, 8.0], [15.0, 8.0]]), 45f64.sqrt());
}

#[test]
fn hatches_have_the_borders_that_another_reader_sees() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/formats/hatch.dxf");
    let options = SceneOptions { flatten: Some(0.01), ..SceneOptions::default() };
    let drawn = read_scene_with(&path, &options).unwrap();
    assert!(says(&drawn, "passed over: 1 HATCH with a gradient, 1 HATCH with a pattern"), "{:?}", drawn.notes());
    let of = |layer: &str| {
        let lies = |&w: &usize| drawn.objects()[drawn.object_of(w)].layers == [layer];
        (0..drawn.walls().len()).filter(lies).map(|w| drawn.ends(w)).collect::<Vec<_>>()
    };
    let far = |ones: &[[DVec2; 2]], others: &[[DVec2; 2]]| {
        let to = |p: DVec2, [a, b]: [DVec2; 2]| {
            p.distance(a + (b - a) * ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0))
        };
        let least = |p: DVec2| others.iter().map(|&wall| to(p, wall)).fold(f64::INFINITY, f64::min);
        ones.iter().flat_map(|&[a, b]| [a, (a + b) / 2.0]).map(least).fold(0.0, f64::max)
    };
    for layer in ["bulged", "edges", "cw", "ellipse", "spline", "whole"] {
        let [ours, theirs] = [of(layer), of(&format!("{layer} flattened"))];
        // Ours lie within 0.01 of the curves, and theirs within 0.005.
        let off = far(&ours, &theirs).max(far(&theirs, &ours));
        assert!(!theirs.is_empty() && off < 0.0152, "{layer}: {off}");
    }
}

#[test]
fn style_sheets_draw_and_move() {
    let drawn = scene("cssgeom.svg");
    let found = walls(&drawn);
    for wall in [[10., 10., 40., 10.], [100., 50., 120., 50.], [150., 10., 190., 90.], [0., 95., 200., 95.]] {
        assert!(found.contains(&wall), "{wall:?} is not in {found:?}");
    }
    let round = drawn.vertices().iter().filter(|p| (p.distance(DVec2::new(60.0, 40.0)) - 8.0).abs() < 1e-9);
    assert!(round.count() >= 12);
    assert_eq!(walls(&scene("cssxform.svg")), [[0., 0., 0., 50.], [10., 25., 60., 25.]]);
}

#[test]
fn units_and_edges_of_drawings() {
    let note = "a unit is 0.5 mm (the drawing is 25 mm high, its viewBox 50); y points down, as in the file";
    assert!(says(&scene("mismatch_meet.svg"), note));
    let e = read("mismatch_none.svg").unwrap_err();
    assert!(e.contains("mismatch_none.svg: line 1: <svg>: a unit is 1 mm along x, but 2 mm along y"), "{e}");
    let note = "nested drawings and symbols are not cut at their edges; elements that reach beyond, taken whole: 1";
    assert!(says(&scene("nestedclip.svg"), note));
}

#[test]
fn what_is_not_seen_is_no_wall() {
    let found = scene("libreoffice-boundingbox.svg");
    assert_eq!(walls(&found), [[4., 4., 8., 8.], [8., 8., 4., 8.]]);
    assert!(says(&found, "shapes neither filled nor stroked, or of opacity 0, which are no walls: 1"));
    // Nothing is left of two sides of this rectangle: its corners meet.
    let round = scene("rectrx.svg");
    assert_eq!(round.dropped(), 0);
}

#[test]
fn a_plan_keeps_its_names_and_tells_of_its_arrow() {
    let lab = scene("lab.svg");
    let note = "markers such as arrow heads are no walls, but the lines that bear them are; lines with markers: 1";
    assert!(says(&lab, note), "{:?}", lab.notes());
    let named = |label: &str| lab.objects().iter().find(|o| o.label.as_deref() == Some(label)).cloned();
    for (label, layer, inside) in [
        ("hall", "Walls", Inside::Free),
        ("divider", "Walls", Inside::Free),
        ("table", "Furniture", Inside::NonZero),
        ("pillar", "Furniture", Inside::NonZero),
        ("bench", "Furniture", Inside::NonZero),
        ("drive direction", "Notes", Inside::Free),
    ] {
        let object = named(label).unwrap_or_else(|| panic!("no {label}"));
        assert_eq!((object.layers, object.inside), (vec![layer.to_string()], inside), "{label}");
    }
}
