//! Pictures of a study and its page, made of an answer that was made up.

use std::collections::BTreeSet;

use glam::DVec2;
use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree::Document;
use tautline::picture;
use tautline::scene::Scene;
use tautline::study::{
    AtTether, Bin, ByObstacle, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, ObstacleContacts, Plan,
    Quantile, Scalar, Stopped, Summary, Survival, SurvivalPoint, TetherAnswer, Visited,
};

/// Random numbers that are the same everywhere.
struct Draws(u64);

impl Draws {
    /// Between 0 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// `value` with an interval of a tenth of it to either side.
fn about(value: f64) -> Estimate {
    let half = value.abs() / 10.0;
    Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) }
}

fn bare(value: f64) -> Estimate {
    Estimate { value, error: None, low: None, high: None }
}

/// Thirty islands around the anchor, all `unit` times as large.
fn islands(unit: f64) -> Scene {
    let mut draws = Draws(7);
    let mut walls = Vec::new();
    for _ in 0..30 {
        let centre = DVec2::new(draws.next() * 160.0 - 80.0, draws.next() * 100.0 - 50.0);
        let radius = 2.0 + 6.0 * draws.next();
        let corners: Vec<DVec2> = (0..9)
            .map(|i| {
                centre + DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 9.0) * radius * (0.5 + draws.next())
            })
            .map(|p| p * unit)
            .collect();
        walls.extend((0..9).map(|i| [corners[i], corners[(i + 1) % 9]]));
    }
    Scene::new(walls).unwrap().with_anchor(DVec2::new(3.0, -2.0) * unit)
}

fn plan(text: &str) -> Plan {
    serde_json::from_str(text).unwrap()
}

