//! Points drawn uniformly over a part of the plane that is made of triangles.

use glam::DVec2;

use super::random::Random;
use crate::geometry::{orient, point};
use crate::scene::Model;
use crate::visibility::Visibility;

/// How many points are drawn in vain, one after the other, before none is.
pub(super) const TRIES: u32 = 1 << 16;

/// The free space in which a model's anchor lies, within the scene's bounding box.
pub(super) struct FreeSpace<'a> {
    model: &'a Model,
    region: Region,
}

impl<'a> FreeSpace<'a> {
    /// Finds the space by a flood through a triangulation of the walls, in O(n log n); `None` where that cannot take
    /// the coordinates or the scene's bounding box has no area.
    pub(super) fn new(model: &'a Model) -> Option<Self> {
        let region = Region::reached(model, &Visibility::new(model)?)?;
        Some(FreeSpace { model, region })
    }

    /// A point of it that touches no wall; the anchor in the unlikely case that 65,536 points in a row touch one.
    pub(super) fn draw(&self, random: &mut Random) -> DVec2 {
        let place = self.region.draw(random, |p| self.model.is_clear(p, p));
        place.map_or(self.model.anchor(), |place| place.at)
    }
}

/// Triangles of a model's triangulation, as far as they lie within the scene's bounding box.
pub(super) struct Region {
    pieces: Vec<Piece>,
    /// The area of all pieces up to each, that one included.
    areas: Vec<f64>,
    low: DVec2,
    high: DVec2,
}

/// A part of a triangle.
struct Piece {
    corners: [DVec2; 3],
    /// The whole triangle, and its number.
    whole: [DVec2; 3],
    triangle: u32,
}

/// A point that touches no wall, and a triangle in which it lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) at: DVec2,
    pub(super) triangle: u32,
}

impl Region {
    /// What can be reached from the anchor; `None` if it has no area.
    pub(super) fn reached(model: &Model, visibility: &Visibility) -> Option<Self> {
        Region::new(model, visibility, &visibility.reached(model.pivot(None)))
    }

    /// The triangles that hold what is visible from the anchor; `None` if they have no area.
    pub(super) fn seen(model: &Model, visibility: &Visibility) -> Option<Self> {
        Region::new(model, visibility, &visibility.seen(model.pivot(None)))
    }

    fn new(model: &Model, visibility: &Visibility, triangles: &[u32]) -> Option<Self> {
        Region::within(model.bounds(), visibility, triangles)
    }

