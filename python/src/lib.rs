//! The compiled part of the Python package `tautrope`: it takes arrays and tables in, has the library compute, and
//! hands arrays and tables back. What users see is in `tautrope/`, in Python.

mod arrow_in;
mod compute;
mod fault;
mod forces;
mod going;
mod live;
mod parts;
mod ropes;
mod scene;
mod steps;
mod stored;
mod study;
mod sweep;
mod table;
mod traces;

use pyo3::prelude::*;

#[pymodule(gil_used = true)]
mod _tautrope {
    #[pymodule_export]
    use super::forces::forces;
    #[pymodule_export]
    use super::live::LiveRope;
    #[pymodule_export]
    use super::parts::{are_enough, merge_parts};
    #[pymodule_export]
    use super::ropes::Ropes;
    #[pymodule_export]
    use super::scene::{Scene, built_in_step, engines};
    #[pymodule_export]
    use super::steps::StepStream;
    #[pymodule_export]
    use super::study::{Study, example_study, look_at_study, resume_study};
    #[pymodule_export]
    use super::sweep::{Sweep, conclude_sweep, has_sweep, look_at_sweep, resume_sweep, status_of};
    #[pymodule_export]
    use super::table::Table;
    #[pymodule_export]
    use super::traces::Traces;

    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(m: &Bound<'_, PyModule>) -> PyResult<()> {
        m.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
