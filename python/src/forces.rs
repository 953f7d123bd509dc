//! The forces of a rope on what it bends round.

use glam::DVec2;
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use tautline::rope::{Force, Slip, forces as all_forces};

use crate::fault::Fault;
use crate::ropes::friction_of;

/// The forces of a rope, of which the corners are given with both ends, on its turns: seven columns, one after the
/// other, the place, the angle, the tension before and beyond, and the force. With `holds` it is about to slip
/// towards the anchor.
#[pyfunction]
pub(crate) fn forces<'py>(
    py: Python<'py>,
    corners: PyReadonlyArray2<'py, f64>,
    friction: f64,
    holds: bool,
) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
    let friction = friction_of(Some(friction))?.ok_or_else(|| Fault::input("friction: none is given"))?;
    let corners: Vec<DVec2> = corners.as_array().rows().into_iter().map(|row| DVec2::new(row[0], row[1])).collect();
    let all = all_forces(&corners, friction, if holds { Slip::ToAnchor } else { Slip::ToFreeEnd });
    let columns: [fn(&Force) -> f64; 7] =
        [|f| f.at.x, |f| f.at.y, |f| f.angle, |f| f.before, |f| f.beyond, |f| f.force.x, |f| f.force.y];
    Ok(columns.iter().map(|column| PyArray1::from_iter(py, all.iter().map(column))).collect())
}
