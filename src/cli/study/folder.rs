//! The folder in which a study lives.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU8, Ordering};

use anyhow::anyhow;
use serde::{Deserialize, Serialize};
use tautline::output::{WholeFile, WriteError, remove_left_files};
use tautline::study::{Check, Plan, Shard, State, Study};

use super::lock::{LOCK, Lock};
use super::parts::{PARTS, TRACES};
use super::shard;
use crate::cli::failure::Failure;

/// The answer.
pub(super) const SUMMARY: &str = "summary.json";

/// What the run cost and where it ran.
pub(super) const RUN_REPORT: &str = "run.json";

/// The answer as a page.
pub(super) const PAGE: &str = "report.html";

const STATE: &str = "state.bin";
const STUDY: &str = "study.json";

/// What a folder remembers of its study: enough to begin it.
#[derive(Serialize, Deserialize)]
struct Remembered {
    plan: Plan,
    /// The folder from which the plan's files are named.
    base: PathBuf,
    /// Which part of the study it is: K/N.
    shard: String,
    /// Of all before, as JSON without spaces: BLAKE3.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    check: String,
}

impl Remembered {
    fn check(&self) -> Result<String, Failure> {
        let bare = Remembered {
            plan: self.plan.clone(),
            base: self.base.clone(),
            shard: self.shard.clone(),
            check: String::new(),
        };
        let text = serde_json::to_vec(&bare).map_err(|e| Failure::internal(e.into()))?;
        Ok(blake3::hash(&text).to_hex().to_string())
    }
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
    /// Where this process writes to it.
    lock: Option<Lock>,
    /// The folders that were made for it, the outermost first.
    made: Vec<PathBuf>,
    /// What would be lost if it were taken back.
    stage: AtomicU8,
}

/// Nothing of a study has been written here by this process.
const UNTOUCHED: u8 = 0;
/// There is nothing but a study that has just begun.
const NEW: u8 = 1;
/// There is something that must not be lost.
const BEGUN: u8 = 2;

impl Folder {
    /// A study's folder that is read.
    pub(super) fn at(path: &Path) -> Self {
        Folder { path: path.to_owned(), lock: None, made: Vec::new(), stage: AtomicU8::new(UNTOUCHED) }
    }

    /// A study's folder that is written to; it is made if it is not there.
    pub(super) fn make(path: &Path) -> Result<Self, Failure> {
        if path.exists() && !path.is_dir() {
            return Err(Failure::input(anyhow!("{} is there already and is no folder; give another", path.display())));
        }
        let mut made: Vec<PathBuf> =
            path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(Path::to_owned).collect();
        made.reverse();
        let mut folder = Folder { made, ..Folder::at(path) };
        let lock = fs::create_dir_all(path)
            .map_err(|cause| WriteError::Io { path: path.to_owned(), cause }.into())
            .and_then(|()| Lock::take(path));
        match lock {
            Ok(lock) => folder.lock = Some(lock),
            Err(failure) => {
                folder.remove_made();
                return Err(failure);
            }
        }
        folder.tidy();
        Ok(folder)
    }

