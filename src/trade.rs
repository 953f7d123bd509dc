//! What accuracy is given for speed, whatever the engine: points of traces, and wall ends, that are left out.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::number;
use crate::scene::Model;
use crate::simplify::{SimplifyError, simplify};
use crate::trace::{SettledTrace, Trace, settle_owned};
use crate::words::{counted, grouped};

/// What accuracy is given for speed. The default gives none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Trade {
    /// Of so many points of a trace one is used, where no wall is in the way of the longer step: at least 1, which uses
    /// all. See [`SettledTrace::coarsened`].
    pub stride: u32,
    /// By how much walls may move for there to be fewer wall ends, in the scene's unit. See [`simplify`].
    pub simplify: Option<f64>,
}

impl Default for Trade {
    fn default() -> Self {
        Trade { stride: 1, simplify: None }
    }
}

impl Trade {
    /// Whether anything is given.
    pub fn is_any(self) -> bool {
        self.stride > 1 || self.simplify.is_some()
    }

    /// The scene as ropes see it, with the anchor of each of the `given` models, which share their scene.
    ///
    /// # Errors
    ///
    /// Those of [`simplify`].
    ///
    /// # Panics
    ///
    /// If no model is given.
    pub fn simplified(self, given: &[Arc<Model>]) -> Result<Vec<Arc<Model>>, SimplifyError> {
        let Some(tolerance) = self.simplify else { return Ok(given.to_vec()) };
        let anchors: Vec<_> = given.iter().map(|model| model.anchor()).collect();
        let scene = simplify(given[0].scene(), &anchors, tolerance)?;
        let first = Model::new(scene, Some(anchors[0]))?;
        anchors.iter().map(|&anchor| Ok(Arc::new(first.tied(anchor)?))).collect()
    }

    /// A trace as ropes see it, in `used`, the scene as they do.
    #[must_use]
    pub fn coarsened(self, trace: SettledTrace, used: &Model) -> SettledTrace {
        if self.is_any() { trace.coarsened(used, self.stride as usize) } else { trace }
    }

    /// What was given and what that came to, in a line.
    ///
    /// ```
    /// use tautline::trade::{Trade, Traded};
    /// let words = Trade { stride: 4, simplify: None }.words(&Traded::default());
    /// assert_eq!(words, "of every 4 points one (0 longer steps would touch a wall and are walked as given)");
    /// ```
    pub fn words(self, traded: &Traded) -> String {
        let mut words = Vec::new();
        if self.stride > 1 {
            let one = "longer step would touch a wall and is walked as given";
            let jumps = counted(traded.jumps, one, "longer steps would touch a wall and are walked as given");
            words.push(format!("of every {} points one ({jumps})", self.stride));
        }
        if let Some(tolerance) = self.simplify {
            let [before, left] = [traded.vertices, traded.vertices_left].map(grouped);
            let traces = counted(traded.crossing_traces, "trace crosses", "traces cross");
            let steps = counted(traded.crossing_steps, "step", "steps");
            words.push(format!(
                "walls simplified by at most {}, {left} of {before} wall ends left ({traces} one, in {steps})",
                number(tolerance)
            ));
        }
        words.join("; ")
    }

    /// What results say of themselves, key by key: nothing if they are exact.
    pub fn notes(self) -> Vec<(&'static str, String)> {
        let stride = (self.stride > 1).then(|| ("tautline.stride", self.stride.to_string()));
        let simplify = self.simplify.map(|tolerance| ("tautline.simplify", number(tolerance)));
        stride.into_iter().chain(simplify).collect()
    }
}

/// What it came to that accuracy was given for speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Traded {
    /// How many wall ends the scene has.
    pub vertices: u64,
    /// How many of them were left.
    pub vertices_left: u64,
    /// How many longer steps would have touched a wall, and were walked point by point.
    pub jumps: u64,
    /// How many traces cross a simplified wall.
    pub crossing_traces: u64,
    /// How many steps do.
    pub crossing_steps: u64,
}

impl Traded {
    /// Counts a trace in.
    pub fn add(&mut self, trace: &SettledTrace) {
        self.jumps += trace.jumps() as u64;
        self.crossing_traces += u64::from(trace.crossings() > 0);
        self.crossing_steps += trace.crossings() as u64;
    }
}

/// What traces are evaluated among, and how much of them.
#[derive(Clone)]
pub struct Terms {
    /// The scene as it was given: traces are checked against it.
    pub given: Arc<Model>,
    /// The scene as ropes see it.
    pub used: Arc<Model>,
    /// What is given for speed.
    pub trade: Trade,
}

impl Terms {
    /// All of the traces, among all walls of `given`.
    pub fn exact(given: impl Into<Arc<Model>>) -> Self {
        let given = given.into();
        Terms { used: given.clone(), given, trade: Trade::default() }
    }

    /// What is left of the traces and of the walls of `given`.
    ///
    /// # Errors
    ///
    /// Those of [`simplify`].
    pub fn new(given: impl Into<Arc<Model>>, trade: Trade) -> Result<Self, SimplifyError> {
        let given = given.into();
        let used = trade.simplified(std::slice::from_ref(&given))?.remove(0);
        Ok(Terms { given, used, trade })
    }

    /// The trace among the walls as they are, then as ropes see it.
    pub fn settle(&self, trace: Trace) -> SettledTrace {
        self.trade.coarsened(settle_owned(&self.given, trace), &self.used)
    }
}
