//! The folder in which a study lives.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::error::{Difference, Note, SessionError};
use super::lock::Lock;
use super::names::{LOCK, PAGE, PARTS, RUN_REPORT, STATE, STUDY, SUMMARY, SWEEP, TRACES};
use super::report::RunReport;
use crate::output::{WholeFile, WriteError, remove_left_files};
use crate::study::{Check, Plan, Shard, State, Study};

/// What a folder remembers of its study: enough to begin it.
#[derive(Serialize, Deserialize)]
struct Remembered {
    plan: Plan,
    /// The folder from which the plan's files are named.
    base: PathBuf,
    /// Which part of the study it is, as K/N.
    #[serde(with = "written_shard")]
    shard: Shard,
    /// Of all before, as JSON without spaces: BLAKE3.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    check: String,
}

impl Remembered {
    fn check(&self) -> Result<String, serde_json::Error> {
        let bare =
            Remembered { plan: self.plan.clone(), base: self.base.clone(), shard: self.shard, check: String::new() };
        Ok(blake3::hash(&serde_json::to_vec(&bare)?).to_hex().to_string())
    }
}

/// The folder in which a study lives.
pub struct Folder {
    path: PathBuf,
    /// Where this process writes to it.
    lock: Option<Lock>,
    /// The folders that were made for it, the outermost first.
    made: Vec<PathBuf>,
    /// What would be lost if it were taken back.
    stage: AtomicU8,
    notes: Mutex<Vec<Note>>,
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
        Folder {
            path: path.to_owned(),
            lock: None,
            made: Vec::new(),
            stage: AtomicU8::new(UNTOUCHED),
            notes: Mutex::default(),
        }
    }

    /// A folder that this process alone writes to from now on; it is made if it is not there.
    ///
    /// # Errors
    ///
    /// Another process that writes there, something else that stands there, and what the operating system says.
    pub fn make(path: &Path) -> Result<Self, SessionError> {
        if path.exists() && !path.is_dir() {
            return Err(SessionError::NoFolder { path: path.to_owned() });
        }
        let mut made: Vec<PathBuf> =
            path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(Path::to_owned).collect();
        made.reverse();
        let mut folder = Folder { made, ..Folder::at(path) };
        let lock = fs::create_dir_all(path)
            .map_err(|cause| WriteError::Io { path: path.to_owned(), cause }.into())
            .and_then(|()| Lock::take(path, |note| folder.note(note)));
        match lock {
            Ok(lock) => folder.lock = Some(lock),
            Err(error) => {
                folder.remove_made();
                return Err(error);
            }
        }
        folder.tidy();
        Ok(folder)
    }

    /// The same of a folder in which there is a study.
    ///
    /// # Errors
    ///
    /// As [`make`](Self::make), and a folder without a study.
    pub fn open(path: &Path) -> Result<Self, SessionError> {
        let mut folder = Folder::at(path);
        // Before anything is made there: it is no study's folder if this fails.
        fs::metadata(folder.file(STUDY)).map_err(|e| folder.no_study(e))?;
        folder.lock = Some(Lock::take(path, |note| folder.note(note))?);
        folder.tidy();
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What there was to note since this was asked last.
    pub fn notes(&self) -> Vec<Note> {
        std::mem::take(&mut self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(super) fn note(&self, note: Note) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
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
    pub(super) fn remember(&self, plan: &Plan, base: &Path, shard: Shard) -> Result<(), SessionError> {
        let base = base.canonicalize().map_err(|cause| SessionError::Base { path: base.to_owned(), cause })?;
        let mut remembered = Remembered { plan: plan.clone(), base, shard, check: String::new() };
        remembered.check = remembered.check()?;
        let text = serde_json::to_string_pretty(&remembered)?;
        self.write(STUDY, format!("{text}\n").as_bytes())
    }

    fn no_study(&self, cause: std::io::Error) -> SessionError {
        match self.file(SWEEP).exists() {
            true => SessionError::IsSweep { folder: self.path.clone() },
            false => SessionError::NoStudy { file: self.file(STUDY), cause },
        }
    }

    fn remembered(&self) -> Result<Remembered, SessionError> {
        let text = fs::read_to_string(self.file(STUDY)).map_err(|e| self.no_study(e))?;
        let damaged = |cause| SessionError::Damaged { file: self.file(STUDY), cause };
        let remembered: Remembered = serde_json::from_str(&text).map_err(|e| damaged(Some(e)))?;
        if remembered.check != remembered.check()? {
            return Err(damaged(None));
        }
        Ok(remembered)
    }

    /// What the study is, and which part of it this is.
    pub(super) fn plan(&self) -> Result<(Plan, Shard), SessionError> {
        let Remembered { plan, shard, .. } = self.remembered()?;
        Ok((plan, shard))
    }

    /// Opens the study, and tells the folder from which its files are named: `base`, or else that as it began.
    pub(super) fn study(&self, base: Option<&Path>) -> Result<(Study, PathBuf), SessionError> {
        let Remembered { plan, base: began, .. } = self.remembered()?;
        let folder = base.map_or(began, Path::to_owned);
        let study = Study::open(plan, &folder)
            .map_err(|error| SessionError::Plan { error, began: base.is_none().then(|| folder.clone()) })?;
        Ok((study, folder))
    }

    /// How far a study is whose folder this is.
    pub(super) fn state(&self, study: &Study) -> Result<State, SessionError> {
        State::load(&self.file(STATE), study).map_err(|error| {
            let can_begin_again = error.is_useless();
            SessionError::State { error, folder: can_begin_again.then(|| self.path.clone()) }
        })
    }

    /// How far a study is whose folder this is: at its beginning if no state is there.
    pub(super) fn state_or_new(&self, study: &Study) -> Result<State, SessionError> {
        if self.file(STATE).exists() {
            return self.state(study);
        }
        let part = self.remembered()?.shard;
        self.note(Note::Begins { folder: self.path.clone() });
        Ok(State::new(study, part))
    }

    /// How far the folder is with this part of this study; `None` if it holds nothing of it, nor of anything else.
    /// Where it `may_raise` the number of traces, the folder may hold the study with fewer.
    pub(super) fn held(&self, study: &Study, part: Shard, may_raise: bool) -> Result<Option<State>, SessionError> {
        let another = |difference| SessionError::Another { folder: self.path.clone(), difference };
        let remembered = self.remembered().ok();
        let difference = remembered.as_ref().map(|there| difference(&there.plan, study.plan()));
        if self.file(STATE).exists() {
            let mut state = State::load(&self.file(STATE), study);
            if let (Err(error), Some(there)) = (&state, remembered.as_ref().filter(|_| may_raise))
                && error.is_foreign()
                && is_raised(&there.plan, study.plan())
            {
                state = State::load_raised(&self.file(STATE), study, there.plan.run.count());
            }
            return match state {
                Ok(state) if state.shard() == part => {
                    self.is_begun();
                    Ok(Some(state))
                }
                Ok(state) => Err(another(Difference::Shard { there: state.shard(), here: part })),
                Err(e) if e.is_foreign() => Err(another(difference.flatten().unwrap_or(Difference::Inputs))),
                Err(_) => self.state(study).map(Some),
            };
        }
        let is_same = difference == Some(None) && remembered.is_some_and(|there| there.shard == part);
        let there = [SUMMARY, RUN_REPORT, PAGE, TRACES, PARTS, SWEEP].map(|name| self.file(name));
        match there.iter().find(|file| file.exists()) {
            Some(file) if !is_same => Err(SessionError::Occupied { file: file.clone() }),
            found => {
                self.stage.store(if found.is_some() { BEGUN } else { NEW }, Ordering::SeqCst);
                Ok(None)
            }
        }
    }

    /// An error if the folder has been moved, since another may have taken its place, and if another process has taken
    /// it over. It is asked before anything is written.
    pub(super) fn check_place(&self) -> Result<(), SessionError> {
        let Some(lock) = &self.lock else { return Ok(()) };
        if !lock.is_in_place() {
            let cause =
                std::io::Error::other("the study's folder is not there any more; if it was moved, resume it there");
            return Err(WriteError::Io { path: self.file(STATE), cause }.into());
        }
        if lock.is_held() { Ok(()) } else { Err(SessionError::Lost { folder: self.path.clone() }) }
    }

    /// Lets go of the folder before the process ends, where nothing more is written.
    pub fn give_up(&self) {
        self.lock.iter().for_each(Lock::give_up);
    }

    pub(super) fn save(&self, state: &State) -> Result<(), SessionError> {
        self.check_place()?;
        Ok(state.save(&self.file(STATE))?)
    }

    /// What was said of the run before, if it is as it was written.
    pub(super) fn run_report(&self, state: &State) -> Option<RunReport> {
        let bytes = fs::read(self.file(RUN_REPORT)).ok()?;
        let is_whole = state.kept.files.get(RUN_REPORT) == Some(blake3::hash(&bytes).as_bytes());
        is_whole.then(|| serde_json::from_slice(&bytes).ok())?
    }

    /// Writes a file of the folder, whole or not at all.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), SessionError> {
        self.check_place()?;
        let path = self.file(name);
        let mut file = WholeFile::create(&path)?;
        file.write_all(bytes).map_err(|cause| WriteError::Io { path, cause })?;
        Ok(file.finish_durably()?)
    }

    /// From now on there is something that must not be lost.
    pub(super) fn is_begun(&self) {
        self.stage.store(BEGUN, Ordering::SeqCst);
    }

    /// Takes back what this process did here, unless there is something that must not be lost. What has taken the
    /// folder's place meanwhile is another's.
    pub fn take_back(&self) {
        if self.check_place().is_err() {
            return;
        }
        let stage = self.stage.load(Ordering::SeqCst);
        let is_own = stage == NEW || (stage == UNTOUCHED && self.lock.as_ref().is_some_and(|lock| lock.is_new));
        if stage == NEW {
            // What cannot be removed is taken over by the next run that begins here.
            [STATE, STUDY, TRACES].iter().for_each(|name| drop(fs::remove_file(self.file(name))));
            let _ = fs::remove_dir_all(self.file(PARTS));
            self.tidy();
        }
        self.give_up();
        if is_own {
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

/// A shard as it is written on the command line.
pub(super) mod written_shard {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    use crate::study::Shard;

    pub(crate) fn serialize<S: Serializer>(shard: &Shard, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(shard)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Shard, D::Error> {
        String::deserialize(from)?.parse().map_err(D::Error::custom)
    }
}

/// Whether all that differs is that there are more traces here.
pub(super) fn is_raised(there: &Plan, here: &Plan) -> bool {
    let mut same = there.clone();
    same.run.traces = here.run.traces;
    there.run.count() < here.run.count() && difference(&same, here).is_none()
}

/// The first key in which two studies differ, with both values, whatever they write out.
pub(super) fn difference(there: &Plan, here: &Plan) -> Option<Difference> {
    fn first(name: &str, there: &serde_json::Value, here: &serde_json::Value) -> Option<Difference> {
        if let (Some(a), Some(b)) = (there.as_object(), here.as_object()) {
            let null = serde_json::Value::Null;
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let of = |key: &String| {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                first(&name, a.get(key).unwrap_or(&null), b.get(key).unwrap_or(&null))
            };
            return keys.filter(|key| !name.is_empty() || *key != "outputs").find_map(of);
        }
        let difference = || Difference::Key { name: name.to_owned(), there: there.to_string(), here: here.to_string() };
        (there != here).then(difference)
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
