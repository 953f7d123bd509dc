//! Rows as text: JSON lines and CSV.
//!
//! A number is written with the fewest digits that read back to the same f64, the same in both formats. CSV needs no
//! quotes but for labels: no other field holds a comma, a quote or a line end.

use std::io::{self, Write};

use glam::DVec2;
use serde::{Serialize, Serializer};

use super::class_columns::{self, Winding};
use super::labels::{Labels, field};
use crate::homotopy::Class;
use crate::rope::{Event, Side, TraceRecord};
use crate::trace::End;

pub(super) const RESULT_HEADER: &str =
    "trace,status,steps,length,max_length,depth,max_depth,events,wraps,sides,pull_x,pull_y";

pub(super) const EVENT_HEADER: &str = "trace,step,kind,vertex,x,y,side";

/// A result as a JSON object; the fields' order is the keys'.
#[derive(Serialize)]
struct ResultLine<'a> {
    trace: u64,
    status: &'static str,
    steps: u64,
    length: f64,
    max_length: f64,
    depth: u32,
    max_depth: u32,
    events: usize,
    #[serde(serialize_with = "positions")]
    wraps: &'a [(DVec2, Side)],
    sides: Sides<'a>,
    pull: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    labels: Option<Vec<Option<&'a str>>>,
    /// Left out where classes are not told, null for a rope without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    class: Option<Option<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    windings: Option<Option<Vec<Winding>>>,
}

/// The class of a rope, as a picture shows it, where classes are told; none if it has none.
pub(super) type Told<'a> = Option<Option<&'a Class>>;

/// What the wall ends are called at which the rope turns, where any have names.
fn names<'a>(r: &TraceRecord, labels: &'a Labels) -> Option<Vec<Option<&'a str>>> {
    (!labels.is_empty()).then(|| r.wraps.iter().map(|(at, _)| labels.at(*at)).collect())
}

fn positions<S: Serializer>(wraps: &&[(DVec2, Side)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(wraps.iter().map(|(at, _)| at.to_array()))
}

/// The sides of turns, as a picture shows them.
struct Sides<'a> {
    wraps: &'a [(DVec2, Side)],
    y_down: bool,
}

impl Sides<'_> {
    fn names(&self) -> impl Iterator<Item = &'static str> {
        self.wraps.iter().map(|(_, side)| side.shown(self.y_down).name())
    }
}

impl Serialize for Sides<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.names())
    }
}

/// An event as a JSON object; the fields' order is the keys'.
#[derive(Serialize)]
struct EventLine<'a> {
    trace: u64,
    step: u32,
    kind: &'static str,
    vertex: u32,
    x: f64,
    y: f64,
    side: &'static str,
    /// Left out where only one end moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    end: Option<&'static str>,
    /// Null where this wall end has none, left out where none has.
    #[serde(skip_serializing_if = "Option::is_none")]
    label: Option<Option<&'a str>>,
}

pub(super) fn result_json(
    out: &mut impl Write,
    y_down: bool,
    r: &TraceRecord,
    labels: &Labels,
    told: Told<'_>,
) -> io::Result<()> {
    let line = ResultLine {
        trace: r.trace,
        status: r.status.name(),
        steps: r.steps,
        length: r.length,
        max_length: r.max_length,
        depth: r.depth,
        max_depth: r.max_depth,
        events: r.events.len(),
        wraps: &r.wraps,
        sides: Sides { wraps: &r.wraps, y_down },
        pull: r.pull.map(|p| p.to_array()),
        labels: names(r, labels),
        class: told.map(|class| class.map(Class::to_string)),
        windings: told.map(|class| class.map(class_columns::windings)),
    };
    serde_json::to_writer(&mut *out, &line)?;
    out.write_all(b"\n")
}

