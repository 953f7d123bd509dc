//! Line strings and rings as walls, shared by the formats that have them.

use glam::DVec2;

use crate::geometry::Shown;
use crate::read_error::{Fault, Place};

/// Adds the walls of one line string or ring: one for each pair of consecutive positions.
///
/// # Errors
///
/// A single position, and the first one that is an error itself, with its number.
pub(super) fn push_line(
    walls: &mut Vec<[DVec2; 2]>,
    positions: impl ExactSizeIterator<Item = Result<DVec2, String>>,
    place: &Place,
) -> Result<(), Fault> {
    if positions.len() == 1 {
        return Err(Fault::new(place.clone(), "one position only; a line needs two or more"));
    }
    let mut last = None;
    for (i, position) in positions.enumerate() {
        // Building the place for every position would take longer than reading the position.
        let p = position.map_err(|what| Fault::new(place.then("position", i), what))?;
        if let Some(last) = last {
            walls.push([last, p]);
        }
        last = Some(p);
    }
    Ok(())
}

/// [`push_line`] for a ring, which must end where it starts.
pub(super) fn push_ring(
    walls: &mut Vec<[DVec2; 2]>,
    positions: impl ExactSizeIterator<Item = Result<DVec2, String>>,
    place: &Place,
) -> Result<(), Fault> {
    let from = walls.len();
    push_line(walls, positions, place)?;
    match &walls[from..] {
        [[first, _], .., [_, last]] | [[first, last]] if first != last => {
            let what = format!("the ring is open: it starts at {} and ends at {}", Shown(*first), Shown(*last));
            Err(Fault::new(place.clone(), format!("{what}; the last position must repeat the first")))
        }
        _ => Ok(()),
    }
}
