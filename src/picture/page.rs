//! `report.html`: a study on one page.

use std::fmt::Write;

use serde_json::Value;

use super::label::{count, counted, estimate, number, percent};
use super::svg::escape;
use super::tables;
use super::tether::sentence;
use crate::scene::Scene;
use crate::study::{AtWalls, ScenePlan, Stopped, Summary};

const STYLE: &str = include_str!("page.css");

/// A page with everything in it: the answer in one sentence, the first of the pictures, what was walked in `scene`, the
/// numbers, and the other pictures, each with its title. `run` is what is known of the run itself: where and how long
/// it ran. The page needs no other file, no network and no scripts; it is dark where the reader's system is.
pub fn page(summary: &Summary, scene: &Scene, pictures: &[(String, String)], run: Option<&Value>) -> String {
    let name = escape(&name(&summary.study.scene));
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Study of {name}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>Study of {name}</h1>\n"
    );
    if let Some(sentence) = sentence(summary, scene) {
        let _ = writeln!(out, "<p class=\"answer\">{}</p>", escape(&sentence));
    }
    let (first, others) = pictures.split_at(pictures.len().min(1));
    out.push_str(&figures(first));
    out.push_str(&facts(summary));
    let confidence = number(100.0 * summary.study.tallies.confidence, None);
    let unit = scene.unit().map_or("the scene’s unit".to_owned(), escape);
    let _ = writeln!(
        out,
        "<p class=\"note\">Lengths are in {unit}. Intervals, in parentheses, hold the true value in {confidence} % of \
         all studies.</p>"
    );
    let mut section = |title: &str, there: bool, body: String| {
        if there {
            let _ = write!(out, "<section>\n<h2>{title}</h2>\n{body}</section>\n");
        }
    };
    section("Numbers", !summary.scalars.is_empty(), tables::scalars(summary));
    section("Quantiles", summary.scalars.iter().any(|s| !s.quantiles.is_empty()), tables::quantiles(summary));
    section("Pictures", !others.is_empty(), figures(others));
    section("Anchors", summary.anchors.is_some(), tables::anchors(summary));
    section("Obstacles that ropes are wound about", !summary.obstacles.is_empty(), tables::obstacles(summary));
    if let Some(counted) = &summary.by_obstacle {
        section("Contacts by obstacle", true, tables::by_obstacle(counted));
    }
    section("Commonest ropes at the end", !summary.ropes.is_empty(), tables::ropes(summary));
    if let Some(found) = &summary.classes {
        section("Commonest homotopy classes at the end", true, tables::classes(found));
    }
    section("Wall ends with the longest contacts", !summary.contacts.is_empty(), tables::contacts(summary));
    let plan = serde_json::to_value(&summary.study).unwrap_or_default();
    section("Parameters", true, tables::values(&plan));
    section("Run", run.is_some(), run.map(tables::values).unwrap_or_default());
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

/// What was computed.
fn facts(summary: &Summary) -> String {
    let stopped = match summary.stopped {
        Stopped::Complete => "all traces are done",
        Stopped::RelativeError => "the mean is as certain as was asked for",
        Stopped::Seconds => "the time was over",
        Stopped::Unfinished => "not finished",
    };
    let share = |share: Option<f64>| share.map_or("–".to_owned(), |s| format!("{} %", number(100.0 * s, None)));
    let at_walls = match summary.study.walk.at_walls() {
        Some(AtWalls::Reject) => "steps not taken at walls",
        Some(AtWalls::Reflect) => "steps thrown back at walls",
        Some(AtWalls::Redraw) | None => "steps drawn again at walls",
    };
    let facts = [
        ("traces", count(summary.traces)),
        ("steps", count(summary.steps)),
        ("steps that stood still", share(summary.still)),
        (at_walls, share(summary.at_walls)),
        ("wraps and unwraps", count(summary.events)),
        ("blocks", count(summary.blocks)),
        ("ended", stopped.into()),
        ("identity", summary.identity.clone()),
    ];
    let traded = summary.traded.iter().flat_map(|traded| {
        [
            ("wall ends left", format!("{} of {}", count(traded.vertices_left), count(traded.vertices))),
            ("longer steps not taken", count(traded.jumps)),
            ("crossing a simplified wall", counted(traded.crossing_traces, "trace", "traces")),
        ]
    });
    let tether = summary.tether.iter().flat_map(|tether| {
        let first = tether.first.map_or("–".to_owned(), |first| estimate(&first));
        [
            ("steps held back by the tether", percent(&tether.held_back)),
            ("walks never held back", percent(&tether.never)),
            ("first step held back, on average where one was", first),
        ]
    });
    let friction = summary.friction.iter().flat_map(|friction| {
        [
            ("coefficient of friction", number(friction.coefficient, None)),
            ("greatest tension, for 1 at the anchor", estimate(&friction.tension.mean)),
            ("work of the free end", estimate(&friction.work.mean)),
        ]
    });
    let visited = summary.map.as_ref().and_then(|map| map.visited).map(|visited| {
        (
            "area visited, in whole cells",
            format!("{}; inner cells {}", number(visited.area, None), number(visited.inner, None)),
        )
    });
    let mut out = String::from("<dl>\n");
    for (name, value) in facts.into_iter().chain(tether).chain(friction).chain(visited).chain(traded) {
        let _ = writeln!(out, "<div><dt>{name}</dt><dd>{}</dd></div>", escape(&value));
    }
    out.push_str("</dl>\n");
    out
}

/// The scene's name.
fn name(plan: &ScenePlan) -> String {
    let file = plan.file.as_ref().map(|f| f.display().to_string());
    plan.built_in.clone().or(file).unwrap_or_else(|| "a scene".into())
}

/// The pictures, each on a card. Their colours are made for white; the page's style turns them where it is dark.
fn figures(pictures: &[(String, String)]) -> String {
    let mut out = String::new();
    for (title, svg) in pictures {
        // Within HTML an SVG needs no name space.
        let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
        let _ = write!(
            out,
            "<figure>\n<figcaption>{}</figcaption>\n<div class=\"card\">\n{svg}</div>\n</figure>\n",
            escape(title)
        );
    }
    out
}
