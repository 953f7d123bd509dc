//! `tautline eval --queries`: a rope for each query of a path planner's benchmark.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use rayon::prelude::*;
use serde_json::json;
use tautline::engine::{Cpu, Engine, Job};
use tautline::queries::{Driver, Query, read_queries};
use tautline::rope::TraceRecord;
use tautline::scene::{GridMap, Model};
use tautline::stream::Files;
use tautline::trace::{Trace, settle_owned};

use super::failure::Failure;
use super::words::{counted, short};
use super::{print, print_json};

/// How far a file's length may be from that of a shortest way, in parts of it: files have six digits.
const DIGITS: f64 = 1e-4;

/// A query's answer.
struct Answer {
    query: Query,
    straight: bool,
    octile: f64,
    record: TraceRecord,
}

/// Evaluates every query in `queries` on the map in `scene`, each with its own anchor, on all cores.
pub(crate) fn run(scene: &Path, queries: &Path, out: Option<&Path>, as_json: bool) -> Result<(), Failure> {
    if scene.extension().is_none_or(|e| !e.eq_ignore_ascii_case("map")) {
        return Err(Failure::input(anyhow!("{}: --queries needs a .map: the grid that they go by", scene.display())));
    }
    let map = GridMap::read(scene)?;
    let asked = read_queries(queries, &map)?;
    let first = Arc::new(tied(&map, &asked[0], scene)?);
    let job = Job::new();
    let answer = |driver: &mut Driver<'_>, (row, query): (usize, &Query)| -> Result<Answer, Failure> {
        let model = first.tied(query.ends()[0]).map_err(|error| Failure::input(anyhow!("{error}")))?;
        let model = Arc::new(model);
        let drive = driver.drive(query, &model).ok_or_else(|| {
            let ([x, y], [to_x, to_y]) = (query.start, query.goal);
            let what = format!("query {row}: there is no way from cell ({x}, {y}) to cell ({to_x}, {to_y})");
            Failure::input(anyhow!("{}: {what}", queries.display()))
        })?;
        let settled = settle_owned(&model, Trace { id: row as u64, points: drive.points });
        if let Some(violation) = settled.violation() {
            return Err(Failure::input(anyhow!("{}: query {row}: {violation}", queries.display())));
        }
        // A query comes once, so lists of what its pivots see would not pay.
        let record = Cpu::new(model.clone()).keep_all().evaluate(&[settled], &job)?.remove(0);
        Ok(Answer { query: *query, straight: drive.straight, octile: drive.octile, record })
    };
    let answers: Vec<Answer> =
        asked.par_iter().enumerate().map_init(|| Driver::new(&map), answer).collect::<Result<_, _>>()?;
    let mut files = Files::new(out, None, &first, Vec::new());
    files.write(answers.iter().map(|answer| answer.record.clone()).collect())?;
    files.finish()?;
    if as_json { print_json(&report(scene, queries, &answers)) } else { print(&table(scene, queries, &map, &answers)) }
}

/// A rope tied at the start of a query.
fn tied(map: &GridMap, query: &Query, scene: &Path) -> Result<Model, Failure> {
    let model = Model::new(map.scene().clone(), Some(query.ends()[0]));
    model.map_err(|error| Failure::input(anyhow!("{}: {error}", scene.display())))
}

/// How many of the file's lengths are not those of shortest ways.
fn off(answers: &[Answer]) -> usize {
    answers.iter().filter(|a| (a.query.octile - a.octile).abs() > DIGITS * a.octile.max(1.0)).count()
}

fn report(scene: &Path, queries: &Path, answers: &[Answer]) -> serde_json::Value {
    let row = |(row, a): (usize, &Answer)| {
        json!({
            "query": row, "bucket": a.query.bucket, "start": a.query.start, "goal": a.query.goal,
            "octile": a.query.octile, "planned": a.octile, "straight": a.straight, "rope": a.record.length,
            "depth": a.record.depth, "events": a.record.events.len(),
        })
    };
    json!({
        "scene": scene.display().to_string(), "queries": queries.display().to_string(),
        "other_octile": off(answers), "rows": answers.iter().enumerate().map(row).collect::<Vec<_>>(),
    })
}

/// Means by bucket, and over all.
fn table(scene: &Path, queries: &Path, map: &GridMap, answers: &[Answer]) -> String {
    let mut buckets: BTreeMap<u32, Vec<&Answer>> = BTreeMap::new();
    for answer in answers {
        buckets.entry(answer.query.bucket).or_default().push(answer);
    }
    let mut text = String::new();
    let walls = counted(map.scene().walls().len() as u64, "wall", "walls");
    let straight = answers.iter().filter(|a| a.straight).count();
    let _ = writeln!(text, "map      {}: {} by {} cells, {walls}", scene.display(), map.width(), map.height());
    let count = counted(answers.len() as u64, "query", "queries");
    let _ = writeln!(text, "queries  {}: {count}, {straight} driven straight, 0 refused\n", queries.display());
    let _ =
        writeln!(text, "  bucket  queries  octile, file  octile, planned        rope  rope / octile  greatest depth");
    let mut line = |name: &str, answers: &[&Answer]| {
        let mean = |of: &dyn Fn(&Answer) -> f64| answers.iter().map(|&a| of(a)).sum::<f64>() / answers.len() as f64;
        let (file, planned, rope) = (mean(&|a| a.query.octile), mean(&|a| a.octile), mean(&|a| a.record.length));
        let ratio = if planned > 0.0 { format!("{:.4}", rope / planned) } else { "n/a".to_owned() };
        let most = answers.iter().map(|a| a.record.max_depth).max().unwrap_or(0);
        let [file, planned, rope] = [file, planned, rope].map(short);
        let _ = writeln!(text, "  {name:>6}{:>9}{file:>14}{planned:>17}{rope:>12}{ratio:>15}{most:>16}", answers.len());
    };
    for (bucket, answers) in &buckets {
        line(&bucket.to_string(), answers);
    }
    line("all", &answers.iter().collect::<Vec<_>>());
    let _ = writeln!(
        text,
        "\nmeans; lengths in cells; a rope goes from the middle of the start's cell to that of the goal's"
    );
    let off = off(answers);
    if off > 0 {
        let what = "are not those of shortest ways that cut no corner: another map, or other moves?";
        let _ = writeln!(text, "{off} of the file's lengths {what}");
    }
    text
}
