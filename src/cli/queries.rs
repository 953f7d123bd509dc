//! `tautline eval --queries`: a rope for each query of a path planner's benchmark.

use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::Job;
use tautline::queries::{Answer, QueryError, Report, answer_all, buckets, read_queries};
use tautline::scene::{GridMap, Model};
use tautline::stream::Files;

use super::failure::Failure;
use super::words::{counted, short};
use super::{print, print_json};

/// Evaluates every query in `queries` on the map in `scene`, each with its own anchor, on all cores.
pub(crate) fn run(scene: &Path, queries: &Path, out: Option<&Path>, as_json: bool) -> Result<(), Failure> {
    if scene.extension().is_none_or(|e| !e.eq_ignore_ascii_case("map")) {
        return Err(Failure::input(anyhow!("{}: --queries needs a .map: the grid that they go by", scene.display())));
    }
    let map = GridMap::read(scene)?;
    let asked = read_queries(queries, &map)?;
    let first = Model::new(map.scene().clone(), Some(asked[0].ends()[0]));
    let first = Arc::new(first.map_err(|error| Failure::input(anyhow!("{}: {error}", scene.display())))?);
    let answers = answer_all(&map, &first, &asked, &Job::new()).map_err(|error| match error {
        QueryError::Engine(error) => error.into(),
        QueryError::Anchor(error) => error.into(),
        error => Failure::input(anyhow!("{}: {error}", queries.display())),
    })?;
    let mut files = Files::new(out, None, &first, Vec::new());
    files.write(Vec::new(), answers.iter().map(|answer| answer.record.clone()).collect())?;
    files.finish()?;
    let report = Report::new(scene.display().to_string(), queries.display().to_string(), &answers);
    if as_json { print_json(&report) } else { print(&table(&report, &map, &answers)) }
}

/// Means by bucket, and over all.
fn table(report: &Report, map: &GridMap, answers: &[Answer]) -> String {
    let walls = counted(map.scene().walls().len() as u64, "wall", "walls");
    let straight = answers.iter().filter(|a| a.straight).count();
    let count = counted(answers.len() as u64, "query", "queries");
    let mut text = format!(
        "map      {}: {} by {} cells, {walls}\n\
         queries  {}: {count}, {straight} driven straight, 0 refused\n\n  \
         bucket  queries  octile, file  octile, planned        rope  rope / octile  greatest depth\n",
        report.scene,
        map.width(),
        map.height(),
        report.queries,
    );
    for bucket in buckets(answers) {
        let name = bucket.number.map_or("all".to_owned(), |number| number.to_string());
        let ratio =
            if bucket.planned > 0.0 { format!("{:.4}", bucket.rope / bucket.planned) } else { "n/a".to_owned() };
        let [file, planned, rope] = [bucket.octile, bucket.planned, bucket.rope].map(short);
        let (queries, most) = (bucket.queries, bucket.max_depth);
        text += &format!("  {name:>6}{queries:>9}{file:>14}{planned:>17}{rope:>12}{ratio:>15}{most:>16}\n");
    }
    text += "\nmeans; lengths in cells; a rope goes from the middle of the start's cell to that of the goal's\n";
    if report.other_octile > 0 {
        let what = "are not those of shortest ways that cut no corner: another map, or other moves?";
        text += &format!("{} of the file's lengths {what}\n", report.other_octile);
    }
    text
}
