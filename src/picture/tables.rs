//! The tables of a study's page.

use std::fmt::Write;

use serde_json::Value;

use super::label::{count, number, percent};
use super::svg::escape;
use crate::study::{ByObstacle, ClassAnswer, Estimate, Scalar, Summary, quantity};

/// How many rows the tables of obstacles and of wall ends have at the most.
const ROWS: usize = 20;

/// A table: its class, its head, and its rows cell by cell. Cells are text; what a row begins with is its head. In a
/// table of `words`, the last column may be long. Each cell knows the head of its column, which stands beside it where
/// the page is too narrow for columns.
fn table(class: &str, head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut out = format!("<table class=\"{class}\">\n<thead><tr>");
    for name in head {
        let _ = write!(out, "<th scope=\"col\">{}</th>", escape(name));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in rows {
        out.push_str("<tr>");
        for (i, (cell, name)) in row.iter().zip(head).enumerate() {
            let cell = escape(cell);
            let _ = match i {
                0 => write!(out, "<th scope=\"row\">{cell}</th>"),
                _ => write!(out, "<td data-head=\"{}\">{cell}</td>", escape(name)),
            };
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody></table>\n");
    out
}

/// The numbers of which there is one a trace.
pub(super) fn scalars(summary: &Summary) -> String {
    let rows = summary.scalars.iter().map(|s| {
        let value = |x: f64| number(x, None);
        let optional = |x: Option<String>| x.unwrap_or_else(|| "–".into());
        vec![
            quantity(&s.name).to_owned(),
            plain(&s.mean),
            optional(s.mean.error.map(|e| number(e, Some(e)))),
            optional(s.deviation.map(value)),
            value(s.min),
            value(s.max),
        ]
    });
    table("numbers", &["", "mean", "standard error", "deviation", "least", "greatest"], rows)
}

/// The quantiles of the same, each with its interval: a column for each number.
pub(super) fn quantiles(summary: &Summary) -> String {
    let mut shares: Vec<f64> = summary.scalars.iter().flat_map(|s| &s.quantiles).map(|q| q.share).collect();
    shares.sort_by(f64::total_cmp);
    shares.dedup();
    let head: Vec<&str> = std::iter::once("").chain(summary.scalars.iter().map(|s| quantity(&s.name))).collect();
    let rows = shares.iter().map(|&share| {
        let name = if share == 0.5 { "median".into() } else { format!("{} %", number(100.0 * share, None)) };
        let of = |s: &Scalar| {
            s.quantile(share).map_or_else(|| "–".into(), |value| whole(&value).unwrap_or_else(|| plain(&value)))
        };
        std::iter::once(name).chain(summary.scalars.iter().map(of)).collect()
    });
    table("numbers", &head, rows)
}

/// A number and its interval where all are whole: counts, whose digits are all known.
fn whole(e: &Estimate) -> Option<String> {
    let ends: Option<Vec<String>> = [Some(e.value), e.low, e.high]
        .into_iter()
        .map(|x| x.filter(|x| *x >= 0.0 && *x < 1e15 && x.fract() == 0.0).map(|x| count(x as u64)))
        .collect();
    ends.map(|ends| format!("{} ({}–{})", ends[0], ends[1], ends[2]))
}

/// What ropes were wound about.
pub(super) fn obstacles(summary: &Summary) -> String {
    let rows = summary.obstacles.iter().take(ROWS).map(|o| {
        vec![
            o.vertex.to_string(),
            place(o.label.as_deref(), o.at),
            count(o.walls.into()),
            percent(&o.wound),
            percent(&o.left),
            percent(&o.right),
            plain(&o.mean),
        ]
    });
    let head = ["obstacle", "at", "walls", "wound", "counter-clockwise", "clockwise", "mean times round"];
    table("numbers", &head, rows) + &left_out(summary.obstacles.len(), "obstacles")
}

/// What the ropes of each anchor say, and by how much that differs from the first.
pub(super) fn anchors(summary: &Summary) -> String {
    let or_none = |e: Option<Estimate>| e.map_or_else(|| "–".to_owned(), |e| plain(&e));
    let rows = summary.anchors.iter().flatten().map(|anchor| {
        let mean = anchor.scalars.iter().find(|scalar| scalar.name == "max_length").map(|scalar| scalar.mean);
        let differences = anchor.differences.iter().flat_map(|differences| &differences.scalars);
        let difference = differences.filter(|difference| difference.name == "max_length").find_map(|d| d.mean);
        vec![point(anchor.at), count(anchor.traces), or_none(mean), or_none(difference)]
    });
    let what = quantity("max_length");
    table("numbers", &["anchor", "traces", &format!("mean {what}"), "difference from the first"], rows)
}

/// The commonest ropes, turn by turn.
pub(super) fn ropes(summary: &Summary) -> String {
    let rows = summary.ropes.iter().enumerate().map(|(i, r)| {
        let labels = r.labels.iter().map(Option::as_deref).chain(std::iter::repeat(None));
        let turns = r.wraps.iter().zip(&r.sides).zip(labels);
        let turns = turns.map(|((&at, side), label)| format!("{} {side}", place(label, at)));
        let turns: Vec<String> = turns.collect();
        let counted =
            if r.at_most > r.count { format!("{} to {}", count(r.count), count(r.at_most)) } else { count(r.count) };
        let way = if turns.is_empty() { "straight".into() } else { turns.join(" → ") };
        vec![(i + 1).to_string(), percent(&r.share), counted, point(r.anchor), way]
    });
    table("words", &["", "share", "traces", "anchor", "turns at"], rows)
}

/// The commonest classes, and what their letters stand for.
pub(super) fn classes(found: &ClassAnswer) -> String {
    let rows = found.classes.iter().enumerate().map(|(i, c)| {
        let counted =
            if c.at_most > c.count { format!("{} to {}", count(c.count), count(c.at_most)) } else { count(c.count) };
        vec![(i + 1).to_string(), percent(&c.share), counted, point(c.anchor), c.class.clone()]
    });
    let letters = found
        .obstacles
        .iter()
        .map(|letter| vec![format!("o{}", letter.obstacle), place(letter.label.as_deref(), letter.at)]);
    let least = if found.is_complete { "" } else { "at least " };
    format!("<p class=\"note\">There are {least}{} different classes.</p>\n", count(found.distinct))
        + &table("words", &["", "share", "traces", "anchor", "class"], rows)
        + &table("words", &["letter", "its obstacle’s cut starts at"], letters)
}

/// The wall ends that ropes touch the longest.
pub(super) fn contacts(summary: &Summary) -> String {
    let rows = summary.contacts.iter().take(ROWS);
    let rows =
        rows.map(|c| vec![c.vertex.to_string(), place(c.label.as_deref(), c.at), percent(&c.share), plain(&c.wraps)]);
    table("numbers", &["wall end", "at", "share of steps", "wraps a trace"], rows)
        + &left_out(summary.contacts.len(), "wall ends")
}

/// Contacts, several in a row with one obstacle counting as one.
pub(super) fn by_obstacle(counted: &ByObstacle) -> String {
    let rows = counted.obstacles.iter().take(ROWS).map(|o| {
        let (walls, at) = (count(o.walls.into()), place(o.label.as_deref(), o.at));
        vec![o.vertex.to_string(), at, walls, percent(&o.share), plain(&o.contacts), plain(&o.turns)]
    });
    let head = ["obstacle", "at", "walls", "share of steps", "contacts a trace", "turns at the end"];
    format!(
        "<p class=\"note\">Wall ends of one obstacle that a rope touches in a row count once. A trace: {} contacts; \
         at the end of one: {} turns.</p>\n",
        plain(&counted.contacts),
        plain(&counted.turns)
    ) + &table("numbers", &head, rows)
        + &left_out(counted.obstacles.len(), "obstacles")
}

/// All that a JSON object holds, one value a row.
pub(super) fn values(value: &Value) -> String {
    let mut rows = Vec::new();
    flatten(value, "", &mut rows);
    table("words", &["", "value"], rows)
}

fn flatten(value: &Value, name: &str, rows: &mut Vec<Vec<String>>) {
    let text = match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let key = key.replace('_', " ");
                let name = if name.is_empty() { key } else { format!("{name}: {key}") };
                flatten(value, &name, rows);
            }
            return;
        }
        Value::Null => "–".into(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::String(text) => text.clone(),
        Value::Array(list) if list.is_empty() => "none".into(),
        Value::Array(list) if list.iter().all(|x| x.is_number() || x.is_string()) => {
            let text = |x: &Value| x.as_str().map_or_else(|| x.to_string(), str::to_owned);
            list.iter().map(text).collect::<Vec<_>>().join(", ")
        }
        other => other.to_string(),
    };
    rows.push(vec![name.into(), text]);
}

/// A wall end: what it is called, and where it is.
fn place(label: Option<&str>, at: [f64; 2]) -> String {
    label.map_or_else(|| point(at), |label| format!("{label} {}", point(at)))
}

fn point([x, y]: [f64; 2]) -> String {
    format!("({}, {})", number(x, None), number(y, None))
}

/// A number and its interval.
fn plain(e: &Estimate) -> String {
    super::label::estimate(e)
}

fn left_out(all: usize, what: &str) -> String {
    match all.checked_sub(ROWS) {
        None | Some(0) => String::new(),
        Some(more) => {
            format!("<p class=\"note\">{} more {what} are in <code>summary.json</code>.</p>\n", count(more as u64))
        }
    }
}
