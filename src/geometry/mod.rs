//! Points and the exact signs that every decision rests on. Knows nothing of ropes.

mod corners;
mod limits;
mod predicates;
mod resting;
mod trace_point;

pub use corners::{higher, lower};
pub use limits::{COORDINATE_MAX, COORDINATE_MIN, CoordinateFault, check_point, check_points, number};
pub(crate) use limits::{Shown, point};
pub(crate) use predicates::CERTAIN;
pub use predicates::{between, forwards, opposite, orient, same_side};
pub use resting::{Resting, Stand};
pub use trace_point::{Hair, TracePoint, Turn, left_of, orient_step};
