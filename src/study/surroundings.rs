//! Whether an anchor stands where it was hardly meant to.

use glam::DVec2;

use super::free_space::Region;
use crate::geometry::{Shown, between, orient};
use crate::scene::{Inside, Model, Scene};
use crate::visibility::Visibility;

/// Which share of the box round all walls a pocket has at most for the anchor in it to be called closed in. A room of a
/// plan has more, unless its doors are drawn closed.
const POCKET: f64 = 0.1;

/// How many walls a scene has at most in which pockets are looked for: more take seconds.
const WALLS: usize = 1 << 17;

/// What is to be said of the model's anchor: that it lies inside of something solid, in a small pocket that walls
/// close, or far outside of all walls, farther from the box round them than that is long and wide together. Sentences
/// without a full stop; none for most anchors. O(n log n).
///
/// Nothing is said of pockets where walls cannot be triangulated, where they cross at a point that no f64 names, and of
/// more than 131,072 walls.
///
/// ```
/// use tautline::scene::{Model, Scene};
/// use tautline::study::anchor_warnings;
///
/// let corners = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [0.0, 0.0]].map(Into::into);
/// let scene = Scene::new(corners.windows(2).map(|w| [w[0], w[1]]))?;
/// assert!(anchor_warnings(&Model::new(scene.clone(), Some([1.0, 1.0].into()))?).is_empty());
/// assert_eq!(
///     anchor_warnings(&Model::new(scene, Some([100.0, 1.0].into()))?),
///     ["the anchor (100, 1) lies far outside of the walls: 91 away from the box round them, which is 9 by 9"]
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn anchor_warnings(model: &Model) -> Vec<String> {
    let (scene, anchor) = (model.scene(), model.anchor());
    let Some((low, high)) = scene.bounds() else { return Vec::new() };
    let size = high - low;
    let beside = (low - anchor).max(anchor - high).max(DVec2::ZERO);
    let shown = Shown(anchor);
    if beside.length() > size.x + size.y {
        let away = short(beside.length());
        let (wide, high) = (short(size.x), short(size.y));
        return vec![format!(
            "the anchor {shown} lies far outside of the walls: {away} away from the box round them, which is {wide} by \
             {high}"
        )];
    }
    if let Some(object) = solid_at(scene, anchor) {
        let name = scene.objects()[object]
            .label
            .as_ref()
            .map_or("something solid".to_owned(), |label| format!("{label:?}, which is solid"));
        return vec![format!("the anchor {shown} lies inside of {name}: a polygon, a filled shape or a blocked cell")];
    }
    match pocket(model, (low, high)) {
        Some(share) if share < POCKET => {
            let share = short(100.0 * share);
            vec![format!(
                "the anchor {shown} is closed in by walls: what can be reached from it is {share} % of the box round \
                 all walls"
            )]
        }
        _ => Vec::new(),
    }
}

/// The share of a box round all walls that can be reached from the anchor, if walls close that in.
fn pocket(model: &Model, (low, high): (DVec2, DVec2)) -> Option<f64> {
    if model.scene().walls().len() > WALLS {
        return None;
    }
    let visibility = Visibility::new(model)?;
    let reached = visibility.reached(model.pivot(None));
    // The mesh goes on far outside.
    let is_outside = |p: DVec2| p.cmplt(low).any() || p.cmpgt(high).any();
    if reached.is_empty()
        || reached.iter().any(|&triangle| visibility.triangle(triangle).iter().any(|&p| is_outside(p)))
    {
        return None;
    }
    let area = Region::within((low, high), &visibility, &reached)?.area();
    Some(area / (high.x - low.x) / (high.y - low.y))
}

/// An object that is solid at `p`, off its walls. O(walls).
fn solid_at(scene: &Scene, p: DVec2) -> Option<usize> {
    let mut crossed = vec![0i32; scene.objects().len()];
    let mut touched = vec![false; scene.objects().len()];
    // Round each point of a map of cells, the nearest wall in some direction tells what it is.
    let mut nearest: [Option<(f64, usize, bool)>; 4] = [None; 4];
    for wall in 0..scene.walls().len() {
        let object = scene.object_of(wall);
        let inside = scene.objects()[object].inside;
        let [u, v] = scene.outline(wall);
        let side = orient(u, v, p);
        touched[object] |= side == 0.0 && between(u, v, p) || u == p || v == p;
        for (turn, nearest) in nearest.iter_mut().enumerate() {
            if inside == Inside::Free || (inside != Inside::Right && turn > 0) {
                break;
            }
            let [a, b, q] = [u, v, p].map(|p| turned(p, turn));
            if (a.y <= q.y) == (b.y <= q.y) {
                continue;
            }
            // The ray to the right of the point meets the wall if that, going up, has the point on its left.
            let up = a.y <= q.y;
            if (side > 0.0) != up {
                continue;
            }
            if inside == Inside::Right {
                let away = a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x) - q.x;
                if nearest.is_none_or(|(least, ..)| away < least) {
                    *nearest = Some((away, object, side < 0.0));
                }
            } else {
                crossed[object] += if up { 1 } else { -1 };
            }
        }
    }
    let solid = |(object, &times): (usize, &i32)| match scene.objects()[object].inside {
        Inside::EvenOdd => times % 2 != 0,
        Inside::NonZero => times != 0,
        Inside::Free | Inside::Right => false,
    };
    let found = crossed.iter().enumerate().find(|&(object, times)| !touched[object] && solid((object, times)));
    let cell = nearest.iter().flatten().next().filter(|&&(_, object, right)| right && !touched[object]);
    found.map(|(object, _)| object).or(cell.map(|&(_, object, _)| object))
}

