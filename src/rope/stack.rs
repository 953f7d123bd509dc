//! The stack of contacts from the anchor to the free end.

use glam::DVec2;

use crate::geometry::{forwards, orient};

/// The side on which a contact lies: the rope turns towards it, or passes it straight.
///
/// Engines compute as if y pointed upwards, whatever the scene says. In a scene whose y points down, a picture shows
/// the other side: what is written or drawn for people and other programs is [`shown`](Self::shown).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// The vertex lies left of the rope as seen from the anchor: the rope turns counter-clockwise there.
    Left,
    /// The vertex lies right of the rope: the rope turns clockwise there.
    Right,
}

impl Side {
    /// `left` or `right`, as results name it.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
        }
    }

    /// The side on which a picture shows it: the same where y points up, the other one where it points down
    /// ([`Scene::y_down`](crate::scene::Scene::y_down)).
    ///
    /// ```
    /// use tautline::rope::Side;
    /// assert_eq!([Side::Left.shown(false), Side::Left.shown(true)], [Side::Left, Side::Right]);
    /// ```
    pub fn shown(self, y_down: bool) -> Side {
        match (self, y_down) {
            (Side::Left, false) | (Side::Right, true) => Side::Left,
            (Side::Right, false) | (Side::Left, true) => Side::Right,
        }
    }

    /// +1 for left, -1 for right.
    #[inline]
    pub(crate) fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// The side that has the sign of `dir`.
    #[inline]
    pub(crate) fn of(dir: f64) -> Side {
        if dir > 0.0 { Side::Left } else { Side::Right }
    }
}

/// A vertex on the rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Which vertex of the scene.
    pub vertex: u32,
    /// Where it stands.
    pub at: DVec2,
    /// On which side of the rope it lies.
    pub side: Side,
    /// The contact before which no other taut one lies, or the anchor: where the taut rope comes from.
    from: TautEnd,
}

/// The taut rope up to one of its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TautEnd {
    at: DVec2,
    length: f64,
    depth: u32,
}

impl TautEnd {
    /// Length on to `to`, in the scene's unit. Squares of coordinates within the limits neither over- nor underflow.
    fn length_to(self, to: DVec2) -> f64 {
        self.length + self.at.distance(to)
    }

    /// The unit vector from `a` to here; `None` if they are the same point.
    fn pull(self, a: DVec2) -> Option<DVec2> {
        pull(self.at, a)
    }
}

/// The unit vector from `a` to `at`; `None` if they are the same point.
pub(super) fn pull(at: DVec2, a: DVec2) -> Option<DVec2> {
    let back = at - a;
    // Scaled first: the length of a tiny vector must not lose digits to underflow.
    let size = back.abs().max_element();
    (size > 0.0).then(|| back / size / (back / size).length())
}

/// Ropes with the same contacts, wherever the free end is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LastLeg {
    /// The taut rope up to the pivot where it bends there.
    bent: TautEnd,
    /// The point before the pivot, and the taut rope that passes the pivot straight; `None` at the anchor.
    straight: Option<(DVec2, TautEnd)>,
}

impl LastLeg {
    /// The last contact, or the anchor.
    #[inline]
    pub(crate) fn pivot(&self) -> DVec2 {
        self.bent.at
    }

    /// The taut rope's length, its number of turns and its pull for the free end `a`: what [`Rope`] says of each.
    pub(super) fn look(&self, a: DVec2) -> (f64, u32, Option<DVec2>) {
        let end = self.taut_end(a);
        (end.length_to(a), end.depth, end.pull(a))
    }

    /// The last corner of the taut rope to the free end `a`.
    #[inline]
    fn taut_end(&self, a: DVec2) -> TautEnd {
        match self.straight {
            Some((prior, before)) if a == self.bent.at || is_straight(prior, self.bent.at, a) => before,
            _ => self.bent,
        }
    }

    /// The taut rope's [`length`](Rope::length) to the free end `a`. O(1).
    #[inline]
    pub(crate) fn length(&self, a: DVec2) -> f64 {
        self.taut_end(a).length_to(a)
    }

