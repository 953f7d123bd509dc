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
}

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
        let from = match self.contacts.last() {
            None => TautEnd { at: self.anchor, length: 0.0, depth: 0 },
            Some(_) => self.taut_end(at),
        };
        self.contacts.push(Contact { vertex, at, side, from });
    }

    /// Unwraps the rope from its pivot and returns it; `None` if it touches nothing. O(1).
    pub fn pop(&mut self) -> Option<Contact> {
        self.contacts.pop()
    }

    /// The last corner of the taut rope when the rope goes on from the pivot to `a`.
    fn taut_end(&self, a: DVec2) -> TautEnd {
        match self.contacts.last() {
            None => TautEnd { at: self.anchor, length: 0.0, depth: 0 },
            Some(o) if o.at == a || is_straight(self.prior(), o.at, a) => o.from,
            Some(o) => TautEnd { at: o.at, length: o.from.length_to(o.at), depth: o.from.depth + 1 },
        }
    }

    /// The length up to the pivot and the number of contacts of the taut rope to a free end that is neither on the
    /// pivot nor such that the rope passes the pivot straight; the way from the pivot is to be added. O(1).
    pub(crate) fn base(&self) -> (f64, u32) {
        self.contacts.last().map_or((0.0, 0), |o| (o.from.length_to(o.at), o.from.depth + 1))
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
        let back = self.taut_end(a).at - a;
        // Scaled first: the length of a tiny vector must not lose digits to underflow.
        let size = back.abs().max_element();
        (size > 0.0).then(|| back / size / (back / size).length())
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
fn is_straight(prior: DVec2, here: DVec2, next: DVec2) -> bool {
    orient(prior, here, next) == 0.0 && forwards(prior, here, next)
}
