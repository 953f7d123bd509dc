//! Scenes as other programs write them, cut off anywhere, and there and back again.

use std::path::{Path, PathBuf};

use glam::DVec2;
use proptest::prelude::*;
use tautline::output::write_scene;
use tautline::scene::{Scene, SceneOptions, Unknown, read_scene, read_scene_with};

use crate::corpus::bodies::scenes::same;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/formats").join(name)
}

fn walls(scene: &Scene) -> Vec<[f64; 4]> {
    (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
}

/// The walls whose both ends pass `keep`.
fn among(scene: &Scene, keep: impl Fn(DVec2) -> bool) -> Vec<[DVec2; 2]> {
    (0..scene.walls().len()).map(|w| scene.ends(w)).filter(|ends| ends.iter().all(|&p| keep(p))).collect()
}

/// Whether there is a wall between these points, in either direction.
fn has(scene: &Scene, [a, b, c, d]: [f64; 4]) -> bool {
    let walls = walls(scene);
    walls.contains(&[a, b, c, d]) || walls.contains(&[c, d, a, b])
}

#[test]
fn a_plan_drawn_in_inkscape() {
    let options = SceneOptions { flatten: Some(0.01), ..Default::default() };
    let plan = read_scene_with(&file("plan.svg"), &options).unwrap();
    assert_eq!(plan.anchor(), Some(DVec2::new(20.0, 15.0)));
    for wall in [[10., 5., 110., 5.], [110., 75., 10., 75.], [50., 5., 50., 35.], [50., 45., 50., 75.]] {
        assert!(has(&plan, wall), "{wall:?}");
    }
    // The pillar is turned about its own centre; its clone is not, and stands elsewhere.
    for centre in [DVec2::new(80.0, 25.0), DVec2::new(95.0, 35.0)] {
        let round = among(&plan, |p| (p.distance(centre) - 3.0).abs() < 1e-9);
        assert!(round.len() >= 16, "{} walls round {centre}", round.len());
        assert!(round.windows(2).all(|w| w[0][1] == w[1][0]) && round[0][0] == round[round.len() - 1][1]);
        let off = round.iter().map(|[a, b]| 3.0 - ((*a + *b) / 2.0).distance(centre)).fold(0.0, f64::max);
        assert!(off <= 0.01 && off > 0.001, "{off}");
    }
    // The bay is a curve from wall to wall: half way it is three quarters of its control points' height.
    let bay = among(&plan, |p| p.y > 55.0 && p.x > 55.0 && p.y <= 75.0 && p.x < 105.0);
    assert_eq!([bay[0][0], bay[bay.len() - 1][1]], [DVec2::new(70.0, 75.0), DVec2::new(100.0, 75.0)]);
    let top = bay.iter().map(|w| w[0].y).fold(75.0, f64::min);
    assert!((top - 60.0).abs() < 0.01, "{top}");
    // The table's layer is hidden.
    assert!(among(&plan, |p| p.x >= 20.0 && p.x <= 30.0 && p.y > 19.0 && p.y < 26.0).is_empty());
    let expected = [
        "a unit is 1 mm (the drawing is 120 mm wide, its viewBox 120); y points down, as in the file",
        "walls lie within 0.01 of the curves that they stand for (--flatten), and contacts there depend on it; curves: 3",
        "hidden elements, which are no walls: 1",
        "passed over: 1 text",
    ];
    assert_eq!(plan.notes(), expected);
    // Without a tolerance it is a 2000th of the longer side, 100.
    let usual = read_scene(&file("plan.svg")).unwrap();
    assert!(usual.notes()[1].contains("within 0.05 of the curves"), "{:?}", usual.notes());
    assert!(usual.walls().len() < plan.walls().len());
}

#[test]
fn a_plan_in_dxf() {
    let options = SceneOptions { flatten: Some(1.0), ..Default::default() };
    let plan = read_scene_with(&file("plan.dxf"), &options).unwrap();
    assert_eq!(plan.anchor(), Some(DVec2::new(100.0, 200.25)));
    // Four sides, one wall, and the straight lines of two doors: one at (1000, 100), the other beyond it, mirrored.
    let straight = [
        [0., 0., 4000., 0.],
        [4000., 0., 4000., 3000.],
        [4000., 3000., 0., 3000.],
        [0., 3000., 0., 0.],
        [2000., 0., 2000., 1250.5],
        [1000., 100., 1000., 1000.],
        [1000., 2100., 1000., 1200.],
    ];
    for wall in straight {
        assert!(has(&plan, wall), "{wall:?}");
    }
    let round = |centre: [f64; 2], radius: f64, least: DVec2, most: DVec2| {
        let on = |p: DVec2| (p.distance(centre.into()) - radius).abs() < 1e-9;
        let walls = among(&plan, |p| on(p) && p.cmpge(least - 1e-9).all() && p.cmple(most + 1e-9).all());
        let ends = [walls[0][0], walls[walls.len() - 1][1]];
        assert!(walls.windows(2).all(|w| w[0][1] == w[1][0]), "{centre:?}");
        (walls.len(), ends.map(|p| p.to_array()))
    };
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let (pillar, ends) = round([3000., 1500.], 250., p(2750., 1250.), p(3250., 1750.));
    assert_eq!(ends, [[3250., 1500.]; 2]);
    let (arc, ends) = round([2000., 2000.], 500., p(1500., 2000.), p(2000., 2500.));
    assert_eq!(ends, [[2000., 2500.], [1500., 2000.]]);
    let (bulge, ends) = round([1000., 3000.], 500., p(500., 2500.), p(1500., 3000.));
    assert_eq!(ends, [[500., 3000.], [1500., 3000.]]);
    let (door, ends) = round([1000., 100.], 900., p(100., 100.), p(1000., 1000.));
    assert_eq!(ends, [[1000., 1000.], [100., 100.]]);
    let (other, ends) = round([1000., 2100.], 900., p(100., 1200.), p(1000., 2100.));
    assert_eq!(ends, [[1000., 1200.], [100., 2100.]]);
    let on_ellipse = |q: DVec2| (((q - p(1000., 1000.)) / p(300., 150.)).length() - 1.0).abs() < 1e-12;
    let ellipse = among(&plan, on_ellipse);
    assert_eq!(ellipse[0][0], ellipse[ellipse.len() - 1][1]);
    let of_spline =
        |q: DVec2| q.x >= 2500. && q.x <= 3500. && q.y >= 2000. && q.y < 3000. && !q.abs_diff_eq(p(2500., 2000.), 1.);
    let spline = among(&plan, of_spline);
    assert_eq!([spline[0][0], spline[spline.len() - 1][1]], [p(2500., 2500.), p(3500., 2750.)]);
    let all = straight.len() + pillar + arc + bulge + door + other + ellipse.len() + spline.len();
    assert_eq!(plan.walls().len(), all);
    let notes = [
        "a unit is 1 mm ($INSUNITS 4)",
        "walls lie within 1 of the curves that they stand for (--flatten), and contacts there depend on it; curves: 8",
        "hidden entities, which are no walls: 1",
        "passed over: 1 TEXT",
    ];
    assert_eq!(plan.notes(), notes);
    let old = read_scene(&file("r12.dxf")).unwrap();
    assert_eq!(walls(&old), [[0., 0., 1., 0.], [1., 0., 1., 1.], [1., 1., 0., 0.]]);
}

#[test]
fn a_plan_in_well_known_text() {
    let plan = read_scene(&file("plan.wkt")).unwrap();
    let expected = [
        [0., 0., 10., 0.],
        [10., 0., 10., 8.5],
        [10., 8.5, 0., 8.5],
        [0., 8.5, 0., 0.],
        [2., 2., 4., 2.],
        [4., 2., 4., 4.],
        [4., 4., 2., 2.],
        [5., 0., 5., 3.],
        [5., 4., 5.1, 8.5],
        [7., 1., 8., 2.],
        [6., 6., 7., 6.],
        [7., 6., 6., 7.],
        [6., 7., 6., 6.],
    ];
    assert_eq!(walls(&plan), expected);
    assert_eq!((plan.anchor(), plan.notes().len()), (Some(DVec2::new(1.0, 0.5)), 0));
}

#[test]
fn a_map_of_a_map_server() {
    // A room of ten by six cells with walls one cell thick and an obstacle of one by three on unknown ground.
    let map = read_scene(&file("map.yaml")).unwrap();
    let at = |x: i32, y: i32| DVec2::new(-1.0, 2.0) + DVec2::new(f64::from(x), f64::from(8 - y)) * 0.05;
    for [from, to] in [[[1, 1], [11, 1]], [[2, 2], [10, 2]], [[5, 2], [6, 2]], [[5, 5], [6, 5]], [[1, 1], [1, 7]]] {
        let [a, b] = [at(from[0], from[1]), at(to[0], to[1])];
        // The obstacle's upper side is one with the wall above it.
        let covered = (0..map.walls().len()).map(|w| map.ends(w)).any(|[c, d]| c == a && d == b);
        assert_eq!(covered, ![[2, 2], [5, 2]].contains(&from), "{from:?} {to:?}");
    }
    assert_eq!(map.notes().len(), 3);
    let blocked = SceneOptions { unknown: Unknown::Blocked, ..Default::default() };
    let blocked = read_scene_with(&file("map.yaml"), &blocked).unwrap();
    assert!(blocked.walls().len() < map.walls().len(), "the room's outer side is no border any more");
    // The same image as PNG.
    let folder = tempfile::tempdir().unwrap();
    let yaml = std::fs::read_to_string(file("map.yaml")).unwrap().replace("map.pgm", file("map.png").to_str().unwrap());
    std::fs::write(folder.path().join("map.yml"), yaml).unwrap();
    assert_eq!(walls(&read_scene(&folder.path().join("map.yml")).unwrap()), walls(&map));
}

#[test]
fn degrees_are_told_of() {
    let scene = read_scene(&file("degrees.geojson")).unwrap();
    assert_eq!(scene.notes().len(), 1);
    assert!(scene.notes()[0].contains("look like longitude and latitude") && scene.notes()[0].contains("project"));
}

#[test]
fn files_cut_off_anywhere_are_read_or_refused_with_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let full: Vec<u8> = std::fs::read(file("map.pgm")).unwrap();
    std::fs::write(folder.path().join("map.pgm"), &full).unwrap();
    for name in ["plan.svg", "plan.dxf", "r12.dxf", "plan.wkt", "map.yaml", "degrees.geojson"] {
        let bytes = std::fs::read(file(name)).unwrap();
        let path = folder.path().join(name);
        let mut refused = 0;
        // Some of the larger file's prefixes, and all of its end.
        for cut in (0..bytes.len()).filter(|cut| bytes.len() < 6000 || cut % 7 == 0 || cut + 500 > bytes.len()) {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            if let Err(e) = read_scene(&path) {
                assert!(e.to_string().contains(name), "{e}");
                refused += 1;
            }
        }
        assert!(refused > 50, "{name}: {refused} prefixes refused");
    }
    for name in ["map.pgm", "map.png"] {
        let bytes = std::fs::read(file(name)).unwrap();
        let yaml = std::fs::read_to_string(file("map.yaml")).unwrap().replace("map.pgm", name);
        let path = folder.path().join("map.yaml");
        std::fs::write(&path, yaml).unwrap();
        for cut in 0..bytes.len() {
            std::fs::write(folder.path().join(name), &bytes[..cut]).unwrap();
            let Err(e) = read_scene(&path) else { panic!("{name} of {cut} bytes was taken") };
            assert!(e.to_string().contains(name), "{e}");
        }
    }
}

