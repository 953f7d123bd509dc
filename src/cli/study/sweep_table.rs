//! What the studies of a sweep say, as a table.

use tautline::study::{Estimate, PointAnswer, SweepAnswer, quantity, shown};
use tautline::words::{NONE, aligned, percent, plainly, short};

/// The scalar that is shown; the files have all.
const SHOWN: &str = "max_length";

/// What people want to see first: a line a point with the mean greatest length and by how much it differs, and the same
/// of the share of ropes within each limit.
pub(super) fn table(answer: &SweepAnswer) -> String {
    let done = answer.points.iter().filter(|point| point.traces > 0).count();
    let against = &answer.points[answer.against];
    let mut text = format!(
        "{}, {done} with an answer; differences are those from {}, with errors from those of blocks\n",
        plainly(answer.points.len() as u64, "study", "studies"),
        against.folder
    );
    text += &format!("\n{}\n", quantity(SHOWN));
    let quantile = |point: &PointAnswer, share: f64| point.scalar(SHOWN)?.quantile(share).map(|q| short(q.value));
    text += &lines(answer, &["median", "95 %"], short, |point| {
        let known = [quantile(point, 0.5), quantile(point, 0.95)].map(|cell| cell.unwrap_or(NONE.to_owned())).to_vec();
        (point.scalar(SHOWN).map(|scalar| scalar.mean), point.mean_difference(SHOWN), known)
    });
    for limit in answer.limits() {
        text += &format!("\nropes never longer than {}\n", short(limit));
        text += &lines(answer, &[], percent, |point| (point.within(limit), point.share_difference(limit), Vec::new()));
    }
    if answer.points.iter().any(|point| point.tether.is_some()) {
        text += "\nsteps held back by the tether, and walks that never were\n";
        text += &lines(answer, &["never"], percent, |point| {
            let tether = point.tether.as_ref();
            let never = tether.map_or(NONE.to_owned(), |tether| percent(tether.never.value));
            (tether.map(|tether| tether.held_back), None, vec![never])
        });
    }
    if answer.points.iter().any(|point| point.friction.is_some()) {
        text += "\ngreatest tension with friction, hauled at the free end, for 1 at the anchor\n";
        let quantile = |point: &PointAnswer, share| point.friction.as_ref()?.tension.quantile(share);
        text += &lines(answer, &["median", "95 %"], short, |point| {
            let mean = point.friction.as_ref().map(|friction| friction.tension.mean);
            let known = [0.5, 0.95].map(|share| quantile(point, share).map_or(NONE.to_owned(), |q| short(q.value)));
            (mean, point.mean_difference("tension"), known.to_vec())
        });
    }
    text
}

/// A line for each point: its folder, its values, and what `of` says of it, an estimate, its difference, and more.
fn lines(
    answer: &SweepAnswer,
    more: &[&str],
    write: fn(f64) -> String,
    of: impl Fn(&PointAnswer) -> (Option<Estimate>, Option<Estimate>, Vec<String>),
) -> String {
    let interval = |estimate: Option<Estimate>| {
        let ends = estimate.and_then(|e| e.low.zip(e.high));
        ends.map_or(NONE.to_owned(), |(low, high)| format!("{} to {}", write(low), write(high)))
    };
    let value = |estimate: Option<Estimate>| estimate.map_or(NONE.to_owned(), |e| write(e.value));
    let head = ["value", "interval"].into_iter().chain(more.iter().copied()).chain(["difference", "interval"]);
    let names = std::iter::once("point").chain(answer.keys.iter().map(String::as_str));
    let mut lines = vec![names.chain(head).map(str::to_owned).collect::<Vec<_>>()];
    lines.extend(answer.points.iter().map(|point| {
        let (estimate, difference, known) = of(point);
        let mut line = vec![point.folder.clone()];
        line.extend(point.values.iter().map(shown));
        line.extend([value(estimate), interval(estimate)]);
        line.extend(known);
        line.extend([value(difference), interval(difference)]);
        line
    }));
    aligned(1 + answer.keys.len(), &lines)
}

/// The values of a point in words.
pub(super) fn words(keys: &[String], values: &[serde_json::Value]) -> String {
    let pairs = keys.iter().zip(values).map(|(key, value)| format!("{key} = {}", shown(value)));
    pairs.collect::<Vec<_>>().join(", ")
}
