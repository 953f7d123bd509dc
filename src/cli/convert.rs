//! `tautline convert`.

use std::path::PathBuf;

use tautline::output::{WrittenScene, write_scene};
use tautline::scene::{SceneFormat, alternatives};

use super::failure::Failure;
use super::input::{FileArgs, read};
use super::paths::keep_apart;
use super::print;
use super::words::{place, plainly};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    #[arg(value_name = "IN", help = scenes_read())]
    from: PathBuf,
    #[arg(value_name = "OUT", help = scenes_written())]
    to: PathBuf,
    #[command(flatten)]
    file: FileArgs,
}

fn scenes_read() -> String {
    let extensions: Vec<&str> = SceneFormat::all().iter().flat_map(SceneFormat::extensions).copied().collect();
    format!("The scene: {}", alternatives(&extensions))
}

fn scenes_written() -> String {
    let extensions: Vec<&str> = WrittenScene::all().iter().flat_map(WrittenScene::extensions).copied().collect();
    format!("The file to write: {}", alternatives(&extensions))
}

pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    keep_apart(&[("IN", Some(&args.from))], &[("OUT", Some(&args.to))])?;
    let scene = read(&args.from, &args.file)?;
    write_scene(&args.to, &scene)?;
    let lacks = WrittenScene::of(&args.to).map_or("", WrittenScene::lacks);
    if !lacks.is_empty() && !scene.is_bare() {
        say!("note: {}: {lacks}", args.to.display());
    }
    let anchor = scene.anchor().map_or("no anchor".to_owned(), |a| format!("anchor {}", place(a)));
    print(&format!(
        "{}: {}, {}, {anchor}\n",
        args.to.display(),
        plainly(scene.walls().len() as u64, "wall", "walls"),
        plainly(scene.vertices().len() as u64, "vertex", "vertices")
    ))
}
