//! Painted areas: HATCH entities with a solid fill.

use super::tests::{file, on_circle, parsed, walls, walls_of};
use super::*;

/// A solid hatch of these paths, each with its flags and its groups.
fn hatch(style: u8, paths: &[(u8, &str)]) -> String {
    let count = paths.len();
    let paths: String = paths.iter().map(|(flags, path)| format!(" 92={flags} {path} 97=0")).collect();
    // The elevation before, and the seed behind, are points too.
    format!("HATCH 10=0 20=0 30=7 210=0 220=0 230=1 2=SOLID 70=1 71=0 91={count}{paths} 75={style} 76=1 98=1 10=9 20=9")
}

/// A square path from `low` to `high`.
fn square(low: f64, high: f64) -> String {
    format!("72=0 73=1 93=4 10={low} 20={low} 10={high} 20={low} 10={high} 20={high} 10={low} 20={high}")
}

fn edges(edges: &[&str]) -> String {
    hatch(0, &[(1, &format!("93={} {}", edges.len(), edges.join(" ")))])
}

/// What is said of a hatch beside the unit.
fn told(entities: &str) -> (usize, Vec<String>) {
    let scene = parsed(&file("", &[], entities)).unwrap_or_else(|what| panic!("{entities}: {what}"));
    (scene.walls().len(), scene.notes()[1..].to_vec())
}

const TRIANGLE: [[f64; 4]; 3] = [[0., 0., 4., 0.], [4., 0., 4., 3.], [4., 3., 0., 0.]];

#[test]
fn solid_hatches_are_solid_walls() {
    let corners = "10=0 20=0 10=4 20=0 10=4 20=3";
    let scene = parsed(&file("", &[], &hatch(0, &[(3, &format!("72=0 73=1 93=3 {corners}"))]))).unwrap();
    assert_eq!((walls_of(&scene), scene.dropped()), (TRIANGLE.to_vec(), 0));
    assert_eq!(scene.objects()[scene.object_of(0)].inside, Inside::EvenOdd);
    // What is painted is closed, and the first corner may come twice.
    for path in [format!("72=0 73=0 93=3 {corners}"), format!("72=0 73=1 93=4 {corners} 10=0 20=0")] {
        let scene = parsed(&file("", &[], &hatch(0, &[(2, &path)]))).unwrap();
        assert_eq!((walls_of(&scene), scene.dropped()), (TRIANGLE.to_vec(), 0), "{path}");
    }
    let lines = ["72=1 10=0 20=0 11=4 21=0", "72=1 10=4 20=0 11=4 21=3", "72=1 10=4 20=3 11=0 21=0"];
    assert_eq!(walls(&[], &edges(&lines)), TRIANGLE);
    let anchor = |at: &str| {
        let scene = parsed(&file("", &[], &format!("{} POINT 8=anchor {at}", edges(&lines)))).unwrap();
        scene.objects()[scene.object_of(0)].inside
    };
    assert_eq!([anchor("10=3 20=1"), anchor("10=2 20=0")], [Inside::Free, Inside::EvenOdd]);
}

#[test]
fn hatches_lie_where_their_blocks_do() {
    let area = hatch(0, &[(2, "72=0 73=1 93=3 10=0 20=0 10=4 20=0 10=4 20=3")]);
    let below = area.replace("230=1", "230=-1");
    assert_eq!(walls(&[], &below)[1], [-4., 0., -4., 3.]);
    let blocks = [("2=pillar 10=1 20=0", area.as_str())];
    assert_eq!(walls(&blocks, "INSERT 2=pillar 10=0 20=0 41=-2 50=90")[1], [0., -6., -3., -6.]);
    let scene = parsed(&file("", &blocks, "INSERT 2=pillar 8=stone 10=0 20=0")).unwrap();
    let object = &scene.objects()[scene.object_of(0)];
    assert_eq!((object.label.as_deref(), object.layers.as_slice()), (Some("pillar"), &["stone".to_string()][..]));
    let hidden = told(&format!("{area} 60=1"));
    assert_eq!(hidden, (0, vec!["hidden entities, which are no walls: 1".to_string()]));
    let askew = parsed(&file("", &[], &area.replace("210=0", "210=1"))).unwrap_err();
    assert!(askew.contains("HATCH: lies askew in space, normal to (1, 0, 1)"), "{askew}");
}