    /// A study's folder that is there and is written to.
    pub(super) fn go_on(path: &Path) -> Result<Self, Failure> {
        let mut folder = Folder::at(path);
        // Before anything is made there: it is no study's folder if this fails.
        fs::metadata(folder.file(STUDY)).map_err(|e| folder.no_study(&e))?;
        folder.lock = Some(Lock::take(path)?);
        folder.tidy();
        Ok(folder)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Removes what killed runs left.
    pub(super) fn tidy(&self) {
        remove_left_files(&self.path);
        remove_left_files(&self.file(PARTS));
    }

    /// Remembers the study.
    pub(super) fn remember(&self, plan: &Plan, base: &Path, shard: Shard) -> Result<(), Failure> {
        let base = base.canonicalize().map_err(|e| Failure::input(anyhow!("{}: {e}", base.display())))?;
        let mut remembered = Remembered { plan: plan.clone(), base, shard: shard.to_string(), check: String::new() };
        remembered.check = remembered.check()?;
        let text = serde_json::to_string_pretty(&remembered).map_err(|e| Failure::internal(e.into()))?;
        self.write(STUDY, format!("{text}\n").as_bytes())
    }

    fn no_study(&self, e: &std::io::Error) -> Failure {
        let file = self.file(STUDY);
        Failure::input(anyhow!("{}: {e}; give the folder that `tautline study run` made", file.display()))
    }

    fn remembered(&self) -> Result<Remembered, Failure> {
        let text = fs::read_to_string(self.file(STUDY)).map_err(|e| self.no_study(&e))?;
        let fault = |what: &dyn std::fmt::Display| {
            let file = self.file(STUDY);
            let way_out = "`tautline study run` with the study's own file and this folder as --out writes it again";
            Failure::input(anyhow!("{}: {what}; {way_out}", file.display()))
        };
        let remembered: Remembered = serde_json::from_str(&text).map_err(|e| fault(&format!("damaged: {e}")))?;
        if remembered.check != remembered.check()? {
            return Err(fault(&"damaged, or made into another study by hand: its check sum is wrong"));
        }
        Ok(remembered)
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
        let Remembered { plan, base: began, .. } = self.remembered()?;
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
        State::load(&self.file(STATE), study).map_err(|e| {
            if e.is_foreign() || !e.path.exists() {
                return e.into();
            }
            let shown = self.path.display();
            Failure::input(anyhow!("{e}; remove it to have `tautline study resume {shown}` begin again"))
        })
    }

    /// How far a study is whose folder this is: at its beginning if no state is there.
    pub(super) fn state_or_new(&self, study: &Study) -> Result<State, Failure> {
        if self.file(STATE).exists() {
            return self.state(study);
        }
        let part = shard(&self.remembered()?.shard).map_err(|e| Failure::input(anyhow!(e)))?;
        say!("note: {}: no state was saved, so the study begins", self.path.display());
        Ok(State::new(study, part))
    }

    /// How far the folder is with this part of this study; `None` if it holds nothing of it, nor of anything else.
    pub(super) fn held(&self, study: &Study, part: Shard) -> Result<Option<State>, Failure> {
        let shown = self.path.display();
        let another = |how: &str| {
            Failure::input(anyhow!(
                "{shown} holds a study already, and another one: {how}; go on with that by `tautline study resume {shown}`, \
                 or give another --out"
            ))
        };
        let remembered = self.remembered().ok();
        let difference = remembered.as_ref().map(|there| difference(&there.plan, study.plan()));
        if self.file(STATE).exists() {
            return match State::load(&self.file(STATE), study) {
                Ok(state) if state.shard() == part => {
                    self.is_begun();
                    Ok(Some(state))
                }
                Ok(state) => Err(another(&format!("shard {}, and not {part}", state.shard()))),
                Err(e) if e.is_foreign() => Err(another(&difference.flatten().unwrap_or_else(|| {
                    "its scene or its traces are others, or another version has begun it".to_owned()
                }))),
                Err(_) => self.state(study).map(Some),
            };
        }
        let is_same = difference == Some(None) && remembered.is_some_and(|there| there.shard == part.to_string());
        let there = [SUMMARY, RUN_REPORT, PAGE, TRACES, PARTS].map(|name| self.file(name));
        match there.iter().find(|file| file.exists()) {
            Some(file) if !is_same => {
                Err(Failure::input(anyhow!("{} is there already; give another --out", file.display())))
            }
            found => {
                self.stage.store(if found.is_some() { BEGUN } else { NEW }, Ordering::SeqCst);
                Ok(None)
            }
        }
    }

    /// An error if the folder has been moved: another may have taken its place.
    pub(super) fn check_place(&self) -> Result<(), WriteError> {
        if self.lock.as_ref().is_some_and(|lock| !lock.is_in_place()) {
            let cause =
                std::io::Error::other("the study's folder is not there any more; if it was moved, resume it there");
            return Err(WriteError::Io { path: self.file(STATE), cause });
        }
        Ok(())
    }

    pub(super) fn save(&self, state: &State) -> Result<(), WriteError> {
        self.check_place()?;
        state.save(&self.file(STATE))
    }

    /// What was said of the run before, if it is as it was written.
    pub(super) fn run_report(&self, state: &State) -> Option<serde_json::Value> {
        let bytes = fs::read(self.file(RUN_REPORT)).ok()?;
        let is_whole = state.kept.files.get(RUN_REPORT) == Some(blake3::hash(&bytes).as_bytes());
        is_whole.then(|| serde_json::from_slice(&bytes).ok())?
    }

    /// Writes a file of the folder, whole or not at all.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        let path = self.file(name);
        let mut file = WholeFile::create(&path)?;
        file.write_all(bytes).map_err(|cause| WriteError::Io { path, cause })?;
        Ok(file.finish_durably()?)
    }

