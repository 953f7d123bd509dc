//! Questions and answers.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec2};

use crate::candidates::{DevicePlace, Frame, Rank, Window};

/// The leg of an answer when nothing happens.
pub const NOTHING: u32 = u32::MAX;

/// The place of an answer when the pivot is unwrapped.
pub const UNWRAP: DevicePlace = DevicePlace(u32::MAX);

/// What is barred when no vertex is.
pub const NOBODY: Rank = Rank(u32::MAX);

/// The furthest that a point can be from the pivot, in the frame's unit: 2^60. What is further is drawn in along its
/// direction, so that no product of two differences (at most 2^61 each) is infinite.
const FURTHEST: f64 = (1u64 << 60) as f64;

/// What is asked of the device: a window of legs about one pivot. The shader's `Question`.
///
/// All coordinates are in the frame's unit, relative to the pivot, but for the vertices of lists that serve several
/// pivots: these are relative to `origin` only after `origin` is taken from them. The sides of the wedge that the legs
/// span only save work; a question whose normals are zero tries every vertex on every leg.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Question {
    /// The inward normal of the wedge's right side.
    pub right: Vec2,
    /// The inward normal of its left side.
    pub left: Vec2,
    /// The direction in which it is cut off.
    pub ahead: Vec2,
    /// What is taken from the vertices.
    pub origin: Vec2,
    /// The direction in which the rope's last leg points on the first leg of the window, if it has turned there
    /// already.
    pub start: Vec2,
    /// The way to the pivot from the prior.
    pub way: Vec2,
    /// How far the wedge goes, measured along `ahead`.
    pub reach: f32,
    /// The way in which the rope has turned on the first leg (+1 counter-clockwise, -1 clockwise); 0 if it has not.
    pub dir: f32,
    /// The way in which it turns to unwrap the pivot; 0 at the anchor.
    pub back: f32,
    /// 1 if the event on the first leg was a wrap.
    pub wrapped: u32,
    /// Where the vertices to be tried begin.
    pub first: DevicePlace,
    /// How many vertices are to be tried.
    pub count: u32,
    /// Where the window's points begin, among those of all questions.
    pub points: u32,
    /// How many legs it has, at least 1; it has one point more.
    pub legs: u32,
    /// The vertex that was unwrapped on the first leg and cannot be wrapped there again, or [`NOBODY`].
    pub barred: Rank,
    /// Fills 16 bytes.
    pub unused: [u32; 3],
}

/// What the device answers: the first event of the window. The shader's `Answer`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct Answer {
    /// The leg on which it happens, or [`NOTHING`].
    pub leg: u32,
    /// The place of the vertex wrapped, or [`UNWRAP`]; means nothing where nothing happens.
    pub place: DevicePlace,
    /// The way in which the rope turns there: +1 or -1.
    pub dir: f32,
    /// Fills 8 bytes.
    pub unused: u32,
    /// Where the vertex wrapped stands, relative to the pivot.
    pub at: Vec2,
}

impl Question {
    /// A question whose wedge is that of `window`; the whole plane without one. The rest is the caller's.
    pub fn wedge(frame: &Frame, window: Option<&Window>) -> Question {
        let free = Question { reach: 1.0, barred: NOBODY, ..Question::default() };
        let Some(window) = window else { return free };
        let axis = window.axis / window.axis.length();
        let at = |slope: f64| axis + slope * axis.perp();
        let middle = (window.low + window.high) / 2.0;
        // The length of `ahead` is at most 1 + middle^2 / 2.
        let reach = frame.scaled(window.squared.sqrt()) * (1.0 + middle * middle / 2.0);
        Question {
            right: at(window.low).perp().as_vec2(),
            left: -at(window.high).perp().as_vec2(),
            ahead: at(middle).as_vec2(),
            reach: reach.min(FURTHEST) as f32,
            ..free
        }
    }
}

/// A way in the frame's unit, rounded to f32; its length is bounded by 2^61.
#[inline]
pub fn rounded(way: DVec2) -> Vec2 {
    let size = way.abs().max_element();
    if size > FURTHEST { (way * (FURTHEST / size)).as_vec2() } else { way.as_vec2() }
}
