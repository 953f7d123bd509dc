//! What accuracy is given for speed, whatever the engine.

use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::Precision;
use tautline::geometry::number;
use tautline::scene::Model;
use tautline::simplify::simplify;
use tautline::study::Traded;
use tautline::trace::{SettledTrace, Trace, settle_owned};

use super::failure::Failure;
use super::parse::{above_zero, stride};
use super::words::{counted, grouped};

/// What accuracy is given for speed.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct TradeArgs {
    /// Go straight from every K-th point of a trace to the next, where no wall is in the way; ropes can be wrong
    #[arg(long, value_name = "K", value_parser = stride)]
    pub stride: Option<u32>,
    /// Leave wall ends out where walls move by at most TOL, in the scene's unit, and no way between them changes
    #[arg(long, value_name = "TOL", value_parser = above_zero)]
    pub simplify: Option<f64>,
}

/// What traces are evaluated among, and how much of them.
#[derive(Clone)]
pub(crate) struct Terms {
    /// The scene as it was given.
    pub given: Arc<Model>,
    /// The scene as ropes see it.
    pub used: Arc<Model>,
    /// Of how many points one is used.
    pub stride: usize,
}

impl Terms {
    /// All of the traces, among all walls.
    pub(crate) fn exact(model: Model) -> Self {
        let given = Arc::new(model);
        Terms { used: given.clone(), given, stride: 1 }
    }

    /// The trace among the walls as they are, then as it is to be used.
    pub(crate) fn settle(&self, trace: Trace) -> SettledTrace {
        let settled = settle_owned(&self.given, trace);
        let is_traded = self.stride > 1 || !Arc::ptr_eq(&self.given, &self.used);
        if is_traded { settled.coarsened(&self.used, self.stride) } else { settled }
    }
}

impl TradeArgs {
    /// Whether anything is traded.
    pub(crate) fn is_any(&self) -> bool {
        self.simplify.is_some() || self.stride.is_some_and(|k| k > 1)
    }

    /// What results say of themselves: nothing if they are exact.
    pub(crate) fn notes(&self, precision: Option<Precision>) -> Vec<(&'static str, String)> {
        let fast = precision.filter(|&p| p == Precision::Fast).map(|p| ("tautline.precision", p.name().to_owned()));
        notes(self.stride.unwrap_or(1), self.simplify).into_iter().chain(fast).collect()
    }

    /// What is left of the scene called `name`, and of traces in it.
    pub(crate) fn terms(&self, name: &str, model: Model) -> Result<Terms, Failure> {
        let mut terms = Terms::exact(model);
        terms.stride = self.stride.unwrap_or(1) as usize;
        if let Some(tolerance) = self.simplify {
            let anchor = terms.given.anchor();
            let scene = simplify(terms.given.scene(), &[anchor], tolerance)
                .map_err(|e| Failure::input(anyhow!("--simplify: {name}: {e}")))?;
            terms.used = Arc::new(Model::new(scene, Some(anchor))?);
        }
        Ok(terms)
    }
}

/// What rows say of how their ropes were traded: nothing if they were not.
pub(crate) fn notes(stride: u32, simplify: Option<f64>) -> Vec<(&'static str, String)> {
    let stride = (stride > 1).then(|| ("tautline.stride", stride.to_string()));
    let simplify = simplify.map(|tolerance| ("tautline.simplify", number(tolerance)));
    stride.into_iter().chain(simplify).collect()
}

/// What was traded and what that came to, in a line.
pub(crate) fn words(stride: u32, simplify: Option<f64>, traded: &Traded) -> String {
    let mut words = Vec::new();
    if stride > 1 {
        let one = "longer step would touch a wall and is walked as given";
        let jumps = counted(traded.jumps, one, "longer steps would touch a wall and are walked as given");
        words.push(format!("of every {stride} points one ({jumps})"));
    }
    if let Some(tolerance) = simplify {
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