    /// The square of a distance from the pivot: no rope to a free end as near as that is longer than `limit`, as
    /// [`length`](Self::length) rounds it. Negative if even ropes that end at the pivot may be. O(1).
    ///
    /// Both lengths that a rope can have are at most that of the one that bends at the pivot, by the triangle
    /// inequality and but for roundings, all of which are far below what is taken off here.
    pub(crate) fn surely_within(&self, limit: f64) -> f64 {
        let far = limit * SURELY - self.bent.length;
        if far > 0.0 { far * far * SURELY } else { -1.0 }
    }
}

/// The share of a length that is left when 2^-40 of it is taken off.
const SURELY: f64 = 1.0 - 1.0 / (1u64 << 40) as f64;

/// The rope of one trace: the anchor and the contacts, the last of which is the pivot.
///
/// ```
/// use tautline::rope::{Rope, Side};
/// let mut rope = Rope::new([0.0, 0.0].into());
/// rope.push(7, [3.0, 4.0].into(), Side::Left);
/// assert_eq!(rope.length([3.0, 6.0].into()), 7.0);
/// assert_eq!(rope.depth([3.0, 6.0].into()), 1);
/// // The free end stands on the pivot: that contact is not part of the taut rope.
/// assert_eq!(rope.depth([3.0, 4.0].into()), 0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rope {
    anchor: DVec2,
    contacts: Vec<Contact>,
}

impl Rope {
    /// A rope that is tied at `anchor` and touches nothing.
    pub fn new(anchor: DVec2) -> Self {
        Rope { anchor, contacts: Vec::new() }
    }

    /// Frees the rope from all contacts and ties it to `anchor`, keeping its memory.
    pub fn reset(&mut self, anchor: DVec2) {
        self.anchor = anchor;
        self.contacts.clear();
    }

    /// Where it is tied.
    pub(super) fn anchor(&self) -> DVec2 {
        self.anchor
    }

    /// All contacts from the anchor on, those passed straight included.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The last contact, or the anchor: `O`.
    #[inline]
    pub fn pivot(&self) -> DVec2 {
        self.contacts.last().map_or(self.anchor, |c| c.at)
    }

    /// The point before the pivot: `X`; the anchor where there is none.
    #[inline]
    pub fn prior(&self) -> DVec2 {
        match self.contacts.len() {
            0 | 1 => self.anchor,
            n => self.contacts[n - 2].at,
        }
    }

    /// Wraps the rope round `vertex`, which stands at `at`; it becomes the pivot. O(1).
    pub fn push(&mut self, vertex: u32, at: DVec2, side: Side) {
        let from = self.taut_end(at);
        self.contacts.push(Contact { vertex, at, side, from });
    }

    /// Unwraps the rope from its pivot and returns it; `None` if it touches nothing. O(1).
    pub fn pop(&mut self) -> Option<Contact> {
        self.contacts.pop()
    }

    /// What all ropes with these contacts have in common. O(1).
    #[inline]
    pub(crate) fn last_leg(&self) -> LastLeg {
        match self.contacts.last() {
            None => LastLeg { bent: TautEnd { at: self.anchor, length: 0.0, depth: 0 }, straight: None },
            Some(o) => {
                let bent = TautEnd { at: o.at, length: o.from.length_to(o.at), depth: o.from.depth + 1 };
                LastLeg { bent, straight: Some((self.prior(), o.from)) }
            }
        }
    }

    /// The last corner of the taut rope when the rope goes on from the pivot to `a`.
    fn taut_end(&self, a: DVec2) -> TautEnd {
        self.last_leg().taut_end(a)
    }

    /// The length up to the pivot and the number of contacts of the taut rope to a free end that is neither on the
    /// pivot nor such that the rope passes the pivot straight; the way from the pivot is to be added. O(1).
    pub(crate) fn base(&self) -> (f64, u32) {
        let TautEnd { length, depth, .. } = self.last_leg().bent;
        (length, depth)
    }

