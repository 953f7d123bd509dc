//! What accuracy is given for speed, whatever the engine.

use std::sync::Arc;

use anyhow::anyhow;
use tautline::engine::Precision;
use tautline::scene::Model;
use tautline::simplify::simplify;
use tautline::study::Traded;

use super::failure::Failure;
use super::input::above_zero;
use super::summary::grouped;

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
}

impl TradeArgs {
    /// Whether anything is traded.
    pub(crate) fn is_any(&self) -> bool {
        self.simplify.is_some() || self.stride.is_some_and(|k| k > 1)
    }

    /// What results say of themselves: nothing if they are exact.
    pub(crate) fn notes(&self, precision: Option<Precision>) -> Vec<(&'static str, String)> {
        let stride = self.stride.filter(|&k| k > 1).map(|k| ("tautline.stride", k.to_string()));
        let simplify = self.simplify.map(|tolerance| ("tautline.simplify", tolerance.to_string()));
        let fast = precision.filter(|&p| p == Precision::Fast).map(|p| ("tautline.precision", p.name().to_owned()));
        [stride, simplify, fast].into_iter().flatten().collect()
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

/// A stride: of so many points one is used.
pub(crate) fn stride(text: &str) -> Result<u32, String> {
    let number = text.trim().parse().ok().filter(|k| (1..=1 << 30).contains(k));
    number.ok_or_else(|| "give a whole number from 1 on, such as 4".to_owned())
}

/// What was traded and what that came to, in a line.
pub(crate) fn words(stride: u32, simplify: Option<f64>, traded: &Traded) -> String {
    let mut words = Vec::new();
    if stride > 1 {
        let jumps = grouped(traded.jumps);
        words.push(format!(
            "of every {stride} points one ({jumps} longer steps would touch a wall and are walked as given)"
        ));
    }
    if let Some(tolerance) = simplify {
        let [before, left] = [traded.vertices, traded.vertices_left].map(grouped);
        let [traces, steps] = [traded.crossing_traces, traded.crossing_steps].map(grouped);
        words.push(format!(
            "walls simplified by at most {tolerance}, {left} of {before} wall ends left ({traces} traces cross one, in {steps} steps)"
        ));
    }
    words.join("; ")
}
