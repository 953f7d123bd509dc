//! Queries of path planners' benchmarks: MovingAI's `.scen` files, and how each is driven.
//!
//! A query asks for a way between two cells of a [`GridMap`]. Here its rope is tied in the middle of the start's cell,
//! and its free end is dragged to the middle of the goal's: straight where no wall is touched, else along a shortest
//! way from cell to cell ([`Driver`]). The file's own length of that way is there to compare with.
//!
//! The format: Sturtevant, "Benchmarks for grid-based pathfinding", IEEE Trans. Comput. Intell. AI Games 4, 2012.

mod answer;
mod drive;

use std::path::Path;

use glam::DVec2;

use crate::read_error::{Fault, Place, ReadError};
use crate::read_file::{SCENE_MAX, read_text};
use crate::scene::GridMap;
use crate::words::plainly;

pub use answer::{Answer, Bucket, QueryError, Report, Row, answer_all, buckets};
pub use drive::{Drive, Driver};

/// One row of a `.scen` file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Query {
    /// The class of queries of about the same length to which it belongs.
    pub bucket: u32,
    /// The start's column and row.
    pub start: [usize; 2],
    /// The goal's column and row.
    pub goal: [usize; 2],
    /// The length of a shortest way from cell to cell that the file gives, in cells: straight moves are 1 long,
    /// diagonal ones, which need both cells beside them free, the square root of 2.
    pub octile: f64,
}

impl Query {
    /// The middle of the start's cell and that of the goal's, in the map's frame.
    pub fn ends(&self) -> [DVec2; 2] {
        [self.start, self.goal].map(middle)
    }
}

/// The middle of a cell.
fn middle([column, row]: [usize; 2]) -> DVec2 {
    DVec2::new(column as f64 + 0.5, row as f64 + 0.5)
}

/// Reads the queries in `path` for `map`.
///
/// A first line `version ...` may stand there; each further line that is not empty has nine columns with white space
/// between them: bucket, map, the map's width and height, the start's column and row, the goal's column and row, the
/// octile length. O(lines).
///
/// # Errors
///
/// A file that cannot be opened; with its line, a row that is none, one for a map of another size, one of which the
/// start or the goal is blocked or outside of the map. A file without queries.
pub fn read_queries(path: &Path, map: &GridMap) -> Result<Vec<Query>, ReadError> {
    parse(&read_text(path, SCENE_MAX)?, map).map_err(|fault| fault.in_file(path))
}

fn parse(text: &str, map: &GridMap) -> Result<Vec<Query>, Fault> {
    let mut queries = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        if text.trim().is_empty() || (queries.is_empty() && text.starts_with("version")) {
            continue;
        }
        queries.push(query(text, map).map_err(|what| Fault::new(Place::line(line), what))?);
    }
    if queries.is_empty() {
        return Err(Fault::new(Place::default(), "no queries; each is a line of nine columns"));
    }
    Ok(queries)
}

/// The query in a line, or what is wrong with it.
fn query(text: &str, map: &GridMap) -> Result<Query, String> {
    let columns: Vec<&str> = text.split_whitespace().collect();
    let &[bucket, _, width, height, x, y, to_x, to_y, octile] = columns.as_slice() else {
        let what = "a query has nine: bucket, map, width, height, start x, start y, goal x, goal y, octile length";
        return Err(format!("{}; {what}", plainly(columns.len() as u64, "column", "columns")));
    };
    let whole = |name: &str, text: &str| {
        text.parse::<usize>().map_err(|_| format!("{name} {text:?}; it must be a whole number from 0 on"))
    };
    let size = [whole("width", width)?, whole("height", height)?];
    if size != [map.width(), map.height()] {
        let [w, h] = size;
        let what = "scaled queries are not read; give the map for which they were made";
        return Err(format!(
            "a query for a map of {w} by {h} cells; this one has {} by {}; {what}",
            map.width(),
            map.height()
        ));
    }
    let cell = |name: &str, x: &str, y: &str| {
        let [column, row] = [whole(name, x)?, whole(name, y)?];
        if map.is_blocked(column, row) {
            let is_there = column < map.width() && row < map.height();
            let what = if is_there { "is blocked" } else { "lies outside of the map" };
            return Err(format!("the {name}'s cell ({column}, {row}) {what}"));
        }
        Ok([column, row])
    };
    let octile = octile.parse().ok().filter(|&length: &f64| length >= 0.0 && length.is_finite());
    Ok(Query {
        bucket: bucket.parse().map_err(|_| format!("bucket {bucket:?}; it must be a whole number from 0 on"))?,
        start: cell("start", x, y)?,
        goal: cell("goal", to_x, to_y)?,
        octile: octile.ok_or_else(|| format!("octile length {:?}; it must be a number from 0 on", columns[8]))?,
    })
}
