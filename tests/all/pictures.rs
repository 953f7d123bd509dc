//! Pictures of a study and its page, made of an answer that was made up.

use std::collections::BTreeSet;

use glam::DVec2;
use resvg::tiny_skia::Pixmap;
use resvg::usvg::roxmltree::Document;
use tautline::picture;
use tautline::scene::Scene;
use tautline::study::{
    Bin, Cell, CommonRope, Contact, Estimate, Histogram, Map, Obstacle, Plan, Quantile, Scalar, Stopped, Summary,
    Survival, SurvivalPoint,
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
    let heights = &mut Draws(2);
    let lengths = [("length", size * 0.4), ("max_length", size * 0.55)];
    let curve = |limit: f64| {
        let points = (0..=64).map(|i| {
            let value = (-f64::from(i) / (64.0 * 4.0 * limit * limit)).exp();
            let half = 0.04 * (value * (1.0 - value)).sqrt();
            let share = Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) };
            SurvivalPoint { step: 16 * i as u64, share }
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
    let map = Map { low: low.into(), cell, columns, rows, cells: cells.collect() };

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
        }
    });
    let ropes = if near.is_empty() { Vec::new() } else { ropes.collect() };
    Summary {
        study: plan(
            r#"{"scene": {"file": "scenes/<sea & \"isles\">.geojson"}, "tallies": {"limits": [0.3, 0.6]},
                "walk": {"kind": "persistent", "step": 0.5, "steps": 1024}, "run": {"traces": 40000}}"#,
        ),
        identity: "8f14e45fceea167a5a36dedd4bea2543".into(),
        traces,
        steps: traces * 1024,
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
        obstacles: near
            .iter()
            .enumerate()
            .map(|(i, &(vertex, at))| {
                let wound = 0.2 / (i as f64 + 1.0);
                let (left, right) = (about(wound * 0.7), about(wound * 0.3));
                Obstacle { vertex, at: at.into(), walls: 9, wound: about(wound), left, right, mean: about(wound * 0.4) }
            })
            .collect(),
        ropes,
        contacts: near
            .iter()
            .map(|&(vertex, at)| Contact { vertex, at: at.into(), wraps: about(1.2), share: about(0.11) })
            .collect(),
        map: Some(map),
    }
}

/// A picture's pixels, 720 wide; it must be an SVG that has a picture at all.
fn pixels(svg: &str) -> Pixmap {
    let png = picture::png(svg, 720).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    Pixmap::decode_png(&png).unwrap()
}

/// How many pixels have that colour.
fn count(pixels: &Pixmap, [r, g, b]: [u8; 3]) -> usize {
    pixels.pixels().iter().filter(|p| (p.red(), p.green(), p.blue()) == (r, g, b)).count()
}

/// All texts in a picture.
fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    document.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text().map(str::to_owned)).collect()
}

/// Checks that no text lies outside the picture and no coordinate is not a number.
fn check(svg: &str) {
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
fn a_study_has_all_pictures() {
    let scene = match std::env::var("TAUTLINE_LOOK_SCENE") {
        Ok(p) => tautline::scene::read_scene(p.as_ref()).unwrap(),
        Err(_) => islands(1.0),
    };
    let summary = answer(&scene);
    let all = every_picture(&summary, &scene);
    let stems: Vec<&str> = all.iter().map(|(stem, ..)| stem.as_str()).collect();
    assert_eq!(stems, ["histogram-length", "histogram-max-length", "survival", "map", "length-map", "ropes"]);
    assert_eq!(all, picture::all(&summary, &scene), "the same answer must give the same bytes");
    for (stem, _, svg) in &all {
        if let Ok(folder) = std::env::var("TAUTLINE_LOOK") {
            std::fs::write(format!("{folder}/{stem}.png"), picture::png(svg, 1440).unwrap()).unwrap();
        }
    }
}