/// Coordinates of all sizes, some of them met again and again.
fn coordinate() -> impl Strategy<Value = f64> {
    let any = any::<f64>().prop_filter("within the limits", |x| x.is_finite() && (1e-130..1e150).contains(&x.abs()));
    prop_oneof![2 => (-3i8..4).prop_map(f64::from), 1 => any, 1 => -1e4..1e4, 1 => Just(0.1 + 0.2)]
}

proptest! {
    #[test]
    fn what_is_written_reads_back_bit_for_bit(
        walls in prop::collection::vec(prop::array::uniform4(coordinate()), 0..30),
        anchor in prop::option::of([coordinate(), coordinate()]),
    ) {
        let mut scene = Scene::new(walls.iter().map(|&[a, b, c, d]| [DVec2::new(a, b), DVec2::new(c, d)])).unwrap();
        if let Some(anchor) = anchor {
            scene = scene.with_anchor(anchor.into());
        }
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.geojson", "b.json", "c.wkt"] {
            let path = folder.path().join(name);
            write_scene(&path, &scene).unwrap();
            let read = read_scene(&path).unwrap();
            prop_assert!(same(&scene, &read) && read.dropped() == 0, "{name}: {}", std::fs::read_to_string(&path).unwrap());
        }
    }
}

#[test]
fn every_golden_file_converts_without_a_change() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["plan.svg", "plan.dxf", "r12.dxf", "plan.wkt", "map.yaml", "degrees.geojson"] {
        let scene = read_scene(&file(name)).unwrap();
        assert!(!scene.walls().is_empty());
        for to in ["a.geojson", "a.wkt"] {
            let path = folder.path().join(to);
            write_scene(&path, &scene).unwrap();
            let read = read_scene(&path).unwrap();
            assert!(same(&scene, &read), "{name} as {to}");
            // Well-known text has no place for it.
            assert_eq!(read.y_down(), name == "plan.svg" && to == "a.geojson", "{name} as {to}");
        }
    }
}
