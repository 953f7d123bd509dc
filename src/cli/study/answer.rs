//! A study's answer as it is printed: the table of all kin of `tautline study run`, or JSON.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use anyhow::anyhow;
use tautline::escape::escaped;
use tautline::geometry::number;
use tautline::picture::sentence;
use tautline::scene::Scene;
use tautline::session::{RunCost, RunReport, Session};
use tautline::study::{AtWalls, Estimate, Scalar, Stopped, Study, Summary, TetherAnswer, quantity};

use crate::cli::failure::Failure;
use crate::cli::words::{counted, grouped, short};
use crate::cli::{print, print_json};

/// Prints an answer as its file has it.
pub(super) fn print_answer(summary: &Summary) -> Result<(), Failure> {
    print_json(&serde_json::to_value(summary).map_err(|e| Failure::internal(e.into()))?)
}

/// The scene that an answer is about.
fn scene(study: &Study) -> &Scene {
    study.models()[0].scene()
}

/// Writes and prints the answer. Exit code 5 if it is not as certain as was asked for.
pub(super) fn conclude(session: &Session, report: &RunReport, as_json: bool) -> Result<(), Failure> {
    let summary = session.conclude(report)?;
    tell(&summary, session.study(), report.run(), session.folder().path(), as_json)
}

/// Prints the answer that lies in `folder`. Exit code 5 if it is not as certain as was asked for.
pub(super) fn tell(
    summary: &Summary,
    study: &Study,
    run: Option<&RunCost>,
    folder: &Path,
    as_json: bool,
) -> Result<(), Failure> {
    if as_json {
        print_answer(summary)?;
    } else {
        print(&table(summary, scene(study), run))?;
        print(&format!("\nwritten to {}\n", folder.display()))?;
    }
    match (summary.study.until.relative_error, summary.stopped) {
        // A shard alone is no answer.
        (Some(wanted), Stopped::Complete | Stopped::Seconds) if summary.shard.is_none() => {
            Err(Failure::unmet(anyhow!(
                "until.relative_error: the mean greatest length is not as certain as {wanted}; more traces would help"
            )))
        }
        _ => Ok(()),
    }
}

