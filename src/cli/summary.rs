//! What `eval` tells of a run: a short table, or JSON.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use glam::DVec2;
use serde_json::{Value, json};
use tautline::engine::{Engine, Precision};
use tautline::geometry::number;
use tautline::rope::{EventKind, TraceRecord};
use tautline::scene::Model;

use tautline::stream::Times;
use tautline::study::quantity;
use tautline::trace::SettledTrace;
use tautline::trade::{Trade, Traded};

use super::spread::{Counts, Lengths, Spread};
use super::trade::words;

/// A run in numbers.
pub(crate) struct Summary {
    scene: String,
    walls: usize,
    vertices: usize,
    /// How many of them the engine tries, once it is known.
    remaining: Option<usize>,
    dropped: usize,
    anchor: [f64; 2],
    on: String,
    engine: &'static str,
    precision: &'static str,
    traces: u64,
    steps: u64,
    /// How many steps leave the free end where it is.
    still: u64,
    /// How many traces break the rules. They are in none of the numbers below: their ropes may be wrong.
    violations: u64,
    /// The steps of all others.
    counted_steps: u64,
    traded: Option<(Trade, Traded)>,
    wraps: u64,
    unwraps: u64,
    length: Lengths,
    max_length: Lengths,
    depth: Counts,
    max_depth: Counts,
    /// The label of each wall end; empty if there are none.
    labels: Vec<Option<String>>,
    /// For each label, how many ropes touch something that is called so at the end.
    touched: BTreeMap<String, u64>,
}

/// How many labels the table has at the most.
const LABELS: usize = 10;

/// How much an engine's ropes can be trusted, as reports name it: `f64` where they are wrong by design.
pub(super) fn precision(engine: &dyn Engine) -> &'static str {
    engine.precision().map_or("f64", Precision::name)
}

fn row(name: &str, spread: Option<Spread>) -> String {
    let [mean, median, max] = spread.map_or(["n/a"; 3].map(str::to_owned), |s| [s.mean, s.median, s.max].map(short));
    format!("  {:26}{mean:>12}{median:>12}{max:>12}\n", quantity(name))
}

/// Null where there is nothing to tell of.
fn json_of(spread: Option<Spread>) -> Value {
    spread.map_or(Value::Null, |spread| spread.json())
}

/// Four significant digits, in the plain way where that is short.
pub(super) fn short(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.3e}")
    }
}

/// A point, with exponents where plain digits would be many.
pub(super) fn place(point: DVec2) -> String {
    format!("({}, {})", number(point.x), number(point.y))
}

/// So many of what one and several are called.
pub(super) fn counted(count: u64, one: &str, several: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { several })
}

