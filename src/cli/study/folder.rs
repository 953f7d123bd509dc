//! The folder in which a study lives.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::anyhow;
use serde::{Deserialize, Serialize};
use tautline::output::{WholeFile, WriteError};
use tautline::study::{Plan, State, Study};

use super::parts::TRACES;
use crate::cli::failure::Failure;

/// What the run cost and where it ran.
pub(super) const RUN_REPORT: &str = "run.json";

/// What a folder remembers of its study: enough to go on with it.
#[derive(Serialize, Deserialize)]
struct Remembered {
    plan: Plan,
    /// The folder from which the plan's files are named.
    base: PathBuf,
}

/// Where the study's files are.
#[derive(Debug, clap::Args)]
pub(crate) struct BaseArgs {
    /// The folder from which the study's file names scene and traces, if it is another than when the study began
    #[arg(long, value_name = "DIR")]
    base: Option<PathBuf>,
}

/// The folder in which a study lives.
pub(super) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes a folder for a new study.
    pub(super) fn create(path: &Path) -> Result<Self, Failure> {
        let folder = Folder::at(path);
        if folder.state_path().exists() || folder.study_path().exists() {
            let shown = path.display();
            return Err(Failure::input(anyhow!(
                "{shown} holds a study already: go on with it by `tautline study resume {shown}`, or give another --out"
            )));
        }
        if let Some(rows) = [TRACES, "traces"].iter().map(|name| path.join(name)).find(|rows| rows.exists()) {
            return Err(Failure::input(anyhow!("{} is there already; give another --out", rows.display())));
        }
        fs::create_dir_all(path)
            .map_err(|e| Failure::system(e.kind(), anyhow!("cannot make {}: {e}", path.display())))?;
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

    /// Opens the study and its state, which are there.
    pub(super) fn open(path: &Path, base: &BaseArgs) -> Result<(Self, Study, State), Failure> {
        let folder = Folder::at(path);
        let (study, _) = folder.study(base)?;
        let state = folder.state(&study)?;
        Ok((folder, study, state))
    }

    /// Opens the study, and tells the folder from which its files are named.
    pub(super) fn study(&self, base: &BaseArgs) -> Result<(Study, PathBuf), Failure> {
        let Remembered { plan, base: began } = self.remembered()?;
        let folder = base.base.clone().unwrap_or(began);
        let study = Study::open(plan, &folder).map_err(|e| match &base.base {
            None => Failure::input(anyhow!(
                "{e}\n(the study's files are named from {}; if they have moved, give --base DIR)",
                folder.display()
            )),
            Some(_) => e.into(),
        })?;
        Ok((study, folder))
    }

    /// How far a study is whose folder this is.
    pub(super) fn state(&self, study: &Study) -> Result<State, Failure> {
        Ok(State::load(&self.state_path(), study)?)
    }

    /// A study's folder that is there.
    pub(super) fn at(path: &Path) -> Self {
        Folder { path: path.to_owned() }
    }

    pub(super) fn save(&self, state: &State) -> Result<(), WriteError> {
        state.save(&self.state_path())
    }

    /// What was said of the run before, if that can be read.
    pub(super) fn run_report(&self) -> Option<serde_json::Value> {
        serde_json::from_slice(&fs::read(self.path.join(RUN_REPORT)).ok()?).ok()
    }

    /// Writes a file of the folder, whole or not at all.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.path.join(name);
        let mut file = WholeFile::create(&path)?;
        std::io::Write::write_all(&mut file, bytes).map_err(|cause| WriteError::Io { path, cause })?;
        Ok(file.finish()?)
    }
}
