//! What a sweep's folder remembers: which studies there are.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{Difference, SessionError};
use super::folder::{difference, is_raised, written_shard};
use super::names::SWEEP;
use crate::study::{Plan, Shard, Sweep, names};

/// What a sweep is: what `sweep.json` holds, the points in the order of their folders.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepRecord {
    /// The keys that differ from point to point, in the order of the file.
    pub keys: Vec<String>,
    /// The number of the point with which all are compared, counted from 0.
    pub against: usize,
    /// The folder from which the studies' files are named.
    pub base: PathBuf,
    /// Which part of each study this is, as K/N.
    #[serde(with = "written_shard")]
    #[schemars(with = "String")]
    pub shard: Shard,
    /// The studies.
    pub points: Vec<SweptStudy>,
    /// Of all before, as JSON without spaces: BLAKE3.
    pub check: String,
}

/// A study of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweptStudy {
    /// Its folder, in that of the sweep.
    pub folder: String,
    /// The values of the keys, in their order.
    pub values: Vec<serde_json::Value>,
    /// The study, as it would be without a sweep.
    pub study: Plan,
}

impl SweepRecord {
    /// The JSON Schema of `sweep.json`.
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(SweepRecord).to_value()
    }

    pub(super) fn new(sweep: &Sweep, base: &Path, shard: Shard) -> Result<SweepRecord, SessionError> {
        let base = base.canonicalize().map_err(|cause| SessionError::Base { path: base.to_owned(), cause })?;
        let points = names(0..sweep.points().len()).zip(sweep.points()).map(|(folder, point)| SweptStudy {
            folder,
            values: point.values.clone(),
            study: point.plan.clone(),
        });
        let keys = sweep.keys().map(str::to_owned).collect();
        let record =
            SweepRecord { keys, against: sweep.against(), base, shard, points: points.collect(), check: String::new() };
        record.checked()
    }

    /// The same for another part of the studies.
    pub(super) fn of_part(&self, shard: Shard) -> Result<SweepRecord, SessionError> {
        SweepRecord { shard, ..self.clone() }.checked()
    }

    /// With its own check sum.
    fn checked(self) -> Result<SweepRecord, SessionError> {
        Ok(SweepRecord { check: self.sum()?, ..self })
    }

    fn sum(&self) -> Result<String, serde_json::Error> {
        let bare = SweepRecord { check: String::new(), ..self.clone() };
        Ok(blake3::hash(&serde_json::to_vec(&bare)?).to_hex().to_string())
    }

    /// What the folder remembers.
    pub(super) fn read(folder: &Path) -> Result<SweepRecord, SessionError> {
        let file = folder.join(SWEEP);
        let text =
            std::fs::read_to_string(&file).map_err(|cause| SessionError::NoSweep { file: file.clone(), cause })?;
        let damaged = |cause| SessionError::Damaged { file: file.clone(), cause };
        let record: SweepRecord = serde_json::from_str(&text).map_err(|e| damaged(Some(e)))?;
        let is_place = |name: &str| !name.is_empty() && !name.contains(['/', '\\']) && name != "." && name != "..";
        let is_whole =
            record.points.iter().all(|point| point.values.len() == record.keys.len() && is_place(&point.folder))
                && record.against < record.points.len();
        if record.check != record.sum()? || !is_whole {
            return Err(damaged(None));
        }
        Ok(record)
    }

    /// How it differs from what is asked for here; `None` if all that differs is what is compared with what, from where
    /// files are named, and, where it `may_raise` them, that there are more traces here.
    pub(super) fn difference(&self, here: &SweepRecord, may_raise: bool) -> Option<Difference> {
        let key =
            |name: &str, there: String, here: String| Some(Difference::Key { name: name.to_owned(), there, here });
        if self.shard != here.shard {
            return Some(Difference::Shard { there: self.shard, here: here.shard });
        }
        if self.keys != here.keys {
            return key("sweep", self.keys.join(", "), here.keys.join(", "));
        }
        for (place, name) in self.keys.iter().enumerate() {
            let [there, here] = [self, here].map(|record| record.values(place));
            if there != here {
                return key(&format!("sweep.{name}"), there, here);
            }
        }
        let mut points = self.points.iter().zip(&here.points);
        points.find_map(|(there, here)| {
            let is_more = may_raise && is_raised(&there.study, &here.study);
            difference(&there.study, &here.study).filter(|_| !is_more)
        })
    }

    /// The values of the key at this place, each once, as JSON.
    fn values(&self, place: usize) -> String {
        let mut values: Vec<String> = Vec::new();
        for value in self.points.iter().map(|point| point.values[place].to_string()) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        format!("[{}]", values.join(", "))
    }
}
