//! Grids of free and blocked cells: the borders between them, merged into straight walls.

use glam::DVec2;

use super::{Inside, Object, Scene, Wall};
use crate::geometry::CoordinateFault;

/// The largest height and width: the corners of a map this large can still be numbered with 32 bits.
pub(super) const SIDE_MAX: usize = 1 << 15;

/// The borders between blocked and other cells, as pairs of corners; corner (x, y) is where cell (x, y) begins. With
/// each, whether the blocked cells lie on the side of the larger coordinates: below in the grid's own order, or on the
/// right.
///
/// What lies around the map is no cell: its outer edge is no wall. Straight runs of borders are one wall; where four
/// borders meet, all four end. Walls along rows come first, by row and column, then those along columns, by column and
/// row. Linear in the cells.
pub(super) fn borders<'a>(
    width: usize,
    height: usize,
    blocked: &'a impl Fn(usize, usize) -> bool,
) -> impl Iterator<Item = ([[usize; 2]; 2], bool)> + 'a {
    let along_rows = (1..height).flat_map(move |y| {
        let walled = |x| blocked(x, y - 1) != blocked(x, y);
        // Between two borders along the line, either none or two borders leave the corner across the line.
        let crossed = |x| blocked(x - 1, y) != blocked(x, y);
        runs(width, walled, crossed).into_iter().map(move |[from, to]| ([[from, y], [to, y]], blocked(from, y)))
    });
    let along_columns = (1..width).flat_map(move |x| {
        let walled = |y| blocked(x - 1, y) != blocked(x, y);
        let crossed = |y| blocked(x, y - 1) != blocked(x, y);
        runs(height, walled, crossed).into_iter().map(move |[from, to]| ([[x, from], [x, to]], blocked(x, from)))
    });
    along_rows.chain(along_columns)
}

/// The scene of such borders, given where corners lie. `mirrored` says that the grid's rows are counted against y.
pub(super) fn scene(
    borders: impl IntoIterator<Item = ([[usize; 2]; 2], bool)>,
    corner: impl Fn([usize; 2]) -> DVec2,
    mirrored: bool,
) -> Result<Scene, CoordinateFault> {
    let wall = |(ends, beyond): ([[usize; 2]; 2], bool)| {
        // Along a row, larger coordinates lie on the left of a wall to larger columns, along a column on the right,
        // with rows counted along y.
        let along_row = ends[0][1] == ends[1][1];
        let right = (along_row != beyond) != mirrored;
        Wall { ends: ends.map(&corner), object: 0, reversed: !right }
    };
    let blocked = Object { inside: Inside::Right, ..Object::default() };
    Scene::of(vec![blocked], borders.into_iter().map(wall))
}

/// The straight runs `[from, to]` of unit borders `from..to` among `0..count`, broken where they are crossed.
///
/// `crossed(i)` tells it for the corner between borders `i - 1` and `i` and is asked only where both are walled.
fn runs(count: usize, walled: impl Fn(usize) -> bool, crossed: impl Fn(usize) -> bool) -> Vec<[usize; 2]> {
    let mut runs = Vec::new();
    let mut start = None;
    for i in 0..count {
        match (walled(i), start) {
            (true, None) => start = Some(i),
            (true, Some(from)) if crossed(i) => {
                runs.push([from, i]);
                start = Some(i);
            }
            (false, Some(from)) => {
                runs.push([from, i]);
                start = None;
            }
            _ => {}
        }
    }
    runs.extend(start.map(|from| [from, count]));
    runs
}