/// An answer about `scene` as it might be.
fn answer(scene: &Scene) -> Summary {
    let mut draws = Draws(1);
    let low = scene.vertices().iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = scene.vertices().iter().copied().reduce(DVec2::max).unwrap_or(DVec2::ONE);
    let size = (high - low).max_element();
    let anchor = scene.anchor().unwrap_or(low.midpoint(high));
    let traces = 40_000;

    let scalar = |name: &str, mean: f64| Scalar {
        name: name.into(),
        mean: Estimate { value: mean, error: Some(mean / 250.0), low: Some(mean * 0.992), high: Some(mean * 1.008) },
        deviation: Some(mean / 2.0),
        min: mean / 50.0,
        max: mean * 3.7,
        quantiles: [0.05, 0.25, 0.5, 0.75, 0.95]
            .map(|share| Quantile { share, value: bare(mean * (0.3 + 1.25 * share)) })
            .into(),
    };
    let mut heights = Draws(2);
    let mut histogram = |name: &str, mean: f64| {
        let weight = |i: u64| (i as f64 + 0.5) * (-(i as f64) / 9.0).exp() * 0.0117;
        let bins = (0..64).map(|i| (i, weight(i) * (0.8 + 0.4 * heights.next()))).filter(|&(i, _)| i != 61);
        let bins = bins.map(|(bin, value)| {
            let half = 2.0 * (value / 10_000.0).sqrt();
            let share = Estimate {
                value,
                error: Some(half / 2.0),
                low: Some((value - half).max(0.0)),
                high: Some(value + half),
            };
            Bin { bin, count: (value * traces as f64) as u64, share }
        });
        Histogram { name: name.into(), width: mean / 18.0, bins: bins.collect() }
    };
    let lengths = [("length", size * 0.4), ("max_length", size * 0.55)];
    let curve = |limit: f64| {
        let points = (0..=64u32).map(|i| {
            let value = (-f64::from(i) / (64.0 * 4.0 * limit * limit)).exp();
            let half = 0.04 * (value * (1.0 - value)).sqrt();
            let share = Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) };
            SurvivalPoint { step: u64::from(16 * i), share }
        });
        Survival { limit: limit * size, curve: points.collect() }
    };

    let (columns, cell) = (64, (high.x - low.x) / 64.0);
    let rows = ((high.y - low.y) / cell).ceil().max(1.0) as u32;
    let number = |p: DVec2| {
        let at = ((p - low) / cell).floor().clamp(DVec2::ZERO, DVec2::new(63.0, f64::from(rows - 1)));
        at.x as u64 + u64::from(columns) * at.y as u64
    };
    let touched: BTreeSet<u64> = scene.vertices().iter().map(|&v| number(v)).collect();
    let cells = (0..u64::from(columns * rows)).filter_map(|i| {
        let at = low + DVec2::new((i % 64) as f64 + 0.5, (i / 64) as f64 + 0.5) * cell;
        let far = at.distance(anchor);
        let visits = (1000.0 * (-4.0 * far / size).exp() * draws.next()) as u64;
        let contacts = if touched.contains(&i) { (-14.0 * far / size).exp() * draws.next() } else { 0.0 };
        let length = (visits > 30).then(|| about(far * (1.1 + 0.3 * draws.next())));
        (visits > 30 || contacts > 0.0).then(|| Cell { cell: i, visits, length, contacts: about(contacts) })
    });
    let map = Map { low: low.into(), cell, columns, rows, visited: None, cells: cells.collect() };

    let mut near: Vec<(u32, DVec2)> =
        scene.vertices().iter().copied().enumerate().map(|(i, v)| (i as u32, v)).collect();
    near.sort_by(|a, b| a.1.distance(anchor).total_cmp(&b.1.distance(anchor)));
    let near: Vec<_> = near.into_iter().step_by(5).take(40).collect();
    let ropes = (0..10).map(|i| {
        let wraps: Vec<[f64; 2]> = (0..i % 7).map(|k| near[(i * 3 + k * 4) % near.len()].1.into()).collect();
        let value = 0.3 / (i as f64 + 1.0);
        let half = 0.02 * value;
        CommonRope {
            count: (value * traces as f64) as u64,
            at_most: (value * traces as f64) as u64 + u64::from(i > 7),
            share: Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) },
            anchor: anchor.into(),
            sides: (0..wraps.len()).map(|k| if (k + i) % 2 == 0 { "left" } else { "right" }.to_string()).collect(),
            wraps,
            labels: vec![],
        }
    });
    let ropes = if near.is_empty() { Vec::new() } else { ropes.collect() };
    Summary {
        shard: None,
        missing: None,
        traded: None,
        study: plan(
            r#"{"scene": {"file": "scenes/<sea & \"isles\">.geojson"}, "tallies": {"limits": [0.3, 0.6]},
                "walk": {"kind": "persistent", "step": 0.5, "steps": 1024}, "run": {"traces": 40000}}"#,
        ),
        identity: "8f14e45fceea167a5a36dedd4bea2543".into(),
        traces,
        steps: traces * 1024,
        still: Some(0.000_25),
        at_walls: Some(0.0625),
        events: 1_234_567,
        blocks: 40,
        stopped: Stopped::Complete,
        scalars: lengths
            .iter()
            .copied()
            .chain([("max_depth", 4.2), ("unwraps", 0.7)])
            .map(|(n, m)| scalar(n, m))
            .collect(),
        histograms: lengths.iter().map(|&(n, m)| histogram(n, m)).collect(),
        survival: [0.2, 0.3, 0.45, 0.6, 0.9].map(curve).into(),
        tether: None,
        friction: None,
        obstacles: near
            .iter()
            .enumerate()
            .map(|(i, &(vertex, at))| {
                let wound = 0.2 / (i as f64 + 1.0);
                let (left, right) = (about(wound * 0.7), about(wound * 0.3));
                Obstacle {
                    vertex,
                    at: at.into(),
                    label: None,
                    walls: 9,
                    wound: about(wound),
                    left,
                    right,
                    mean: about(wound * 0.4),
                }
            })
            .collect(),
        ropes,
        anchors: None,
        contacts: near
            .iter()
            .map(|&(vertex, at)| Contact { vertex, at: at.into(), label: None, wraps: about(1.2), share: about(0.11) })
            .collect(),
        classes: None,
        by_obstacle: Some(ByObstacle {
            contacts: about(2.5),
            turns: about(1.5),
            obstacles: near
                .iter()
                .map(|&(vertex, at)| ObstacleContacts {
                    vertex,
                    at: at.into(),
                    label: Some("a <rock>".into()),
                    walls: 9,
                    contacts: about(1.25),
                    turns: about(0.75),
                    share: about(0.125),
                })
                .collect(),
        }),
        map: Some(map),
    }
}