/// The point after so many quarter turns about the origin.
fn turned(p: DVec2, quarters: usize) -> DVec2 {
    (0..quarters).fold(p, |p, _| DVec2::new(-p.y, p.x))
}

/// Three significant digits.
fn short(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    rounded.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, Wall, read_scene};

    fn ring(low: [f64; 2], high: [f64; 2]) -> Vec<[DVec2; 2]> {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]], low].map(DVec2::from);
        corners.windows(2).map(|w| [w[0], w[1]]).collect()
    }

    fn warned(scene: &Scene, anchor: [f64; 2]) -> Vec<String> {
        anchor_warnings(&Model::new(scene.clone(), Some(anchor.into())).unwrap())
    }

    #[test]
    fn small_closed_pockets_are_told_and_rooms_are_not() {
        let mut walls = ring([0.0, 0.0], [10.0, 10.0]);
        walls.extend(ring([1.0, 1.0], [2.0, 2.0]));
        walls.extend(ring([4.0, 4.0], [8.0, 8.0]));
        let scene = Scene::new(walls.clone()).unwrap();
        let closed = "the anchor (1.5, 1.5) is closed in by walls: what can be reached from it is 1 % of the box round \
                      all walls";
        assert_eq!(warned(&scene, [1.5, 1.5]), [closed]);
        // A sixth of the box, what is left of it, outside, and where a pocket is open.
        for anchor in [[5.0, 5.0], [3.0, 3.0], [-1.0, 5.0], [2.0, 1.0]] {
            assert_eq!(warned(&scene, anchor), [""; 0], "{anchor:?}");
        }
        let open: Vec<_> = walls.into_iter().enumerate().filter(|(i, _)| *i != 5).map(|(_, wall)| wall).collect();
        assert_eq!(warned(&Scene::new(open).unwrap(), [1.5, 1.5]), [""; 0]);
    }

    #[test]
    fn anchors_in_what_is_solid_are_told() {
        let mut walls: Vec<Wall> = Vec::new();
        for (object, (low, high)) in
            [([0.0, 0.0], [9.0, 9.0]), ([3.0, 3.0], [6.0, 6.0]), ([20.0, 0.0], [29.0, 9.0])].into_iter().enumerate()
        {
            walls.extend(ring(low, high).into_iter().map(|ends| Wall {
                ends,
                object: object as u32 / 2,
                reversed: false,
            }));
        }
        for (inside, hole) in [(Inside::EvenOdd, false), (Inside::NonZero, true)] {
            let pillar = Object { label: Some("pillar 3".into()), inside, ..Object::default() };
            let scene = Scene::of(vec![pillar, Object::default()], walls.clone()).unwrap();
            let told =
                |anchor| warned(&scene, anchor).iter().any(|w| w.contains("inside of \"pillar 3\", which is solid: "));
            assert!(told([1.0, 3.0]) && told([8.0, 6.5]));
            assert_eq!(told([4.0, 4.0]), hole);
            // On its border, outside of it, and in what is not solid.
            for anchor in [[0.0, 0.0], [9.5, 3.0], [22.0, 3.0], [15.0, 9.0]] {
                assert!(!told(anchor), "{anchor:?}");
            }
        }
    }

    #[test]
    fn anchors_in_blocked_cells_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let rows = ["@@....", "@..@@.", "...@..", ".....@"];
        let path = folder.path().join("a.map");
        std::fs::write(&path, format!("type octile\nheight 4\nwidth 6\nmap\n{}\n", rows.join("\n"))).unwrap();
        let mut map = "image: a.pgm\nresolution: 0.5\norigin: [3, 4, 0.3]\nnegate: 0\n".to_owned();
        map += "occupied_thresh: 0.65\nfree_thresh: 0.2\n";
        let pixels: Vec<u8> = rows.concat().bytes().map(|b| if b == b'@' { 0 } else { 254 }).collect();
        std::fs::write(folder.path().join("a.pgm"), [b"P5 6 4 255\n", &pixels[..]].concat()).unwrap();
        std::fs::write(folder.path().join("a.yaml"), map).unwrap();
        let [cells, metres] = ["a.map", "a.yaml"].map(|name| read_scene(&folder.path().join(name)).unwrap());
        for (y, row) in rows.iter().enumerate() {
            for (x, cell) in row.bytes().enumerate() {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.25);
                let turned = DVec2::new(3.0, 4.0) + DVec2::from_angle(0.3).rotate(DVec2::new(at.x, 4.0 - at.y) * 0.5);
                for (scene, at) in [(&cells, at), (&metres, turned)] {
                    assert_eq!(solid_at(scene, at).is_some(), cell == b'@', "({x}, {y})");
                }
            }
        }
    }

    #[test]
    fn anchors_far_outside_are_told() {
        let scene = Scene::new(ring([0.0, 0.0], [4.0, 3.0])).unwrap();
        assert!(
            warned(&scene, [9.0, 9.0])[0].starts_with("the anchor (9, 9) lies far outside of the walls: 7.81 away")
        );
        assert_eq!(warned(&scene, [10.0, 3.0]), [""; 0]);
        assert_eq!(warned(&Scene::new([]).unwrap(), [1e9, 0.0]), [""; 0]);
    }
}