/// What people want to see first.
pub(super) fn table(summary: &Summary, scene: &Scene, run: Option<&RunCost>) -> String {
    let mut text = tether(summary, scene);
    let mut line = |text_of: std::fmt::Arguments<'_>| {
        let _ = text.write_fmt(text_of);
        text.push('\n');
    };
    let why = match summary.stopped {
        Stopped::Complete => "all done",
        Stopped::RelativeError => "as certain as was asked for",
        Stopped::Seconds => "the time was over",
        Stopped::Unfinished => "not finished",
    };
    let traces = counted(summary.traces, "trace", "traces");
    let steps = counted(summary.steps, "step", "steps");
    let events = counted(summary.events, "event", "events");
    line(format_args!("{traces}, {steps}, {events}; {why}"));
    if let Some(missing) = &summary.missing {
        line(format_args!(
            "put together from {} alone; missing are {missing}",
            counted(summary.blocks, "block", "blocks")
        ));
    }
    if let Some(words) = standing(summary) {
        line(format_args!("{words}"));
    }
    if let Some(run) = run {
        // Those of earlier runs took other seconds.
        let rate = run.traces as f64 / run.seconds;
        line(format_args!(
            "{} on {} threads' time: {} traces/s{}",
            duration(Duration::from_secs_f64(run.seconds)),
            run.threads,
            short(rate),
            if run.tests > 0 { format!(", {} tests/s", short(run.tests_per_second)) } else { String::new() }
        ));
    }
    if let Some(traded) = &summary.traded {
        line(format_args!("traded: {}", summary.study.run.trade().words(traded)));
    }
    if let Some(scene) = run.map(|run| &run.scene)
        && let Some(&tried) = scene.remaining.iter().flatten().max()
    {
        line(format_args!("{} of {} wall ends tried", grouped(tried as u64), grouped(scene.vertices as u64)));
    }
    let confidence = 100.0 * summary.study.tallies.confidence;
    line(format_args!(
        "\n{:24}{:>10}  {:>24}{:>10}{:>10}{:>10}",
        "a trace",
        "mean",
        format!("{confidence} % interval"),
        "median",
        "95 %",
        "most"
    ));
    for scalar in &summary.scalars {
        line(format_args!("{}", figures(quantity(&scalar.name), scalar)));
    }
    if !summary.survival.is_empty() {
        line(format_args!("\nropes never longer than"));
    }
    for survival in &summary.survival {
        if let Some(last) = survival.curve.last() {
            line(format_args!(
                "  {:>10}  {:>7}  {}",
                short(survival.limit),
                percent(last.share.value),
                shares(&last.share)
            ));
        }
    }
    if !summary.obstacles.is_empty() {
        line(format_args!(
            "\nropes wound all the way round an obstacle at the end (the point about which that is counted)"
        ));
    }
    for obstacle in summary.obstacles.iter().take(5) {
        let at = format!("({}, {})", short(obstacle.at[0]), short(obstacle.at[1]));
        let at = obstacle.label.as_ref().map_or(at.clone(), |label| format!("{label} {at}"));
        line(format_args!("  {at:24}  {:>7}  {}", percent(obstacle.wound.value), shares(&obstacle.wound)));
    }
    if let Some(counted) = &summary.by_obstacle {
        line(format_args!(
            "\nby obstacle, a trace: {} contacts, {} turns at the end",
            with_interval(&counted.contacts),
            with_interval(&counted.turns)
        ));
        for touched in counted.obstacles.iter().take(5) {
            let at = format!("({}, {})", short(touched.at[0]), short(touched.at[1]));
            let at = touched.label.as_ref().map_or(at.clone(), |label| format!("{label} {at}"));
            let contacts = with_interval(&touched.contacts);
            line(format_args!("  {at:24}  {:>7} of the steps, {contacts} contacts", percent(touched.share.value)));
        }
    }
    if !summary.ropes.is_empty() {
        line(format_args!("\nmost common ropes at the end"));
    }
    for rope in summary.ropes.iter().take(5) {
        let turns = match rope.wraps.len() {
            0 => "straight".to_owned(),
            1 => "1 turn".to_owned(),
            n => format!("{n} turns"),
        };
        let names: Vec<&str> = rope.labels.iter().flatten().map(String::as_str).collect();
        let names = if names.is_empty() { String::new() } else { format!("  round {}", names.join(", ")) };
        line(format_args!("  {turns:24}  {:>7}  {}{names}", percent(rope.share.value), shares(&rope.share)));
    }
    if let Some(found) = &summary.classes {
        let least = if found.is_complete { "" } else { "at least " };
        let different = counted(found.distinct, "homotopy class", "homotopy classes");
        line(format_args!("\n{least}{different} of ropes at the end, the most common"));
        for class in found.classes.iter().take(5) {
            line(format_args!("  {:24}  {:>7}  {}", class.class, percent(class.share.value), shares(&class.share)));
        }
        for letter in &found.obstacles {
            let at = format!("({}, {})", short(letter.at[0]), short(letter.at[1]));
            let at = letter.label.as_ref().map_or(at.clone(), |label| format!("{label} {at}"));
            line(format_args!("  o{:<23} is {at}", letter.obstacle));
        }
    }
    if let Some(friction) = &summary.friction {
        line(format_args!(
            "\nfriction {}, a rope hauled at the free end, for a tension of 1 at the anchor",
            number(friction.coefficient)
        ));
        for (name, scalar) in [("greatest tension", &friction.tension), ("work of the free end", &friction.work)] {
            line(format_args!("{}", figures(name, scalar)));
        }
        for above in &friction.above {
            let tension = short(above.tension);
            line(format_args!("  above {tension:18}  {:>7} of the steps", percent(above.share.value)));
        }
    }
    for (i, anchor) in summary.anchors.iter().flatten().enumerate() {
        if i == 0 {
            line(format_args!(
                "\nmean greatest rope length by anchor, and by how much it differs from the first one's"
            ));
        }
        let at = format!("({}, {})", short(anchor.at[0]), short(anchor.at[1]));
        let mean = anchor.scalars.iter().find(|scalar| scalar.name == "max_length").map(|scalar| scalar.mean);
        let mean = mean.map_or(String::new(), |mean| format!("{:>10}  {:>24}", short(mean.value), interval(&mean)));
        let differences = anchor.differences.iter().flat_map(|differences| &differences.scalars);
        let difference = differences.filter(|d| d.name == "max_length").find_map(|d| d.mean);
        let difference = difference.map_or(String::new(), |d| format!("{:>10}  ({})", short(d.value), interval(&d)));
        line(format_args!("  {at:22}{mean}{difference}"));
    }
    text
}

