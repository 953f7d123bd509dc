//! What was measured, as tables.

use tautline::environment::Environment;
use tautline::lab::tradeoff::{Answer, Failed, Point, Tradeoff};

use crate::cli::bench::table::{aligned, range};
use crate::cli::words::{counted, grouped, short};

/// What stands where there is no number.
const NONE: &str = "-";

/// What was measured, what it says of a study's answer, and what failed.
pub(super) fn report(environment: &Environment, repeats: u32, measured: &Tradeoff, hint: bool) -> String {
    let mut text = head(environment, repeats, measured);
    text += &aligned(3, &errors(&measured.points));
    text += "\n* no other point is faster and as right. events, ropes: traces of which they differ, in all or at the \
        end;\n";
    text += "none of N seen: below 3/N, with 95 % confidence. funnel knows no contacts passed straight, which are \
        events of the rest.\n";
    text += "length: relative error at the end, over the traces.\n";
    text += "jumps: steps that every K-th point would have taken through a wall; they are walked point by point. \
        crossing: traces\n\
             that a simplified wall is in the way of.\n";
    text += "\nthe study's own answers: error of the method, ± what the sample leaves open (one standard error)\n\n";
    text += &aligned(2, &answers(&measured.points));
    text += "\nwhat failed\n\n";
    text += &failures(measured);
    if hint {
        text += "\n--out FILE draws the diagram\n";
    }
    text
}

fn head(environment: &Environment, repeats: u32, measured: &Tradeoff) -> String {
    let adapter = environment.adapter.as_ref().map_or("none".to_owned(), ToString::to_string);
    format!(
        "machine   {}, {} threads; {}\n\
         adapter   {adapter}\n\
         scene     {}: {} wall ends\n\
         work      {}, {}; {} each, interleaved; ns per step as given, of the engine alone\n\
         truth     the exact reference: of the first {} by itself, of all by the engine cpu, which agrees\n\n",
        environment.processor,
        environment.threads,
        environment.os,
        measured.scene,
        grouped(measured.n as u64),
        counted(measured.traces as u64, "trace", "traces"),
        counted(measured.steps, "step", "steps"),
        counted(repeats.into(), "run", "runs"),
        counted(measured.vouched as u64, "trace", "traces"),
    )
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
            range(p.ns_per_step),
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

fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

fn share(count: usize, of: usize) -> String {
    match count {
        // Of so few, three say nothing.
        0 if of <= 3 => format!("0 of {of}"),
        0 => format!("below 3/{of}"),
        _ => percent(count as f64 / of as f64),
    }
}

fn failures(measured: &Tradeoff) -> String {
    if measured.failed.is_empty() {
        return "nothing\n".to_owned();
    }
    let line =
        |f: &Failed| vec![f.method.to_owned(), f.setting.map_or(NONE.to_owned(), |s| s.to_string()), f.why.clone()];
    aligned(3, &measured.failed.iter().map(line).collect::<Vec<_>>())
}
