//! What accuracy is given for speed, whatever the engine.

use anyhow::anyhow;
use tautline::scene::Model;
use tautline::trade::{Terms, Trade};

use super::failure::Failure;
use super::parse::{above_zero, stride};

/// What accuracy is given for speed.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct TradeArgs {
    /// Go straight from every K-th point of a trace to the next, where no wall is in the way; ropes can be wrong
    #[arg(long, allow_negative_numbers = true, value_name = "K", value_parser = stride)]
    pub stride: Option<u32>,
    /// Leave wall ends out where walls move by at most TOL, in the scene's unit, and no way between them changes
    #[arg(long, allow_negative_numbers = true, value_name = "TOL", value_parser = above_zero)]
    pub simplify: Option<f64>,
}

impl TradeArgs {
    /// What is given.
    pub(crate) fn trade(&self) -> Trade {
        Trade { stride: self.stride.unwrap_or(1), simplify: self.simplify }
    }

    /// What is left of the scene called `name`, and of traces in it.
    pub(crate) fn terms(&self, name: &str, model: Model) -> Result<Terms, Failure> {
        Terms::new(model, self.trade()).map_err(|e| Failure::input(anyhow!("--simplify: {name}: {e}")))
    }
}
