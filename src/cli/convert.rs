//! `tautline convert`.

use std::path::PathBuf;

use tautline::output::write_scene;
use tautline::scene::read_scene_with;

use super::failure::Failure;
use super::input::{FileArgs, note};
use super::interrupt::{self, Writing};
use super::print;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    tautline convert plan.svg plan.geojson                  a drawing made in Inkscape\n  \
    tautline convert --flatten 0.5 plan.dxf plan.wkt        arcs and splines to half a unit\n  \
    tautline convert --unknown blocked map.yaml map.geojson a map of ROS's map_server, in metres\n\n\
    Reading OUT gives the same walls and the same anchor, bit for bit. docs/scenes.md says what becomes a wall.")]
pub(crate) struct Args {
    /// The scene: .geojson, .json, .wkt, .svg, .dxf, .map, .yaml or .yml
    #[arg(value_name = "IN")]
    from: PathBuf,
    /// The file to write: .geojson, .json or .wkt
    #[arg(value_name = "OUT")]
    to: PathBuf,
    #[command(flatten)]
    file: FileArgs,
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    interrupt::listen()?;
    let scene = read_scene_with(&args.from, &args.file.options())?;
    note(&args.from, &scene);
    let writing = Writing::begin();
    interrupt::check()?;
    write_scene(&args.to, &scene)?;
    writing.end()?;
    let anchor = scene.anchor().map_or("no anchor".to_owned(), |a| format!("anchor ({}, {})", a.x, a.y));
    print(&format!(
        "{}: {} walls, {} vertices, {anchor}\n",
        args.to.display(),
        scene.walls().len(),
        scene.vertices().len()
    ))
}
