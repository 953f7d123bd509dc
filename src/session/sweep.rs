//! A sweep in a folder: a folder for each of its studies, and what all of them say side by side.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::conclude::{WIDTH, look};
use super::error::SessionError;
use super::folder::Folder;
use super::merge::merge;
use super::names::{STATE, STUDY, SUMMARY, SWEEP, SWEEP_CSV, SWEEP_PARQUET};
use super::report::pretty;
use super::sweep_record::{SweepRecord, SweptStudy};
use crate::output::{WholeFile, WriteError, remove_left_files};
use crate::picture::{self, PictureError};
use crate::study::{PointAnswer, Reference, Shard, Stopped, Sweep, SweepAnswer};

/// The folder of a sweep. It remembers which studies there are; each has a folder of its own in it, as one that is run
/// alone, with its own lock and its own state.
pub struct SweepFolder {
    path: PathBuf,
    record: SweepRecord,
}

impl SweepFolder {
    /// Whether a folder is that of a sweep.
    pub fn is_at(path: &Path) -> bool {
        path.join(SWEEP).exists()
    }

    /// The folder `path` for part `shard` of each study of a sweep: it is made, or holds that already. The studies'
    /// files are named from `base`. Where it `may_raise` the number of traces, the folder may hold the sweep with
    /// fewer.
    ///
    /// # Errors
    ///
    /// A folder that holds something else, and what the operating system says.
    pub fn begin(path: &Path, sweep: &Sweep, base: &Path, shard: Shard, may_raise: bool) -> Result<Self, SessionError> {
        SweepFolder { path: path.to_owned(), record: SweepRecord::new(sweep, base, shard)? }.begun(may_raise)
    }

    /// Has the folder remember the sweep.
    fn begun(self, may_raise: bool) -> Result<Self, SessionError> {
        let path = &self.path;
        if path.exists() && !path.is_dir() {
            return Err(SessionError::NoFolder { path: path.clone() });
        }
        match SweepRecord::read(path) {
            Ok(there) => {
                if let Some(difference) = there.difference(&self.record, may_raise) {
                    return Err(SessionError::Another { folder: path.clone(), difference });
                }
            }
            Err(SessionError::NoSweep { .. }) => {
                let there = [STUDY, STATE, SUMMARY].map(|name| path.join(name));
                if let Some(file) = there.into_iter().find(|file| file.exists()) {
                    return Err(SessionError::Occupied { file });
                }
            }
            // The folders of the studies know what they hold.
            Err(SessionError::Damaged { .. }) => {}
            Err(error) => return Err(error),
        }
        fs::create_dir_all(path).map_err(|cause| WriteError::Io { path: path.clone(), cause })?;
        remove_left_files(path);
        self.write(SWEEP, pretty(&self.record)?.as_bytes())?;
        Ok(self)
    }