#[test]
fn arcs_go_the_way_that_they_are_told() {
    // Half a disc on its chord from (1, 0) to (-1, 0): over it counter-clockwise, and below it clockwise.
    let chord = "72=1 10=-1 20=0 11=1 21=0";
    for (arc, above) in [
        ("72=2 10=0 20=0 40=1 50=0 51=180 73=1", true),
        ("72=2 10=0 20=0 40=1 50=0 51=180 73=0", false),
        // An ellipse whose axes are as long is a circle.
        ("72=3 10=0 20=0 11=1 21=0 40=1 50=0 51=180 73=1", true),
        ("72=3 10=0 20=0 11=0 21=1 40=1 50=270 51=450 73=1", true),
        ("72=3 10=0 20=0 11=1 21=0 40=1 50=0 51=180 73=0", false),
    ] {
        let found = walls(&[], &edges(&[arc, chord]));
        let (line, arc) = found.split_last().unwrap();
        assert_eq!(*line, [-1., 0., 1., 0.]);
        on_circle(arc, [0., 0.], 1.);
        assert!(arc[1..].iter().all(|w| (w[1] > 0.0) == above), "{arc:?}");
    }
    // Polylines have bulges.
    let found = walls(&[], &hatch(0, &[(3, "72=1 73=1 93=2 10=0 20=0 42=1 10=2 20=0 42=1")]));
    assert_eq!(on_circle(&found, [1., 0.], 1.), [[0., 0.], [0., 0.]]);
}

#[test]
fn angles_of_ellipses_are_seen_from_their_centre() {
    // From the end of the long axis to where the ellipse is seen at 45 degrees: x = y there.
    let edge = "72=3 10=0 20=0 11=4 21=0 40=0.5 50=0 51=45 73=1";
    let at = 4.0 / 5f64.sqrt();
    let back = [format!("72=1 10={at} 20={at} 11=0 21=0"), "72=1 10=0 20=0 11=4 21=0".to_string()];
    let found = walls(&[], &edges(&[edge, &back[0], &back[1]]));
    let arc = &found[..found.len() - 2];
    let round: Vec<_> = arc.iter().map(|w| [w[0], w[1] * 2.0, w[2], w[3] * 2.0]).collect();
    assert_eq!(on_circle(&round, [0., 0.], 4.)[0], [4., 0.]);
    // The line's end is told, the arc's is computed.
    assert_eq!(arc[arc.len() - 1][2..], [at, at]);
}

#[test]
fn splines_go_through_edges() {
    let knots = "40=0 40=0 40=0 40=0 40=1 40=1 40=1 40=1";
    let points = "10=0 20=0 10=2 20=4 10=4 20=4 10=6 20=0";
    let chord = "72=1 10=6 20=0 11=0 21=0";
    // Since 2010 the number of points that it was fitted to follows, and these.
    for fit in ["", "97=0", "97=2 11=0 21=0 11=6 21=0 12=1 22=2 13=1 23=-2"] {
        let spline = format!("72=4 94=3 73=0 74=0 95=8 96=4 {knots} {points} {fit}");
        for border in [[spline.as_str(), chord], [chord, spline.as_str()]] {
            let found = walls(&[], &edges(&border));
            assert!(found.contains(&[6., 0., 0., 0.]) && found.iter().any(|w| w[..2] == [3.0, 3.0]), "{found:?}");
        }
    }
    let weighted = points.replace(" 10=", " 42=1 10=") + " 42=";
    let spline = |weight: u8| format!("72=4 94=3 73=1 74=0 95=8 96=4 {knots} {weighted}{weight}");
    assert_eq!(told(&edges(&[&spline(1), chord])).0, walls(&[], &edges(&[&spline(1), chord])).len());
    let rational = vec!["passed over: 1 HATCH with a rational spline".to_string()];
    assert_eq!(told(&edges(&[&spline(2), chord])), (0, rational));
    let fitted = "72=4 94=3 73=0 74=0 95=0 96=0 97=2 11=0 21=0 11=6 21=0";
    let fitted_only = vec!["passed over: 1 HATCH with a spline without control points".to_string()];
    assert_eq!(told(&edges(&[chord, fitted])), (0, fitted_only));
}

