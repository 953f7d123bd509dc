//! What was measured, as people read it: the [`Display`](fmt::Display) of a report is its tables.

use std::fmt;

use super::{Answer, Failed, Point, Tradeoff};
use crate::environment::Environment;
use crate::lab::surroundings::head;
use crate::words::{NONE, aligned, counted, grouped, percent, short};

/// What was measured, and where and how.
pub struct Report {
    /// Where.
    pub environment: Environment,
    /// What decided where random walls lie and walks lead.
    pub seed: u64,
    /// How often every method ran at every setting.
    pub repeats: usize,
    /// What came of it.
    pub measured: Tradeoff,
}

/// What the columns of the first table mean.
const MEANINGS: &str = "
* no other point is faster and as right. events, ropes: traces of which they differ, in all or at the end;
none of N seen: below 3/N, with 95 % confidence. funnel knows no contacts passed straight, which are events of the rest.
length: relative error at the end, over the traces.
jumps: steps that every K-th point would have taken through a wall; they are walked point by point. crossing: traces
that a simplified wall is in the way of.
";

impl fmt::Display for Report {
    /// What was measured, what it says of a study's answer, and what failed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tradeoff { scene, n, traces, steps, vouched, points, failed } = &self.measured;
        f.write_str(&head(&self.environment))?;
        writeln!(f, "scene     {scene}: {} wall ends", grouped(*n as u64))?;
        writeln!(
            f,
            "work      {}, {}; {} each, interleaved; ns per step as given, of the engine alone",
            counted(*traces as u64, "trace", "traces"),
            counted(*steps, "step", "steps"),
            counted(self.repeats as u64, "run", "runs"),
        )?;
        let vouched = counted(*vouched as u64, "trace", "traces");
        writeln!(
            f,
            "truth     the exact reference: of the first {vouched} by itself, of all by the engine cpu, which agrees\n"
        )?;
        write!(f, "{}{MEANINGS}", aligned(3, &errors(points)))?;
        f.write_str(
            "\nthe study's own answers: error of the method, ± what the sample leaves open (one standard error)\n\n",
        )?;
        write!(f, "{}\nwhat failed\n\n{}", aligned(2, &answers(points)), failures(failed))
    }
}

fn errors(points: &[Point]) -> Vec<Vec<String>> {
    let heading = [
        "",
        "method",
        "setting",
        "n",
        "traces",
        "ns/step",
        "min..max",
        "events differ",
        "ropes differ",
        "length, mean",
        "worst",
        "jumps",
        "crossing",
    ];
    let row = |p: &Point| {
        let count = |count: usize| if count == 0 { NONE.to_owned() } else { grouped(count as u64) };
        vec![
            if p.pareto { "*" } else { "" }.to_owned(),
            p.method.to_owned(),
            p.setting.to_string(),
            grouped(p.n as u64),
            grouped(p.traces as u64),
            short(p.ns_per_step.median),
            p.ns_per_step.to_string(),
            p.event_mismatch.map_or(NONE.to_owned(), |count| share(count, p.traces)),
            share(p.final_mismatch, p.traces),
            short(p.length_error.mean),
            short(p.length_error.max),
            count(p.jumps),
            count(p.crossing_traces),
        ]
    };
    std::iter::once(heading.map(str::to_owned).into()).chain(points.iter().map(row)).collect()
}

fn answers(points: &[Point]) -> Vec<Vec<String>> {
    let heading = ["method", "setting", "mean length", "", "", "mean wraps", "", ""].map(str::to_owned);
    let row = |p: &Point| {
        let mut cells = vec![p.method.to_owned(), p.setting.to_string()];
        cells.extend(answer(p.length));
        cells.extend(p.wraps.map_or([NONE; 3].map(str::to_owned), answer));
        cells
    };
    std::iter::once(heading.into()).chain(points.iter().map(row)).collect()
}

/// The answer, its error as a share of the truth, and that of the sample.
fn answer(answer: Answer) -> [String; 3] {
    let error = answer.error();
    let signed =
        if error == 0.0 { "0".to_owned() } else { format!("{}{}", if error > 0.0 { "+" } else { "" }, percent(error)) };
    [short(answer.value), signed, answer.noise().map_or(NONE.to_owned(), |noise| format!("± {}", percent(noise)))]
}

fn share(count: usize, of: usize) -> String {
    match count {
        // Of so few, three say nothing.
        0 if of <= 3 => format!("0 of {of}"),
        0 => format!("below 3/{of}"),
        _ => percent(count as f64 / of as f64),
    }
}

fn failures(failed: &[Failed]) -> String {
    if failed.is_empty() {
        return "nothing\n".to_owned();
    }
    let line =
        |f: &Failed| vec![f.method.to_owned(), f.setting.map_or(NONE.to_owned(), |s| s.to_string()), f.why.clone()];
    aligned(3, &failed.iter().map(line).collect::<Vec<_>>())
}