/// Which share of the steps stood still, and which met a wall; `None` if there are no steps.
pub(super) fn standing(summary: &Summary) -> Option<String> {
    let still = percent(summary.still?);
    let met = match (summary.at_walls, summary.study.walk.at_walls()) {
        (Some(share), Some(AtWalls::Redraw)) => format!(", {} were drawn again at walls", percent(share)),
        (Some(share), Some(AtWalls::Reject)) => format!(", {} were not taken at walls", percent(share)),
        (Some(share), Some(AtWalls::Reflect)) => format!(", {} were thrown back at walls", percent(share)),
        _ => String::new(),
    };
    let held = summary
        .tether
        .as_ref()
        .map_or(String::new(), |tether| format!(", {} were held back by the tether", percent(tether.held_back.value)));
    Some(format!("{still} of the steps stood still{met}{held}"))
}

/// The answer in one sentence and one picture: how much of each tether's length is needed by which share of the walks.
fn tether(summary: &Summary, scene: &Scene) -> String {
    let Some(sentence) = sentence(summary, scene) else { return String::new() };
    let mut text = format!("{}\n\n", escaped(&sentence));
    if let Some(tether) = &summary.tether {
        return text + &first_held_back(tether);
    }
    let longest = summary.scalars.iter().find(|scalar| scalar.name == "max_length");
    let (quantiles, most) = longest.map_or((&[][..], 0.0), |scalar| (&scalar.quantiles[..], scalar.max));
    for quantile in quantiles {
        let length = quantile.value.value;
        let marks = if most > 0.0 { (BAR * length / most).round() as usize } else { 0 };
        let (share, length) = (format!("{} %", short_share(quantile.share)), short(length));
        text += &format!("{share:>8} of them up to {length:>10}  {}\n", "#".repeat(marks));
    }
    text.push('\n');
    text
}

/// When the tether held walks back first.
fn first_held_back(tether: &TetherAnswer) -> String {
    let mut text = String::new();
    for quantile in &tether.quantiles {
        let (share, step) = (format!("{} %", short_share(quantile.share)), short(quantile.value.value));
        text += &format!("{share:>8} of them are held back by step {step:>8}  ({})\n", interval(&quantile.value));
    }
    text += &format!("{:>8} of them never are  {}\n\n", percent(tether.never.value), shares(&tether.never));
    text
}

/// How many marks stand for the greatest length.
const BAR: f64 = 32.0;

/// A share in percent, without zeros that say nothing.
fn short_share(share: f64) -> String {
    number((1e10 * share).round() / 1e8)
}

fn with_interval(estimate: &Estimate) -> String {
    format!("{} ({})", short(estimate.value), interval(estimate))
}

/// A scalar's mean with its interval, its median, where 95 % are below, and the most.
fn figures(name: &str, scalar: &Scalar) -> String {
    let quantile = |share| scalar.quantile(share).map_or(String::new(), |quantile| short(quantile.value));
    format!(
        "{name:24}{:>10}  {:>24}{:>10}{:>10}{:>10}",
        short(scalar.mean.value),
        interval(&scalar.mean),
        quantile(0.5),
        quantile(0.95),
        short(scalar.max)
    )
}

fn interval(estimate: &Estimate) -> String {
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("{} to {}", short(low), short(high)),
        _ => "?".to_owned(),
    }
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

fn shares(estimate: &Estimate) -> String {
    match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("({} to {})", percent(low), percent(high)),
        _ => String::new(),
    }
}

/// A time in words.
pub(super) fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
