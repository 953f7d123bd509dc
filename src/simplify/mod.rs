//! Fewer vertices for nearly the same scene: what a coast or a map has in detail that no rope of interest feels.
//!
//! A vertex `v` at which two walls meet, `u-v` and `v-w`, can go: one wall `u-w` takes their place. That is done only
//! where it changes nothing but lengths:
//!
//! - Nothing lies in the closed triangle `u`, `v`, `w`: no vertex, no anchor, no other wall but those that end at `u`
//!   or `w` and lead away from it. So `v` can be moved onto the line from `u` to `w` with everything else staying where
//!   it is, and no wall meets another on the way: the scene before and after are the same up to a bending of the plane.
//!   Walls never meet that did not, nothing changes sides, and traces go between the same walls.
//! - All vertices that went for a wall lie within the tolerance of it. Then the walls lie within it as well, both ways:
//!   distance from a segment is convex, so along a wall that went it is greatest at an end; and the nearest point of
//!   the new wall moves steadily from `u` to `w` while one goes along the old ones, so each of its points is the
//!   nearest one to some point of theirs.
//! - Obstacles only give way. Where the rope reaches one side of the walls only, as at a closed obstacle, the triangle
//!   must lie on the other side. Then space is only gained, and traces that kept to the rules keep to them: inner
//!   corners stay, at which no rope bends. Where both sides are reached, as at walls that end somewhere, or where
//!   neither is, any triangle will do, and a trace that passed through it may cross the new wall.
//!
//! A vertex in line with its neighbours is treated alike, with both sides for the triangle's: a trace may stand on a
//! wall's end but not inside a wall, so it stays where only one side is reached.

mod near;
mod sides;
mod thinning;

use glam::DVec2;

use self::thinning::Thinning;
use crate::geometry::number;
use crate::scene::{AnchorError, Model, Scene};
use crate::visibility::Visibility;

/// Why a scene cannot be simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimplifyError {
    /// The tolerance is no length.
    #[error("the tolerance is {}; give a number above 0, in the scene's unit", number(*.0))]
    Tolerance(f64),
    /// A rope cannot be tied there.
    #[error(transparent)]
    Anchor(#[from] AnchorError),
    /// It is not known which sides of the walls a rope can reach.
    #[error("the scene cannot be simplified: its coordinates span more than 140 binary orders of magnitude")]
    Span,
}

/// The scene with fewer vertices, for ropes that are tied at any of `anchors`: by at most `tolerance`, in the scene's
/// unit, no wall of either scene is further from those of the other.
///
/// Its vertices are among the scene's, bit for bit, and numbered anew; anchor, direction of y and notes are the
/// scene's. All but the comparison with the tolerance, of a rounded distance, is decided by exact signs. The vertex
/// that moves walls least goes first, of several the one that stands for the fewest others, of those the one with the
/// smallest number. The same input gives the same scene.
///
/// O(n log n) for scenes whose walls are short compared with the scene and stand for few vertices each; O(n^2) at
/// worst, as where many walls meet at one end or each vertex that goes leaves one that costs more.
///
/// ```
/// use tautline::scene::Scene;
/// use tautline::simplify::simplify;
///
/// // A square with a dent in its lower side, looked at from below.
/// let ring = [[0.0, 0.0], [4.0, 0.0], [5.0, 0.5], [6.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(Into::into);
/// let scene = Scene::new((0..7).map(|i| [ring[i], ring[(i + 1) % 7]]))?;
/// let anchor = [5.0, -3.0].into();
/// // The dent's inner end stays: to fill the dent would take space from the rope. Its outer ends may go.
/// let simplified = simplify(&scene, &[anchor], 0.5)?;
/// assert_eq!(simplified.vertices().len(), 5);
/// assert!(simplified.vertices().contains(&[5.0, 0.5].into()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// A tolerance that is not above 0 or not finite, an anchor at which no rope can be tied, a scene that cannot be
/// triangulated.
///
/// # Panics
///
/// If no anchor is given.
pub fn simplify(scene: &Scene, anchors: &[DVec2], tolerance: f64) -> Result<Scene, SimplifyError> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(SimplifyError::Tolerance(tolerance));
    }
    let model = Model::new(scene.clone(), Some(anchors[0]))?;
    anchors[1..].iter().try_for_each(|&anchor| model.tied(anchor).map(drop))?;
    let visibility = Visibility::new(&model).ok_or(SimplifyError::Span)?;
    let mut thinning = Thinning::new(&model, &visibility, anchors, tolerance);
    thinning.run();
    Ok(scene.with_walls(thinning.walls()))
}
