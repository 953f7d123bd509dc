//! Disjoint random walls in a square.

use glam::DVec2;

use super::draws::Draws;
use crate::geometry::{orient, same_side};
use crate::scene::Scene;

/// The shortest and the longest wall, in units of `1.2 / sqrt(walls)`.
const SHORTEST: f64 = 0.1;
const LONGEST: f64 = 1.5;

/// How far every wall stays from the anchor, in the same unit: enough that a rope can start in any direction.
const CLEARANCE: f64 = 0.1;

/// `walls` random walls in the square [-1, 1]^2, no two of which touch, and the anchor in its centre, off them all.
/// Each is `1.2 / sqrt(walls)` times a uniform number in 0.1..1.5 long and lies anywhere, in any direction.
///
/// The same `seed` gives the same walls. O(walls): 20,000 take some hundredths of a second.
///
/// ```
/// let scene = tautline::example::random_walls(500, 1);
/// assert_eq!((scene.walls().len(), scene.vertices().len()), (500, 1000));
/// ```
pub fn random_walls(walls: usize, seed: u64) -> Scene {
    let mut draws = Draws::new(seed, Draws::SCENE);
    let unit = 1.2 / (walls as f64).sqrt();
    let mut field = Field::new(LONGEST * unit);
    for _ in 0..walls {
        // Only the place is drawn again: lengths stay uniform, though short walls fit more easily.
        let half = 0.5 * unit * draws.between(SHORTEST, LONGEST);
        let wall = loop {
            let (centre, along) = (draws.point(1.0), half * draws.direction());
            let wall = [centre - along, centre + along];
            let inside = wall.iter().all(|end| end.abs().max_element() <= 1.0);
            if inside && distance_from_origin(wall) > CLEARANCE * unit && field.is_free(wall) {
                break wall;
            }
        };
        field.add(wall);
    }
    let scene = Scene::new(field.walls).expect("all coordinates lie in the square");
    scene.with_anchor(DVec2::ZERO)
}

fn distance_from_origin([a, b]: [DVec2; 2]) -> f64 {
    let way = b - a;
    let nearest = (-a.dot(way) / way.length_squared()).clamp(0.0, 1.0);
    (a + nearest * way).length()
}

/// Walls by the cell of a grid in which their middle lies. The cells are as wide as the longest wall, so walls that
/// meet lie in the same cell or in neighbours.
struct Field {
    walls: Vec<[DVec2; 2]>,
    cell: f64,
    side: usize,
    cells: Vec<Vec<u32>>,
}

impl Field {
    fn new(longest: f64) -> Self {
        let side = (2.0 / longest) as usize + 1;
        Field { walls: Vec::new(), cell: longest, side, cells: vec![Vec::new(); side * side] }
    }

    /// Column and row of the cell in which a wall's middle lies.
    fn place(&self, [a, b]: [DVec2; 2]) -> [usize; 2] {
        let middle = (a + b) / 2.0;
        [middle.x, middle.y].map(|c| (((c + 1.0) / self.cell).max(0.0) as usize).min(self.side - 1))
    }

    fn add(&mut self, wall: [DVec2; 2]) {
        let [column, row] = self.place(wall);
        self.cells[row * self.side + column].push(self.walls.len() as u32);
        self.walls.push(wall);
    }

    /// Whether `wall` meets none of the walls in the field.
    fn is_free(&self, wall: [DVec2; 2]) -> bool {
        let [columns, rows] = self.place(wall).map(|i| i.saturating_sub(1)..=(i + 1).min(self.side - 1));
        let mut near = rows.flat_map(|row| columns.clone().map(move |column| row * self.side + column));
        near.all(|cell| self.cells[cell].iter().all(|&other| are_disjoint(wall, self.walls[other as usize])))
    }
}

/// Whether two segments have no point in common, by exact signs.
fn are_disjoint([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let apart = a.max(b).cmplt(c.min(d)) | c.max(d).cmplt(a.min(b));
    // Of two segments on one line, the boxes meet where the segments do.
    apart.any() || same_side(orient(a, b, c), orient(a, b, d)) || same_side(orient(c, d, a), orient(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_that_touch_are_not_disjoint() {
        let s = |a: [f64; 2], b: [f64; 2]| [DVec2::from(a), DVec2::from(b)];
        let wall = s([0.0, 0.0], [2.0, 0.0]);
        for other in [s([1.0, -1.0], [1.0, 1.0]), s([1.0, 0.0], [1.0, 1.0]), s([2.0, 0.0], [3.0, 0.0]), wall] {
            assert!(!are_disjoint(wall, other) && !are_disjoint(other, wall), "{other:?}");
        }
        for other in [s([3.0, 0.0], [4.0, 0.0]), s([3.0, 0.0], [3.0, 1.0]), s([1.0, 1e-30], [1.0, 1.0])] {
            assert!(are_disjoint(wall, other) && are_disjoint(other, wall), "{other:?}");
        }
    }
}