    /// From now on there is something that must not be lost.
    pub(super) fn is_begun(&self) {
        self.stage.store(BEGUN, Ordering::SeqCst);
    }

    /// Takes back what this process did here, unless there is something that must not be lost. What has taken the folder's place
    /// meanwhile is another's.
    pub(super) fn take_back(&self) {
        if self.lock.as_ref().is_some_and(|lock| !lock.is_in_place()) {
            return;
        }
        let stage = self.stage.load(Ordering::SeqCst);
        if stage == NEW {
            // What cannot be removed is taken over by the next run that begins here.
            [STATE, STUDY, TRACES].iter().for_each(|name| drop(fs::remove_file(self.file(name))));
            let _ = fs::remove_dir_all(self.file(PARTS));
            self.tidy();
        }
        if stage == NEW || (stage == UNTOUCHED && self.lock.as_ref().is_some_and(|lock| lock.is_new)) {
            let _ = fs::remove_file(self.file(LOCK));
            self.remove_made();
        }
    }

    fn remove_made(&self) {
        self.made.iter().rev().for_each(|folder| drop(fs::remove_dir(folder)));
    }
}

/// The check sum of a file.
pub(super) fn check(path: &Path) -> std::io::Result<Check> {
    let mut hasher = blake3::Hasher::new();
    hasher.update_reader(fs::File::open(path)?)?;
    Ok(hasher.finalize().into())
}

/// The first key in which two studies differ, with both values, whatever they write out.
fn difference(there: &Plan, here: &Plan) -> Option<String> {
    fn first(name: &str, there: &serde_json::Value, here: &serde_json::Value) -> Option<String> {
        if let (Some(a), Some(b)) = (there.as_object(), here.as_object()) {
            let null = serde_json::Value::Null;
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let of = |key: &String| {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                first(&name, a.get(key).unwrap_or(&null), b.get(key).unwrap_or(&null))
            };
            return keys.filter(|key| !name.is_empty() || *key != "outputs").find_map(of);
        }
        (there != here).then(|| format!("{name} is {there} there and {here} here"))
    }
    let [there, here] = [there, here].map(|plan| serde_json::to_value(plan).unwrap_or_default());
    first("", &there, &here)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_took_the_place_of_a_folder_is_not_taken_back() {
        let room = tempfile::tempdir().unwrap();
        let [path, moved] = ["a", "b"].map(|name| room.path().join(name));
        let folder = Folder::make(&path).unwrap();
        folder.stage.store(NEW, Ordering::SeqCst);
        fs::rename(&path, moved).unwrap();
        fs::create_dir(&path).unwrap();
        fs::write(path.join(STATE), "another's").unwrap();
        folder.take_back();
        assert_eq!(fs::read(path.join(STATE)).unwrap(), b"another's");
    }
}
