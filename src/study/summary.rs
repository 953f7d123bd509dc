//! A study's answer: what `summary.json` holds. The same study gives the same bytes, wherever and in however many parts it
//! was computed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::plan::Plan;
use crate::trade::Traded;

/// The answer. Lengths are in the scene's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Summary {
    /// The study, with everything that its file left out.
    pub study: Plan,
    /// A hash of all that the answer depends on: the study, the scene and the traces given.
    pub identity: String,
    /// How many traces the answer is made of.
    pub traces: u64,
    /// How many steps they have together.
    pub steps: u64,
    /// The share of the steps that left the free end where it was; `None` where there are no steps.
    pub still: Option<f64>,
    /// The share of the steps that met a wall or the scene's border as they were drawn first, so that they were drawn again,
    /// not taken or thrown back, as `study.walk.at_walls` says; `None` for walks that have no such steps.
    pub at_walls: Option<f64>,
    /// How many wraps and unwraps there were.
    pub events: u64,
    /// How many blocks are in it.
    pub blocks: u64,
    /// Why no more blocks are.
    pub stopped: Stopped,
    /// What it came to that accuracy was given for speed, if it was; `study.run` says how.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traded: Option<Traded>,
    /// Which shard this is, `K/N` with K from 0; `None` for the whole study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<String>,
    /// One number a trace: its distribution over the traces.
    pub scalars: Vec<Scalar>,
    /// Histograms of the rope length at the end and of the greatest.
    pub histograms: Vec<Histogram>,
    /// For each limit, when the rope became longer.
    pub survival: Vec<Survival>,
    /// The obstacles that ropes were wound about at the end, the most often first.
    pub obstacles: Vec<Obstacle>,
    /// The most common taut ropes at the end, the most common first.
    pub ropes: Vec<CommonRope>,
    /// The wall ends with which ropes had contacts, those with the greatest share of steps first, at most a thousand.
    pub contacts: Vec<Contact>,
    /// The plane.
    pub map: Option<Map>,
}

impl Summary {
    /// The JSON Schema of `summary.json`; its descriptions say what each field means, and how bins and cells are numbered.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(Summary).to_value()
    }
}

/// Why a study ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// All traces are done; of a shard, all its own.
    Complete,
    /// The mean is as certain as was asked for.
    RelativeError,
    /// The time was over.
    Seconds,
    /// It has not ended.
    Unfinished,
}

/// A number with its uncertainty: the true value lies between `low` and `high` as often as the study's confidence says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// The best guess.
    pub value: f64,
    /// Its standard error; `None` where too little was seen to say.
    pub error: Option<f64>,
    /// The lower end of the interval; `None` where too little was seen to say.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
}

/// The distribution of one number a trace.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Scalar {
    /// `length`, `max_length`, `depth`, `max_depth`, `wraps` or `unwraps`.
    pub name: String,
    /// The mean over the traces.
    pub mean: Estimate,
    /// The standard deviation over the traces.
    pub deviation: Option<f64>,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
    /// Quantiles. Those of counts are exact; those of lengths are the middles of classes that are at most a 128th of the
    /// lengths in them wide, so within 0.4 %.
    pub quantiles: Vec<Quantile>,
}

/// What a scalar or a histogram of this name is about, in the words of every table, picture and page: those of the glossary
/// in `docs/studies.md`.
///
/// ```
/// assert_eq!(tautline::study::quantity("max_depth"), "greatest depth");
/// ```
pub fn quantity(name: &str) -> &str {
    match name {
        "length" => "rope length at the end",
        "max_length" => "greatest rope length",
        "depth" => "depth at the end",
        "max_depth" => "greatest depth",
        other => other,
    }
}

/// A quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Quantile {
    /// Which share of the traces lies below.
    pub share: f64,
    /// The quantile. It has no standard error of its own.
    pub value: Estimate,
}

