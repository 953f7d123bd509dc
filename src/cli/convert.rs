//! `tautline convert`.

use std::path::PathBuf;

use tautline::output::write_scene;
use tautline::scene::read_scene_with;

use super::failure::Failure;
use super::input::{FileArgs, note};
use super::paths::keep_apart;
use super::print;
use super::summary::{place, plainly};

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
    keep_apart(&[("IN", Some(&args.from))], &[("OUT", Some(&args.to))])?;
    let scene = read_scene_with(&args.from, &args.file.options())?;
    note(&args.from, &scene);
    write_scene(&args.to, &scene)?;
    let is_text = args.to.extension().is_some_and(|e| e.eq_ignore_ascii_case("wkt"));
    if is_text && !scene.is_bare() {
        say!(
            "note: {}: well-known text has no place for labels, layers and what is solid; GeoJSON has",
            args.to.display()
        );
    }
    let anchor = scene.anchor().map_or("no anchor".to_owned(), |a| format!("anchor {}", place(a)));
    print(&format!(
        "{}: {}, {}, {anchor}\n",
        args.to.display(),
        plainly(scene.walls().len() as u64, "wall", "walls"),
        plainly(scene.vertices().len() as u64, "vertex", "vertices")
    ))
}
