//! Which file the rope after every step goes to, and about what turns are counted.

use std::path::PathBuf;

use anyhow::anyhow;
use tautline::scene::{Centre, Scene};

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
}

impl StepArgs {
    /// About what turns are counted.
    pub(crate) fn centres(&self, scene: &Scene) -> Result<Vec<Centre>, Failure> {
        match self.about.as_slice() {
            [] => Ok(scene.labelled()),
            names => scene.called(names).map_err(|error| Failure::input(anyhow!("--about: {error}"))),
        }
    }
}
