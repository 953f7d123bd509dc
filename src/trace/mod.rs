//! What the user brings as movement: the points through which the free end is dragged.

mod coarse;
mod corner;
mod csv_file;
mod csv_lines;
mod csv_rows;
mod gather;
mod parquet_columns;
mod parquet_file;
mod pluck;
mod read;
mod settle;
#[cfg(test)]
mod settle_truth;
mod settled;
mod slide;

use glam::DVec2;

pub use read::{TraceReader, read_traces};
pub(crate) use settle::{first_violation, settle_clear};
pub use settle::{settle, settle_owned};
pub(crate) use settled::Walked;
pub use settled::{SettledTrace, Violation, ViolationKind, bounds};

/// One trace: its number and its points, in the scene's frame and unit.
///
/// Point 0 is where the free end starts, visible from the anchor; step k moves it from point k-1 to point k.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// The number that results name it by.
    pub id: u64,
    /// The points; at least one. Each within the limits of [`check_point`](crate::geometry::check_point).
    pub points: Vec<DVec2>,
}