/// How many traces have which value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Histogram {
    /// `length` or `max_length`.
    pub name: String,
    /// How wide a bin is, in the scene's unit: bin i is from i times this up to i + 1 times this.
    pub width: f64,
    /// The bins that are not empty, in order.
    pub bins: Vec<Bin>,
}

/// A bin of a histogram.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bin {
    /// Its number, counted from 0: bin i holds the lengths from i times `width` up to i + 1 times `width`, the latter left out.
    pub bin: u64,
    /// How many traces are in it.
    pub count: u64,
    /// Which share of all traces that is.
    pub share: Estimate,
}

/// Which share of the ropes was never longer than a limit, step by step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Survival {
    /// The limit.
    pub limit: f64,
    /// At how many steps the curve is given, and what it is there: the share of traces whose rope was never longer than
    /// the limit up to that step.
    pub curve: Vec<SurvivalPoint>,
}

/// A point of a survival curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurvivalPoint {
    /// The step.
    pub step: u64,
    /// The share.
    pub share: Estimate,
}

/// Walls that hang together by common ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Obstacle {
    /// Its number: the lowest of its wall ends' numbers.
    pub vertex: u32,
    /// The point about which the times round are counted: the middle of the first of its walls, x and y.
    pub at: [f64; 2],
    /// What the scene's file calls it: the label of that wall end, or of the first of its wall ends that has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// How many walls it has.
    pub walls: u32,
    /// The share of ropes that go about it at least once at the end, all the way round.
    pub wound: Estimate,
    /// The share that does so counter-clockwise, as a picture of the scene shows it.
    pub left: Estimate,
    /// The share that does so clockwise, as a picture of the scene shows it.
    pub right: Estimate,
    /// The mean number of times round over all ropes, counter-clockwise counting as positive, clockwise as negative.
    pub mean: Estimate,
}

/// A taut rope and how common it is. Ropes that turn at the same wall ends on the same sides in the same order are one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CommonRope {
    /// How many traces ended with it, at the least.
    pub count: u64,
    /// How many at the most: ropes that are rare in a block are not all counted.
    pub at_most: u64,
    /// The share of all traces that `count` is.
    pub share: Estimate,
    /// Which of the anchors it is tied to.
    pub anchor: [f64; 2],
    /// Its turns, from the anchor: the places of the wall ends at which it bends.
    pub wraps: Vec<[f64; 2]>,
    /// On which side of the rope the wall end of each turn lies, seen from the anchor: `left` or `right`, as a picture of
    /// the scene shows it.
    pub sides: Vec<String>,
    /// What the scene's file calls the things there; left out where it calls nothing anything.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<Option<String>>,
}

/// How often ropes had a contact with a wall end, contacts passed straight included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// Its number in the scene.
    pub vertex: u32,
    /// Where it is.
    pub at: [f64; 2],
    /// What the scene's file calls the thing to which it belongs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The number of wraps about it per trace.
    pub wraps: Estimate,
    /// The share of all steps after which the rope has a contact with it, however many: a rope wound round it counts once.
    pub share: Estimate,
}

/// The plane, cell by cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Map {
    /// The lowest x and y of the cells: the corner of cell 0.
    pub low: [f64; 2],
    /// How wide and high a cell is.
    pub cell: f64,
    /// How many there are side by side.
    pub columns: u32,
    /// How many one above the other.
    pub rows: u32,
    /// The cells in which a free end was seen, or a rope touched a wall end, in the order of their numbers.
    pub cells: Vec<Cell>,
}

/// A cell of the map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cell {
    /// Its number: column + columns * row. Both count from 0, columns from the lowest x and rows from the lowest y, also where
    /// y points down. The cell holds the points from low + cell * (column, row) up to a cell further in x and in y; what lies
    /// on the highest x or y belongs to the last column or row.
    pub cell: u64,
    /// How often a free end was seen in it: it is looked at every `study.tallies.map_every` steps.
    pub visits: u64,
    /// The mean length of the rope then.
    pub length: Option<Estimate>,
    /// The number of wall ends in the cell with which the rope has a contact after a step, on average over all steps.
    pub contacts: Estimate,
}
