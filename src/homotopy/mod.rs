//! The homotopy class of a rope: which way it lies among the obstacles, as a short word.
//!
//! Two ropes between the same ends have the same word exactly if one can be moved into the other without crossing a
//! wall, whatever their histories. Ropes that end in different places can be compared by their words too.
//!
//! ```
//! use std::sync::Arc;
//! use tautline::engine::{Cpu, Engine, Job};
//! use tautline::homotopy::{Class, Classes};
//! use tautline::scene::{Model, Scene};
//! use tautline::trace::{Trace, settle};
//!
//! // A lone wall, and the anchor south of it. One free end goes round its eastern end, one round its western, one all
//! // the way round and half a turn more.
//! let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
//! let model = Arc::new(Model::new(scene, Some([0.0, -1.0].into()))?);
//! let [south, east, north, west] = [[0.0, -1.0], [3.0, 0.0], [0.0, 2.0], [-3.0, 0.0]];
//! let ways = [vec![east, north], vec![west, north], vec![east, north, west, south, east, north]];
//! let trace = |(points, id): (&Vec<[f64; 2]>, u64)| {
//!     settle(&model, &Trace { id, points: points.iter().map(|&p| p.into()).collect() })
//! };
//! let traces: Vec<_> = ways.iter().zip(0..).map(trace).collect();
//! let records = Cpu::new(model.clone()).evaluate(&traces, &Job::new())?;
//!
//! let classes = Classes::new(&model);
//! let class = |i: usize| classes.of_record(&traces[i], &records[i]).expect("no wall is crossed");
//! // The wall is obstacle 0, and its cut goes up from its eastern end.
//! assert_eq!([0, 1, 2].map(|i| class(i).to_string()), ["o0", "e", "o0^2"]);
//! assert_eq!("o0^2".parse::<Class>()?, class(2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod angle;
mod changes;
mod class;
mod classes;
mod components;

pub use changes::ClassChange;
pub use class::{Class, NoClass};
pub use classes::{Classes, Cut};
