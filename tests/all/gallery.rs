//! The gallery: its files are what the program makes, and what its captions claim is so.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use assert_cmd::cargo::cargo_bin;
use glam::DVec2;
use tautline::engine::{Engine, Job, Note, Promise, Reference};
use tautline::picture::Situation;
use tautline::rope::EventKind::{self, Unwrap, Wrap};
use tautline::rope::Side::{self, Left, Right};
use tautline::rope::{Friction, Moment, Slip, TraceRecord, forces, moments};
use tautline::scene::Model;

use crate::engine_table::Subject;

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs");

type Place = [f64; 2];
type Claimed = (&'static str, &'static [(u32, EventKind, Place, Side)], &'static [(Place, Side)]);

/// What happens in each situation, and the rope at its end.
const CLAIMS: &[Claimed] = &[
    ("wrap", &[(2, Wrap, [4.0, 1.0], Right)], &[([4.0, 1.0], Right)]),
    ("unwrap", &[(2, Wrap, [4.0, 1.0], Right), (4, Unwrap, [4.0, 1.0], Right)], &[]),
    (
        "several-events",
        &[(2, Wrap, [2.0, 1.5], Right), (2, Wrap, [4.0, 2.0], Right), (2, Wrap, [6.0, 1.5], Right)],
        &[([2.0, 1.5], Right), ([4.0, 2.0], Right), ([6.0, 1.5], Right)],
    ),
    (
        "wrap-and-unwrap",
        &[(2, Wrap, [3.0, 0.5], Right), (3, Unwrap, [3.0, 0.5], Right), (3, Wrap, [6.0, 2.0], Left)],
        &[([6.0, 2.0], Left)],
    ),
    (
        "both-sides",
        &[(2, Wrap, [3.0, 1.0], Right), (4, Wrap, [6.0, -1.0], Left)],
        &[([3.0, 1.0], Right), ([6.0, -1.0], Left)],
    ),
    (
        "closed-obstacle",
        &[
            (1, Wrap, [3.0, 1.5], Right),
            (2, Wrap, [4.2, 1.5], Right),
            (3, Wrap, [6.0, 0.2], Right),
            (4, Wrap, [6.0, -1.0], Right),
        ],
        // Not at (4.2, 0.2), the inner corner.
        &[([3.0, 1.5], Right), ([4.2, 1.5], Right), ([6.0, 0.2], Right), ([6.0, -1.0], Right)],
    ),
    (
        "friction",
        &[(2, Wrap, [4.0, 0.0], Left), (4, Wrap, [4.0, 3.0], Left)],
        &[([4.0, 0.0], Left), ([4.0, 3.0], Left)],
    ),
    (
        "winding",
        &[
            (2, Wrap, [3.0, 1.0], Right),
            (2, Wrap, [5.0, 1.0], Right),
            (3, Wrap, [5.0, -1.0], Right),
            (4, Wrap, [3.0, -1.0], Right),
            (5, Wrap, [3.0, 1.0], Right),
            (6, Wrap, [5.0, 1.0], Right),
            (7, Wrap, [5.0, -1.0], Right),
            (8, Wrap, [3.0, -1.0], Right),
            (9, Wrap, [3.0, 1.0], Right),
        ],
        &[
            ([3.0, 1.0], Right),
            ([5.0, 1.0], Right),
            ([5.0, -1.0], Right),
            ([3.0, -1.0], Right),
            ([3.0, 1.0], Right),
            ([5.0, 1.0], Right),
            ([5.0, -1.0], Right),
            ([3.0, -1.0], Right),
            ([3.0, 1.0], Right),
        ],
    ),
    (
        "doubling-back",
        &[(2, Wrap, [3.0, 0.0], Right), (2, Wrap, [6.0, 0.0], Right), (4, Wrap, [3.0, 0.0], Right)],
        &[([6.0, 0.0], Right), ([3.0, 0.0], Right)],
    ),
    (
        "passed-straight",
        &[(2, Wrap, [2.0, 0.0], Right), (2, Wrap, [4.0, 0.0], Right), (2, Wrap, [6.0, 0.0], Right)],
        &[([6.0, 0.0], Right)],
    ),
    (
        "collinear-walls",
        &[(2, Wrap, [2.0, 1.0], Right), (4, Wrap, [4.0, 2.0], Left), (5, Unwrap, [4.0, 2.0], Left)],
        &[([2.0, 1.0], Right)],
    ),
    ("touching-a-corner", &[(1, Wrap, [4.0, 1.0], Right)], &[([4.0, 1.0], Right)]),
    (
        "sliding",
        &[(2, Wrap, [3.0, 2.0], Right), (3, Wrap, [6.0, 1.0], Right)],
        &[([3.0, 2.0], Right), ([6.0, 1.0], Right)],
    ),
    ("touching-a-tip", &[(1, Wrap, [4.0, 1.0], Left)], &[([4.0, 1.0], Left)]),
    ("touching-the-middle", &[(1, Wrap, [3.0, 2.0], Right)], &[([3.0, 2.0], Right)]),
    (
        "crossing-walls",
        &[(1, Wrap, [3.0, 2.0], Right), (2, Wrap, [6.0, 2.0], Right)],
        &[([3.0, 2.0], Right), ([6.0, 2.0], Right)],
    ),
    (
        "same-place-other-rope",
        &[
            (2, Wrap, [3.0, 1.0], Right),
            (2, Wrap, [4.5, 1.0], Right),
            (4, Wrap, [4.5, -1.0], Right),
            (5, Wrap, [3.0, -1.0], Right),
            (6, Wrap, [3.0, 1.0], Right),
            (7, Wrap, [4.5, 1.0], Right),
        ],
        &[
            ([3.0, 1.0], Right),
            ([4.5, 1.0], Right),
            ([4.5, -1.0], Right),
            ([3.0, -1.0], Right),
            ([3.0, 1.0], Right),
            ([4.5, 1.0], Right),
        ],
    ),
];

fn evaluated(engine: &mut dyn Engine, model: &Model, situation: &Situation) -> TraceRecord {
    engine.evaluate(&[situation.trace(model)], &Job::new()).unwrap().remove(0)
}

fn named(name: &str) -> Situation {
    *Situation::all().iter().find(|s| s.name == name).unwrap()
}

/// The moments after the steps of a situation.
fn steps(situation: &Situation, model: &Arc<Model>) -> Vec<Moment> {
    let trace = situation.trace(model);
    let points: Vec<DVec2> =
        (0..trace.points().len()).filter(|&i| trace.ends_step(i)).map(|i| trace.points()[i]).collect();
    let record = evaluated(&mut Reference::new(model.clone()), model, situation);
    let mut steps = Vec::new();
    moments(model.anchor(), model.vertices(), &points, &record.events, |m| {
        if m.event.is_none() {
            steps.push(m.clone());
        }
    });
    steps
}

#[test]
fn every_situation_is_as_its_caption_says() {
    let names: Vec<&str> = Situation::all().iter().map(|s| s.name).collect();
    assert_eq!(names, CLAIMS.iter().map(|c| c.0).collect::<Vec<_>>());
    for (situation, (name, events, wraps)) in Situation::all().iter().zip(CLAIMS) {
        let model = situation.model();
        assert_eq!(situation.trace(&model).violation(), None, "{name}");
        let wraps: Vec<(DVec2, Side)> = wraps.iter().map(|&(at, side)| (at.into(), side)).collect();
        for subject in Subject::usual().iter().filter(|subject| subject.promise() != Promise::Nothing) {
            let record = evaluated(&mut *subject.open(&model), &model, situation);
            let at = |vertex: u32| model.vertices()[vertex as usize].to_array();
            let found: Vec<_> = record.events.iter().map(|e| (e.step, e.kind, at(e.vertex), e.side)).collect();
            assert!(subject.promise() == Promise::Ropes || found == *events, "{name}, {subject}: {found:?}");
            assert_eq!(record.wraps, wraps, "{name}, {subject}");
        }
    }
}

#[test]
fn what_captions_say_besides_is_so() {
    // The wall end on which the free end rests is a contact, but no turn before it moves on.
    let (touching, model) = (named("touching-a-corner"), named("touching-a-corner").model());
    let depths: Vec<u32> = steps(&touching, &model).iter().map(|m| m.rope.depth(m.at)).collect();
    assert_eq!(depths, [0, 0, 1]);

    // Two of three contacts are passed straight.
    let (straight, model) = (named("passed-straight"), named("passed-straight").model());
    let last = steps(&straight, &model).pop().unwrap();
    assert_eq!((last.rope.contacts().len(), last.rope.taut(last.at).len()), (3, 1));

    // The near wall end is passed straight while the rope is wrapped round the far one. A rope that forgot it would be
    // straight in the end, and that way leads through a wall.
    let (collinear, model) = (named("collinear-walls"), named("collinear-walls").model());
    let steps_of_it = steps(&collinear, &model);
    let taut: Vec<DVec2> = steps_of_it[4].rope.taut(steps_of_it[4].at).iter().map(|c| c.at).collect();
    assert_eq!(taut, [DVec2::new(4.0, 2.0)]);
    assert_eq!(steps_of_it[4].rope.contacts().len(), 2);
    assert!(!model.is_clear(model.anchor(), steps_of_it[5].at));

    // One place, two ropes.
    let (same, model) = (named("same-place-other-rope"), named("same-place-other-rope").model());
    let moments = steps(&same, &model);
    assert_eq!(moments[2].at, moments[7].at);
    assert!(moments[7].rope.length(moments[7].at) > 2.0 * moments[2].rope.length(moments[2].at));

    // The last leg goes back level with the first: half a turn, and the tension that comes of it.
    let (friction, model) = (named("friction"), named("friction").model());
    let last = steps(&friction, &model).pop().unwrap();
    let turns: Vec<DVec2> = last.rope.taut(last.at).iter().map(|c| c.at).collect();
    let corners: Vec<DVec2> = [model.anchor()].into_iter().chain(turns).chain([last.at]).collect();
    let forces = forces(&corners, Friction::new(0.5).unwrap(), Slip::ToFreeEnd);
    assert_eq!(forces.iter().map(|force| force.angle).sum::<f64>(), PI);
    assert!(friction.caption.contains(&format!("{:.2} times", forces[1].beyond)));

    // Twice round: each corner of the block twice, and the first once more.
    let (winding, model) = (named("winding"), named("winding").model());
    let mut times = BTreeMap::new();
    for contact in steps(&winding, &model).pop().unwrap().rope.contacts() {
        *times.entry(contact.vertex).or_insert(0) += 1;
    }
    assert_eq!(times.values().sum::<i32>(), 9);
    assert!(times.len() == 4 && times.values().all(|&n| n >= 2));
}

#[test]
fn one_event_a_step_is_not_enough_where_the_gallery_says_so() {
    for name in ["several-events", "wrap-and-unwrap", "passed-straight", "winding", "touching-a-corner"] {
        let (situation, model) = (named(name), named(name).model());
        let truth = evaluated(&mut Reference::new(model.clone()), &model, &situation).wraps;
        assert_ne!(evaluated(&mut Note::new(model.clone()), &model, &situation).wraps, truth, "{name}");
    }
}

fn files(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read_to_string(e.path()).unwrap())).collect()
}

/// Mend it with `tautline draw --gallery docs/gallery`.
#[test]
fn the_files_are_what_the_program_makes() {
    let folder = tempfile::tempdir().unwrap();
    let made = folder.path().join("new/gallery");
    let status = Command::new(cargo_bin!("tautline")).args(["draw", "--gallery"]).arg(&made).output().unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
    let (made, kept) = (files(&made), files(&Path::new(DOCS).join("gallery")));
    assert_eq!(made.keys().collect::<Vec<_>>(), kept.keys().collect::<Vec<_>>());
    assert_eq!(made.len(), Situation::all().len());
    for (name, svg) in &made {
        assert!(kept[name] == *svg, "docs/gallery/{name} is not what the program makes");
        assert!(svg.len() < 20_000, "{name} has {} bytes", svg.len());
    }
    let page = fs::read_to_string(Path::new(DOCS).join("gallery.md")).unwrap();
    let page = page.split_whitespace().collect::<Vec<_>>().join(" ");
    for situation in Situation::all() {
        for part in [format!("gallery/{}.svg", situation.name), situation.title.into(), situation.caption.into()] {
            assert!(page.contains(&part), "docs/gallery.md does not say {part:?}");
        }
    }
}
