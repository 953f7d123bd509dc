//! `tautline completions` and `tautline man`.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Command;
use clap_complete::Shell;

use super::failure::Failure;
use super::print;

#[derive(Debug, clap::Args)]
pub(crate) struct CompletionsArgs {
    /// Which shell
    shell: Shell,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ManArgs {
    /// The folder to write the pages to, one for each command; it is made where there is none
    #[arg(default_value = ".", value_name = "DIR")]
    folder: PathBuf,
}

pub(crate) fn completions(args: &CompletionsArgs, mut command: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "tautline", &mut script);
    print(&String::from_utf8_lossy(&script))
}

pub(crate) fn man(args: &ManArgs, command: Command) -> Result<(), Failure> {
    let shown = args.folder.display();
    std::fs::create_dir_all(&args.folder)
        .map_err(|e| Failure::system(e.kind(), anyhow!("cannot make the folder {shown}: {e}")))?;
    clap_mangen::generate_to(command, &args.folder)
        .map_err(|e| Failure::system(e.kind(), anyhow!("cannot write to {shown}: {e}")))?;
    print(&format!("wrote the pages to {shown}; read them with: man -l {}\n", args.folder.join("tautline.1").display()))
}
