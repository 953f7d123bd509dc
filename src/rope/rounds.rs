//! How often a path goes all the way round a wall end.

use glam::DVec2;

use crate::geometry::{TracePoint, between, left_of, orient, orient_step};

/// How often a path has gone all the way round a wall end, counted as it goes on.
///
/// Counted are crossings of the ray from the wall end through the path's start, by the exact signs of
/// [`left_of`] and [`orient_step`]: nothing is summed that could be rounded, and a path that touches the wall end
/// passes it on the side of its [hair](crate::geometry::Hair).
///
/// ```
/// use tautline::geometry::TracePoint;
/// use tautline::rope::Rounds;
/// let mut rounds = Rounds::about([0.0, 0.0].into());
/// let square = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
/// let counted = square.map(|at| {
///     rounds.go_on(TracePoint::from(glam::DVec2::from(at)));
///     rounds.whole()
/// });
/// assert_eq!(counted, [0, 0, 0, 0, 1, 1]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rounds {
    centre: DVec2,
    /// Where the path was first that is not the wall end itself.
    start: Option<DVec2>,
    /// Where it is, and whether that is left of the ray or on it.
    at: Option<(TracePoint, bool)>,
    /// How often it has crossed the ray counter-clockwise, less how often clockwise: the rounds, rounded down.
    crossings: i64,
}

impl Rounds {
    /// About the wall end at `centre`; the path has not begun.
    pub fn about(centre: DVec2) -> Self {
        Rounds { centre, start: None, at: None, crossings: 0 }
    }

    /// The path's next point: its first, or where it goes in a straight line. O(1).
    #[inline]
    pub fn go_on(&mut self, to: TracePoint) {
        let Some(start) = self.start else {
            if to.at != self.centre {
                let left = left_of(self.centre, to.at, to);
                (self.start, self.at) = (Some(to.at), Some((to, left)));
                // A start that is a hair right of the ray is at the end of the round before.
                self.crossings = if left { 0 } else { -1 };
            }
            return;
        };
        let left = left_of(self.centre, start, to);
        if let Some((from, was_left)) = self.at
            && left != was_left
        {
            // It crosses the line through the ray: the ray itself if it goes to the left counter-clockwise, or to the
            // right clockwise.
            let side = orient_step(from, to, self.centre);
            if left && side > 0.0 {
                self.crossings += 1;
            } else if !left && side < 0.0 {
                self.crossings -= 1;
            }
        }
        self.at = Some((to, left));
    }

    /// How often the path has gone all the way round: counter-clockwise, as if y pointed up, counts as positive,
    /// clockwise as negative, and going back takes back. Rounds that are not complete do not count. O(1).
    #[inline]
    pub fn whole(&self) -> i64 {
        // Below 0 the crossings are one too many, but for a path that is on the ray.
        if self.crossings < 0 && !self.is_on_ray() { self.crossings + 1 } else { self.crossings }
    }

    fn is_on_ray(&self) -> bool {
        let (Some(start), Some((to, _))) = (self.start, self.at) else { return false };
        to.hair.is_none() && orient(self.centre, start, to.at) == 0.0 && !between(start, to.at, self.centre)
    }
}
