//! A study's file as it is written, with values that were given elsewhere in place of its own.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::{Table, Value};

use super::assignment::{Assignment, covers, nested};
use super::file_places::{explain, line_of, vanishing};
use super::plan::Plan;
use super::plan_error::{PlanError, PlanFault};
use crate::read_file::{SETTINGS_MAX, read_text};

/// The option by which values are given elsewhere.
const OPTION: &str = "--set";

/// The table of a file that makes it one of a sweep.
pub(super) const SWEEP: &str = "sweep";

/// A study's file, with values that were given elsewhere in place of its own.
#[derive(Debug, Clone)]
pub struct StudyFile {
    path: Option<PathBuf>,
    text: String,
    assignments: Vec<Assignment>,
    /// The file's, with all of these.
    pub(super) table: Table,
}

impl StudyFile {
    /// Reads a file (TOML) and puts the values in, the last one of a key where there are several.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is no TOML, with the line; a key in something that is no table.
    pub fn read(path: &Path, assignments: &[Assignment]) -> Result<StudyFile, PlanError> {
        let text = read_text(path, SETTINGS_MAX)?;
        let in_file = |e: PlanError| if e.option.is_some() { e } else { e.at(path) };
        let file = StudyFile::parse(&text, assignments).map_err(in_file)?;
        Ok(StudyFile { path: Some(path.to_owned()), ..file })
    }

    /// The same of a text.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read), without the file's name.
    ///
    /// ```
    /// use tautline::study::{EXAMPLE, StudyFile};
    /// let file = StudyFile::parse(EXAMPLE, &["walk.step=2".parse()?])?;
    /// assert_eq!(file.plan()?.walk.step(), Some(2.0));
    /// let wrong = StudyFile::parse(EXAMPLE, &["walk.stpe=2".parse()?])?.plan().unwrap_err();
    /// assert!(wrong.to_string().starts_with("--set: walk.stpe: unknown field `stpe`"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn parse(text: &str, assignments: &[Assignment]) -> Result<StudyFile, PlanError> {
        let mut table: Table = toml::from_str(text).map_err(|e| explain(text, &e))?;
        if let Some(Value::Table(swept)) = table.get_mut(SWEEP) {
            let within = |e: PlanError| PlanError { key: e.key.map(|key| format!("{SWEEP}.{key}")), ..e };
            *swept = nested(std::mem::take(swept)).map_err(|e| {
                let e = within(e);
                PlanError { line: e.key.as_deref().and_then(|key| line_of(text, key)), ..e }
            })?;
        }
        for assignment in assignments {
            assignment.apply(&mut table).map_err(|e| PlanError { option: Some(OPTION), ..e })?;
        }
        Ok(StudyFile { path: None, text: text.to_owned(), assignments: assignments.to_vec(), table })
    }

    /// The study.
    ///
    /// # Errors
    ///
    /// As [`Plan::read`]; what is wrong with a value that was given elsewhere names `--set` and no line.
    pub fn plan(&self) -> Result<Plan, PlanError> {
        let plan = match self.assignments.is_empty() {
            // The text says more than its table of what is wrong with it.
            true => Plan::parse(&self.text),
            false => self.plan_of(&self.table).map_err(|e| self.located(e)),
        };
        plan.map_err(|e| self.in_file(e))
    }

    /// The file as it is written.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// Whether a value was given elsewhere for a key, one in it or one round it.
    pub(super) fn assigns(&self, key: &str) -> bool {
        self.assignments.iter().any(|assignment| covers(assignment.key(), key))
    }

    /// The study of this table.
    pub(super) fn plan_of(&self, table: &Table) -> Result<Plan, PlanError> {
        let plan = match Plan::deserialize(Value::Table(table.clone())) {
            Ok(plan) => plan,
            Err(_) => return Err(fault(table)),
        };
        vanishing(&self.text).map_or_else(|| plan.checked(), |what| Err(PlanError::new(what)))
    }

    /// The same fault with its place: the option by which the key was given, else the file and the line. What is wrong
    /// with other files stays as it is.
    #[must_use]
    pub fn located(&self, error: PlanError) -> PlanError {
        if error.is_placed() {
            return error;
        }
        let Some(key) = error.key.as_deref() else { return error };
        if self.assigns(key) {
            return PlanError { option: Some(OPTION), ..error };
        }
        match line_of(&self.text, key).filter(|_| self.path.is_some()) {
            Some(line) => self.in_file(PlanError { line: Some(line), ..error }),
            None => error,
        }
    }

    /// The same fault with the file's name, unless it lies elsewhere.
    fn in_file(&self, error: PlanError) -> PlanError {
        match &self.path {
            Some(path) if error.path.is_none() && error.option.is_none() => error.at(path),
            _ => error,
        }
    }
}

impl Plan {
    /// The study that a JSON object describes, with the keys of a study's file; `null` stands for one that is left out.
    ///
    /// # Errors
    ///
    /// What is wrong with its form: the key, what it must be, and what it is.
    ///
    /// ```
    /// use tautline::study::Plan;
    /// let plan = r#"{"scene": {"built_in": "rooms"}, "walk": {"kind": "uniform", "step": "far", "steps": 9}}"#;
    /// let told = Plan::from_json(plan).unwrap_err().what();
    /// assert_eq!(told, "walk.step: must be a number, such as 0.5, and is \"far\"");
    /// ```
    pub fn from_json(text: &str) -> Result<Plan, PlanError> {
        serde_json::from_str::<Plan>(text).map_err(|error| {
            let value = serde_json::from_str(text).ok().map(without_nulls);
            match value.and_then(|value| Table::try_from(value).ok()) {
                Some(table) => fault(&table),
                // Lines of an object that a program wrote are nobody's.
                None => {
                    PlanFault::Value(error.to_string().split(" at line ").next().unwrap_or_default().to_owned()).into()
                }
            }
        })
    }
}

/// The same without what is left out.
fn without_nulls(value: serde_json::Value) -> serde_json::Value {
    match value {
        serde_json::Value::Object(fields) => {
            let kept = fields.into_iter().filter(|(_, value)| !value.is_null());
            kept.map(|(name, value)| (name, without_nulls(value))).collect()
        }
        other => other,
    }
}

/// What is wrong with the form of a table, with the key at fault.
fn fault(table: &Table) -> PlanError {
    let written = toml::to_string(table).map_err(|e| PlanFault::Value(e.to_string()));
    let text = match written {
        Ok(text) => text,
        Err(fault) => return fault.into(),
    };
    match toml::from_str::<Plan>(&text) {
        // Lines of what is written here are nobody's.
        Err(error) => PlanError { line: None, ..explain(&text, &error) },
        Ok(_) => PlanFault::Value("it cannot be read as a study".to_owned()).into(),
    }
}
