//! Classes of ropes against paths: the way that the free end was dragged, with points that are really pushed off the
//! walls, over cuts that are really there, letter by letter; and against the other method's ropes.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use tautline::engine::{Engine, Funnel, Job, Reference};
use tautline::geometry::{Turn, between, orient};
use tautline::homotopy::{Class, ClassChange, Classes};
use tautline::rope::{EventKind, Side};
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::scenes::{KINDS, Kind, on_lawful};

/// How far points are pushed off walls, and how far cuts lie beside the columns of their wall ends: on whole numbers
/// and their quarters the one is far less than the other, and that far less than anything else.
const HAIR: f64 = 1.0 / (1u64 << 30) as f64;
const BESIDE: f64 = 1.0 / (1u64 << 20) as f64;
const ABOVE: f64 = 1.0 / (1u64 << 12) as f64;

/// The turn of a hair: less than that of a cut at its wall end.
const TURN: f64 = 1.0 / 2048.0;

/// A cut as a line of points: from its wall end up and a little to the right, and then straight up.
struct Line {
    obstacle: u32,
    points: [DVec2; 3],
}

/// Those of all walls that hang together, by looks at all pairs; `far` is above everything.
fn lines(scene: &Scene, far: f64) -> Vec<Line> {
    let walls: Vec<[DVec2; 2]> = (0..scene.walls().len()).map(|wall| scene.ends(wall)).collect();
    let mut of: Vec<usize> = (0..walls.len()).collect();
    for i in 0..walls.len() {
        for j in 0..i {
            if of[i] != of[j] && meet(walls[i], walls[j]) {
                let (from, to) = (of[i], of[j]);
                of.iter_mut().filter(|of| **of == from).for_each(|of| *of = to);
            }
        }
    }
    let mut groups = BTreeMap::<usize, (u32, DVec2)>::new();
    for (wall, group) in of.iter().enumerate() {
        for (vertex, at) in scene.walls()[wall].into_iter().zip(walls[wall]) {
            let best = groups.entry(*group).or_insert((vertex, at));
            best.0 = best.0.min(vertex);
            if at.y > best.1.y || at.y == best.1.y && at.x > best.1.x {
                best.1 = at;
            }
        }
    }
    // The lower of two in a column lies further to the right.
    let mut all: Vec<(u32, DVec2)> = groups.into_values().collect();
    all.sort_by(|a, b| b.1.y.total_cmp(&a.1.y));
    let line = |(i, (obstacle, at)): (usize, (u32, DVec2))| {
        let x = at.x + BESIDE * (1.0 + i as f64 / 64.0);
        Line { obstacle, points: [at, DVec2::new(x, at.y + ABOVE), DVec2::new(x, far)] }
    };
    all.into_iter().enumerate().map(line).collect()
}

/// The sign of the triangle's area, in whole numbers: all coordinates are multiples of 2^-48.
fn sign(p: DVec2, q: DVec2, r: DVec2) -> i32 {
    let whole = |p: DVec2| p.to_array().map(|c| (c * (1u64 << 48) as f64) as i128);
    let [p, q, r] = [p, q, r].map(whole);
    let [a, b] = [[q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]];
    (a[0] * b[1] - a[1] * b[0]).signum() as i32
}

/// Whether two walls have a point in common, in whole numbers.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let boxes = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes && sign(a, b, c) * sign(a, b, d) <= 0 && sign(c, d, a) * sign(c, d, b) <= 0
}

/// The word of a path over the lines, reduced: 1 for each passed from its right to its left, in the direction in which
/// it was drawn. `word` is what comes before.
fn word(mut word: Vec<(u32, i64)>, path: &[DVec2], lines: &[Line]) -> Vec<(u32, i64)> {
    for leg in path.windows(2) {
        let mut passed = Vec::new();
        for line in lines {
            for cut in line.points.windows(2) {
                let [p, q] = [sign(cut[0], cut[1], leg[0]), sign(cut[0], cut[1], leg[1])];
                let [u, v] = [sign(leg[0], leg[1], cut[0]), sign(leg[0], leg[1], cut[1])];
                assert!(p != 0 && q != 0 || u * v > 0 || p * q > 0, "no point lies on a cut");
                if p * q < 0 && u * v <= 0 {
                    assert!(u * v < 0, "no leg passes a cut's corner: {leg:?} {cut:?}");
                    let areas = leg.iter().map(|&a| (cut[1] - cut[0]).perp_dot(a - cut[0])).collect::<Vec<f64>>();
                    passed.push((areas[0] / (areas[0] - areas[1]), line.obstacle, i64::from(q)));
                }
            }
        }
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, obstacle, power) in passed {
            match word.last() {
                Some(&last) if last == (obstacle, -power) => drop(word.pop()),
                _ => word.push((obstacle, power)),
            }
        }
    }
    word
}