    /// The taut rope's length to the free end `a`, in the scene's unit, summed from the anchor on. O(1).
    pub fn length(&self, a: DVec2) -> f64 {
        self.taut_end(a).length_to(a)
    }

    /// The number of contacts of the taut rope to the free end `a`. O(1).
    pub fn depth(&self, a: DVec2) -> u32 {
        self.taut_end(a).depth
    }

    /// Both [`length`](Self::length) and [`depth`](Self::depth). O(1).
    pub fn measure(&self, a: DVec2) -> (f64, u32) {
        let end = self.taut_end(a);
        (end.length_to(a), end.depth)
    }

    /// The unit vector along which the rope pulls the free end `a`; `None` when the rope has no length.
    pub fn pull(&self, a: DVec2) -> Option<DVec2> {
        self.taut_end(a).pull(a)
    }

    /// The taut rope to the free end `a`: the contacts without those passed straight, and without the pivot if `a`
    /// stands on it. O(contacts).
    pub fn taut(&self, a: DVec2) -> Vec<Contact> {
        let mut end = self.contacts.len();
        while end > 0 && self.contacts[end - 1].at == a {
            end -= 1;
        }
        let mut prior = self.anchor;
        let mut taut = Vec::with_capacity(end);
        for i in 0..end {
            let here = self.contacts[i].at;
            let next = if i + 1 < end { self.contacts[i + 1].at } else { a };
            if !is_straight(prior, here, next) {
                taut.push(self.contacts[i]);
            }
            prior = here;
        }
        taut
    }
}

/// Whether a rope from `prior` over `here` to `next` passes `here` straight.
pub(super) fn is_straight(prior: DVec2, here: DVec2, next: DVec2) -> bool {
    orient(prior, here, next) == 0.0 && forwards(prior, here, next)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The length of the taut rope, summed from corner to corner.
    fn summed(rope: &Rope, a: DVec2) -> f64 {
        let (mut from, mut sum) = (rope.anchor, 0.0);
        for at in rope.taut(a).iter().map(|contact| contact.at).chain([a]) {
            sum += from.distance(at);
            from = at;
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// On a coarse lattice many free ends are on the pivot, or straight on behind it.
        #[test]
        fn lengths_are_those_of_the_taut_rope_wherever_it_ends(
            points in prop::collection::vec((0..4i8, 0..4i8), 1..8),
            scale in prop::sample::select(vec![1.0, 0.1, 1.1 * 2f64.powi(-440), 1.3 * 2f64.powi(490)]),
            wide in any::<bool>(),
        ) {
            let width = if wide { 1e-9 } else { 1.0 };
            let mut points: Vec<DVec2> =
                points.iter().map(|&(x, y)| scale * DVec2::new(f64::from(x), width * f64::from(y))).collect();
            points.dedup();
            let mut rope = Rope::new(points[0]);
            points[1..].iter().for_each(|&at| rope.push(0, at, Side::Left));
            let leg = rope.last_leg();
            prop_assert_eq!(leg.pivot(), rope.pivot());
            for end in 0..64 {
                let a = scale * DVec2::new(f64::from(end % 8), width * f64::from(end / 8));
                let length = summed(&rope, a);
                prop_assert_eq!(leg.length(a), length);
                prop_assert_eq!(rope.length(a), length);
                let square = leg.pivot().distance_squared(a);
                // Whatever is surely within a limit is, for limits right beside the length as well.
                for limit in [length.next_down(), length * (1.0 - 1e-13), 0.5 * length] {
                    prop_assert!(length <= limit || square > leg.surely_within(limit), "{} {}", length, limit);
                }
                // Nearly all that is within a limit is surely so.
                let (limit, bent) = (length * (1.0 + 1e-9), leg.bent.length_to(a));
                prop_assert!(bent > length * (1.0 + 1e-12) || length == 0.0 || square <= leg.surely_within(limit));
            }
        }
    }
}
