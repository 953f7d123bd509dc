//! Drawings of traces and their ropes.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec2;
use resvg::usvg::roxmltree::Document;
use tautline::engine::{Engine, Job, Reference};
use tautline::example::{Walker, floor_plan, walks};
use tautline::picture::{DrawError, Drawing, Part, Theme, png};
use tautline::rope::TraceRecord;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

use crate::pictures::{pixels, texts};

/// Walls, an anchor and traces, evaluated.
struct Dragged {
    model: Arc<Model>,
    traces: Vec<SettledTrace>,
    records: Vec<TraceRecord>,
}

impl Dragged {
    fn new(walls: &[[[f64; 2]; 2]], traces: &[&[[f64; 2]]]) -> Self {
        let scene = Scene::new(walls.iter().map(|w| w.map(DVec2::from))).unwrap();
        let points = traces.iter().map(|t| t.iter().copied().map(DVec2::from).collect());
        Dragged::of(Arc::new(Model::new(scene, Some(DVec2::ZERO)).unwrap()), points)
    }

    fn of(model: Arc<Model>, points: impl Iterator<Item = Vec<DVec2>>) -> Self {
        let traces: Vec<_> = points.zip(0..).map(|(points, id)| settle(&model, &Trace { id, points })).collect();
        let records = Reference::new(model.clone()).evaluate(&traces, &Job::new()).unwrap();
        Dragged { model, traces, records }
    }

    /// A walk in the floor plan, everything `unit` times as large.
    fn walk(steps: usize, unit: f64) -> Self {
        let plan = floor_plan();
        let model = Arc::new(Model::new(plan.clone(), None).unwrap());
        let trace = walks(&model, Walker { step: 0.25, steps, seed: 1 }, 4).remove(3);
        let walls = (0..plan.walls().len()).map(|w| plan.ends(w).map(|p| p * unit));
        let scaled = Arc::new(Model::new(Scene::new(walls).unwrap(), Some(model.anchor() * unit)).unwrap());
        Dragged::of(scaled, std::iter::once(trace.points.iter().map(|&p| p * unit).collect()))
    }

    fn drawing(&self) -> Drawing<'_> {
        let pairs = self.traces.iter().zip(&self.records);
        pairs.fold(Drawing::new(&self.model), |drawing, (trace, record)| drawing.with(trace, record))
    }
}

/// The picture's window on the plane.
fn inside(svg: &str) -> &str {
    let from = svg.find("overflow=\"hidden\"").unwrap();
    &svg[from..from + svg[from..].find("</svg>").unwrap()]
}

