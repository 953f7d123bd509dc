//! What `eval` tells of a batch: a short table, or JSON.

use std::time::Duration;

use serde_json::{Value, json};
use tautline::rope::{EventKind, Status, TraceRecord};
use tautline::scene::Model;

/// A batch in numbers.
pub(crate) struct Summary {
    scene: String,
    walls: usize,
    vertices: usize,
    dropped: usize,
    anchor: [f64; 2],
    on: String,
    engine: &'static str,
    traces: usize,
    steps: u64,
    violations: usize,
    wraps: u64,
    unwraps: u64,
    length: Spread,
    max_length: Spread,
    depth: Spread,
    max_depth: Spread,
    prepared: Duration,
    evaluated: Duration,
}

/// Mean, median and maximum over the traces.
struct Spread {
    mean: f64,
    median: f64,
    max: f64,
}

impl Spread {
    fn of(records: &[TraceRecord], value: impl Fn(&TraceRecord) -> f64) -> Self {
        let mut values: Vec<f64> = records.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let n = values.len();
        if n == 0 {
            return Spread { mean: 0.0, median: 0.0, max: 0.0 };
        }
        let median = (values[(n - 1) / 2] + values[n / 2]) / 2.0;
        Spread { mean: values.iter().sum::<f64>() / n as f64, median, max: values[n - 1] }
    }

    fn row(&self, name: &str) -> String {
        format!("  {name:26}{:>12}{:>12}{:>12}\n", short(self.mean), short(self.median), short(self.max))
    }

    fn json(&self) -> Value {
        json!({"mean": self.mean, "median": self.median, "max": self.max})
    }
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
    pub(crate) fn new(
        scene: &str,
        model: &Model,
        (engine, on): (&'static str, String),
        records: &[TraceRecord],
        prepared: Duration,
        evaluated: Duration,
    ) -> Self {
        let count =
            |kind| -> u64 { records.iter().map(|r| r.events.iter().filter(|e| e.kind == kind).count() as u64).sum() };
        Summary {
            scene: scene.to_owned(),
            walls: model.scene().walls().len(),
            vertices: model.vertices().len(),
            dropped: model.scene().dropped(),
            anchor: model.anchor().to_array(),
            on,
            engine,
            traces: records.len(),
            steps: records.iter().map(|r| r.steps).sum(),
            violations: records.iter().filter(|r| r.status == Status::Violation).count(),
            wraps: count(EventKind::Wrap),
            unwraps: count(EventKind::Unwrap),
            length: Spread::of(records, |r| r.length),
            max_length: Spread::of(records, |r| r.max_length),
            depth: Spread::of(records, |r| f64::from(r.depth)),
            max_depth: Spread::of(records, |r| f64::from(r.max_depth)),
            prepared,
            evaluated,
        }
    }

    fn rate(&self) -> f64 {
        self.steps as f64 / self.evaluated.as_secs_f64().max(1e-9)
    }

    pub(crate) fn table(&self, hint: bool) -> String {
        let [x, y] = self.anchor;
        let events = self.wraps + self.unwraps;
        let mut text = format!(
            "scene    {}: {} walls with {} ends, anchor ({x}, {y})\n\
             traces   {}, {} steps\n\
             engine   {} on {}\n",
            self.scene,
            grouped(self.walls as u64),
            grouped(self.vertices as u64),
            grouped(self.traces as u64),
            grouped(self.steps),
            self.engine,
            self.on,
        );
        if self.violations > 0 {
            text += &format!("crossing {} traces cross walls and are marked\n", grouped(self.violations as u64));
        }
        text += &format!("events   {} wraps, {} unwraps", grouped(self.wraps), grouped(self.unwraps));
        if self.steps > 0 {
            text += &format!(", {} a step", short(events as f64 / self.steps as f64));
        }
        text += &format!("\n\n  {:26}{:>12}{:>12}{:>12}\n", "over all traces", "mean", "median", "max");
        text += &self.length.row("rope length at the end");
        text += &self.max_length.row("longest rope on the way");
        text += &self.depth.row("contacts at the end");
        text += &self.max_depth.row("most contacts on the way");
        text += &format!(
            "\nread and checked in {:.2} s; evaluated in {:.2} s, {} steps/s\n",
            self.prepared.as_secs_f64(),
            self.evaluated.as_secs_f64(),
            grouped(self.rate() as u64)
        );
        if hint {
            text += "--out FILE writes every trace's rope, --events FILE every wrap and unwrap\n";
        }
        text
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "scene": {"name": self.scene, "walls": self.walls, "vertices": self.vertices, "dropped": self.dropped, "anchor": self.anchor},
            "engine": self.engine, "on": self.on, "version": env!("CARGO_PKG_VERSION"),
            "traces": self.traces, "steps": self.steps, "violations": self.violations,
            "wraps": self.wraps, "unwraps": self.unwraps,
            "length": self.length.json(), "max_length": self.max_length.json(),
            "depth": self.depth.json(), "max_depth": self.max_depth.json(),
            "seconds": {"prepare": self.prepared.as_secs_f64(), "evaluate": self.evaluated.as_secs_f64()},
            "steps_per_second": self.rate(),
        })
    }
}