#[test]
fn edges_are_joined_in_either_direction() {
    let [a, b, c] = ["72=1 10=0 20=0 11=4 21=0", "72=1 10=4 20=0 11=4 21=3", "72=1 10=4 20=3 11=0 21=0"];
    let [back_a, back_b] = ["72=1 10=4 20=0 11=0 21=0", "72=1 10=4 20=3 11=4 21=0"];
    let [circle, disc] = ["72=2 10=9 20=9 40=1 50=0 51=360 73=1", "72=2 10=9 20=9 40=1 50=0 51=360 73=0"];
    let round = walls(&[], "CIRCLE 10=9 20=9 40=1");
    for border in [[back_a, b, c], [a, back_b, c], [back_a, back_b, c]] {
        let found = walls(&[], &edges(&border));
        assert!(found.len() == 3 && found.contains(&TRIANGLE[2]), "{border:?}: {found:?}");
        // Several rings may be one path. A circle is the same walls whichever way it goes.
        for ring in [circle, disc] {
            assert_eq!(walls(&[], &edges(&[ring, border[0], border[1], border[2]]))[..round.len()], round);
            assert_eq!(walls(&[], &edges(&[border[0], border[1], border[2], ring]))[3..], round);
        }
    }
    // Ends that miss each other by little are one.
    let near = "72=1 10=4.0000001 20=0 11=4 21=3";
    assert_eq!(walls(&[], &edges(&[a, near, c])), TRIANGLE);
    let [upper, left] = ["72=1 10=4 20=3 11=0 21=3", "72=1 10=0 20=3 11=0 21=0"];
    let open = vec!["passed over: 1 HATCH with an open border".to_string()];
    for border in [&[a, b][..], &[a, upper, b, left], &[a, "72=1 10=4.1 20=0 11=4 21=3", c], &[a], &[circle, a]] {
        assert_eq!(told(&edges(border)), (0, open.clone()), "{border:?}");
    }
}

#[test]
fn the_style_says_between_which_paths_it_is_painted() {
    let [outer, hole, island] = [square(0.0, 9.0), square(1.0, 8.0), square(2.0, 7.0)];
    let count = |style, flags: [u8; 3]| {
        let paths = [(flags[0], outer.as_str()), (flags[1], &hole), (flags[2], &island)];
        walls(&[], &hatch(style, &paths)).len()
    };
    assert_eq!([0, 1, 2].map(|style| count(style, [3, 18, 2])), [12, 8, 4]);
    // Programs that do not say which path goes round which mean all of them.
    assert_eq!([0, 1, 2].map(|style| count(style, [2, 2, 2])), [12, 12, 12]);
}

#[test]
fn hatches_that_are_not_painted_all_over_are_counted_apart() {
    let solid = hatch(0, &[(3, &square(0.0, 1.0))]);
    let pattern = solid.replace("70=1", "70=0");
    let gradient = format!("{solid} 450=1 451=0 452=0 453=2 463=0 470=LINEAR");
    let none = format!("{solid} 450=0");
    let passed = vec!["passed over: 1 HATCH with a gradient, 2 HATCH with a pattern".to_string()];
    // They may also lie anywhere in space.
    let askew = pattern.replace("210=0", "210=1");
    assert_eq!(told(&format!("{pattern} {gradient} {none} {askew}")), (4, passed));
}

