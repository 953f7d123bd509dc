//! A list of vertices to be tried.

use std::sync::OnceLock;

use glam::DVec2;

use super::places::{Places, VERTICES};
use super::{Fan, Frame, Rank};
use crate::scene::Model;

/// How many vertices share a distance, that of the nearest: few, so that a query tries few too many; several, so that
/// finding how far it reaches takes one or two lines of the cache.
const GROUP: usize = 4;

/// The vertices that one pivot's queries try, the nearest first: their numbers, and their coordinates in the frame.
#[derive(Debug)]
pub struct List {
    /// How many vertices there are.
    len: usize,
    /// The square of the distance from the pivot beyond which vertices may be missing.
    reach: f64,
    /// The square of the distance from the pivot of the first vertex of each group, as its [`key`]; `None` where the
    /// list is for any pivot.
    nearest: Option<Box<[u32]>>,
    fan: OnceLock<Fan>,
    /// The last is filled up with NaN, which lies in no triangle.
    pub(super) places: Box<[Places]>,
}

impl List {
    /// The vertices of these numbers, for queries about `pivot` whose points are no further from it than the square
    /// root of `reach`. O(vertices log vertices).
    pub fn about(model: &Model, frame: &Frame, pivot: DVec2, reach: f64, numbers: &[u32]) -> Self {
        let keyed = |&v: &u32| {
            let squared = model.vertices()[v as usize].distance_squared(pivot);
            u64::from(key(squared)) << 32 | u64::from(v)
        };
        let mut near: Vec<u64> = numbers.iter().map(keyed).collect();
        near.sort_unstable();
        let nearest = near.iter().step_by(GROUP).map(|keyed| (keyed >> 32) as u32).collect();
        Self::new(model, frame, near.iter().map(|&keyed| keyed as u32), Some(nearest), reach)
    }

    /// The vertices of these numbers, for queries about any pivot.
    pub fn of_any(model: &Model, frame: &Frame, numbers: impl ExactSizeIterator<Item = u32>) -> Self {
        Self::new(model, frame, numbers, None, f64::INFINITY)
    }

    fn new(
        model: &Model,
        frame: &Frame,
        vertices: impl ExactSizeIterator<Item = u32>,
        nearest: Option<Box<[u32]>>,
        reach: f64,
    ) -> Self {
        let empty = Places { x: [f32::NAN; VERTICES], y: [f32::NAN; VERTICES], numbers: [0; VERTICES] };
        let len = vertices.len();
        let mut places = vec![empty; len.div_ceil(VERTICES)];
        for (i, v) in vertices.enumerate() {
            let (block, i) = (&mut places[i / VERTICES], i % VERTICES);
            let p = frame.place(model.vertices()[v as usize]).as_vec2();
            (block.x[i], block.y[i], block.numbers[i]) = (p.x, p.y, v);
        }
        List { len, reach, nearest, fan: OnceLock::new(), places: places.into() }
    }

    /// Whether it serves queries whose points are all no further from the pivot than the square root of `squared`, in
    /// the scene's unit; infinity for all there are.
    #[inline]
    pub fn reaches(&self, squared: f64) -> bool {
        squared <= self.reach
    }

    /// How many vertices, from the first on, a query must try whose points are all no further from the pivot than the
    /// square root of `squared`, in the scene's unit. O(log vertices).
    #[inline]
    pub fn within(&self, squared: f64) -> usize {
        let Some(nearest) = &self.nearest else { return self.len };
        // Both are rounded: to 4 units in the last place each.
        let most = key(squared * (1.0 + 16.0 * f64::EPSILON));
        (GROUP * nearest.partition_point(|&nearest| nearest <= most)).min(self.len)
    }

    /// The fan of its pivot, which stands at `pivot`; `None` if the list is for any. Made when it is first asked for.
    #[inline]
    pub fn fan(&self, model: &Model, pivot: DVec2) -> Option<&Fan> {
        self.nearest.as_ref()?;
        Some(self.fan.get_or_init(|| Fan::new(model, pivot, self.numbers())))
    }

    /// The square of the distance from the pivot beyond which vertices may be missing.
    #[inline]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether it is for queries about any pivot.
    #[inline]
    pub fn is_of_any(&self) -> bool {
        self.nearest.is_none()
    }

    /// How many vertices it holds.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The numbers of the vertices.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        self.places.iter().flat_map(|p| p.numbers).take(self.len)
    }

    /// The vertex of this rank.
    #[inline]
    pub fn vertex(&self, rank: Rank) -> Option<u32> {
        let place = rank.0 as usize;
        (place < self.len).then(|| self.places[place / VERTICES].numbers[place % VERTICES])
    }

    /// The rank of a vertex, if it is there. O(vertices).
    pub fn rank_of(&self, vertex: u32) -> Option<Rank> {
        self.numbers().zip(0..).find(|(v, _)| *v == vertex).map(|(_, rank)| Rank(rank))
    }

    /// Their coordinates in the frame, one after the other.
    pub fn coordinates(&self) -> impl Iterator<Item = [f32; 2]> {
        let all = self.places.iter().flat_map(|p| p.x.iter().zip(&p.y));
        all.take(self.len).map(|(&x, &y)| [x, y])
    }

    /// The memory that it takes, in bytes, its fan included.
    pub fn bytes(&self) -> usize {
        let fan = if self.is_of_any() { 0 } else { Fan::BYTES * self.len };
        size_of::<Self>() + fan + size_of_val(self.nearest.as_deref().unwrap_or_default()) + size_of_val(&*self.places)
    }
}

/// A number that is no less for a larger `squared`, which is not negative: the half of its bits that says most.
#[inline]
fn key(squared: f64) -> u32 {
    (squared.to_bits() >> 32) as u32
}