/// Where the free end goes, from the anchor on, pushed off the walls.
fn path(model: &Model, settled: &SettledTrace) -> Vec<DVec2> {
    let on = |c: f64| (c * (1u64 << 48) as f64).round() / (1u64 << 48) as f64;
    let pushed = |i: usize| {
        let at = settled.point(i).at;
        let Some(hair) = settled.point(i).hair else { return at };
        let along = (hair.witness - at).normalize() * if hair.away { -1.0 } else { 1.0 };
        at + HAIR * (along + along.perp() * if hair.turn == Turn::Left { TURN } else { -TURN })
    };
    let points = (0..settled.points().len()).map(pushed);
    std::iter::once(model.anchor()).chain(points.map(|p| DVec2::new(on(p.x), on(p.y)))).collect()
}

/// A class's word, letter by letter.
fn letters(class: &Class) -> Vec<(u32, i64)> {
    let times = |&(obstacle, power): &(u32, i64)| vec![(obstacle, power.signum()); power.unsigned_abs() as usize];
    class.word().iter().flat_map(times).collect()
}

fn class(model: &Arc<Model>, settled: &SettledTrace) -> Class {
    let record = Reference::new(model.clone()).evaluate(std::slice::from_ref(settled), &Job::new()).unwrap().remove(0);
    Classes::new(model).of_record(settled, &record).unwrap()
}

/// The angles of the walls at a point, counter-clockwise from the right, each once.
fn walls_at(scene: &Scene, at: DVec2) -> Vec<f64> {
    let ends = (0..scene.walls().len()).map(|wall| scene.ends(wall)).filter(|&[u, v]| meet([u, v], [at, at]));
    let mut angles: Vec<f64> = ends.flatten().filter(|&end| end != at).map(|end| angle(end - at)).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    angles
}

fn angle(way: DVec2) -> f64 {
    way.y.atan2(way.x).rem_euclid(TAU)
}

/// Between which walls at the anchor a path starts, if there are several, and the letter of a start right of the cut
/// that may start there.
fn start(model: &Model, path: &mut [DVec2], lines: &[Line]) -> (Option<u32>, Vec<(u32, i64)>) {
    let (anchor, walls) = (model.anchor(), walls_at(model.scene(), model.anchor()));
    let Some(&to) = path.iter().find(|&&p| p != anchor).filter(|_| !walls.is_empty()) else { return (None, vec![]) };
    let on = |c: f64| (c * (1u64 << 48) as f64).round() / (1u64 << 48) as f64;
    // Off the cut.
    path[0] = anchor + ((to - anchor) / 4.0).map(on);
    let between = |angle: f64| walls.iter().rposition(|&wall| wall < angle).unwrap_or(walls.len() - 1);
    let sector = between(angle(to - anchor));
    let letter = lines.iter().find(|line| line.points[0] == anchor).and_then(|line| {
        let cut = angle(line.points[1] - anchor);
        let from_wall = |angle: f64| (angle - walls[sector]).rem_euclid(TAU);
        let is_right = sector == between(cut) && from_wall(angle(to - anchor)) < from_wall(cut);
        is_right.then_some((line.obstacle, -1))
    });
    ((walls.len() > 1).then_some(sector as u32), letter.into_iter().collect())
}

/// The path along which the free end was dragged can be moved into the rope, so it has the rope's word.
#[test]
fn ropes_have_the_words_of_the_paths_that_were_dragged() {
    let (seen, anchored) = (Cell::new(0), Cell::new(0));
    for kind in [Kind::Lattice, Kind::Grid, Kind::Boxes] {
        for touching in [false, true] {
            on_lawful(kind, touching, 600, |model, _, settled| {
                let found = class(model, settled);
                let kept: Vec<u32> = Classes::new(model).cuts().iter().map(|cut| cut.obstacle).collect();
                let mut lines = lines(model.scene(), 1e6);
                lines.retain(|line| kept.contains(&line.obstacle));
                let mut path = path(model, settled);
                let (start, first) = start(model, &mut path, &lines);
                let truth = word(first, &path, &lines);
                assert_eq!((found.start(), letters(&found)), (start, truth.clone()));
                seen.set(seen.get() + truth.len());
                anchored.set(anchored.get() + usize::from(start.is_some()));
            });
        }
    }
    assert!(seen.get() > 1000 && anchored.get() > 100, "{seen:?} {anchored:?}");
}

