//! A bench as tables.

use tautline::engine::Phase;
use tautline::environment::Environment;
use tautline::lab::Spread;
use tautline::lab::bench::{Plan, Row, Setting, Sweep};

use super::super::words::{counted, grouped, short};

/// What stands where there is no number.
const NONE: &str = "-";

/// All engines on one setting: how fast, what they did, and where the time went.
pub(super) fn bench(environment: &Environment, setting: &Setting, plan: &Plan, rows: &[Row]) -> String {
    let mut text = head(environment, setting, plan);
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
        [rate(row.steps_per_second()), short(row.ns_per_step.median), range(row.ns_per_step), ratio, paired]
    });
    let names = ["engine", "variant"];
    let name = |row: &Row| [row.contender.engine.name.to_owned(), variant(row)];
    let columns = ["tests/step", "avoided", "events/step", "events/s", "wrong ropes"];
    text += "\n";
    text += &table(&names, &columns, rows, name, |row| {
        let tried = row.tests_avoided_per_step.map(|avoided| [short(row.tests_per_step), short(avoided)]);
        let [tests, avoided] = tried.unwrap_or([NONE; 2].map(str::to_owned));
        let wrong = row.wrong_ropes.map_or(NONE.to_owned(), |w| grouped(w as u64));
        [tests, avoided, short(row.events_per_step), rate(row.events_per_second()), wrong]
    });
    let timed: Vec<Row> = rows.iter().filter(|row| row.phases.iter().any(|ns| *ns > 0.0)).cloned().collect();
    if !timed.is_empty() {
        text += "\nns/step in each phase, summed over threads\n";
        text += &table(&names, &Phase::ALL.map(Phase::name), &timed, name, |row| row.phases.map(short));
    }
    text
}

/// All engines on every value of a sweep.
pub(super) fn sweep(environment: &Environment, sweep: Sweep, base: &Setting, plan: &Plan, rows: &[Row]) -> String {
    let mut text = head(environment, base, plan);
    let swept = match sweep {
        Sweep::Vertices => "n",
        Sweep::Batch => "batch",
        Sweep::Step => "step",
        Sweep::Window => "window",
    };
    text += &format!("scene     {}; sweep over {swept}\n\n", base.scene.name());
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
        [rate(row.steps_per_second()), short(ns.median), range(ns), tests, events, ratio]
    });
    text
}

fn head(environment: &Environment, setting: &Setting, plan: &Plan) -> String {
    let adapter = environment.adapter.as_ref().map_or("none".to_owned(), ToString::to_string);
    format!(
        "machine   {}, {} threads; {}\n\
         adapter   {adapter}\n\
         work      {} traces of {} steps, seed {}; {} each, interleaved\n",
        environment.processor,
        environment.threads,
        environment.os,
        grouped(setting.traces),
        grouped(setting.steps as u64),
        setting.seed,
        counted(plan.repeats as u64, "run", "runs"),
    )
}

/// The variant, with the widest window where that counts.
fn variant(row: &Row) -> String {
    match row.contender.window(row.setting.window) {
        Some(legs) => format!("{} to {legs}", row.contender.variant),
        None => row.contender.variant.to_owned(),
    }
}

fn relative(row: &Row) -> [String; 2] {
    row.relative.map_or([NONE; 2].map(str::to_owned), |r| [short(r.ratio), range(r.paired)])
}

pub(in crate::cli) fn range(spread: Spread) -> String {
    format!("{}..{}", short(spread.min), short(spread.max))
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

/// Lines of as many cells, all columns as wide as they need be: the first `left` stand on the left, the others on the
/// right.
pub(in crate::cli) fn aligned(left: usize, lines: &[Vec<String>]) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let padded = line.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column < left {
            true => format!("{cell:width$}"),
            false => format!("{cell:>width$}"),
        });
        text += padded.collect::<Vec<_>>().join("  ").trim_end();
        text.push('\n');
    }
    text
}