/// A picture's pixels, 720 wide; it must be an SVG that has a picture at all.
pub(crate) fn pixels(svg: &str) -> Pixmap {
    let png = picture::png(svg, 720).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    Pixmap::decode_png(&png).unwrap()
}

/// How many pixels have that colour.
fn count(pixels: &Pixmap, [r, g, b]: [u8; 3]) -> usize {
    pixels.pixels().iter().filter(|p| (p.red(), p.green(), p.blue()) == (r, g, b)).count()
}

/// All texts in a picture.
pub(crate) fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text().map(str::to_owned)).collect()
}

/// Checks that no text lies outside the picture and no coordinate is not a number.
pub(crate) fn check(svg: &str) {
    let drawn = pixels(svg);
    assert!(drawn.pixels().iter().any(|p| p.red() < 128), "nothing is drawn");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let texts = texts(svg);
    assert!(!texts.is_empty());
    let (w, h) = (drawn.width(), drawn.height());
    let border = drawn.pixels().iter().enumerate().filter(|&(i, _)| {
        let (x, y) = (i as u32 % w, i as u32 / w);
        x == 0 || y == 0 || x == w - 1 || y == h - 1
    });
    assert!(border.map(|(_, p)| p.red()).all(|red| red == 255), "something leaves the picture: {texts:?}");
}

fn every_picture(summary: &Summary, scene: &Scene) -> Vec<(String, String, String)> {
    let all = picture::all(summary, scene);
    all.iter().for_each(|(_, _, svg)| check(svg));
    all
}

