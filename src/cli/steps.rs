//! Which file the rope after every step goes to, and what is told beside it.

use std::path::PathBuf;

use anyhow::anyhow;
use tautline::output::Extras;
use tautline::parse_number;
use tautline::rope::{Friction, FrictionFault};
use tautline::scene::Scene;

use super::failure::Failure;

/// The rope after every step.
#[derive(Debug, clap::Args)]
pub(crate) struct StepArgs {
    /// Where to write the rope after every step: .jsonl, .csv or .parquet
    #[arg(long, value_name = "FILE")]
    pub steps: Option<PathBuf>,
    /// Of which obstacles --steps counts how often the free end has gone round: by label, or by the number of a wall
    /// end; may be given several times [default: all that have a label]
    #[arg(long, value_name = "NAME", requires = "steps")]
    about: Vec<String>,
    /// With --steps: how ropes pull the anchor too, by which angle they turn, and what friction with this coefficient
    /// makes of their tension and of the work of the free end
    #[arg(long, value_name = "MU", allow_negative_numbers = true, value_parser = friction)]
    pub friction: Option<Friction>,
}

/// A coefficient of friction.
fn friction(text: &str) -> Result<Friction, String> {
    let number = parse_number(text).ok_or_else(|| format!("give a number from 0 to {}", Friction::MOST))?;
    Friction::new(number).map_err(|fault: FrictionFault| fault.to_string())
}

impl StepArgs {
    /// What is told beside the rope.
    pub(crate) fn extras(&self, scene: &Scene) -> Result<Extras, Failure> {
        let centres = match self.about.as_slice() {
            [] => Ok(scene.labelled()),
            names => scene.called(names).map_err(|error| Failure::input(anyhow!("--about: {error}"))),
        }?;
        Ok(Extras { centres, friction: self.friction })
    }
}
