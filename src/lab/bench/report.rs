//! A bench as people read it: the [`Display`](fmt::Display) of a report is its tables.

use std::fmt;

use super::measure::{Measured, Plan, Row};
use super::setting::{Setting, Sweep};
use crate::engine::Phase;
use crate::environment::Environment;
use crate::gpu::TryingAll;
use crate::lab::surroundings::head;
use crate::words::{NONE, aligned, counted, grouped, short};

/// What came of a bench, and where and how it was made.
pub struct Report {
    /// Where.
    pub environment: Environment,
    /// What was swept over, if anything was.
    pub sweep: Option<Sweep>,
    /// The setting, or that which the sweep changes.
    pub base: Setting,
    /// How much was measured.
    pub plan: Plan,
    /// What came of it.
    pub measured: Measured,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Setting { traces, steps, seed, .. } = self.base;
        let runs = counted(self.plan.repeats as u64, "run", "runs");
        let [traces, steps] = [counted(traces, "trace", "traces"), counted(steps as u64, "step", "steps")];
        f.write_str(&head(&self.environment))?;
        writeln!(f, "work      {traces} of {steps}, seed {seed}; {runs} each, interleaved")?;
        f.write_str(&match self.sweep {
            None => side_by_side(&self.base, &self.measured.rows),
            Some(sweep) => swept(sweep, &self.base, &self.measured.rows),
        })
    }
}

/// All engines on one setting: how fast, what they did, and where the time went.
fn side_by_side(setting: &Setting, rows: &[Row]) -> String {
    let mut text = String::new();
    if let Some(row) = rows.first() {
        let (n, step) = (grouped(row.n as u64), short(setting.step));
        text += &format!("scene     {}: {n} wall ends; steps of about {step}\n\n", setting.scene.name());
    }
    let names = ["engine", "variant", "threads", "traces", "steps"];
    let name = |row: &Row| {
        let contender = row.contender;
        let [traces, steps] = [row.traces, row.steps].map(|count| grouped(count as u64));
        [contender.engine.name.to_owned(), variant(row), contender.engine.threads().to_string(), traces, steps]
    };
    text += &table(&names, &["steps/s", "ns/step", "min..max", "x note", "min..max"], rows, name, |row| {
        let [ratio, paired] = relative(row);
        [rate(row.steps_per_second()), short(row.ns_per_step.median), row.ns_per_step.to_string(), ratio, paired]
    });
    let names = ["engine", "variant"];
    let name = |row: &Row| [row.contender.engine.name.to_owned(), variant(row)];
    let columns = ["tests/step", "avoided", "tests/s", "events/step", "events/s", "doubts/step", "wrong ropes"];
    text += "\n";
    text += &table(&names, &columns, rows, name, |row| {
        let tried = row.tests_avoided_per_step.map(|avoided| [short(row.tests_per_step), short(avoided)]);
        let [tests, avoided] = tried.unwrap_or([NONE; 2].map(str::to_owned));
        let tested = row.tests_per_second().map_or(NONE.to_owned(), rate);
        let wrong = row.wrong_ropes.map_or(NONE.to_owned(), |w| grouped(w as u64));
        let doubts = row.doubts_per_step.map_or(NONE.to_owned(), short);
        [tests, avoided, tested, short(row.events_per_step), rate(row.events_per_second()), doubts, wrong]
    });
    for row in rows {
        if let (Some(peak), Some(tests), Some(share)) = (row.peak, row.tests_per_second(), row.share_of_peak()) {
            let operations = TryingAll::OPERATIONS;
            text += &format!(
                "\n{}: {} tests/s of {operations} products and sums are {:.0} % of the {}/s that the adapter does in a \
                 kernel of nothing else\n",
                row.contender.engine.name,
                short(tests),
                100.0 * share,
                short(peak)
            );
        }
    }
    let timed: Vec<Row> = rows.iter().filter(|row| row.phases.iter().any(|ns| *ns > 0.0)).cloned().collect();
    if !timed.is_empty() {
        text += "\nns/step in each phase, summed over threads\n";
        text += &table(&names, &Phase::ALL.map(Phase::name), &timed, name, |row| row.phases.map(short));
    }
    text
}

/// All engines on every value of a sweep.
fn swept(sweep: Sweep, base: &Setting, rows: &[Row]) -> String {
    let swept = match sweep {
        Sweep::Vertices => "n",
        Sweep::Batch => "batch",
        Sweep::Step => "step",
        Sweep::Window => "window",
    };
    let mut text = format!("scene     {}; sweep over {swept}\n\n", base.scene.name());
    let value = |row: &Row| match sweep {
        Sweep::Vertices => grouped(row.n as u64),
        Sweep::Batch => grouped(row.setting.traces),
        Sweep::Step => short(row.setting.step),
        Sweep::Window => grouped(row.setting.window as u64),
    };
    let name = |row: &Row| {
        let [traces, steps] = [row.traces, row.steps].map(|count| grouped(count as u64));
        [value(row), row.contender.engine.name.to_owned(), row.contender.variant.to_owned(), traces, steps]
    };
    let columns = ["steps/s", "ns/step", "min..max", "tests/step", "events/step", "x note"];
    text += &table(&[swept, "engine", "variant", "traces", "steps"], &columns, rows, name, |row| {
        let tests = row.tests_avoided_per_step.map_or(NONE.to_owned(), |_| short(row.tests_per_step));
        let [ratio, _] = relative(row);
        let (ns, events) = (row.ns_per_step, short(row.events_per_step));
        [rate(row.steps_per_second()), short(ns.median), ns.to_string(), tests, events, ratio]
    });
    text
}

/// The variant, with the widest window where that counts.
fn variant(row: &Row) -> String {
    match row.contender.window(row.setting.window) {
        Some(legs) => format!("{} to {legs}", row.contender.variant),
        None => row.contender.variant.to_owned(),
    }
}

fn relative(row: &Row) -> [String; 2] {
    row.relative.map_or([NONE; 2].map(str::to_owned), |r| [short(r.ratio), r.paired.to_string()])
}

/// A number a second, in whole ones where there are many.
fn rate(per_second: f64) -> String {
    if per_second >= 1000.0 { grouped(per_second.round() as u64) } else { short(per_second) }
}

/// Rows below a heading, all columns as wide as they need be: the first ones are names and stand on the left, the last
/// ones numbers and stand on the right.
fn table<const A: usize, const B: usize>(
    names: &[&str; A],
    numbers: &[&str; B],
    rows: &[Row],
    name: impl Fn(&Row) -> [String; A],
    number: impl Fn(&Row) -> [String; B],
) -> String {
    let heading: Vec<String> = names.iter().chain(numbers).map(|&text| text.to_owned()).collect();
    let cells = rows.iter().map(|row| name(row).into_iter().chain(number(row)).collect());
    aligned(A, &std::iter::once(heading).chain(cells).collect::<Vec<_>>())
}
