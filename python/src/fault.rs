//! What goes wrong, on its way to the package's exceptions.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use tautline::ReadError;
use tautline::engine::{AdvanceError, EngineError};
use tautline::output::WriteError;
use tautline::picture::DrawError;
use tautline::scene::AnchorError;
use tautline::session::SessionError;
use tautline::study::PlanError;
use tautline::trace::Violation;

/// A fault that can be carried through code that holds no Python objects: the exception's name, what it says, and its
/// fields.
#[derive(Debug)]
pub(crate) struct Fault {
    class: &'static str,
    message: String,
    texts: Vec<(&'static str, String)>,
    numbers: Vec<(&'static str, u64)>,
}

impl Fault {
    pub(crate) fn new(class: &'static str, message: impl ToString) -> Self {
        Fault { class, message: message.to_string(), texts: Vec::new(), numbers: Vec::new() }
    }

    /// What was given from Python is not what can be used.
    pub(crate) fn input(message: impl ToString) -> Self {
        Fault::new("InputError", message)
    }

    pub(crate) fn number(mut self, name: &'static str, value: u64) -> Self {
        self.numbers.push((name, value));
        self
    }

    /// The same with what else can be done.
    pub(crate) fn and(mut self, hint: &str) -> Self {
        self.message = format!("{}; {hint}", self.message);
        self
    }

    fn file(mut self, path: &std::path::Path) -> Self {
        self.texts.push(("file", path.display().to_string()));
        self
    }

    /// The exception of this fault, if the package can be imported.
    fn exception(&self, py: Python<'_>) -> PyResult<PyErr> {
        let fields = PyDict::new(py);
        self.texts.iter().try_for_each(|(name, value)| fields.set_item(name, value))?;
        self.numbers.iter().try_for_each(|(name, value)| fields.set_item(name, value))?;
        let class = py.import("tautrope._errors")?.getattr(self.class)?;
        Ok(PyErr::from_value(class.call((&self.message,), Some(&fields))?))
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> PyErr {
        Python::attach(|py| fault.exception(py).unwrap_or_else(|error| error))
    }
}

impl From<ReadError> for Fault {
    fn from(error: ReadError) -> Fault {
        let fault = Fault::new("ReadError", &error);
        match error {
            ReadError::Io { path, .. } | ReadError::Extension { path, .. } => fault.file(&path),
            ReadError::Content { path, place, .. } => {
                let named = |part: &&(&'static str, u64)| matches!(part.0, "line" | "row");
                let at = place.parts().iter().find(named).copied();
                at.into_iter().fold(fault.file(&path), |fault, (name, number)| fault.number(name, number))
            }
        }
    }
}

impl From<Violation> for Fault {
    fn from(violation: Violation) -> Fault {
        let step = violation.step as u64;
        let fault = Fault::new("ViolationError", violation).number("trace", violation.trace);
        fault.number("step", step).number("wall", violation.wall as u64)
    }
}

impl From<EngineError> for Fault {
    fn from(error: EngineError) -> Fault {
        Fault::new("EngineError", error)
    }
}

impl From<WriteError> for Fault {
    fn from(error: WriteError) -> Fault {
        Fault::new("WriteError", error)
    }
}

impl From<AnchorError> for Fault {
    fn from(error: AnchorError) -> Fault {
        match error {
            AnchorError::Missing => Fault::input("the scene has no anchor; give one: scene.tied((x, y))"),
            other => Fault::input(other),
        }
    }
}

impl From<PlanError> for Fault {
    fn from(error: PlanError) -> Fault {
        let fault = Fault::new("StudyError", &error);
        let fault = error.line.into_iter().fold(fault, |fault, line| fault.number("line", line as u64));
        error.path.iter().fold(fault, |fault, path| fault.file(path))
    }
}

impl From<SessionError> for Fault {
    fn from(error: SessionError) -> Fault {
        match error {
            SessionError::Traces(error) => error.into(),
            SessionError::Engine(error) => error.into(),
            SessionError::Write(error) => error.into(),
            error => Fault::new("StudyError", error),
        }
    }
}

impl From<AdvanceError> for Fault {
    fn from(error: AdvanceError) -> Fault {
        match error {
            AdvanceError::Touches { wall, .. } => Fault::new("ViolationError", error).number("wall", wall as u64),
            AdvanceError::Coordinate { .. } => Fault::input(error),
        }
    }
}

impl From<DrawError> for Fault {
    fn from(error: DrawError) -> Fault {
        Fault::input(error)
    }
}