#[test]
fn the_key_explains_what_occurs_and_nothing_else() {
    let all = [
        "anchor",
        "free end",
        "trace",
        "points of the trace",
        "every 2nd point of the trace",
        "trace still to come",
        "rope",
        "trace 0 and its rope",
        "trace 1 and its rope",
        "turn, wall end on the left",
        "turn, wall end on the right",
        "contact passed straight",
        "rays of the pivot",
        "rays of the pivot (1 of 2)",
        "unwrapping ray",
        "where it wraps or unwraps",
        "wall",
    ];
    let explained = |svg: &str| {
        let there: BTreeSet<String> = texts(svg).into_iter().collect();
        all.into_iter().filter(|&name| there.contains(name)).collect::<Vec<_>>()
    };
    let wall = [[4.0, -2.0], [4.0, 1.0]];
    let over = [[2.0, 2.0], [5.0, 2.5], [7.0, -1.0]];
    let under = [[2.0, -3.0], [5.0, -3.0], [7.0, -1.0]];
    let basic = ["anchor", "free end", "trace", "points of the trace"];
    let with = |more: &[&'static str]| -> Vec<&str> {
        all.into_iter().filter(|name| basic.contains(name) || more.contains(name)).collect()
    };

    let right = Dragged::new(&[wall], &[&over]);
    let turn = "turn, wall end on the right";
    let full = with(&["rope", turn, "rays of the pivot", "unwrapping ray", "wall"]);
    assert_eq!(explained(&right.drawing().svg().unwrap()), full);
    assert_eq!(explained(&right.drawing().rays(0).svg().unwrap()), with(&["rope", turn, "wall"]));
    let early = with(&["trace still to come", "rope", "rays of the pivot", "wall"]);
    assert_eq!(explained(&right.drawing().at_step(1).svg().unwrap()), early);
    let one = with(&["trace still to come", "rope", "rays of the pivot (1 of 2)", "wall"]);
    assert_eq!(explained(&right.drawing().at_step(1).rays(1).svg().unwrap()), one);
    let event = with(&["trace still to come", "rope", turn, "where it wraps or unwraps", "wall"]);
    assert_eq!(explained(&right.drawing().frames(None).unwrap()), event);
    let rays = explained(&right.drawing().rays(9).frames(None).unwrap());
    assert!(rays.contains(&"rays of the pivot") && rays.contains(&"unwrapping ray"), "{rays:?}");

    let left = Dragged::new(&[wall], &[&under]);
    let turn = "turn, wall end on the left";
    assert_eq!(explained(&left.drawing().rays(0).svg().unwrap()), with(&["rope", turn, "wall"]));

    let both = Dragged::new(&[wall], &[&over, &under]);
    let several: Vec<&str> = all
        .into_iter()
        .filter(|name| ["anchor", "free end", "trace", "rope", "wall"].contains(name) || name.ends_with("its rope"))
        .collect();
    let found = explained(&both.drawing().svg().unwrap());
    assert_eq!(found.iter().filter(|n| !n.starts_with("turn")).copied().collect::<Vec<_>>(), several);
    assert_eq!(found.iter().filter(|n| n.starts_with("turn")).count(), 2);

    let row = [[[2.0, -2.0], [2.0, 0.0]], [[4.0, -2.0], [4.0, 0.0]]];
    let straight = Dragged::new(&row, &[&[[1.0, 1.5], [8.0, 1.5], [8.0, -1.5]]]);
    let turn = "turn, wall end on the right";
    let found = explained(&straight.drawing().rays(0).svg().unwrap());
    assert_eq!(found, with(&["rope", turn, "contact passed straight", "wall"]));

    let crowd: Vec<[f64; 2]> = (0..80).map(|i| [2.0 + 0.07 * f64::from(i), 2.0]).collect();
    let found = explained(&Dragged::new(&[], &[&crowd]).drawing().svg().unwrap());
    assert_eq!(found, ["anchor", "free end", "trace", "every 2nd point of the trace", "rope"]);

    assert_eq!(explained(&Drawing::of_scene(right.model.scene()).svg().unwrap()), ["wall"]);
}

#[test]
fn turns_are_numbered_and_the_state_is_told() {
    let box_ =
        [[[3.0, -1.0], [5.0, -1.0]], [[5.0, -1.0], [5.0, 1.0]], [[5.0, 1.0], [3.0, 1.0]], [[3.0, 1.0], [3.0, -1.0]]];
    let round = [[2.0, 2.0], [6.0, 2.0], [6.0, -2.0], [2.0, -2.0]];
    let rounds: Vec<[f64; 2]> = round.iter().copied().cycle().take(4 * 75).collect();
    let dragged = Dragged::new(&box_, &[&rounds]);
    let words = texts(&dragged.drawing().at_step(4).svg().unwrap());
    assert!(words.contains(&"Trace 0 after step 4 of 299: 4 turns, 12.32 long".to_string()), "{words:?}");
    for number in ["1", "2", "3", "4"] {
        assert!(words.contains(&number.to_string()), "{number} is not in {words:?}");
    }
    // Very many turns at one place are not listed all.
    let words = texts(&dragged.drawing().svg().unwrap());
    assert!(words.iter().any(|w| w.starts_with("1, 5 … 29")), "{words:?}");
    assert!(words.iter().all(|w| w.len() < 80), "{words:?}");
}

#[test]
fn pictures_do_not_depend_on_the_unit() {
    let svg = |unit: f64| Dragged::walk(300, unit).drawing().svg().unwrap();
    let one = svg(1.0);
    assert!(inside(&one).len() > 5000);
    for unit in [2f64.powi(-20), 2f64.powi(40), 2f64.powi(-300), 2f64.powi(300)] {
        assert!(inside(&svg(unit)) == inside(&one), "{unit:e}");
    }
    let coarse = texts(&svg(2f64.powi(40)));
    assert!(coarse.iter().any(|t| t == "x and y in 10¹² scene units"), "{coarse:?}");
}

#[test]
fn nothing_of_a_picture_lies_on_its_edge() {
    for dragged in [Dragged::walk(300, 1.0), Dragged::new(&[], &[&[[0.0, 0.0]]]), Dragged::new(&[], &[&[[1.0, 1e-9]]])]
    {
        for drawing in [dragged.drawing(), dragged.drawing().part(Part::All)] {
            let drawn = pixels(&drawing.svg().unwrap());
            let (w, h) = (drawn.width() as usize, drawn.height() as usize);
            let edge = |i: usize| i < w || i >= w * (h - 1) || i.is_multiple_of(w) || i % w == w - 1;
            assert!(drawn.pixels().iter().enumerate().filter(|&(i, _)| edge(i)).all(|(_, p)| p.red() == 255));
            assert!(drawn.pixels().iter().any(|p| p.red() < 60), "nothing is drawn");
        }
    }
}