/// Out, back and out again, with the other method's ropes after every step: where the free end is at one place twice,
/// its ropes are of one class if they are the same rope, and only then.
#[test]
fn classes_are_the_same_exactly_for_the_same_ropes() {
    let (same, other, places) = (Cell::new(0), Cell::new(0), Cell::new(0));
    for kind in KINDS {
        for touching in [false, true] {
            on_lawful(kind, touching, 30, |model, trace, _| {
                let n = trace.points.len();
                let there_and_back = (0..n).chain((0..n - 1).rev()).chain(1..n);
                let points: Vec<DVec2> = there_and_back.clone().map(|i| trace.points[i]).collect();
                let cut = |k: usize| settle(model, &Trace { id: k as u64, points: points[..=k].to_vec() });
                // A point on a wall stands for one on one of its sides.
                let is_off = |&k: &usize| !model.is_on_wall(points[k]);
                let cuts: Vec<SettledTrace> = (0..points.len()).filter(is_off).map(cut).collect();
                // Back over a corner that was touched may lead where it does not come from.
                let cuts: Vec<SettledTrace> = cuts.into_iter().filter(|cut| cut.violation().is_none()).collect();
                let records = Reference::new(model.clone()).evaluate(&cuts, &Job::new()).unwrap();
                let ropes = Funnel::new(model.clone()).evaluate(&cuts, &Job::new()).unwrap();
                let classes = Classes::new(model);
                // Of the whole trace, step by step: the same as that of the trace that ends there.
                let whole = settle(model, &Trace { id: 0, points: points.clone() });
                if whole.violation().is_none() {
                    let record = Reference::new(model.clone())
                        .evaluate(std::slice::from_ref(&whole), &Job::new())
                        .unwrap()
                        .remove(0);
                    let changes = classes.changes(&whole, &record).unwrap();
                    assert!(changes.windows(2).all(|two| two[0].step < two[1].step && two[0].class != two[1].class));
                    for (cut, record) in cuts.iter().zip(&records) {
                        let last = changes.partition_point(|change| change.step <= cut.steps() as u64) - 1;
                        assert_eq!(Some(&changes[last].class), classes.of_record(cut, record).as_ref());
                    }
                }
                let mut at = BTreeMap::<[u64; 2], Vec<(Class, usize, bool)>>::new();
                for (i, (cut, record)) in cuts.iter().zip(&records).enumerate() {
                    let class = classes.of_record(cut, record).unwrap();
                    // A rope that passes wall ends straight may lie along either side of a wall.
                    let contacts =
                        record.events.iter().fold(0, |n, e| if e.kind == EventKind::Wrap { n + 1 } else { n - 1 });
                    let plain = contacts == record.wraps.len() as i64 && bends_off_all_lines(model, cut, &record.wraps);
                    let point = cut.points()[cut.points().len() - 1];
                    at.entry((point + DVec2::ZERO).to_array().map(f64::to_bits)).or_default().push((class, i, plain));
                }
                for group in at.values() {
                    for (i, one) in group.iter().enumerate() {
                        for two in &group[..i] {
                            let is_one_rope = ropes[one.1].wraps == ropes[two.1].wraps;
                            if one.0 == two.0 {
                                assert!(is_one_rope, "{}: {:?} {:?}", one.0, ropes[one.1].wraps, ropes[two.1].wraps);
                                same.set(same.get() + 1);
                            } else if one.2 && two.2 {
                                assert!(!is_one_rope, "{} {}: {:?}", one.0, two.0, ropes[one.1].wraps);
                                other.set(other.get() + 1);
                            }
                        }
                    }
                    places.set(places.get() + 1);
                }
            });
        }
    }
    assert!(same.get() > 3000 && other.get() > 300, "{same:?} {other:?} {places:?}");
}

/// Whether no leg of a rope touches a wall end but those at which it turns, and none starts along a wall.
fn bends_off_all_lines(model: &Model, trace: &SettledTrace, wraps: &[(DVec2, Side)]) -> bool {
    let end = trace.points()[trace.points().len() - 1];
    let rope: Vec<DVec2> = [model.anchor()].into_iter().chain(wraps.iter().map(|w| w.0)).chain([end]).collect();
    let touches = |leg: &[DVec2]| {
        let on_leg = |&v: &DVec2| orient(leg[0], leg[1], v) == 0.0 && between(leg[0], leg[1], v);
        model.vertices().iter().any(on_leg)
    };
    let along = |[u, v]: [DVec2; 2]| {
        let on = |p: DVec2| orient(u, v, p) == 0.0;
        on(rope[0]) && on(rope[1])
    };
    !rope.windows(2).any(touches) && !(0..model.scene().walls().len()).any(|wall| along(model.scene().ends(wall)))
}

fn square([x, y]: [f64; 2], size: f64) -> [[[f64; 2]; 2]; 4] {
    let corners = [[x, y], [x + size, y], [x + size, y + size], [x, y + size]];
    [0, 1, 2, 3].map(|i| [corners[i], corners[(i + 1) % 4]])
}