/// The same with plain digits.
pub(super) fn plainly(count: u64, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// What is said of walls that were dropped.
pub(super) fn dropped(walls: usize) -> String {
    counted(walls as u64, "wall of zero length was dropped", "walls of zero length were dropped")
}

/// A count with commas between its thousands.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

impl Summary {
    /// No traces so far.
    pub(crate) fn new(scene: &str, model: &Model, engine: &dyn Engine, on: String) -> Self {
        Summary {
            scene: scene.to_owned(),
            walls: model.scene().walls().len(),
            vertices: model.vertices().len(),
            remaining: None,
            dropped: model.scene().dropped(),
            anchor: model.anchor().to_array(),
            on,
            engine: engine.name(),
            precision: precision(engine),
            traces: 0,
            steps: 0,
            still: 0,
            violations: 0,
            counted_steps: 0,
            traded: None,
            wraps: 0,
            unwraps: 0,
            length: Lengths::default(),
            max_length: Lengths::default(),
            depth: Counts::default(),
            max_depth: Counts::default(),
            labels: Vec::new(),
            touched: BTreeMap::new(),
        }
    }

    /// Learns what wall ends are called, in the scene as ropes see it.
    pub(crate) fn label(&mut self, used: &Model) {
        self.labels = used.scene().labels().into_iter().map(|label| label.map(str::to_owned)).collect();
    }

    /// Counts the labels of what a rope touches at the end, each once.
    fn touch(&mut self, used: &Model, record: &TraceRecord) {
        let label = |at: &DVec2| self.labels.get(used.vertex_at(*at)? as usize)?.as_deref();
        let touched: BTreeSet<&str> = record.wraps.iter().filter_map(|(at, _)| label(at)).collect();
        for label in touched {
            match self.touched.get_mut(label) {
                Some(count) => *count += 1,
                None => drop(self.touched.insert(label.to_owned(), 1)),
            }
        }
    }

    /// The labels that most ropes touch at the end first.
    fn most_touched(&self) -> Vec<(&str, u64)> {
        let mut all: Vec<(&str, u64)> = self.touched.iter().map(|(label, count)| (label.as_str(), *count)).collect();
        all.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        all
    }

    /// Learns how many vertices the engine has tried, after the last traces.
    pub(crate) fn learn(&mut self, engine: &dyn Engine) {
        self.remaining = engine.remaining();
    }

    /// What was traded, and the scene as ropes see it.
    pub(crate) fn trade(&mut self, trade: Trade, used: &Model) {
        let (vertices, vertices_left) = (self.vertices as u64, used.vertices().len() as u64);
        self.traded = Some((trade, Traded { vertices, vertices_left, ..Traded::default() }));
    }

    /// Counts the next traces and their records in.
    pub(crate) fn add(&mut self, used: &Model, settled: &[SettledTrace], records: &[TraceRecord]) {
        if let Some((_, traded)) = &mut self.traded {
            settled.iter().for_each(|trace| traded.add(trace));
        }
        for (trace, record) in settled.iter().zip(records) {
            self.traces += 1;
            self.steps += record.steps;
            self.still += trace.still() as u64;
            if trace.violation().is_some() {
                self.violations += 1;
                continue;
            }
            if !self.labels.is_empty() {
                self.touch(used, record);
            }
            let wraps = record.events.iter().filter(|e| e.kind == EventKind::Wrap).count();
            self.counted_steps += record.steps;
            self.wraps += wraps as u64;
            self.unwraps += (record.events.len() - wraps) as u64;
            self.length.add(record.length);
            self.max_length.add(record.max_length);
            self.depth.add(record.depth);
            self.max_depth.add(record.max_depth);
        }
    }

    /// Steps a second from start to end.
    fn rate(&self, total: Duration) -> f64 {
        self.steps as f64 / total.as_secs_f64().max(1e-9)
    }

    pub(crate) fn table(&self, times: &Times, total: Duration, hint: bool) -> String {
        let anchor = place(self.anchor.into());
        let events = self.wraps + self.unwraps;
        let mut text = format!(
            "scene    {}: {} with {} ends{}, anchor {anchor}\n\
             traces   {}, {}{}\n\
             engine   {} ({}) on {}\n",
            self.scene,
            counted(self.walls as u64, "wall", "walls"),
            grouped(self.vertices as u64),
            self.tried(),
            grouped(self.traces),
            counted(self.steps, "step", "steps"),
            if self.still > 0 { format!(", {} of which stand still", grouped(self.still)) } else { String::new() },
            self.engine,
            self.precision,
            self.on,
        );
        if let Some((trade, traded)) = &self.traded {
            text += &format!("traded   {}\n", words(*trade, traded));
        }
        if self.violations > 0 {
            let what =
                counted(self.violations, "trace crosses a wall and is marked", "traces cross walls and are marked");
            text += &format!("crossing {what}; what follows leaves them out\n");
        }
        let [wraps, unwraps] =
            [(self.wraps, "wrap", "wraps"), (self.unwraps, "unwrap", "unwraps")].map(|(n, a, b)| counted(n, a, b));
        text += &format!("events   {wraps}, {unwraps}");
        if self.counted_steps > 0 {
            text += &format!(", {} a step", short(events as f64 / self.counted_steps as f64));
        }
        let over = match self.violations {
            0 => "over all traces".to_owned(),
            _ => format!("over {}", counted(self.traces - self.violations, "trace", "traces")),
        };
        text += &format!("\n\n  {over:26}{:>12}{:>12}{:>12}\n", "mean", "median", "max");
        text += &row("length", self.length.spread());
        text += &row("max_length", self.max_length.spread());
        text += &row("depth", self.depth.spread());
        text += &row("max_depth", self.max_depth.spread());
        if !self.touched.is_empty() {
            text += &format!("\n  {:50}{:>12}\n", "touched by ropes at the end", "traces");
        }
        for (label, count) in self.most_touched().into_iter().take(LABELS) {
            text += &format!("  {label:50}{:>12}\n", grouped(count));
        }
        if let Some(more @ 1..) = self.touched.len().checked_sub(LABELS) {
            text += &format!("  and {more} more labels\n");
        }
        let [prepared, evaluated, written, seconds] =
            [times.prepared, times.evaluated, times.written, total].map(|t| t.as_secs_f64());
        let written = if written > 0.0 { format!(", writing {written:.2} s") } else { String::new() };
        text += &format!(
            "\n{seconds:.2} s, {} steps/s\n\
             at the same time: reading and checking {prepared:.2} s, evaluating {evaluated:.2} s{written}\n",
            grouped(self.rate(total) as u64)
        );
        if hint {
            text += "--out FILE writes every trace's rope, --events FILE every wrap and unwrap\n";
        }
        text
    }

    /// How many of the vertices the engine tries, in words that go on.
    fn tried(&self) -> String {
        match self.remaining {
            None => String::new(),
            Some(all) if all == self.vertices => ", all of which are tried".to_owned(),
            Some(some) => format!(", {} of which a rope can turn at", grouped(some as u64)),
        }
    }

    pub(crate) fn json(&self, times: &Times, total: Duration) -> Value {
        json!({
            "scene": {
                "name": self.scene, "walls": self.walls, "vertices": self.vertices, "remaining": self.remaining,
                "dropped": self.dropped, "anchor": self.anchor,
            },
            "engine": self.engine, "precision": self.precision, "on": self.on, "version": env!("CARGO_PKG_VERSION"), "commit": env!("TAUTLINE_COMMIT"),
            "traded": self.traded.as_ref().map(|(trade, traded)| json!({
                "stride": trade.stride, "simplify": trade.simplify,
                "vertices_left": traded.vertices_left, "jumps": traded.jumps,
                "crossing_traces": traded.crossing_traces, "crossing_steps": traded.crossing_steps,
            })),
            "traces": self.traces, "steps": self.steps, "still": self.still,
            "violations": self.violations, "counted": self.traces - self.violations,
            "wraps": self.wraps, "unwraps": self.unwraps,
            "length": json_of(self.length.spread()), "max_length": json_of(self.max_length.spread()),
            "depth": json_of(self.depth.spread()), "max_depth": json_of(self.max_depth.spread()),
            "touched": self.most_touched().iter().map(|(label, traces)| json!({"label": label, "traces": traces}))
                .collect::<Vec<_>>(),
            "seconds": {
                "prepare": times.prepared.as_secs_f64(), "evaluate": times.evaluated.as_secs_f64(),
                "write": times.written.as_secs_f64(), "total": total.as_secs_f64(),
            },
            "steps_per_second": self.rate(total),
        })
    }
}