#[test]
fn what_has_no_extent_is_dropped() {
    let line = "LINE 10=1 20=2 11=3 21=5";
    for paths in
        [vec![], vec![(3, "93=0")], vec![(3, "93=1 10=1 20=1 42=1")], vec![(1, "93=1 72=2 10=0 20=0 40=0 50=0 51=9")]]
    {
        let scene = parsed(&file("", &[], &format!("{line} {}", hatch(0, &paths)))).unwrap();
        assert_eq!((scene.walls().len(), scene.dropped()), (1, 1), "{paths:?}");
    }
}

#[test]
fn broken_hatches_are_refused() {
    let broken = |path: &str| hatch(0, &[(1, path)]);
    let [line, arc] = ["72=1 10=0 20=0 11=4", "72=2 10=0 20=0 40=1 50=0 51=180 73=0"];
    for (entity, expected) in [
        ("HATCH 70=1".to_string(), "no number with the group code 91, which says how many paths go round it"),
        ("HATCH 70=x".to_string(), "group code 70 has the value \"x\"; it must be a whole number"),
        ("HATCH 70=1 91=2 92=2 93=0 75=0".to_string(), "1 paths, where the group code 91 says 2; they must be as many"),
        ("HATCH 70=1 91=999999999999".to_string(), "0 paths, where the group code 91 says 999999999999"),
        (hatch(0, &[(2, "93=-1 10=0 20=0")]), "1 corners of a path, where the group code 93 says -1"),
        (hatch(0, &[(2, "93=1000000000 10=0 20=0")]), "1 corners of a path, where the group code 93 says 1000000000"),
        (hatch(0, &[(2, "93=2 10=0 20=0 10=1")]), "corner 1 has an x but no y"),
        (broken(&format!("93=2 {arc}")), "1 edges of a path, where the group code 93 says 2; they must be as many"),
        (broken(&format!("93=1 {line}")), "no number with the group code 21"),
        (broken("93=1 72=5"), "an edge of the kind 5 (group code 72); it must be 1, 2, 3 or 4"),
        (broken("93=1 72=2 10=0 20=0 40=-1 50=0 51=9"), "radius -1; it must not be negative"),
        (broken("93=1 72=2 10=0 20=0 40=1 50=nan 51=9"), "NaN is not a finite number"),
        (broken("93=1 72=1 10=0 20=0 11=1e200 21=0"), "1e200 is too large for exact products"),
        (broken("93=1 72=4 94=3 40=0 10=0 20=0"), "1 knot for 1 control point; degree 3 needs"),
        (broken("93=1 72=4 94=3 40=0 10=0 20=0 10=1"), "2 x and 1 y of control points"),
    ] {
        let what = parsed(&file("", &[], &entity)).unwrap_err();
        assert!(what.starts_with("line 12: HATCH: ") && what.contains(expected), "{entity}: {what}");
    }
    let anchors = parsed(&file("", &[], &format!("{} 8=anchor", hatch(0, &[(3, &square(0.0, 1.0))])))).unwrap_err();
    assert!(anchors.contains("HATCH: lies on the layer anchor, which is for one POINT"), "{anchors}");
}

#[test]
fn long_paths_that_are_inserted_again_and_again_are_refused() {
    let corners: String = (0..20_000).map(|i| format!(" 10={i} 20={}", i % 7)).collect();
    let gradient = hatch(0, &[(3, &format!("93=20000{corners}"))]) + " 450=1";
    let array = "INSERT 2=A 10=0 20=0 70=1000 71=1000";
    let what = parsed(&file("", &[("2=A", &gradient)], array)).unwrap_err();
    assert!(what.contains("with all that is inserted again and again, the drawing is too large"), "{what}");
}
