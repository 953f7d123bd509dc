//! Reading what the user brings: scene, anchor, traces.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use glam::DVec2;
use tautline::escape::{escaped, escaped_path};
use tautline::example::{Walker, floor_plan};
use tautline::scene::{
    AnchorError, Model, Ros, Scene, SceneFormat, SceneOptions, Unknown, alternatives, read_scene_with,
};
use tautline::stream::Source;
use tautline::study::anchor_warnings;
use tautline::trace::TraceReader;

use super::failure::Failure;
use super::parse::{above_zero, point};
use super::paths::Named;
use super::violations::{OnViolation, Violations};
use super::words::counted;

/// How many traces the built-in example has, and how they are walked.
const EXAMPLE_TRACES: u64 = 4000;
const EXAMPLE_WALK: Walker = Walker { step: 0.25, steps: 500, seed: 1 };

/// Where the walls are and the rope is tied.
#[derive(Debug, clap::Args)]
pub(crate) struct InputArgs {
    #[arg(long, value_name = "FILE", help = scenes())]
    pub scene: Option<PathBuf>,
    /// Where the rope is tied; overrides what the scene says
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = point)]
    pub anchor: Option<DVec2>,
    /// The traces: .csv with columns trace,x,y, or .parquet with the same columns
    #[arg(long, value_name = "FILE")]
    pub traces: Option<PathBuf>,
    #[command(flatten)]
    pub file: FileArgs,
    /// What to do with a trace that crosses a wall
    #[arg(long, value_enum, default_value = "error")]
    on_violation: OnViolation,
}

/// What scene files of some formats leave open.
#[derive(Debug, clap::Args)]
pub(crate) struct FileArgs {
    /// How far walls may lie from the curves of an .svg or .dxf, in the scene's unit [default: its longer side / 2000]
    #[arg(long, allow_negative_numbers = true, value_name = "TOL", value_parser = above_zero)]
    flatten: Option<f64>,
    /// What unknown cells of a map_server's map are
    #[arg(long, value_enum, default_value = "free")]
    unknown: Cells,
    /// Which ROS's map_server says what cells of a map are occupied: nav2's of ROS 2, or that of ROS 1
    #[arg(long, value_name = "1|2", default_value = "2", value_parser = ros)]
    ros: Ros,
    /// Take the walls of this layer only; may be given several times. Layers are those of a .dxf, layers and groups of
    /// an .svg, and of .geojson what the property `layer` says, or as KEY=VALUE what the property KEY does
    #[arg(long = "layer", value_name = "NAME")]
    layers: Vec<String>,
    /// Leave the walls of this layer out; may be given several times
    #[arg(long = "without-layer", value_name = "NAME")]
    without_layers: Vec<String>,
}

fn ros(text: &str) -> Result<Ros, String> {
    match text {
        "1" => Ok(Ros::One),
        "2" => Ok(Ros::Two),
        _ => Err("give 1 or 2".to_owned()),
    }
}

/// What cells are.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Cells {
    /// No obstacles
    Free,
    /// Obstacles
    Blocked,
}

impl FileArgs {
    fn options(&self) -> SceneOptions {
        let unknown = match self.unknown {
            Cells::Free => Unknown::Free,
            Cells::Blocked => Unknown::Blocked,
        };
        SceneOptions {
            flatten: self.flatten,
            unknown,
            ros: self.ros,
            layers: self.layers.clone(),
            without_layers: self.without_layers.clone(),
        }
    }
}

/// The scene in a file. Says on stderr what is to be known of it.
pub(super) fn read(path: &Path, file: &FileArgs) -> Result<Scene, Failure> {
    let scene = read_scene_with(path, &file.options())?;
    note(path, &scene);
    Ok(scene)
}

/// Ties the rope in the scene called `name`; where nothing says at which point, the message says `how` to.
pub(super) fn tie(scene: Scene, anchor: Option<DVec2>, name: &str, how: &str) -> Result<Model, Failure> {
    Model::new(scene, anchor).map_err(|error| match error {
        AnchorError::Missing => Failure::input(anyhow!("{name}: no anchor; {how}")),
        other => Failure::input(anyhow!("{name}: {other}")),
    })
}

/// Tells what the reader of a scene has to say.
pub(crate) fn note(path: &Path, scene: &Scene) {
    for note in scene.notes() {
        say!("note: {}: {}", escaped_path(path), escaped(note));
    }
}

/// Warns of an anchor that is hardly where it was meant to be.
pub(crate) fn warn(name: &str, model: &Model) {
    for warning in anchor_warnings(model) {
        say!("warning: {name}: {warning}");
    }
}

impl InputArgs {
    /// The scene's name in reports.
    pub(crate) fn name(&self) -> String {
        self.scene.as_deref().map_or("the built-in floor plan".to_owned(), |p| p.display().to_string())
    }

    /// The files that are read.
    pub(crate) fn named(&self) -> [Named<'_>; 2] {
        [("--scene", self.scene.as_deref()), ("--traces", self.traces.as_deref())]
    }

    pub(crate) fn model(&self) -> Result<Model, Failure> {
        self.tie(self.walls()?)
    }

    /// The walls, and the anchor that the file may mark. Says on stderr what is to be known of the file.
    pub(crate) fn walls(&self) -> Result<Scene, Failure> {
        self.scene.as_deref().map_or_else(|| Ok(floor_plan()), |path| read(path, &self.file))
    }

    /// Ties the rope in `scene`. Warns of an anchor that is hardly where it was meant to be.
    pub(crate) fn tie(&self, scene: Scene) -> Result<Model, Failure> {
        let model = tie(scene, self.anchor, &self.name(), &self.how_to_tie())?;
        if self.scene.is_some() {
            warn(&self.name(), &model);
        }
        Ok(model)
    }

    /// How to say where the rope is tied.
    pub(crate) fn how_to_tie(&self) -> String {
        format!("give --anchor X,Y{}", self.scene.as_deref().map_or(String::new(), how_to_mark))
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

/// What is said of a file of walls.
fn scenes() -> String {
    let files: Vec<&str> = SceneFormat::all().iter().map(SceneFormat::files).collect();
    format!("The walls: {} (docs/scenes.md)", alternatives(&files))
}

/// What is said of walls that were dropped.
pub(super) fn dropped(walls: usize) -> String {
    counted(walls as u64, "wall of zero length was dropped", "walls of zero length were dropped")
}

/// How a file of this format marks its anchor.
fn how_to_mark(path: &Path) -> String {
    let anchor = SceneFormat::of(path).map_or("", SceneFormat::anchor);
    if anchor.is_empty() { String::new() } else { format!(", or {anchor}") }
}
