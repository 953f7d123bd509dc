//! `tautline convert`.

use std::path::PathBuf;

use tautline::output::write_scene;
use tautline::scene::read_scene_with;

use super::failure::Failure;
use super::input::{FileArgs, note};
use super::interrupt::{self, Writing};
use super::print;
use super::summary::place;

#[derive(Debug, clap::Args)]
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
    let anchor = scene.anchor().map_or("no anchor".to_owned(), |a| format!("anchor {}", place(a)));
    print(&format!(
        "{}: {} walls, {} vertices, {anchor}\n",
        args.to.display(),
        scene.walls().len(),
        scene.vertices().len()
    ))
}