#[test]
fn a_study_with_a_tether_begins_with_it() {
    let scene = islands(1.0);
    let mut summary = answer(&scene);
    let curve = summary.survival[0].curve.clone();
    summary.tether = Some(TetherAnswer {
        length: 2.5,
        at: AtTether::Slide,
        held_back: about(0.25),
        never: about(0.125),
        first: Some(about(100.0)),
        quantiles: Vec::new(),
        curve: curve.clone(),
    });
    summary.map.as_mut().unwrap().visited = Some(Visited { area: 40.0, inner: 30.0 });
    let all = every_picture(&summary, &scene);
    let (stem, title, svg) = &all[0];
    assert_eq!((stem.as_str(), all.len()), ("held-back", 8));
    let words = texts(svg);
    assert!(words.iter().any(|text| text == "2.5") && title.contains("not held back yet"), "{words:?}");
    // It is the survival curve of one limit, in other words.
    summary.survival = vec![Survival { limit: 2.5, curve }];
    let line = |svg: &str| svg.lines().filter(|line| line.contains("<polygon")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(line(svg), line(&picture::survival(&summary, &scene).unwrap()));
    let sentence = picture::sentence(&summary, &scene).unwrap();
    assert!(sentence.starts_with("a tether of 2.5"), "{sentence}");
    assert!(sentence.ends_with(" holds the walks back in 25.0 % (22.5–27.5) of their steps"), "{sentence}");
    let page = picture::page(&summary, &scene, &[], None);
    for fact in [
        "<dt>steps held back by the tether</dt><dd>25.0 % (22.5–27.5)</dd>",
        "<dt>walks never held back</dt><dd>12.5 % (11.2–13.8)</dd>",
        "<dt>first step held back, on average where one was</dt><dd>100 (90–110)</dd>",
        "<dt>area visited, in whole cells</dt><dd>40; inner cells 30</dd>",
    ] {
        assert!(page.contains(fact), "{fact}\n{page}");
    }
}

#[test]
fn a_study_has_all_pictures() {
    let scene = islands(1.0);
    let summary = answer(&scene);
    let all = every_picture(&summary, &scene);
    let stems: Vec<&str> = all.iter().map(|(stem, ..)| stem.as_str()).collect();
    assert_eq!(stems, ["tether", "histogram-length", "histogram-max-length", "survival", "map", "length-map", "ropes"]);
    assert_eq!(all, picture::all(&summary, &scene), "the same answer must give the same bytes");
    for (stem, _, svg) in &all {
        assert!(svg.len() < 200_000, "{stem} has {} bytes", svg.len());
        assert_eq!(picture::png(svg, 300).unwrap(), picture::png(svg, 300).unwrap());
    }
}

/// A summary with one bin, one curve, one cell and one rope, all of them certain, and without any interval.
fn least(scene: &Scene) -> Summary {
    let mut summary = answer(scene);
    let anchor = summary.ropes.first().map_or([0.0, 0.0], |r| r.anchor);
    summary.histograms =
        vec![Histogram { name: "length".into(), width: 2.0, bins: vec![Bin { bin: 3, count: 10, share: bare(1.0) }] }];
    summary.scalars.retain(|s| s.name == "length");
    summary.scalars[0].mean = bare(7.0);
    summary.scalars[0].deviation = None;
    summary.scalars[0].quantiles.clear();
    let point = |step, share| SurvivalPoint { step, share: bare(share) };
    summary.survival = vec![Survival { limit: 8.0, curve: vec![point(0, 1.0), point(10, 0.0)] }];
    let rope =
        CommonRope { count: 10, at_most: 10, share: bare(1.0), anchor, wraps: vec![], sides: vec![], labels: vec![] };
    summary.ropes = vec![rope];
    let cell = Cell { cell: 0, visits: 3, length: Some(bare(1.0)), contacts: bare(0.5) };
    let low = scene.vertices().iter().copied().reduce(DVec2::min).unwrap_or_default();
    summary.map = Some(Map { low: low.into(), cell: 4.0, columns: 1, rows: 1, visited: None, cells: vec![cell] });
    summary
}

#[test]
fn little_is_enough_for_a_picture() {
    let scene = islands(1.0);
    let all = every_picture(&least(&scene), &scene);
    assert_eq!(all.len(), 5);
    // One bar, as high as the axis is long: its colour fills the picture's middle.
    assert!(count(&pixels(&all[0].2), [0x9d, 0xcd, 0xea]) > 20_000);
    assert!(texts(&all[0].2).contains(&"mean 7".to_string()));
    assert!(texts(&all[4].2).contains(&"straight".to_string()));

    let empty = Scene::new([]).unwrap();
    assert_eq!(every_picture(&least(&empty), &empty).len(), 5);
}

#[test]
fn what_was_not_counted_has_no_picture() {
    let scene = islands(1.0);
    let mut summary = answer(&scene);
    summary.survival.clear();
    summary.map = None;
    summary.ropes.clear();
    summary.histograms[1].bins.clear();
    let all = every_picture(&summary, &scene);
    assert_eq!(all.len(), 2, "without lengths nobody knows how many walks a tether holds");
    assert_eq!(texts(&all[1].2), ["Nothing was counted: greatest rope length"]);

    let mut summary = answer(&scene);
    for cell in &mut summary.map.as_mut().unwrap().cells {
        cell.length = None;
        cell.contacts = bare(0.0);
    }
    assert!(picture::map(&summary, &scene).is_none() && picture::length_map(&summary, &scene).is_none());
}

#[test]
fn scenes_may_have_any_size_and_shape() {
    for unit in [1e9, 1e-9] {
        let scene = islands(unit);
        let all = every_picture(&answer(&scene), &scene);
        let unit = if unit > 1.0 { "10⁹ scene units)" } else { "10⁻⁹ scene units)" };
        assert!(texts(&all[4].2).iter().any(|t| t == &format!("x ({unit}")), "{:?}", texts(&all[4].2));
    }
    let wall = |a: [f64; 2], b: [f64; 2]| [DVec2::from(a), DVec2::from(b)];
    let far = [wall([1e9, 1e9], [1e9 + 3.0, 1e9 + 1.0]), wall([1e9, 1e9 + 2.0], [1e9 + 3.0, 1e9 + 2.0])];
    let flat = (0..40).map(|i| wall([f64::from(i), 0.0], [f64::from(i) + 0.9, 0.01])).collect::<Vec<_>>();
    let tall = (0..40).map(|i| wall([0.0, f64::from(i)], [0.4, f64::from(i) + 0.9])).collect::<Vec<_>>();
    for walls in [far.to_vec(), flat, tall] {
        let scene = Scene::new(walls).unwrap();
        every_picture(&answer(&scene), &scene);
    }
}

#[test]
fn very_many_walls_do_not_make_a_large_file() {
    // A grid of 35,000 walls, straight or not.
    for (uneven, most) in [(0.0, 150_000), (0.5, 800_000)] {
        let mut draws = Draws(3);
        let mut moved = |x: usize| x as f64 + uneven * draws.next();
        let corners: Vec<DVec2> = (0..133 * 133).map(|i| DVec2::new(moved(i % 133), moved(i / 133))).collect();
        let inner = (0..132 * 132).map(|i| i % 132 + i / 132 * 133);
        let walls = inner.flat_map(|i| [[corners[i], corners[i + 1]], [corners[i], corners[i + 133]]]);
        let scene = Scene::new(walls).unwrap();
        assert!(scene.walls().len() > 34_000);
        let size = picture::map(&answer(&scene), &scene).unwrap().len();
        assert!(size < most, "{size} bytes");
    }
}

#[test]
fn marks_lie_where_their_numbers_say() {
    let scene = islands(1.0);
    let mut summary = least(&scene);
    let share = |value, low, high| Estimate { value, error: None, low: Some(low), high: Some(high) };
    let bins = vec![
        Bin { bin: 0, count: 2, share: share(0.2, 0.1, 0.3) },
        Bin { bin: 1, count: 4, share: share(0.4, 0.3, 0.5) },
        Bin { bin: 3, count: 4, share: share(0.4, 0.3, 0.5) },
    ];
    summary.histograms[0].bins = bins;
    let svg = picture::histogram(&summary, &scene, "length");
    let names = texts(&svg);
    for tick in ["0", "10", "20", "30", "40", "50", "1", "8", "share of traces (%)"] {
        assert!(names.iter().any(|t| t == tick), "{tick} is not in {names:?}");
    }
    let document = Document::parse(&svg).unwrap();
    let bars: Vec<[f64; 4]> = document
        .descendants()
        .filter(|n| n.attribute("class") == Some("bar"))
        .map(|n| ["x", "y", "width", "height"].map(|a| n.attribute(a).unwrap().parse().unwrap()))
        .collect();
    assert_eq!(bars.len(), 3);
    assert!((bars[1][3] - 2.0 * bars[0][3]).abs() < 0.2, "twice the share is twice as high: {bars:?}");
    assert!((bars[2][0] - bars[1][0] - 2.0 * (bars[1][0] - bars[0][0])).abs() < 0.2, "the empty bin has its place");
    assert!(bars.iter().all(|b| (b[1] + b[3] - (bars[0][1] + bars[0][3])).abs() < 0.11), "all stand on the axis");
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let svg = picture::histogram(&answer(&islands(1.0)), &islands(1.0), "length");
    assert!(matches!(picture::png(&svg, 0), Err(picture::PictureError::Size { .. })));
    assert!(matches!(picture::png(&svg, 1_000_000), Err(picture::PictureError::Size { .. })));
    assert!(matches!(picture::png("no picture", 10), Err(picture::PictureError::Svg(_))));
}

/// The page that a browser looks at too: `tests/page.sh` says where it is to be written.
#[test]
fn the_page_has_everything_and_needs_nothing() {
    let scene = islands(1.0);
    let summary = answer(&scene);
    let pictures = picture::all(&summary, &scene).into_iter().map(|(_, title, svg)| (title, svg)).collect::<Vec<_>>();
    let run = serde_json::json!({"seconds": 12.5, "machine": {"adapter": "<none & nowhere>"}, "parts": [1, 2]});
    let page = picture::page(&summary, &scene, &pictures, Some(&run));
    assert_eq!(page.matches("<svg ").count(), pictures.len());
    assert_eq!(page.matches("<figure>").count(), pictures.len());
    for absent in ["http:", "https:", "<script", "url(", "src=", "@import", "<sea", "<none", "& \"isles"] {
        assert!(!page.contains(absent), "{absent} is in the page");
    }
    for present in [
        "&lt;sea &amp; &quot;isles&quot;&gt;",
        "&lt;none &amp; nowhere&gt;",
        "walk: kind",
        "persistent",
        "machine: adapter",
    ] {
        assert!(page.contains(present), "{present} is not in the page");
    }
    // Ids must be those of one element in the whole page.
    let ids: Vec<&str> = page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len(), "{ids:?}");
    // The answer comes first, then its picture, and then all else.
    let sentence = picture::sentence(&summary, &scene).unwrap();
    let places =
        [&format!("<p class=\"answer\">{sentence}</p>"), "How many walks a tether holds", "<dl>", "<h2>Numbers"];
    let places: Vec<usize> =
        places.iter().map(|part| page.find(*part).unwrap_or_else(|| panic!("no {part}"))).collect();
    assert!(places.is_sorted(), "{places:?}");
    if let Some(path) = std::env::var_os("TAUTLINE_TEST_PAGE") {
        std::fs::write(path, &page).unwrap();
    }

    let bare = picture::page(&least(&scene), &scene, &[], None);
    assert!(!bare.contains("<figure") && !bare.contains("<h2>Run"));
}

