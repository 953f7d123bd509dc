//! Reading what the user brings: scene, anchor, traces.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use glam::DVec2;
use tautline::example::{Walker, floor_plan};
use tautline::scene::{AnchorError, Model, Scene, read_scene};
use tautline::trace::TraceReader;

use super::batches::Source;
use super::failure::Failure;
use super::violations::{OnViolation, Violations};

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
        self.tie(self.walls()?)
    }

    /// The walls, and the anchor that the file may mark.
    pub(crate) fn walls(&self) -> Result<Scene, Failure> {
        match &self.scene {
            Some(path) => Ok(read_scene(path)?),
            None => Ok(floor_plan()),
        }
    }

    /// Ties the rope in `scene`.
    pub(crate) fn tie(&self, scene: Scene) -> Result<Model, Failure> {
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
    pub(crate) fn source(&self) -> Result<Source, Failure> {
        match (&self.traces, &self.scene) {
            (Some(path), Some(_)) => Ok(Source::File(TraceReader::open(path)?)),
            (None, None) => Ok(Source::Walks(EXAMPLE_WALK, 0..EXAMPLE_TRACES)),
            (Some(_), None) => Err(Failure::input(anyhow!("--traces needs --scene: the walls that they go by"))),
            (None, Some(_)) => Err(Failure::input(anyhow!("--scene needs --traces: a .csv or .parquet of points"))),
        }
    }

    /// What is to be done with traces that cross walls; none so far.
    pub(crate) fn violations(&self) -> Violations {
        let file = self.traces.as_deref().map_or(String::new(), |p| format!("{}: ", p.display()));
        Violations::new(file, self.on_violation)
    }
}

fn is_geojson(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("geojson") || e.eq_ignore_ascii_case("json"))
}
