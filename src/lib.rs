//! Taut ropes of dragged traces among walls, in bulk and exactly.
//!
//! A rope is tied to a fixed anchor and held at its free end. The free end is dragged along a trace through a plane
//! full of walls. After every step the taut rope is the list of wall ends that it bends round. `tautline` keeps that
//! list for thousands to millions of independent traces at once: a compute shader finds the few wall ends that a trace
//! can meet, and the CPU decides exactly what happens.
//!
//! Data flows one way: a [`scene`] and its anchor make a [`Model`](scene::Model); a [`trace`] is checked against the
//! model and settled; an [`engine`] turns settled traces into [`TraceRecord`](rope::TraceRecord)s; [`output`] writes
//! them.
//!
//! Engines share the exact update of the [`rope`], which rests on the signs of [`geometry`]. They differ in how they
//! find the wall ends to try: [`visibility`] says which a rope can turn at next, [`candidates`] which of these a few
//! steps can meet, [`gpu`] asks the same of a device, and [`fast`] has it decide in f32 as well.
//!
//! Around them: [`example`] has scenes and traces without files, and [`queries`] those of path planners' benchmarks;
//! [`simplify`] leaves wall ends out of a scene for speed; a [`study`] draws very many traces and says what their ropes
//! are like; [`lab`] measures engines against each other; a [`picture`] shows ropes and studies; [`words`] are numbers
//! as people read them; [`escape`] makes text from files fit for terminals.
//!
//! ```
//! use std::sync::Arc;
//!
//! use tautline::engine::{Engine, Job, Reference};
//! use tautline::scene::{Model, Scene};
//! use tautline::trace::{Trace, settle};
//!
//! // One wall, the anchor south of it; the free end goes round its eastern end and comes to rest north of it.
//! let scene = Scene::new([[[-1.0, 0.0].into(), [1.0, 0.0].into()]])?;
//! let model = Arc::new(Model::new(scene, Some([0.0, -1.0].into()))?);
//! let points = [[0.0, -0.5], [1.5, -0.5], [1.5, 0.5], [0.0, 0.5]].map(Into::into).to_vec();
//! let settled = settle(&model, &Trace { id: 0, points });
//! assert!(settled.violation().is_none());
//!
//! let records = Reference::new(model.clone()).evaluate(&[settled], &Job::new())?;
//! assert_eq!(records[0].wraps.len(), 1);
//! assert_eq!(records[0].wraps[0].0, [1.0, 0.0].into());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod candidates;
mod caught;
pub mod engine;
pub mod environment;
pub mod escape;
pub mod example;
pub mod fast;
pub mod geometry;
pub mod gpu;
pub mod homotopy;
pub mod lab;
mod number;
pub mod output;
pub mod picture;
pub mod queries;
mod read_error;
mod read_file;

pub mod rope;
pub mod scene;
pub mod session;
pub mod simplify;
pub mod stream;
pub mod study;
pub mod trace;
pub mod trade;
pub mod visibility;
pub mod words;

pub use number::parse_number;
pub use read_error::{Place, ReadError};
