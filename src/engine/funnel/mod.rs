//! Another method altogether: the shortest path homotopic to the trace, by triangulation, crossing word and funnel.
//!
//! The trace's crossing word over a triangulation of the vertices, with neighbouring crossings of one edge back and
//! forth cancelled, names its homotopy class; the funnel algorithm finds the shortest path through the triangles that
//! the word leads through (Hershberger and Snoeyink, "Computing minimum length paths of a given homotopy class",
//! Comput. Geom. 4, 1994; Lee and Preparata, Networks 14, 1984). It shares the exact predicates with the ray method and
//! nothing else, so the two check each other. It keeps no contacts passed straight: events may differ from the
//! reference's, taut ropes may not.

mod chains;
mod drag;
mod log;
mod mesh;
mod triangle;
mod word;

use std::sync::Arc;

use rayon::prelude::*;

use self::drag::Drag;
use self::mesh::{Mesh, MeshError, bounds};
use super::table::Open;
use super::{Engine, EngineError, EngineKind, Job, Precision, Promise};
use crate::rope::TraceRecord;
use crate::scene::Model;
use crate::trace::SettledTrace;

/// The other method, which knows the rope after every step.
pub static FUNNEL: EngineKind = EngineKind {
    name: "funnel",
    about: "Another method: triangulation, crossing word, funnel",
    precisions: &[Precision::Certified],
    asks: false,
    both_ends: false,
    promise: Promise::Ropes,
    open: Open::Threads(|model, _| Box::new(Funnel::new(model))),
};

/// The engine that keeps the funnel of each trace's crossing word up to date, on all cores.
///
/// A step costs O(1 + edges crossed) times the logarithm of the corners that the funnel's ends and the rope's last
/// corner pass over. The triangulation is made once, and anew only for traces that lead far outside the scene.
pub struct Funnel {
    model: Arc<Model>,
    mesh: Option<Mesh>,
    final_only: bool,
}

impl Funnel {
    /// An engine for `model`.
    pub fn new(model: Arc<Model>) -> Self {
        Funnel { model, mesh: None, final_only: false }
    }

    /// The same engine for final ropes only: it follows the crossing words alone and makes each trace's funnel once, at
    /// its end.
    ///
    /// A record's `length`, `depth`, `wraps` and `pull` are those of the engine that sees every step. Its `max_length`
    /// and `max_depth` are the final rope's too, and its events wrap the final rope, all in the last step.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tautline::engine::{Engine, Funnel, Job};
    /// use tautline::scene::{Model, Scene};
    /// use tautline::trace::{Trace, settle};
    /// let walls = [[[1.0, 0.0].into(), [1.0, 5.0].into()]];
    /// let model = Arc::new(Model::new(Scene::new(walls)?, Some([0.0, 1.0].into()))?);
    /// // Down below the wall, up behind it and a little back.
    /// let points = [[0.0, -1.0], [3.0, -1.0], [3.0, 4.0], [2.0, 0.0]].map(Into::into).to_vec();
    /// let trace = settle(&model, &Trace { id: 0, points });
    /// let record = Funnel::new(model).final_only().evaluate(&[trace], &Job::new())?.remove(0);
    /// assert_eq!((record.depth, record.max_length), (1, record.length));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn final_only(mut self) -> Self {
        self.final_only = true;
        self
    }
}

impl Engine for Funnel {
    fn name(&self) -> &'static str {
        FUNNEL.name
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        job.go_on()?;
        let model = &*self.model;
        let unfit = |why: MeshError| EngineError::Unfit { engine: FUNNEL.name, why: why.into() };
        let bounds = bounds(model, traces);
        let mesh = match self.mesh.take() {
            Some(mesh) if mesh.covers(bounds) => mesh,
            _ => Mesh::new(model, bounds).map_err(unfit)?,
        };
        let mesh = self.mesh.insert(mesh);
        let final_only = self.final_only;
        let evaluate = |drag: &mut Drag, trace| drag.evaluate(model, mesh, trace, final_only, job);
        traces.par_iter().map_init(Drag::default, evaluate).collect()
    }

    fn forget(&mut self) {
        self.mesh = None;
    }
}