    /// What of these triangles lies within a box; `None` if it has no area.
    pub(super) fn within((low, high): (DVec2, DVec2), visibility: &Visibility, triangles: &[u32]) -> Option<Self> {
        let (mut pieces, mut areas, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for &triangle in triangles {
            let whole = visibility.triangle(triangle);
            let clipped = clip(&whole, low, high);
            for i in 2..clipped.len() {
                let corners = [clipped[0], clipped[i - 1], clipped[i]];
                let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
                if area > 0.0 {
                    sum += area;
                    pieces.push(Piece { corners, whole, triangle });
                    areas.push(sum);
                }
            }
        }
        (!pieces.is_empty()).then_some(Region { pieces, areas, low, high })
    }

    /// Its area.
    pub(super) fn area(&self) -> f64 {
        // Pieces have twice the area of their triangles.
        self.areas.last().map_or(0.0, |twice| twice / 2.0)
    }

    /// A uniform point of those that are `fit`; `None` if 65,536 points in a row are not.
    pub(super) fn draw(&self, random: &mut Random, is_fit: impl Fn(DVec2) -> bool) -> Option<Place> {
        (0..TRIES).find_map(|_| {
            let area = random.unit() * self.areas[self.areas.len() - 1];
            // The rounded product may be the whole area.
            let piece = self.areas.partition_point(|&sum| sum <= area).min(self.pieces.len() - 1);
            let Piece { corners: [a, b, c], whole, triangle } = self.pieces[piece];
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let at = point(a + (b - a) * u + (c - a) * v);
            // Rounding may have led out.
            let is_inside = at.cmpge(self.low).all()
                && at.cmple(self.high).all()
                && (0..3).all(|i| orient(whole[i], whole[(i + 1) % 3], at) >= 0.0)
                && !whole.contains(&at);
            (is_inside && is_fit(at)).then_some(Place { at, triangle })
        })
    }
}

/// What of a polygon lies in the box, up to roundings (Sutherland and Hodgman, "Reentrant polygon clipping", Commun.
/// ACM 17, 1974).
fn clip(polygon: &[DVec2], low: DVec2, high: DVec2) -> Vec<DVec2> {
    let mut kept = polygon.to_vec();
    for (axis, side, sign) in [(0, low.x, 1.0), (0, high.x, -1.0), (1, low.y, 1.0), (1, high.y, -1.0)] {
        let depth = |p: DVec2| sign * (p[axis] - side);
        let polygon = std::mem::take(&mut kept);
        for (i, &q) in polygon.iter().enumerate() {
            let p = polygon[(i + polygon.len() - 1) % polygon.len()];
            if (depth(p) < 0.0) != (depth(q) < 0.0) {
                let mut met = p.lerp(q, depth(p) / (depth(p) - depth(q)));
                met[axis] = side;
                kept.push(met);
            }
            if depth(q) >= 0.0 {
                kept.push(q);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::random::Purpose;
    use super::*;
    use crate::scene::Scene;

    fn model(walls: &[[[f64; 2]; 2]], anchor: [f64; 2]) -> Model {
        let walls = walls.iter().map(|wall| wall.map(DVec2::from));
        Model::new(Scene::new(walls).unwrap(), Some(anchor.into())).unwrap()
    }

    fn ring(corners: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
        (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect()
    }

    #[test]
    fn points_are_uniform_over_the_room_with_the_anchor_and_lie_in_no_other() {
        // An L-shaped room of three unit squares within a larger one.
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let walls = [ring(&corners), ring(&[[-9.0, -9.0], [9.0, -9.0], [9.0, 5.0], [-9.0, 5.0]])].concat();
        let model = model(&walls, [0.5, 0.25]);
        let space = FreeSpace::new(&model).unwrap();
        let mut random = Random::new(1, Purpose::Anchor, 0);
        let mut counts = [0; 12];
        for _ in 0..12_000 {
            let p = space.draw(&mut random);
            assert!(model.is_clear(p, p));
            // Quarters of the unit squares.
            let square = (p.x as usize) + 2 * (p.y as usize);
            let quarter = (p.x.fract() * 2.0) as usize + 2 * (p.y.fract() * 2.0) as usize;
            assert!(p.cmpgt(DVec2::ZERO).all() && square < 3, "{p}");
            counts[4 * square + quarter] += 1;
        }
        // Five standard errors of a count of mean 1,000.
        assert!(counts.iter().all(|&c| (f64::from(c) - 1000.0).abs() < 5.0 * 30.3), "{counts:?}");
    }

    #[test]
    fn a_solid_on_whose_border_the_anchor_stands_is_not_free() {
        use crate::scene::{Inside, Object, Wall};
        let rings = [
            ring(&[[1.0, 1.0], [4.0, 1.0], [4.0, 2.0], [1.0, 2.0]]),
            ring(&[[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [0.0, 3.0]]),
        ];
        let walls = rings.iter().zip(0..).flat_map(|(ring, object)| {
            ring.iter().map(move |wall| Wall { ends: wall.map(DVec2::from), object, reversed: false })
        });
        let objects = |inside| vec![Object { inside, ..Object::default() }, Object::default()];
        let scene = |inside| Scene::of(objects(inside), walls.clone()).unwrap();
        for anchor in [[1.0, 2.0], [2.0, 1.0]] {
            let within = |inside| {
                let model = Model::new(scene(inside), Some(anchor.into())).unwrap();
                let space = FreeSpace::new(&model).unwrap();
                let mut random = Random::new(1, Purpose::Anchor, 0);
                let is_within = |p: DVec2| p.cmpgt(DVec2::ONE).all() && p.cmplt(DVec2::new(4.0, 2.0)).all();
                (0..1000).filter(|_| is_within(space.draw(&mut random))).count()
            };
            assert_eq!(within(Inside::EvenOdd), 0);
            // A thin outline has free space on both sides.
            assert!(within(Inside::Free) > 100);
        }
    }

    #[test]
    fn a_room_round_the_scene_ends_at_its_box() {
        let model = model(&[[[0.0, 0.0], [8.0, 0.125]], [[1.0, 1.0], [7.0, 1.0]]], [4.0, 0.5]);
        let space = FreeSpace::new(&model).unwrap();
        let mut random = Random::new(1, Purpose::Anchor, 0);
        let points: Vec<DVec2> = (0..4000).map(|_| space.draw(&mut random)).collect();
        assert!(points.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::new(8.0, 1.0)).all()));
        let mean = points.iter().sum::<DVec2>() / 4000.0;
        // Five standard errors of the mean of numbers spread uniformly over 8 and over 1.
        assert!(
            (mean - DVec2::new(4.0, 0.5)).abs().cmplt(DVec2::new(8.0, 1.0) * 5.0 * (1.0 / 12.0 / 4000f64).sqrt()).all()
        );
    }

    #[test]
    fn a_scene_without_area_has_no_free_space() {
        assert!(FreeSpace::new(&model(&[[[0.0, 0.0], [1.0, 0.0]]], [2.0, 0.0])).is_none());
    }
}