#[test]
fn long_traces_and_large_scenes_make_small_files() {
    let long = Dragged::walk(20_000, 1.0);
    let svg = long.drawing().svg().unwrap();
    assert!(svg.len() < 300_000, "{} bytes", svg.len());
    assert!(svg.matches("<circle").count() < 200, "{} circles", svg.matches("<circle").count());
    let moving = long.drawing().animated().unwrap();
    assert!(moving.len() < 4_000_000, "{} bytes", moving.len());
    assert!(long.drawing().page().unwrap().len() < 4_000_000);

    let grid = (0..130 * 130).flat_map(|i| {
        let at = DVec2::new(f64::from(i % 130), f64::from(i / 130));
        [[at, at + 0.8 * DVec2::X], [at, at + 0.7 * DVec2::Y]]
    });
    let model = Arc::new(Model::new(Scene::new(grid).unwrap(), Some(DVec2::splat(0.5))).unwrap());
    let dragged =
        Dragged::of(model, std::iter::once(vec![DVec2::splat(0.5), DVec2::new(0.9, 0.9), DVec2::new(0.9, 3.6)]));
    let (near, all) = (dragged.drawing().svg().unwrap(), dragged.drawing().part(Part::All).svg().unwrap());
    // The part that matters is a few walls, and sharp.
    assert!(near.len() < 12_000 && all.len() > 100_000 && all.len() < 1_500_000, "{} {}", near.len(), all.len());
}

#[test]
fn the_dark_is_dark_and_pixels_are_light_unless_told() {
    let dragged = Dragged::walk(100, 1.0);
    let of = |theme| dragged.drawing().theme(theme).svg().unwrap();
    let [reader, light, dark] = [Theme::Reader, Theme::Light, Theme::Dark].map(of);
    assert!(png(&reader, 700).unwrap() == png(&light, 700).unwrap());
    assert!(reader.contains("prefers-color-scheme: dark") && !light.contains("<style") && !dark.contains("<style"));
    let corner = |svg: &str| pixels(svg).pixels()[0].red();
    assert_eq!((corner(&light), corner(&dark)), (0xff, 0x16));
    // In the dark, the classes say what the dark picture's attributes say.
    let document = Document::parse(&reader).unwrap();
    let style = document.descendants().find(|n| n.has_tag_name("style")).unwrap().text().unwrap();
    let dark_document = Document::parse(&dark).unwrap();
    let pairs = document.descendants().filter(|n| n.is_element() && !n.has_tag_name("style"));
    let mut compared = 0;
    for (a, b) in pairs.zip(dark_document.descendants().filter(|n| n.is_element())) {
        assert_eq!(a.tag_name().name(), b.tag_name().name());
        for (what, letter) in [("fill", "f"), ("stroke", "s")] {
            let classes = a.attribute("class").unwrap_or_default().split(' ');
            if let Some(class) = classes.into_iter().find(|c| c.starts_with(&format!("{letter}-"))) {
                let rule = format!(".{class} {{ {what}: {} }}", b.attribute(what).unwrap());
                assert!(style.contains(&rule), "{rule} is not in {style}");
                compared += 1;
            }
        }
    }
    assert!(compared > 20);
}

#[test]
fn a_filmstrip_has_a_picture_for_each_event() {
    let dragged = Dragged::walk(500, 1.0);
    let events = dragged.records[0].events.len();
    assert!(events > 26, "{events}");
    let windows = |svg: &str| svg.matches("overflow=\"hidden\"").count();
    let strip = dragged.drawing().frames(None).unwrap();
    assert_eq!(windows(&strip), 24);
    let heading = format!("Trace 0: events 1 to 24 of {events}; {} are left out", events - 24);
    assert!(texts(&strip).contains(&heading), "{:?}", texts(&strip));
    let rest = dragged.drawing().frames(Some(25..=events)).unwrap();
    assert_eq!(windows(&rest), events - 24);
    let first = &dragged.records[0].events[24];
    let title = format!("25. {} in step {}", first.kind.name(), first.step);
    assert!(texts(&rest).contains(&title), "{:?}", texts(&rest));
    let all = dragged.drawing().frames(Some(1..=events)).unwrap();
    assert_eq!(texts(&all)[0], format!("Trace 0: all its {events} events"));
    for (events, parts) in [
        (0..=3, "no events 0 to 3"),
        (std::ops::RangeInclusive::new(5, 4), "no events 5 to 4"),
        (1..=9999, "no events 1 to 9999"),
    ] {
        let e = dragged.drawing().frames(Some(events)).unwrap_err().to_string();
        assert!(e.contains(parts), "{e}");
    }
}

