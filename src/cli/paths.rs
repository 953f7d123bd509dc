//! Files that a run names: what is written must not replace what is read, nor what is written besides.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use tautline::output::folder_of;
use tautline::scene::map_image;

use super::failure::Failure;

/// A file, if it is given, and how the command line calls it.
pub(crate) type Named<'a> = (&'a str, Option<&'a Path>);

/// Refuses outputs that are the same file as an input, or as an output before them. The image that a map
/// names is an input too.
pub(crate) fn keep_apart(inputs: &[Named<'_>], outputs: &[Named<'_>]) -> Result<(), Failure> {
    let given = |(name, path): &Named<'_>| path.map(|path| ((*name).to_owned(), path.to_owned()));
    let image = |(name, path): &Named<'_>| Some((format!("the image of {name}"), map_image((*path)?)?));
    let mut taken: Vec<(String, PathBuf)> = inputs.iter().filter_map(given).collect();
    if outputs.iter().any(|(_, path)| path.is_some()) {
        taken.extend(inputs.iter().filter_map(image));
    }
    for (output, path) in outputs.iter().filter_map(given) {
        if let Some((other, _)) = taken.iter().find(|(_, other)| place(other) == place(&path)) {
            return Err(Failure::input(anyhow!("{other} and {output} name the same file, {}", path.display())));
        }
        taken.push((output, path));
    }
    Ok(())
}

/// The path without links and detours, so that equal places have equal paths; the file need not be there yet.
pub(crate) fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = folder_of(path);
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        path.file_name().map_or(folder.clone(), |name| folder.join(name))
    })
}
