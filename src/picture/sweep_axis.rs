//! Where the points of a sweep lie along the lower axis, and on which line.

use super::label::shortened;
use super::ticks::Ticks;
use crate::study::{SweepAnswer, shown};

/// From how many times the least value on the greatest lies so far off that the axis has decades.
const FAR: f64 = 50.0;

/// How wide the name of a line is at the most, in pixels.
const WIDEST: f64 = 150.0;

/// How many lines are told apart at the most.
const LINES: usize = 8;

/// The lower axis of a picture of a sweep.
pub(super) struct Axis {
    /// What it shows.
    pub title: String,
    /// The least value and the greatest.
    pub range: (f64, f64),
    /// The values that are named; `None` for round numbers.
    pub marks: Option<Vec<(f64, String)>>,
    /// Whether values between two others mean something, so that lines may join them.
    pub is_ordered: bool,
    /// Where each point lies.
    pub places: Vec<f64>,
}

/// Points that one line joins.
pub(super) struct Line {
    /// The value that they have in common; empty for a line of all.
    pub name: String,
    /// The points' numbers, in the order in which they are joined.
    pub points: Vec<usize>,
}

/// The axis of the first key, and a line for each value of the second, if that is all there is and no more lines than
/// can be told apart. Else the points stand side by side by their numbers.
pub(super) fn axis_and_lines(answer: &SweepAnswer) -> (Axis, Vec<Line>) {
    let all = Vec::from_iter(0..answer.points.len());
    let one = |axis: Axis| (axis, vec![Line { name: String::new(), points: all.clone() }]);
    let lines = (answer.keys.len() == 2).then(|| lines(answer));
    match (&answer.keys[..], lines) {
        ([_], _) => {
            let (axis, mut lines) = one(axis(answer));
            sort(&axis, &mut lines);
            (axis, lines)
        }
        ([..], Some(mut lines)) if lines.len() <= LINES => {
            let axis = axis(answer);
            sort(&axis, &mut lines);
            (axis, lines)
        }
        _ => one(Axis {
            title: format!("point ({})", answer.keys.join(", ")),
            range: side_by_side(all.len()),
            marks: Some(all.iter().map(|&i| (i as f64, i.to_string())).collect()),
            is_ordered: false,
            places: all.iter().map(|&i| i as f64).collect(),
        }),
    }
}

/// The range of so many values side by side, each in the middle of its place.
fn side_by_side(count: usize) -> (f64, f64) {
    (-0.5, count as f64 - 0.5)
}

/// Has lines go from the least value to the greatest.
fn sort(axis: &Axis, lines: &mut [Line]) {
    lines.iter_mut().for_each(|line| line.points.sort_by(|&a, &b| axis.places[a].total_cmp(&axis.places[b])));
}

/// A line for each value of the second key.
fn lines(answer: &SweepAnswer) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for (i, point) in answer.points.iter().enumerate() {
        let name = shortened(&shown(&point.values[1]), WIDEST);
        match lines.iter_mut().find(|line| answer.points[line.points[0]].values[1] == point.values[1]) {
            Some(line) => line.points.push(i),
            None => lines.push(Line { name, points: vec![i] }),
        }
    }
    lines
}

/// The axis of the first key: of numbers, or of values side by side.
fn axis(answer: &SweepAnswer) -> Axis {
    let title = answer.keys[0].clone();
    let values = || answer.points.iter().map(|point| &point.values[0]);
    if let Some(numbers) = values().map(serde_json::Value::as_f64).collect::<Option<Vec<f64>>>() {
        let [low, high] = [f64::min, f64::max].map(|of| numbers.iter().copied().reduce(of).unwrap_or_default());
        if low > 0.0 && high / low >= FAR {
            let decades = |x: f64| libm::log10(x);
            let marks = Ticks::logarithmic(low, high, 8).marks.into_iter().map(|(x, name)| (decades(x), name));
            return Axis {
                title,
                range: (decades(low), decades(high)),
                marks: Some(marks.collect()),
                is_ordered: true,
                places: numbers.into_iter().map(decades).collect(),
            };
        }
        return Axis { title, range: (low, high), marks: None, is_ordered: true, places: numbers };
    }
    let mut names: Vec<&serde_json::Value> = Vec::new();
    let places = values().map(|value| {
        let place = names.iter().position(|known| *known == value).unwrap_or_else(|| {
            names.push(value);
            names.len() - 1
        });
        place as f64
    });
    let places: Vec<f64> = places.collect();
    let marks = names.iter().enumerate().map(|(i, value)| (i as f64, shown(value))).collect();
    Axis { title, range: side_by_side(names.len()), marks: Some(marks), is_ordered: false, places }
}
