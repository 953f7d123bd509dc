//! The folder in which a study lives.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use serde::{Deserialize, Serialize};
use tautline::output::{WholeFile, WriteError};
use tautline::study::{Plan, State, Study};

use crate::cli::failure::Failure;

/// What a folder remembers of its study: enough to go on with it.
#[derive(Serialize, Deserialize)]
struct Remembered {
    plan: Plan,
    /// The folder from which the plan's files are named.
    base: PathBuf,
}

/// The folder in which a study lives.
pub(super) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes a folder for a new study.
    pub(super) fn create(path: &Path) -> Result<Self, Failure> {
        let folder = Folder { path: path.to_owned() };
        if folder.state_path().exists() || folder.study_path().exists() {
            let shown = path.display();
            return Err(Failure::input(anyhow!(
                "{shown} holds a study already: go on with it by `tautline study resume {shown}`, or give another --out"
            )));
        }
        fs::create_dir_all(path).map_err(|e| Failure::input(anyhow!("cannot make {}: {e}", path.display())))?;
        Ok(folder)
    }

    /// The first of `name`, `name-2`, `name-3` and so on that is not there yet.
    pub(super) fn unused(name: &str) -> PathBuf {
        let numbered = (2..).map(|i| PathBuf::from(format!("{name}-{i}")));
        let mut names = std::iter::once(PathBuf::from(name)).chain(numbered);
        names.find(|path| !path.exists()).expect("there are names without end")
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    fn state_path(&self) -> PathBuf {
        self.path.join("state.bin")
    }

    fn study_path(&self) -> PathBuf {
        self.path.join("study.json")
    }

    /// Remembers the study.
    pub(super) fn remember(&self, plan: &Plan, base: &Path) -> Result<(), Failure> {
        let base = base.canonicalize().map_err(|e| Failure::input(anyhow!("{}: {e}", base.display())))?;
        let remembered = Remembered { plan: plan.clone(), base };
        let text = serde_json::to_string_pretty(&remembered).map_err(|e| Failure::internal(e.into()))?;
        self.write("study.json", format!("{text}\n").as_bytes())
    }

    fn remembered(&self) -> Result<Remembered, Failure> {
        let file = self.study_path();
        let text = fs::read_to_string(&file).map_err(|e| {
            Failure::input(anyhow!("{}: {e}; give the folder that `tautline study run` made", file.display()))
        })?;
        serde_json::from_str(&text).map_err(|e| Failure::input(anyhow!("{}: {e}", file.display())))
    }

    /// The folder from which the plan's files are named.
    pub(super) fn base(&self) -> Result<PathBuf, Failure> {
        Ok(self.remembered()?.base)
    }

    /// Opens the study and its state, which are there.
    pub(super) fn open(path: &Path) -> Result<(Self, Study, State), Failure> {
        let folder = Folder { path: path.to_owned() };
        let Remembered { plan, base } = folder.remembered()?;
        let study = Study::open(plan, &base)?;
        let state = State::load(&folder.state_path(), &study)?;
        Ok((folder, study, state))
    }

    pub(super) fn save(&self, state: &State) -> Result<(), WriteError> {
        state.save(&self.state_path())
    }

    /// Writes a file of the folder, whole or not at all.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.path.join(name);
        let mut file = WholeFile::create(&path)?;
        std::io::Write::write_all(&mut file, bytes).map_err(|cause| WriteError::Io { path, cause })?;
        Ok(file.finish()?)
    }
}