    /// A folder in which there is a sweep.
    ///
    /// # Errors
    ///
    /// A folder without a sweep or with a damaged one.
    pub fn open(path: &Path) -> Result<Self, SessionError> {
        Ok(SweepFolder { path: path.to_owned(), record: SweepRecord::read(path)? })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the sweep is.
    pub fn record(&self) -> &SweepRecord {
        &self.record
    }

    /// The folders of all studies, with what each is.
    pub fn points(&self) -> impl Iterator<Item = (PathBuf, &SweptStudy)> {
        self.record.points.iter().map(|point| (self.path.join(&point.folder), point))
    }

    /// What the studies say so far, side by side. Their files are named from `base`, or else from where they were as
    /// each began. Whoever writes there is not disturbed. O(what was counted), and all scenes are read.
    ///
    /// # Errors
    ///
    /// A study that is damaged, or whose files are not there any more. One that has not begun is none.
    pub fn answer(&self, base: Option<&Path>) -> Result<SweepAnswer, SessionError> {
        self.answer_against(self.record.against, base)
    }

    /// The same with all points compared with the one of number `against`.
    ///
    /// # Errors
    ///
    /// Those of [`answer`](Self::answer).
    ///
    /// # Panics
    ///
    /// If there is no such point.
    pub fn answer_against(&self, against: usize, base: Option<&Path>) -> Result<SweepAnswer, SessionError> {
        let look = |path: &Path| match path.join(STATE).exists() {
            true => look(path, base).map(Some),
            false => Ok(None),
        };
        let other = look(&self.path.join(&self.record.points[against].folder))?;
        let reference =
            other.filter(|(_, state)| state.traces() > 0).map(|(study, state)| Reference::new(&study, &state));
        let points = self.points().map(|(path, point)| {
            let (folder, values) = (point.folder.clone(), point.values.clone());
            Ok(match look(&path)? {
                Some((study, state)) => PointAnswer::new(folder, values, (&study, &state), reference.as_ref()),
                None => PointAnswer::not_begun(folder, values, point.study.tallies.confidence),
            })
        });
        Ok(SweepAnswer {
            keys: self.record.keys.clone(),
            against,
            shard: (self.record.shard != Shard::WHOLE).then(|| self.record.shard.to_string()),
            points: points.collect::<Result<_, SessionError>>()?,
        })
    }

    /// Writes what the studies say so far, side by side: `sweep.csv`, `sweep.parquet` and, once one of them has an
    /// answer, the picture `sweep.svg` and `sweep.png`.
    ///
    /// # Errors
    ///
    /// Those of [`answer`](Self::answer), and what the operating system says.
    pub fn conclude(&self, base: Option<&Path>) -> Result<SweepAnswer, SessionError> {
        let answer = self.answer(base)?;
        let sheet = answer.sheet();
        [SWEEP_CSV, SWEEP_PARQUET].iter().try_for_each(|name| sheet.write(&self.path.join(name)))?;
        if let Some(svg) = picture::sweep(&answer) {
            self.write("sweep.svg", svg.as_bytes())?;
            match picture::png(&svg, WIDTH) {
                Ok(png) => self.write("sweep.png", &png)?,
                // The SVG says the same.
                Err(PictureError::Unavailable) => {}
                Err(error) => return Err(SessionError::Picture { name: "sweep".to_owned(), error }),
            }
        }
        Ok(answer)
    }

    /// The studies that ended less certain than they were asked to.
    pub fn unmet<'a>(&'a self, answer: &'a SweepAnswer) -> impl Iterator<Item = &'a str> {
        // A shard alone is no answer.
        let is_whole = self.record.shard == Shard::WHOLE;
        let both = self.record.points.iter().zip(&answer.points).filter(move |_| is_whole);
        both.filter(|(point, answer)| {
            let is_over = matches!(answer.stopped, Stopped::Complete | Stopped::Seconds);
            point.study.until.relative_error.is_some() && is_over
        })
        .map(|(point, _)| point.folder.as_str())
    }

    /// Writes a file, whole or not at all, unless it holds that already.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), SessionError> {
        let path = self.path.join(name);
        if fs::read(&path).is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        let mut file = WholeFile::create(&path)?;
        file.write_all(bytes).map_err(|cause| WriteError::Io { path, cause })?;
        Ok(file.finish_durably()?)
    }
}

/// Puts parts of a sweep together, study by study, in the folder `out`, as [`merge`] does those of one study. `made` is
/// told of the folder of each study there.
///
/// # Errors
///
/// Folders that hold no parts of one sweep, and those of [`merge`].
///
/// # Panics
///
/// If no part is given.
pub fn merge_sweep(
    parts: &[PathBuf],
    is_partial: bool,
    base: Option<&Path>,
    out: &Path,
    mut made: impl FnMut(&Arc<Folder>),
) -> Result<(SweepFolder, SweepAnswer), SessionError> {
    let records = parts.iter().map(|part| SweepRecord::read(part)).collect::<Result<Vec<_>, _>>()?;
    let record = records[0].of_part(Shard::WHOLE)?;
    for (part, other) in parts.iter().zip(&records) {
        if let Some(difference) = other.of_part(Shard::WHOLE)?.difference(&record, false) {
            return Err(SessionError::OtherSweep { folder: part.clone(), first: parts[0].clone(), difference });
        }
    }
    if parts.iter().any(|part| part.canonicalize().is_ok_and(|part| out.canonicalize().is_ok_and(|out| part == out))) {
        return Err(SessionError::IsShard { folder: out.to_owned() });
    }
    let [is_new, is_made] = [!SweepFolder::is_at(out), !out.exists()];
    let sweep = SweepFolder { path: out.to_owned(), record }.begun(false)?;
    let merged = merge_points(&sweep, parts, is_partial, base, &mut made);
    if merged.is_err() && is_new && sweep.points().all(|(folder, _)| !folder.exists()) {
        // Nothing came of it.
        let _ = fs::remove_file(out.join(SWEEP));
        let _ = if is_made { fs::remove_dir(out) } else { Ok(()) };
    }
    merged?;
    let answer = sweep.conclude(base)?;
    Ok((sweep, answer))
}

fn merge_points(
    sweep: &SweepFolder,
    parts: &[PathBuf],
    is_partial: bool,
    base: Option<&Path>,
    made: &mut impl FnMut(&Arc<Folder>),
) -> Result<(), SessionError> {
    for (folder, point) in sweep.points() {
        let own: Vec<PathBuf> = parts.iter().map(|part| part.join(&point.folder)).collect();
        // A part that came to it once others were certain enough has not begun it: what is missing is named.
        let begun: Vec<PathBuf> = own.iter().filter(|part| part.join(STATE).exists()).cloned().collect();
        // Of a study that no part has begun there is nothing to say yet.
        if is_partial && begun.is_empty() {
            continue;
        }
        let own = if begun.is_empty() { own } else { begun };
        let (session, report) = merge(&own, is_partial, base, &folder, &mut *made)?;
        session.conclude(&report)?;
    }
    Ok(())
}
