//! One rope, move by move.

use std::sync::Arc;

use pyo3::prelude::*;
use tautline::engine;
use tautline::scene::Model;

use crate::fault::Fault;
use crate::scene::Scene;
use crate::table::pairs;

/// A rope that follows its free end, one straight move at a time.
#[pyclass(module = "tautrope._tautrope")]
pub(crate) struct LiveRope {
    rope: engine::LiveRope,
    model: Arc<Model>,
}

#[pymethods]
impl LiveRope {
    #[new]
    fn new(py: Python<'_>, scene: &Scene) -> PyResult<Self> {
        let model = scene.model()?.clone();
        let rope = py.detach(|| engine::LiveRope::new(model.clone()));
        Ok(LiveRope { rope, model })
    }

    /// Moves the free end, and returns the events: kind, vertex, side.
    fn advance(&mut self, x: f64, y: f64) -> PyResult<Vec<(&'static str, u32, &'static str)>> {
        let y_down = self.model.scene().y_down();
        let events = self.rope.advance([x, y].into()).map_err(Fault::from)?;
        Ok(events.iter().map(|e| (e.kind.name(), e.vertex, e.side.shown(y_down).name())).collect())
    }

    #[getter]
    fn free_end(&self) -> (f64, f64) {
        self.rope.free_end().into()
    }

    #[getter]
    fn length(&self) -> f64 {
        self.rope.length()
    }

    #[getter]
    fn pull(&self) -> Option<(f64, f64)> {
        self.rope.pull().map(Into::into)
    }

    /// The taut rope: the anchor, its turns, and the free end.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let end = self.rope.free_end();
        let turns = self.rope.rope().taut(end).into_iter().map(|contact| contact.at);
        let all = [self.model.anchor()].into_iter().chain(turns).chain([end]);
        pairs(py, all.flat_map(|p| p.to_array()).collect::<Vec<f64>>())
    }

    /// The vertices at which it turns, from the anchor.
    #[getter]
    fn contacts(&self) -> Vec<u32> {
        self.rope.rope().taut(self.rope.free_end()).iter().map(|contact| contact.vertex).collect()
    }
}
