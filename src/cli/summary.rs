//! What `eval` tells of a run, as a table.

use tautline::stream::{Report, Statistics};
use tautline::study::quantity;

use super::failure::Failure;
use super::words::{counted, grouped, place, short};
use super::{print, print_json};

/// How many labels the table has at the most.
const LABELS: usize = 10;

/// Prints what a run came to; with a hint, if it is to have one.
pub(super) fn finish(report: &Report, json: bool, has_hint: bool) -> Result<(), Failure> {
    if json {
        return print_json(report);
    }
    let hint = "--out FILE writes every trace's rope, --events FILE every wrap and unwrap\n";
    print(&format!("{}{}", table(report), if has_hint { hint } else { "" }))
}

/// A run in numbers.
fn table(report: &Report) -> String {
    let Report { scene, traces, steps, still, violations, seconds, tests, .. } = report;
    let tried = match scene.remaining {
        None => String::new(),
        Some(all) if all == scene.vertices => ", all of which are tried".to_owned(),
        Some(some) => format!(", {} of which a rope can turn at", grouped(some as u64)),
    };
    let mut text = format!(
        "scene    {}: {} with {} ends{tried}, anchor {}\n\
         traces   {}, {}{}\n\
         engine   {} ({}) on {}\n",
        scene.name,
        counted(scene.walls as u64, "wall", "walls"),
        grouped(scene.vertices as u64),
        place(scene.anchor.into()),
        grouped(*traces),
        counted(*steps, "step", "steps"),
        if *still > 0 { format!(", {} of which stand still", grouped(*still)) } else { String::new() },
        report.engine,
        report.precision,
        report.on,
    );
    if let Some(traded) = &report.traded {
        text += &format!("traded   {traded}\n");
    }
    if *violations > 0 {
        let what = counted(*violations, "trace crosses a wall and is marked", "traces cross walls and are marked");
        text += &format!("crossing {what}; what follows leaves them out\n");
    }
    let [wraps, unwraps] =
        [(report.wraps, "wrap", "wraps"), (report.unwraps, "unwrap", "unwraps")].map(|(n, a, b)| counted(n, a, b));
    text += &format!("events   {wraps}, {unwraps}");
    if report.counted_steps > 0 {
        let events = report.wraps + report.unwraps;
        text += &format!(", {} a step", short(events as f64 / report.counted_steps as f64));
    }
    let over = match violations {
        0 => "over all traces".to_owned(),
        _ => format!("over {}", counted(report.counted, "trace", "traces")),
    };
    text += &format!("\n\n  {over:26}{:>12}{:>12}{:>12}\n", "mean", "median", "max");
    text += &row("length", report.length);
    text += &row("max_length", report.max_length);
    text += &row("depth", report.depth);
    text += &row("max_depth", report.max_depth);
    if !report.touched.is_empty() {
        text += &format!("\n  {:50}{:>12}\n", "touched by ropes at the end", "traces");
    }
    for touched in report.touched.iter().take(LABELS) {
        text += &format!("  {:50}{:>12}\n", touched.label, grouped(touched.traces));
    }
    if let Some(more @ 1..) = report.touched.len().checked_sub(LABELS) {
        text += &format!("  and {more} more labels\n");
    }
    let written = if seconds.write > 0.0 { format!(", writing {:.2} s", seconds.write) } else { String::new() };
    let tests = if *tests > 0 { format!(", {} tests/s", short(report.tests_per_second)) } else { String::new() };
    text += &format!(
        "\n{:.2} s, {} steps/s\n\
         at the same time: reading and checking {:.2} s, evaluating {:.2} s{tests}{written}\n",
        seconds.total,
        grouped(report.steps_per_second as u64),
        seconds.prepare,
        seconds.evaluate,
    );
    text
}

fn row(name: &str, of: Option<Statistics>) -> String {
    let [mean, median, max] = of.map_or(["n/a"; 3].map(str::to_owned), |s| [s.mean, s.median, s.max].map(short));
    format!("  {:26}{mean:>12}{median:>12}{max:>12}\n", quantity(name))
}