#[test]
fn an_animation_moves_the_rope_through_its_moments() {
    let dragged = Dragged::walk(300, 1.0);
    let svg = dragged.drawing().animated().unwrap();
    let document = Document::parse(&svg).unwrap();
    let mut moved = BTreeSet::new();
    for animate in document.descendants().filter(|n| n.has_tag_name("animate")) {
        let list = |name: &str| animate.attribute(name).unwrap().split(';').collect::<Vec<_>>();
        let times: Vec<f64> = list("keyTimes").iter().map(|t| t.parse().unwrap()).collect();
        let values = list("values");
        assert_eq!(times.len(), values.len());
        assert!(times[0] == 0.0 && times.windows(2).all(|w| w[0] <= w[1]) && times[times.len() - 1] <= 1.0);
        let attribute = animate.attribute("attributeName").unwrap();
        if attribute == "points" {
            // As many points at each moment, or browsers do not move from one to the next.
            let counts: BTreeSet<usize> = values.iter().map(|v| v.split(' ').count()).collect();
            assert_eq!(counts.len(), 1, "{counts:?}");
            assert!(values.iter().collect::<BTreeSet<_>>().len() > 250);
        }
        // Where nothing moves, the last moment is shown.
        let still = animate.parent().unwrap().attribute(attribute).unwrap();
        assert_eq!(values[values.len() - 1], still, "{attribute}");
        moved.insert(attribute);
    }
    assert_eq!(moved, BTreeSet::from(["cx", "cy", "points", "visibility"]));
}

/// The page that a browser looks at too: `tests/animation.sh` says where both are to be written.
#[test]
fn the_page_that_plays_needs_nothing() {
    let dragged = Dragged::walk(500, 1.0);
    let page = dragged.drawing().page().unwrap();
    for absent in ["http:", "https:", "url(", "src=", "@import", "NaN", "Infinity"] {
        assert!(!page.contains(absent), "{absent} is in the page");
    }
    assert!(page.contains("<script") && page.contains("type=\"range\""));
    assert!(!dragged.drawing().frames_page(None).unwrap().contains("<script"));
    assert!(!Drawing::new(&dragged.model).page().unwrap().contains("<script"));
    if let Some(folder) = std::env::var_os("TAUTLINE_TEST_ANIMATION") {
        let folder = std::path::Path::new(&folder);
        std::fs::write(folder.join("player.html"), &page).unwrap();
        std::fs::write(folder.join("moving.svg"), dragged.drawing().animated().unwrap()).unwrap();
    }
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let wall = [[4.0, -2.0], [4.0, 1.0]];
    let straight: &[[f64; 2]] = &[[1.0, 1.0], [2.0, 2.0]];
    let two = Dragged::new(&[wall], &[straight, straight]);
    let one = Dragged::new(&[wall], &[straight]);
    let none = Drawing::new(&one.model);
    assert!(none.svg().is_ok());
    assert_eq!(none.animated().unwrap_err(), DrawError::NoTrace { what: "an animation" });
    assert_eq!(two.drawing().animated().unwrap_err(), DrawError::OneTrace { what: "an animation", traces: 2 });
    assert_eq!(two.drawing().frames(None).unwrap_err(), DrawError::OneTrace { what: "a filmstrip", traces: 2 });
    assert_eq!(one.drawing().frames(None).unwrap_err(), DrawError::NoEvents { trace: 0 });
    assert_eq!(one.drawing().at_step(2).svg().unwrap_err(), DrawError::Step { trace: 0, step: 2, steps: 1 });
    let seven = Dragged::new(&[wall], &[straight; 7]);
    assert_eq!(seven.drawing().svg().unwrap_err(), DrawError::TooManyTraces { traces: 7, most: 6 });
    for (a, b) in [(DVec2::ZERO, DVec2::X), (DVec2::ZERO, DVec2::splat(f64::NAN)), (DVec2::ONE, DVec2::ONE)] {
        let e = one.drawing().part(Part::Between(a, b)).svg().unwrap_err();
        assert!(matches!(e, DrawError::Part { .. }), "{e}");
    }
}
