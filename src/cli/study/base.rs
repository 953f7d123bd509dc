//! What all commands about a study's folder have in common.

use std::path::{Path, PathBuf};

use tautline::session::Folder;

/// Where the study's files are.
#[derive(Debug, clap::Args)]
pub(crate) struct BaseArgs {
    /// The folder from which the study's file names scene and traces, if it is another than when the study began
    #[arg(long, value_name = "DIR")]
    base: Option<PathBuf>,
}

impl BaseArgs {
    /// The folder, if it is given.
    pub(super) fn folder(&self) -> Option<&Path> {
        self.base.as_deref()
    }
}

/// Says what there is to note of a study's folder.
pub(super) fn tell(folder: &Folder) {
    folder.notes().iter().for_each(|note| say!("note: {note}"));
}
