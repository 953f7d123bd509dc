//! What becomes of queries: a rope for each.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Driver, Query};
use crate::engine::{Cpu, Engine, EngineError, Job};
use crate::rope::TraceRecord;
use crate::scene::{AnchorError, GridMap, Model};
use crate::trace::{Trace, Violation, settle_owned};

/// How far a file's length may be from that of a shortest way, in parts of it: files have six digits.
const DIGITS: f64 = 1e-4;

/// A query's answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The query.
    pub query: Query,
    /// Whether the free end went straight.
    pub straight: bool,
    /// The length of a shortest way from cell to cell, in cells.
    pub octile: f64,
    /// The rope.
    pub record: TraceRecord,
}

/// Why queries have no answers. Rows are counted from 0.
#[derive(Debug, thiserror::Error)]
pub enum QueryError {
    /// A rope cannot be tied at the start.
    #[error(transparent)]
    Anchor(#[from] AnchorError),
    /// The goal cannot be reached.
    #[error("query {row}: there is no way from cell ({}, {}) to cell ({}, {})", start[0], start[1], goal[0], goal[1])]
    NoWay {
        /// Which query.
        row: usize,
        /// Its start.
        start: [usize; 2],
        /// Its goal.
        goal: [usize; 2],
    },
    /// The way crosses a wall, which none should.
    #[error("query {row}: {violation}")]
    Violation {
        /// Which query.
        row: usize,
        /// Where.
        #[source]
        violation: Box<Violation>,
    },
    /// The ropes cannot be evaluated, or the job was stopped.
    #[error(transparent)]
    Engine(#[from] EngineError),
}

/// Answers every query on `map`, each with its own anchor, on all cores; `tied` is any model of the map's scene. The
/// trace of each record is the query's row.
///
/// # Errors
///
/// A query that has no answer, and a job that was stopped.
pub fn answer_all(map: &GridMap, tied: &Model, queries: &[Query], job: &Job) -> Result<Vec<Answer>, QueryError> {
    let answer = |driver: &mut Driver<'_>, (row, query): (usize, &Query)| {
        let model = Arc::new(tied.tied(query.ends()[0])?);
        let (start, goal) = (query.start, query.goal);
        let drive = driver.drive(query, &model).ok_or(QueryError::NoWay { row, start, goal })?;
        let settled = settle_owned(&model, Trace { id: row as u64, points: drive.points });
        if let Some(&violation) = settled.violation() {
            return Err(QueryError::Violation { row, violation: Box::new(violation) });
        }
        // A query comes once, so lists of what its pivots see would not pay.
        let record = Cpu::new(model).keep_all().evaluate(&[settled], job)?.remove(0);
        Ok(Answer { query: *query, straight: drive.straight, octile: drive.octile, record })
    };
    queries.par_iter().enumerate().map_init(|| Driver::new(map), answer).collect()
}

/// Answers as a document.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Report {
    /// The map.
    pub scene: String,
    /// The file of queries.
    pub queries: String,
    /// How many of the file's lengths are not those of shortest ways.
    pub other_octile: usize,
    /// A row a query.
    pub rows: Vec<Row>,
}

/// A query and its answer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Row {
    /// The query's number, from 0 on.
    pub query: usize,
    /// Its bucket.
    pub bucket: u32,
    /// The start's column and row.
    pub start: [usize; 2],
    /// The goal's column and row.
    pub goal: [usize; 2],
    /// The length that the file gives, in cells.
    pub octile: f64,
    /// That of a shortest way from cell to cell.
    pub planned: f64,
    /// Whether the free end went straight.
    pub straight: bool,
    /// The rope's length at the end, in cells.
    pub rope: f64,
    /// The number of its turns.
    pub depth: u32,
    /// How many wraps and unwraps there were.
    pub events: usize,
}

impl Report {
    /// The answers to the queries in a file, on the map in another.
    pub fn new(scene: String, queries: String, answers: &[Answer]) -> Self {
        let row = |(query, a): (usize, &Answer)| Row {
            query,
            bucket: a.query.bucket,
            start: a.query.start,
            goal: a.query.goal,
            octile: a.query.octile,
            planned: a.octile,
            straight: a.straight,
            rope: a.record.length,
            depth: a.record.depth,
            events: a.record.events.len(),
        };
        let is_other = |a: &&Answer| (a.query.octile - a.octile).abs() > DIGITS * a.octile.max(1.0);
        let other_octile = answers.iter().filter(is_other).count();
        Report { scene, queries, other_octile, rows: answers.iter().enumerate().map(row).collect() }
    }

    /// The JSON Schema of such documents.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Report).to_value()
    }
}

/// Queries of about the same length: means, in cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Bucket {
    /// Its number; `None` for all queries.
    pub number: Option<u32>,
    /// How many queries.
    pub queries: usize,
    /// The length that the file gives.
    pub octile: f64,
    /// That of a shortest way from cell to cell.
    pub planned: f64,
    /// The rope's length at the end.
    pub rope: f64,
    /// The greatest number of turns that any of the ropes ever had.
    pub max_depth: u32,
}

/// The buckets of these answers in order, then all of them. O(answers).
pub fn buckets(answers: &[Answer]) -> Vec<Bucket> {
    let mut buckets: BTreeMap<u32, Vec<&Answer>> = BTreeMap::new();
    for answer in answers {
        buckets.entry(answer.query.bucket).or_default().push(answer);
    }
    let all = answers.iter().collect();
    buckets.into_iter().map(|(n, part)| (Some(n), part)).chain([(None, all)]).map(Bucket::of).collect()
}

impl Bucket {
    fn of((number, answers): (Option<u32>, Vec<&Answer>)) -> Self {
        let mean = |of: &dyn Fn(&Answer) -> f64| answers.iter().map(|&a| of(a)).sum::<f64>() / answers.len() as f64;
        Bucket {
            number,
            queries: answers.len(),
            octile: mean(&|a| a.query.octile),
            planned: mean(&|a| a.octile),
            rope: mean(&|a| a.record.length),
            max_depth: answers.iter().map(|a| a.record.max_depth).max().unwrap_or(0),
        }
    }
}
