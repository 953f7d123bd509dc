//! Near-degenerate queries: the vertices lie within rounding of the swept triangles' sides and corners.

use glam::DVec2;

use super::{Filter, Truth, covers, holds};
use crate::candidates::{DevicePlace, Found, Frame, List, ListKey, Query, ROOM, Rank, Simd, Slopes, Window};
use crate::example::Draws;
use crate::geometry::{check_point, opposite, orient, same_side};
use crate::gpu::{GpuError, GpuPass};
use crate::scene::{Model, Scene};

/// How many queries a trial has.
pub const QUERIES: usize = 512;

/// How many vertices a query tries at most: as many as it can name, and an even number, since lists begin at even
/// places.
const VERTICES: usize = ROOM - 1;

/// A scene of some size somewhere in the plane, with [`QUERIES`] queries of up to 14 vertices each, and which of them
/// lie in the swept triangles, by exact signs.
pub struct Trial {
    asked: Vec<Asked>,
}

struct Asked {
    query: Query,
    list: List,
    truths: Vec<Truth>,
}

impl Trial {
    /// Trial `number` of a seed. O([`QUERIES`] log [`QUERIES`]), some milliseconds.
    ///
    /// Triangles are of every shape: between points of the scene, on a small lattice, or up to 2^80 scenes away; legs
    /// that start on their way; windows of several legs. Scenes have a unit from 2^-200 to 2^200 or lie up to a million
    /// of it off the origin.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut draws = Draws::new(seed, number);
        let unit = if number.is_multiple_of(2) { 1.0 } else { 2f64.powi(draws.whole(-200, 200) as i32) };
        let offset = if number.is_multiple_of(3) { draws.point(1e6) * unit } else { DVec2::ZERO };
        let place = |p: DVec2| p * unit + offset;
        let sketches: Vec<Sketch> = (0..QUERIES).map(|_| Sketch::new(&mut draws, place)).collect();
        // Tiny walls, so that the scene is made quickly, and two in the corners, so that all lies in the frame.
        let corners = [1.0, -1.0].map(|x| [place(DVec2::splat(x)), place(DVec2::splat(0.99 * x))]);
        let drawn = sketches.iter().flat_map(|sketch| sketch.vertices.as_chunks::<2>().0);
        let walls = corners.iter().chain(drawn).copied();
        let scene = Scene::new(walls).expect("coordinates were checked as they were drawn");
        let model = Model::new(scene, Some(corners[0][0])).expect("no wall holds the corner");
        let (frame, mut slopes) = (Frame::new(&model), Slopes::default());
        Trial { asked: sketches.into_iter().map(|sketch| sketch.ask(&model, &frame, &mut slopes)).collect() }
    }

    /// The same trial with triangles smaller by `less`, in the frame's unit: with less of a margin, or none.
    #[must_use]
    pub fn shrunk(mut self, less: f64) -> Self {
        for Asked { query, .. } in &mut self.asked {
            for half_plane in [&mut query.right, &mut query.left, &mut query.far] {
                half_plane[2] -= less as f32;
            }
        }
        self
    }

    /// What the loops on the CPU make of it.
    pub fn swept(&self, simd: Simd) -> Filter {
        let (mut filter, mut named) = (Filter::default(), Vec::new());
        for Asked { query, list, truths } in &self.asked {
            named.clear();
            simd.sweep(list, query, list.len(), &mut named);
            filter.count(truths.iter().copied().zip(list.numbers().map(|v| named.contains(&v))));
        }
        filter
    }

    /// What a device makes of it, in one round: `pass` takes [`QUERIES`] queries a round and lists of 14 times as many
    /// vertices.
    ///
    /// # Errors
    ///
    /// What the device complains of.
    ///
    /// # Panics
    ///
    /// If the pass takes less than that.
    pub fn dispatched(&self, pass: &mut GpuPass) -> Result<Filter, GpuError> {
        // All vertices make one list, of which each query tries its own part.
        let mut coordinates = vec![[0.0; 2]; QUERIES * VERTICES];
        for (Asked { list, .. }, part) in self.asked.iter().zip(coordinates.chunks_mut(VERTICES)) {
            list.coordinates().zip(part).for_each(|(p, place)| *place = p);
        }
        pass.forget();
        pass.start_round();
        let first = pass
            .place(ListKey::default(), coordinates.len(), || coordinates)
            .expect("the first list of a round finds room");
        let parts = (0..).step_by(VERTICES).map(|rank| first.of(Rank(rank)));
        let query =
            |(asked, first): (&Asked, DevicePlace)| Query { first, count: asked.list.len() as u32, ..asked.query };
        let queries: Vec<Query> = self.asked.iter().zip(parts).map(query).collect();
        pass.send(0, &queries, &[]);
        let mut found = vec![Found::default(); queries.len()];
        pass.collect(0, &mut found)?;
        let mut filter = Filter::default();
        for ((Asked { truths, .. }, query), found) in self.asked.iter().zip(&queries).zip(&found) {
            let named = found.places().unwrap_or_default();
            filter.count(truths.iter().copied().zip((0..).map(|rank| named.contains(&query.first.of(Rank(rank))))));
        }
        Ok(filter)
    }
}

