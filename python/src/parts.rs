//! Parts of a study that was shared out.

use std::path::PathBuf;

use pyo3::prelude::*;
use tautline::session::{SessionError, merge};
use tautline::study::{self, State, Stopped};

use crate::compute::{self, Work};
use crate::fault::Fault;
use crate::study::Study;

/// Puts the parts in these folders together in the folder `out`, and has the answer written there. Blocks may be missing
/// where the study ends before them. What is to be known of the folder.
#[pyfunction]
pub(crate) fn merge_parts(
    py: Python<'_>,
    parts: Vec<PathBuf>,
    base: Option<PathBuf>,
    out: PathBuf,
) -> PyResult<Vec<String>> {
    let together = |_: &Work| {
        let (session, report) = merge(&parts, false, base.as_deref(), &out, |_| ())?;
        session.conclude(&report)?;
        Ok(session.folder().notes().iter().map(ToString::to_string).collect())
    };
    compute::run(py, together, |_, _| Ok(()))
}

/// Whether the parts in these folders are all that the answer needs: the study ends with a block before the first that
/// is missing.
#[pyfunction]
pub(crate) fn are_enough(py: Python<'_>, study: &Study, parts: Vec<PathBuf>) -> PyResult<bool> {
    let study = &study.study;
    let together = |_: &Work| {
        let load = |path: &std::path::Path| Ok::<_, SessionError>(State::load(&path.join("state.bin"), study)?);
        let state = study::merge(study, &parts, true, load)?;
        Ok::<_, Fault>(state.stopped() != Stopped::Unfinished)
    };
    compute::run(py, together, |_, _| Ok(()))
}
