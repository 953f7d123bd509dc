//! What is counted of every trace, block by block.
//!
//! All but the moments are whole numbers, so that blocks may be put together in any order; the moments are kept for
//! each block and put together in the order of the blocks.
//!
//! A tally is a file with a struct that is a [`Tally`], and a line in [`table`], in the order of the
//! summary; its options have their lines there too, in the order of a plan.

mod batches;
mod block;
pub(super) mod contacts;
pub(super) mod histograms;
mod lengths;
pub(super) mod map;
mod merge;
pub(super) mod obstacles;
mod options;
pub(super) mod ropes;
pub(super) mod scalars;
mod setting;
pub(super) mod survival;
#[allow(clippy::module_inception)] // the trait is named as what it is
mod tally;
mod totals;
mod winding;

pub(super) use block::{Block, Counts, Tallies, Traced};
pub use contacts::Contact;
pub use histograms::{Bin, Histogram};
pub use map::{Cell, Map};
pub(super) use merge::Merge;
pub use obstacles::Obstacle;
pub use options::TallyPlan;
pub use ropes::CommonRope;
pub use scalars::{Quantile, Scalar, quantity};
pub(super) use setting::Setting;
pub use survival::{Survival, SurvivalPoint};
pub(super) use tally::Tally;

/// All tallies and their options, handed to the macro `$to`.
///
/// An option is a field of a plan's `[tallies]`: its description, its name, its type, and what it is unless told
/// otherwise. A tally is a field of the summary: its description, its name, its type, and what counts it.
macro_rules! table {
    ($to:ident) => {
        $to! { options {
        /// How often intervals are to hold the truth, between 0 and 1.
        confidence: f64 = 0.95;
        /// Rope lengths: for each, when the rope first becomes longer (the survival curve).
        limits: Vec<f64> = Vec::new();
        /// How wide the bins of the histograms of lengths are; 0 for a power of two near a 64th of the scene's size.
        bin: f64 = 0.0;
        /// How many cells the longer side of the map of the plane has; they are squares. 0 for no map.
        map: u32 = 64;
        /// After how many steps the map looks at the free end again: neighbouring steps say nearly the same.
        map_every: u32 = 8;
        /// How many of the most common taut ropes are reported.
        ropes: u32 = 10;
        } tallies {
        /// One number a trace: its distribution over the traces.
        scalars: Vec<tally::Scalar> = tally::scalars::Scalars;
        /// Histograms of the rope length at the end and of the greatest.
        histograms: Vec<tally::Histogram> = tally::histograms::Histograms;
        /// For each limit, when the rope became longer.
        survival: Vec<tally::Survival> = tally::survival::Limits;
        /// The obstacles that ropes were wound about at the end, the most often first.
        obstacles: Vec<tally::Obstacle> = tally::obstacles::Obstacles;
        /// The most common taut ropes at the end, the most common first.
        ropes: Vec<tally::CommonRope> = tally::ropes::Ropes;
        /// The wall ends with which ropes had contacts, those with the greatest share of steps first, at most a thousand.
        contacts: Vec<tally::Contact> = tally::contacts::Contacts;
        /// The plane.
        map: Option<tally::Map> = tally::map::Cells;
        } }
    };
}
pub(super) use table;