/// A query before the scene is known.
struct Sketch {
    pivot: DVec2,
    /// Where the free end stands on the first leg, if not at its start.
    start: Option<DVec2>,
    points: Vec<DVec2>,
    vertices: Vec<DVec2>,
}

impl Sketch {
    fn new(draws: &mut Draws, place: impl Fn(DVec2) -> DVec2) -> Self {
        let pivot = place(draws.point(1.0));
        let points: Vec<DVec2> = (0..draws.whole(2, 3)).map(|_| place(trace_point(draws))).collect();
        let on_the_way = points[0] + (points[1] - points[0]) * draws.unit();
        // Rounded, it may lie beyond the leg's end as seen from the pivot, which no start does.
        let is_before_end =
            |start: DVec2| same_side(orient(pivot, start, points[1]), orient(pivot, points[0], points[1]));
        let start = Some(on_the_way).filter(|&start| draws.whole(0, 2) == 0 && is_before_end(start));
        let mut vertices = Vec::with_capacity(VERTICES);
        let corners = [pivot, start.unwrap_or(points[0]), points[1]];
        let (low, high) = (place(DVec2::splat(-1.0)), place(DVec2::splat(1.0)));
        for _ in 0..10 * VERTICES {
            let p = near_side(draws, corners, high.x - low.x);
            // A wall from each to one a few units in the last place off it.
            let q = nudged(draws, p);
            let is_in_frame = |p: DVec2| p.cmpge(low).all() && p.cmple(high).all() && check_point(p).is_ok();
            if p != q && is_in_frame(p) && is_in_frame(q) {
                vertices.extend([p, q]);
            }
            if vertices.len() == VERTICES {
                break;
            }
        }
        Sketch { pivot, start, points, vertices }
    }

    fn ask(self, model: &Model, frame: &Frame, slopes: &mut Slopes) -> Asked {
        let Sketch { pivot, start, points, vertices } = self;
        let direction = start.map(|start| start - pivot);
        let (legs, query) = match Window::fold(Simd::detected(), pivot, direction, &points, slopes) {
            Some(window) => (window.legs, window.query(frame, pivot)),
            None => (1, Query::leg(frame, pivot, points[0], points[1])),
        };
        // What lies before the start on the first leg is not swept.
        let is_past = |s: DVec2, p: DVec2| !opposite(orient(pivot, s, p), orient(pivot, s, points[1]));
        let swept = |p: DVec2| {
            let is_swept = |leg: usize| holds([pivot, points[leg], points[leg + 1]], p);
            is_swept(0) && start.is_none_or(|s| is_past(s, p)) || (1..legs).any(is_swept)
        };
        let mut numbers: Vec<u32> = vertices.iter().filter_map(|&p| model.vertex_at(p)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let truth = |&v: &u32| {
            let p = model.vertices()[v as usize];
            Truth { is_covered: covers(&query, frame, p), is_inside: swept(p) }
        };
        let truths = numbers.iter().map(truth).collect();
        Asked { query, list: List::of_any(model, frame, numbers.into_iter()), truths }
    }
}

/// A point of a trace in the scene's own unit: anywhere, on a small lattice, or far away.
fn trace_point(draws: &mut Draws) -> DVec2 {
    match draws.whole(0, 5) {
        0..3 => draws.point(1.0),
        3 => DVec2::new(draws.whole(-2, 2) as f64, draws.whole(-2, 2) as f64) / 2.0,
        _ => draws.point(1.0) * 2f64.powi(draws.whole(-40, 80) as i32),
    }
}

/// A point on a side of the triangle, or up to 10^-5 of a scene of size `size` off it, to either side; one in eight is
/// at a corner.
fn near_side(draws: &mut Draws, corners: [DVec2; 3], size: f64) -> DVec2 {
    let side = draws.whole(0, 2) as usize;
    let (from, to) = (corners[side], corners[(side + 1) % 3]);
    // Of sides that lead far away, the part that can lie in the scene: at the pivot, or all along the far side.
    let length = (to - from).abs().max_element();
    let reach = if length > 0.0 { 1f64.min(size / length) } else { 1.0 };
    let along = if draws.whole(0, 7) == 0 { 0.0 } else { draws.unit() };
    let on = match side {
        2 => to + (from - to) * (along * reach),
        1 => from + (to - from) * draws.unit(),
        _ => from + (to - from) * (along * reach),
    };
    if draws.whole(0, 2) == 0 || length == 0.0 {
        return on;
    }
    let off = draws.within(1.0) * 10f64.powi(-(draws.whole(5, 9) as i32)) * size;
    on + ((to - from) / length).perp() * off
}

/// `p` moved by up to three units in the last place.
fn nudged(draws: &mut Draws, p: DVec2) -> DVec2 {
    let moved = |x: f64, by: i64| if x == 0.0 { x } else { f64::from_bits(x.to_bits().wrapping_add_signed(by)) };
    let x = moved(p.x, draws.whole(-3, 3));
    DVec2::new(x, moved(p.y, draws.whole(-3, 3)))
}
