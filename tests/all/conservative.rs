//! That the candidate pass never misses a vertex that lies in the exact swept triangle: vertices within rounding of the
//! triangle's sides and corners, triangles of every shape and distance.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use tautline::candidates::{Frame, Lists, Query, Simd, Slopes, Window, Wrapping};
use tautline::geometry::orient;
use tautline::scene::{Model, Scene};

/// Whether `p` lies in the closed triangle, exactly.
fn holds([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    let sides = [orient(a, b, p), orient(b, c, p), orient(c, a, p)];
    let boxed = p.cmpge(a.min(b).min(c)).all() && p.cmple(a.max(b).max(c)).all();
    boxed && (sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0))
}

/// `p` moved by a few units in the last place.
fn nudged(p: DVec2, ulps: (i64, i64)) -> DVec2 {
    let move_by = |x: f64, n: i64| if x == 0.0 { x } else { f64::from_bits((x.to_bits() as i64 + n) as u64) };
    DVec2::new(move_by(p.x, ulps.0), move_by(p.y, ulps.1))
}

fn unit_point() -> impl Strategy<Value = DVec2> {
    (-1.0f64..1.0, -1.0f64..1.0).prop_map(|(x, y)| DVec2::new(x, y))
}

/// Points of a trace: anywhere, on a small lattice, or 2^k away.
fn trace_point() -> impl Strategy<Value = DVec2> {
    prop_oneof![
        3 => unit_point(),
        1 => (-2i8..=2, -2i8..=2).prop_map(|(x, y)| DVec2::new(f64::from(x), f64::from(y)) / 2.0),
        2 => (unit_point(), -40i32..500).prop_map(|(p, k)| p * 2f64.powi(k)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_vertex_in_a_swept_triangle_is_missed(
        pivot in unit_point(),
        turned in prop::option::of(0.0f64..=1.0),
        points in prop::collection::vec(trace_point(), 2..6),
        near in prop::collection::vec((0usize..3, 0.0f64..1.0, 0.0f64..1e-6, -3i64..4, -3i64..4), 10),
    ) {
        // Where the free end stands at first: at the first point, or on its way from there.
        let start = turned.map(|along| points[0] + (points[1] - points[0]) * along).filter(|&s| s != pivot);
        // Vertices along the sides of the first leg's triangle, a hair to either side of them, and within the scene.
        let corners = [pivot, start.unwrap_or(points[0]), points[1]];
        let mut vertices = vec![DVec2::splat(1.0), DVec2::splat(-1.0)];
        for (side, along, inwards, x, y) in near {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            // Far corners: only the part of the side that lies in the scene can have vertices on it.
            let reach = 1.0f64.min(2.0 / (to - from).abs().max_element());
            let on = if side == 2 { to + (from - to) * along * reach } else { from + (to - from) * along * reach };
            let p = nudged(on + (corners[(side + 2) % 3] - on) * inwards * reach, (x, y));
            if p.abs().max_element() <= 1.0 && p.abs().min_element() > 1e-100 {
                vertices.push(p);
            }
        }
        let walls = vertices.windows(2).map(|w| [w[0], w[1]]);
        let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(DVec2::splat(1.0))).unwrap());
        let frame = Frame::new(&model);
        for simd in [Simd::detected(), Simd::baseline()] {
            let mut slopes = Slopes::default();
            let window = Window::fold(simd, pivot, start.map(|s| s - pivot), &points, &mut slopes);
            let (legs, query) = match window {
                Some(window) => (window.legs, window.query(&frame, pivot)),
                None => (1, Query::leg(&frame, pivot, points[0], points[1])),
            };
            let mut named = vec![];
            simd.sweep(Lists::new(model.clone()).all(), &query, model.vertices().len(), &mut named);
            for leg in 0..legs {
                let from = if leg == 0 { corners[1] } else { points[leg] };
                for (vertex, &p) in model.vertices().iter().enumerate() {
                    let inside = holds([pivot, from, points[leg + 1]], p);
                    prop_assert!(!inside || named.contains(&(vertex as u32)), "{p} of {pivot} {from} {}", points[leg + 1]);
                }
            }
        }
    }

    /// Legs that a window passes over without a look have both ends strictly on one side of the line, or are nearer to
    /// the pivot than the vertex.
    #[test]
    fn no_crossing_of_a_line_is_passed_over(
        pivot in unit_point(),
        points in prop::collection::vec(trace_point(), 2..100),
        along in 0.0f64..2.0,
        ulps in (-3i64..4, -3i64..4),
        on in 0usize..100,
    ) {
        // A vertex almost on the way to one of the points.
        let p = nudged(pivot + (points[on % points.len()] - pivot) * along, ulps);
        for simd in [Simd::detected(), Simd::baseline()] {
            let mut slopes = Slopes::default();
            let Some(window) = Window::fold(simd, pivot, None, &points, &mut slopes) else { continue };
            for (line, is_wrapping) in [(window.wrapping(p - pivot), true), (window.unwrapping(p - pivot), false)] {
                let mut met: Vec<usize> = vec![];
                if let Some(line) = line {
                    let mut lines = [Wrapping::new(0, line)];
                    for from in (0..window.legs).step_by(7) {
                        simd.meet(&mut lines, &slopes, from, window.legs - from);
                        met.extend((from..window.legs.min(from + 7)).filter(|leg| lines[0].met >> (leg - from) & 1 == 1));
                    }
                }
                for leg in (0..window.legs).filter(|leg| !met.contains(leg)) {
                    let [a, b] = [points[leg], points[leg + 1]];
                    let [left, right] = [a, b].map(|a| orient(pivot, p, a));
                    let one_side = (left > 0.0 && right > 0.0) || (left < 0.0 && right < 0.0);
                    let within = is_wrapping && a.distance(pivot).max(b.distance(pivot)) < p.distance(pivot);
                    prop_assert!(one_side || within, "leg {leg} from {a} to {b} about {pivot}, line to {p}");
                }
            }
        }
    }
}

/// Legs that pass the scene close by but start and end 10^13 units away: their triangles cannot be placed well enough.
#[test]
fn legs_from_far_away_miss_nothing() {
    use tautline::engine::{Cpu, Engine, Job, Reference};
    use tautline::trace::{Trace, settle};
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let walls = [
        [p(1.0, 1.0), p(1.0, 0.95)],
        [p(-1.0, -1.0), p(-1.0, -0.95)],
        [p(-0.22245374810066224, -0.1611385044403076), p(-0.18958940171875, -0.16346423125)],
    ];
    let model = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(p(0.1069136, -0.184447))).unwrap());
    let far = [p(-1553375562843.4456, -17523470951330.07), p(1553375562843.0005, 17523470951329.748)];
    let settled = settle(&model, &Trace { id: 0, points: vec![model.anchor(), far[0], far[1]] });
    let truth = Reference::new(model.clone()).evaluate(std::slice::from_ref(&settled), &Job::new()).unwrap();
    assert_eq!(truth[0].depth, 2);
    assert_eq!(Cpu::new(model.clone()).evaluate(&[settled], &Job::new()).unwrap(), truth);
}