#[test]
fn the_sentence_has_the_highest_quantile_and_the_unit() {
    let scene = islands(1.0);
    let mut summary = answer(&scene);
    let longest = summary.scalars.iter_mut().find(|s| s.name == "max_length").unwrap();
    let value = Estimate { value: 366.8, error: None, low: Some(360.2), high: Some(371.9) };
    longest.quantiles.push(tautline::study::Quantile { share: 0.995, value });
    assert_eq!(picture::sentence(&summary, &scene).unwrap(), "99.5 % of the walks need at most 367 (360 to 372)");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.svg");
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"90mm\" height=\"60mm\" viewBox=\"0 0 90 60\">\
                   <path d=\"M3,4h50v20\" stroke=\"#000\" fill=\"none\"/></svg>";
    std::fs::write(&path, drawing).unwrap();
    let drawn = tautline::scene::read_scene(&path).unwrap();
    assert_eq!(picture::sentence(&summary, &drawn).unwrap(), "99.5 % of the walks need at most 367 mm (360 to 372)");
    // On every axis along which lengths go, in every picture.
    for (stem, _, svg) in every_picture(&summary, &drawn) {
        let texts = texts(&svg);
        assert!(!texts.iter().any(|text| text.contains("scene unit")), "{stem}: {texts:?}");
        assert!(stem == "ropes" || texts.iter().any(|text| text.contains("mm)")), "{stem}: {texts:?}");
    }
    let mut known = |low, high| {
        let longest = summary.scalars.iter_mut().find(|s| s.name == "max_length").unwrap();
        longest.quantiles.last_mut().unwrap().value = Estimate { low, high, ..value };
        picture::sentence(&summary, &scene).unwrap()
    };
    assert!(known(Some(350.0), None).ends_with("at most 366.8 (350 or more)"), "{}", known(Some(350.0), None));
    assert!(known(None, None).ends_with("at most 366.8"));
    summary.traces = 0;
    assert!(picture::sentence(&summary, &scene).is_none() && picture::tether(&summary, &scene).is_none());
}

#[test]
fn the_curve_of_tethers_goes_from_none_to_all() {
    let scene = islands(1.0);
    let summary = answer(&scene);
    let held = summary.held();
    assert_eq!((held[0].share.value, held[held.len() - 1].share.value), (0.0, 1.0));
    assert!(held.is_sorted_by(|a, b| a.length < b.length && a.share.value <= b.share.value));
    let bins = &summary.histograms.iter().find(|h| h.name == "max_length").unwrap().bins;
    let all: u64 = bins.iter().map(|bin| bin.count).sum();
    let half = bins.len() / 2;
    let below: u64 = bins[..half].iter().map(|bin| bin.count).sum();
    let end = (bins[half - 1].bin + 1) as f64 * summary.histograms[1].width;
    let there = held.iter().find(|h| h.length == end).unwrap();
    assert_eq!(there.share.value, below as f64 / all as f64);
}
