//! Reading what the user brings: scene, anchor, traces.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use glam::DVec2;
use rayon::prelude::*;
use tautline::example::{Walker, floor_plan, walks};
use tautline::scene::{AnchorError, Model, read_scene};
use tautline::trace::{SettledTrace, Trace, read_traces, settle};

use super::failure::Failure;

/// How many traces the built-in example has, and how they are walked.
const EXAMPLE_TRACES: u64 = 4000;
const EXAMPLE_WALK: Walker = Walker { step: 0.25, steps: 500, seed: 1 };

/// Where the walls are and the rope is tied.
#[derive(Debug, clap::Args)]
pub(crate) struct InputArgs {
    /// The walls: GeoJSON (.geojson, .json) or a MovingAI grid map (.map)
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Where the rope is tied; overrides what the scene says
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub anchor: Option<DVec2>,
    /// The traces: .csv with columns trace,x,y, or .parquet with the same columns
    #[arg(long, value_name = "FILE")]
    pub traces: Option<PathBuf>,
    /// What to do with a trace that crosses a wall
    #[arg(long, value_enum, default_value = "error")]
    on_violation: OnViolation,
}

/// Two numbers with a comma between them.
fn point(text: &str) -> Result<DVec2, String> {
    let wrong = || "give two numbers with a comma between them, such as 1.5,-2".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |t: &str| t.trim().parse::<f64>().map_err(|_| wrong());
    Ok(DVec2::new(number(x)?, number(y)?))
}

impl InputArgs {
    /// The scene's name in reports.
    pub(crate) fn name(&self) -> String {
        self.scene.as_deref().map_or("the built-in floor plan".to_owned(), |p| p.display().to_string())
    }

    pub(crate) fn model(&self) -> Result<Model, Failure> {
        let scene = match &self.scene {
            Some(path) => read_scene(path)?,
            None => floor_plan(),
        };
        Model::new(scene, self.anchor).map_err(|error| match error {
            AnchorError::Missing => Failure::input(anyhow!(
                "{}: no anchor; give --anchor X,Y{}",
                self.name(),
                if self.scene.as_deref().is_some_and(is_geojson) {
                    ", or put a Point with the property \"role\": \"anchor\" into the file"
                } else {
                    ""
                }
            )),
            other => Failure::input(anyhow!("{}: {other}", self.name())),
        })
    }

    /// The traces given, or the example's.
    pub(crate) fn read_traces(&self, model: &Model) -> Result<Vec<Trace>, Failure> {
        match (&self.traces, &self.scene) {
            (Some(path), Some(_)) => Ok(read_traces(path)?),
            (None, None) => Ok(walks(model, EXAMPLE_WALK, EXAMPLE_TRACES)),
            (Some(_), None) => Err(Failure::input(anyhow!("--traces needs --scene: the walls that they go by"))),
            (None, Some(_)) => Err(Failure::input(anyhow!("--scene needs --traces: a .csv or .parquet of points"))),
        }
    }

    /// Settles all traces, on all cores, and consumes them.
    pub(crate) fn settle(&self, model: &Model, traces: Vec<Trace>) -> Result<Vec<SettledTrace>, Failure> {
        let file = self.traces.as_deref().map_or(String::new(), |p| format!("{}: ", p.display()));
        let settled: Vec<SettledTrace> = traces.into_par_iter().map(|trace| settle(model, &trace)).collect();
        let violations: Vec<_> = settled.iter().filter_map(|t| t.violation()).collect();
        match (violations.first(), self.on_violation) {
            (Some(first), OnViolation::Error) => {
                let more = match violations.len() - 1 {
                    0 => String::new(),
                    more => format!(" ({more} more traces cross walls)"),
                };
                let hint = "--on-violation flag marks such traces and goes on";
                Err(Failure::input(anyhow!("{file}{first}; {hint}{more}")))
            }
            (Some(_), OnViolation::Flag) => {
                const SHOWN: usize = 1000;
                violations.iter().take(SHOWN).for_each(|v| eprintln!("warning: {file}{v}"));
                if violations.len() > SHOWN {
                    let more = violations.len() - SHOWN;
                    let list = "`tautline check --on-violation flag --json` lists them all";
                    eprintln!("warning: and {more} more traces that cross walls; {list}");
                }
                Ok(settled)
            }
            (None, _) => Ok(settled),
        }
    }
}

fn is_geojson(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("geojson") || e.eq_ignore_ascii_case("json"))
}

/// What to do with a trace that breaks the small update condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum OnViolation {
    /// Stop, and name the first
    Error,
    /// Mark such traces in the results and go on
    Flag,
}