fn model(walls: &[[[f64; 2]; 2]], anchor: [f64; 2]) -> Arc<Model> {
    let walls = walls.iter().map(|wall| wall.map(DVec2::from));
    Arc::new(Model::new(Scene::new(walls).unwrap(), Some(anchor.into())).unwrap())
}

#[test]
fn only_what_ropes_can_be_wound_about_has_a_cut() {
    // A room with a post and a closed box in it, in the box another post, and one more outside of the room.
    let mut walls = [square([0.0, 0.0], 10.0), square([6.0, 6.0], 2.0)].concat();
    walls.extend([[[2.0, 2.0], [3.0, 2.0]], [[7.0, 6.5], [7.0, 7.5]], [[12.0, 5.0], [12.0, 6.0]]]);
    // A cross of two walls with a third one that ends on it is one obstacle.
    walls.extend([[[2.0, 5.0], [4.0, 5.0]], [[3.0, 4.0], [3.0, 6.0]], [[4.5, 4.0], [3.5, 5.0]]]);
    let cuts = |anchor: [f64; 2]| -> Vec<(u32, [f64; 2])> {
        Classes::new(&model(&walls, anchor)).cuts().iter().map(|cut| (cut.obstacle, cut.at.to_array())).collect()
    };
    // Walls are numbered as they come: 4 ends of the room, 4 of the box, 2 of each post.
    let cross = (14, [3.0, 6.0]);
    assert_eq!(cuts([1.0, 1.0]), [cross, (8, [3.0, 2.0]), (4, [8.0, 8.0])]);
    assert_eq!(cuts([6.5, 7.0]), [(10, [7.0, 7.5])]);
    assert_eq!(cuts([11.0, 5.0]), [(0, [10.0, 10.0]), (12, [12.0, 6.0])]);
}

#[test]
fn turns_about_a_pillar_are_counted_both_ways() {
    let pillar = model(&square([1.0, 1.0], 1.0), [0.0, 0.0]);
    let corners = [[3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0]].map(DVec2::from);
    for turns in [0, 1, 2, 5000] {
        let mut points = corners.repeat(turns);
        points.insert(0, DVec2::ZERO);
        let there = settle(&pillar, &Trace { id: 0, points: points.clone() });
        // Out and back again: all contacts go, one after the other.
        let out_and_back = points.iter().chain(points.iter().rev()).copied().collect();
        let trace = settle(&pillar, &Trace { id: 0, points: out_and_back });
        let record =
            Reference::new(pillar.clone()).evaluate(std::slice::from_ref(&trace), &Job::new()).unwrap().remove(0);
        let changes = Classes::new(&pillar).changes(&trace, &record).unwrap();
        let power = |change: &ClassChange| change.class.word().first().map_or(0, |letter| letter.1);
        let expected: Vec<i64> = (0..=turns as i64).chain((0..turns as i64).rev()).collect();
        assert_eq!(changes.iter().map(power).collect::<Vec<_>>(), expected);
        points.reverse();
        let back = settle(&pillar, &Trace { id: 0, points });
        for (trace, turns) in [(there, turns as i64), (back, -(turns as i64))] {
            let found = class(&pillar, &trace);
            assert_eq!(found.windings().collect::<Vec<_>>(), if turns == 0 { vec![] } else { vec![(0, turns)] });
            let text = match turns {
                0 => "e".to_owned(),
                1 => "o0".to_owned(),
                _ => format!("o0^{turns}"),
            };
            assert_eq!(found.to_string(), text);
        }
    }
}

/// A thin wall under the anchor, from which ropes leave on either side: round the wall's end they come to the same
/// place.
#[test]
fn ropes_that_leave_an_anchor_on_two_sides_of_a_wall_are_of_two_classes() {
    let wall = model(&[[[-1.0, 0.0], [1.0, 0.0]]], [0.0, 0.0]);
    let found = |points: &[[f64; 2]]| {
        let points = points.iter().map(|&p| p.into()).collect();
        class(&wall, &settle(&wall, &Trace { id: 0, points })).to_string()
    };
    assert_eq!(found(&[[0.0, 1.0]]), "@0");
    assert_eq!(found(&[[0.0, -1.0], [2.0, 0.0], [0.0, 1.0]]), "@1 o0");
    assert_eq!(found(&[[0.0, -1.0], [-2.0, 0.0], [0.0, 1.0]]), "@1");
    assert_eq!(found(&[[0.0, 1.0], [2.0, 0.0], [0.0, -1.0], [-2.0, 0.0], [0.0, 1.0]]), "@0 o0^-1");
}
