//! Walls on a lattice: where signs are zero all the time.

use glam::DVec2;

use super::draws::Draws;
use crate::scene::Scene;

/// The longest wall.
const LONGEST: i64 = 3;

/// `walls` random walls, each along x or y, with ends at whole numbers, 1 to 3 long. They may share ends, cross,
/// overlap and be equal. The anchor is (0.5, 0.5), in a cell of the lattice that no wall touches.
///
/// They lie in the square of half side `sqrt(walls)`, rounded up, about the origin: walls close about a quarter of the
/// ways from cell to cell, so that nearly all of the lattice can be reached. The same `seed` gives the same walls.
/// O(walls).
///
/// ```
/// let scene = tautline::example::lattice_walls(200, 1);
/// assert_eq!(scene.walls().len(), 200);
/// assert!(scene.vertices().iter().all(|p| *p == p.round()));
/// ```
pub fn lattice_walls(walls: usize, seed: u64) -> Scene {
    let mut draws = Draws::new(seed, Draws::SCENE);
    let half = (walls as f64).sqrt().ceil() as i64;
    let mut draw = || loop {
        let (x, y, length) = (draws.whole(-half, half), draws.whole(-half, half), draws.whole(1, LONGEST));
        let (to_x, to_y) = if draws.unit() < 0.5 { (x + length, y) } else { (x, y + length) };
        let touches_anchors_cell = x <= 1 && to_x >= 0 && y <= 1 && to_y >= 0;
        if to_x <= half && to_y <= half && !touches_anchors_cell {
            return [DVec2::new(x as f64, y as f64), DVec2::new(to_x as f64, to_y as f64)];
        }
    };
    let scene = Scene::new((0..walls).map(|_| draw())).expect("all coordinates are small whole numbers");
    scene.with_anchor(DVec2::splat(0.5))
}