pub(super) fn result_csv(
    out: &mut impl Write,
    y_down: bool,
    r: &TraceRecord,
    labels: &Labels,
    told: Told<'_>,
) -> io::Result<()> {
    write!(out, "{},{},{},", r.trace, r.status.name(), r.steps)?;
    number(out, r.length)?;
    out.write_all(b",")?;
    number(out, r.max_length)?;
    write!(out, ",{},{},{},", r.depth, r.max_depth, r.events.len())?;
    for (i, (at, _)) in r.wraps.iter().enumerate() {
        out.write_all(if i == 0 { b"" } else { b";" })?;
        number(out, at.x)?;
        out.write_all(b" ")?;
        number(out, at.y)?;
    }
    out.write_all(b",")?;
    for (i, side) in (Sides { wraps: &r.wraps, y_down }).names().enumerate() {
        out.write_all(if i == 0 { b"" } else { b";" })?;
        out.write_all(side.as_bytes())?;
    }
    out.write_all(b",")?;
    if let Some(pull) = r.pull {
        number(out, pull.x)?;
        out.write_all(b",")?;
        number(out, pull.y)?;
    } else {
        out.write_all(b",")?;
    }
    if let Some(names) = names(r, labels) {
        out.write_all(b",")?;
        // A label may hold whatever a list of them could be parted by.
        field(out, &serde_json::to_string(&names)?)?;
    }
    if let Some(class) = told {
        class_columns::csv(out, class)?;
    }
    out.write_all(b"\n")
}

/// An event as rows have it.
pub(super) struct Row<'a> {
    pub trace: u64,
    pub event: &'a Event,
    /// At which end it happened, where both move.
    pub end: Option<End>,
    /// Where the vertex stands.
    pub at: DVec2,
    /// Whether the scene's y points down.
    pub y_down: bool,
    /// Where the scene's wall ends have labels: that of the vertex, if it has one.
    pub label: Option<Option<&'a str>>,
}

impl Row<'_> {
    /// The side as a picture shows it.
    pub(super) fn side(&self) -> &'static str {
        self.event.side.shown(self.y_down).name()
    }
}

pub(super) fn event_json(out: &mut impl Write, row: &Row<'_>) -> io::Result<()> {
    let Row { trace, at, label, .. } = *row;
    let Event { step, kind, vertex, .. } = *row.event;
    let (kind, end) = (kind.name(), row.end.map(End::name));
    let line = EventLine { trace, step, kind, vertex, x: at.x, y: at.y, side: row.side(), end, label };
    serde_json::to_writer(&mut *out, &line)?;
    out.write_all(b"\n")
}

pub(super) fn event_csv(out: &mut impl Write, row: &Row<'_>) -> io::Result<()> {
    let Event { step, kind, vertex, .. } = *row.event;
    write!(out, "{},{step},{},{vertex},", row.trace, kind.name())?;
    number(out, row.at.x)?;
    out.write_all(b",")?;
    number(out, row.at.y)?;
    write!(out, ",{}", row.side())?;
    if let Some(end) = row.end {
        write!(out, ",{}", end.name())?;
    }
    if let Some(label) = row.label {
        out.write_all(b",")?;
        field(out, label.unwrap_or_default())?;
    }
    out.write_all(b"\n")
}

pub(super) fn number(out: &mut impl Write, x: f64) -> io::Result<()> {
    Ok(serde_json::to_writer(out, &x)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_f64() {
        let mut text = Vec::new();
        let mut state = 3u64;
        let random = std::iter::repeat_with(|| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            f64::from_bits(state ^ state >> 29)
        });
        let special = [0.0, -0.0, 1.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, f64::EPSILON, 0.1 + 0.2, 1e21, 1e-7, 1e16];
        for x in special.into_iter().chain(random.take(20_000)).filter(|x| x.is_finite()) {
            text.clear();
            number(&mut text, x).unwrap();
            let text = std::str::from_utf8(&text).unwrap();
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), x.to_bits(), "{text}");
            assert_eq!(serde_json::from_str::<f64>(text).unwrap().to_bits(), x.to_bits(), "{text}");
            assert!(text.contains(['.', 'e']), "{text} would read back as an integer");
        }
    }
}
