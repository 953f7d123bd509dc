//! What the user brings as movement: the points through which the free end is dragged.

mod coarse;
mod corner;
mod csv_file;
mod csv_lines;
mod csv_rows;
mod end;
mod gather;
mod given;
mod parquet_columns;
mod parquet_file;
mod pluck;
mod read;
mod settle;
#[cfg(test)]
mod settle_truth;
mod settled;
mod settled_ends;
mod slide;

pub use end::End;
pub use gather::traces_of_rows;
pub use given::{EndsTrace, Trace};
pub use read::{TraceReader, read_traces};
pub(crate) use settle::{first_violation, settle_clear};
pub use settle::{settle, settle_owned};
pub(crate) use settled::{HeldBack, Walked};
pub use settled::{SettledTrace, Violation, ViolationKind, bounds};
pub use settled_ends::{EndsFault, SettledEnds, settle_ends};
