//! The picture of a sweep, with values of every kind and size.

use serde_json::{Value, json};
use tautline::picture;
use tautline::study::{Estimate, PointAnswer, Quantile, Scalar, Stopped, SweepAnswer};

use super::pictures::{check, texts};

fn about(value: f64) -> Estimate {
    let half = 0.1 * value.abs();
    Estimate { value, error: Some(half / 2.0), low: Some(value - half), high: Some(value + half) }
}

/// A point with that mean greatest length; none if it has not begun.
fn point(values: Vec<Value>, mean: Option<f64>) -> PointAnswer {
    let scalar = |mean: f64| Scalar {
        name: "max_length".to_owned(),
        mean: about(mean),
        deviation: Some(mean),
        min: 0.0,
        max: 3.0 * mean,
        quantiles: [(0.05, 0.3), (0.5, 0.9), (0.95, 2.5)]
            .map(|(share, of)| Quantile { share, value: Estimate { error: None, ..about(of * mean) } })
            .to_vec(),
    };
    PointAnswer {
        folder: "point".to_owned(),
        values,
        traces: 100,
        blocks: 10,
        stopped: Stopped::Complete,
        confidence: 0.95,
        scalars: mean.into_iter().map(scalar).collect(),
        within: Vec::new(),
        tether: None,
        friction: None,
        differences: None,
    }
}

fn answer(keys: &[&str], points: Vec<PointAnswer>) -> SweepAnswer {
    SweepAnswer { keys: keys.iter().map(|&key| key.to_owned()).collect(), against: 0, shard: None, points }
}

fn of_one(values: Vec<Value>) -> SweepAnswer {
    let points = (1..).zip(values).map(|(i, value)| point(vec![value], Some(f64::from(i)))).collect();
    answer(&["walk.step"], points)
}

#[test]
fn values_of_every_kind_have_a_picture() {
    let long = "a name <of & something> that is far longer than there is room for in any picture".repeat(3);
    for values in [
        vec![json!(0.5)],
        vec![json!(0.4), json!(0.400_01), json!(0.400_02)],
        vec![json!(1e-9), json!(1e-3), json!(1), json!(1e9)],
        vec![json!(-5), json!(0), json!(1e12)],
        vec![json!("uniform"), json!("gaussian"), json!(long)],
        vec![json!([0, 0]), json!([1.25, -2.5]), json!([[0, 0], [1, 1]]), json!({"sample": 8})],
        vec![json!(true), json!(false)],
        (0..500).map(|i| json!(format!("scene-{i}.geojson"))).collect(),
        (0..500).map(|i| json!(i)).collect(),
    ] {
        let svg = picture::sweep(&of_one(values.clone())).unwrap();
        check(&svg);
        assert!(texts(&svg).iter().any(|text| text.starts_with("walk.step")), "{values:?}");
    }
    for scale in [1e-12, 1e12] {
        let points = [0.1, 0.2].map(|x| point(vec![json!(x)], Some(scale * x))).to_vec();
        check(&picture::sweep(&answer(&["walk.step"], points)).unwrap());
    }
}

#[test]
fn a_second_key_has_lines_and_more_keys_stand_side_by_side() {
    let two = |count: usize| {
        let pairs = (0..5).flat_map(|i| (0..count).map(move |j| (i, j)));
        answer(
            &["walk.step", "walk.turn"],
            pairs.map(|(i, j)| point(vec![json!(i), json!(format!("turn {j}"))], Some((i + j + 1) as f64))).collect(),
        )
    };
    for (count, is_named) in [(2, true), (8, true), (9, false)] {
        let svg = picture::sweep(&two(count)).unwrap();
        check(&svg);
        assert_eq!(texts(&svg).iter().any(|text| text == "turn 1"), is_named, "{count}");
        assert_eq!(texts(&svg).contains(&"point (walk.step, walk.turn)".to_owned()), !is_named, "{count}");
    }
    let three = answer(&["a.b", "c.d", "e.f"], (0..40).map(|i| point(vec![json!(i); 3], Some(1.0))).collect());
    check(&picture::sweep(&three).unwrap());
}

#[test]
fn what_has_not_begun_is_left_out() {
    let begun = |first: Option<f64>| answer(&["a.b"], vec![point(vec![json!(1)], first), point(vec![json!(2)], None)]);
    check(&picture::sweep(&begun(Some(3.0))).unwrap());
    assert_eq!(picture::sweep(&begun(None)), None);
}

/// Marks of means lie in proportion to their values, from the lower axis on: with a line through 1 and 3, the value 2 is
/// in the middle.
#[test]
fn marks_lie_where_their_values_say() {
    let points = [(1.0, 1.0), (2.0, 2.0), (5.0, 3.0)].map(|(x, mean)| point(vec![json!(x)], Some(mean))).to_vec();
    let svg = picture::sweep(&answer(&["a.b"], points)).unwrap();
    let number = |line: &str, name: &str| -> f64 {
        let from = line.find(&format!("{name}=\"")).unwrap() + name.len() + 2;
        line[from..].split('"').next().unwrap().parse().unwrap()
    };
    let means = svg.lines().filter(|line| line.starts_with("<circle") && line.contains("#d55e00"));
    let means: Vec<[f64; 2]> = means.take(3).map(|line| [number(line, "cx"), number(line, "cy")]).collect();
    let [a, b, c] = means[..] else { panic!("{means:?}") };
    assert!((b[1] - (a[1] + c[1]) / 2.0).abs() < 0.2 && c[1] < a[1], "{means:?}");
    assert!(((b[0] - a[0]) / (c[0] - a[0]) - 0.25).abs() < 0.01, "{means:?}");
}
