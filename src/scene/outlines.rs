//! What a drawing draws, and how it becomes walls.

use glam::{DAffine2, DVec2};

use super::curves::Piece;
use super::extent::extent;
use super::flattened::Flattened;
use super::{Object, Wall};
use crate::geometry::number;

/// Without a tolerance, walls lie within the drawing's longer side divided by this, to three digits, of their curves.
const PARTS_OF_SIDE: f64 = 2000.0;

/// How many walls all curves of a drawing may become.
const WALLS_MAX: f64 = 4_194_304.0;

/// Lines and curves in the scene's coordinates.
#[derive(Debug, Default)]
pub(super) struct Outlines {
    pub(super) pieces: Vec<Piece>,
    pub(super) objects: Vec<Object>,
}

/// What a part of a drawing is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Since {
    /// How many lines and curves.
    pub(super) lines: usize,
    /// Whether each line ends where it began.
    pub(super) closed: bool,
}

impl Outlines {
    /// Begins an object: what is drawn from now on is its own.
    pub(super) fn begin(&mut self, object: Object) {
        self.objects.push(object);
        self.pieces.push(Piece::Object);
    }

    /// Takes the last object back, for which nothing was drawn.
    pub(super) fn take_back(&mut self) {
        if let Some(Piece::Object) = self.pieces.last() {
            self.pieces.pop();
            self.objects.pop();
        }
    }

    /// How many lines and curves there are.
    pub(super) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// The lowest and highest x and y of what is drawn; `None` if there is nothing.
    pub(super) fn bounds(&self) -> Option<[DVec2; 2]> {
        extent(&self.pieces, DAffine2::IDENTITY)
    }

    /// What was drawn since there were `from` pieces.
    pub(super) fn since(&self, from: usize) -> Since {
        let mut since = Since { lines: 0, closed: true };
        // Where the line began and where it is.
        let mut line: Option<[DVec2; 2]> = None;
        for piece in &self.pieces[from..] {
            match piece {
                Piece::Object => {}
                Piece::Start(p) => {
                    since.closed &= line.is_none_or(|[first, last]| first == last);
                    line = Some([*p, *p]);
                }
                Piece::Line(p) | Piece::Curve(_, p) => {
                    since.lines += 1;
                    line = line.map(|[first, _]| [first, *p]);
                }
            }
        }
        since.closed &= line.is_none_or(|[first, last]| first == last);
        since
    }

    /// All walls; those of curves lie within `tolerance` of them, or within a sensible part of the drawing's size.
    ///
    /// # Errors
    ///
    /// A tolerance for which there would be too many walls.
    pub(super) fn flatten(&self, tolerance: Option<f64>) -> Result<Flattened, String> {
        let side = self.bounds().map_or(0.0, |[low, high]| (high - low).max_element());
        let tolerance = tolerance.unwrap_or_else(|| rounded(side / PARTS_OF_SIDE));
        let mut walls = Vec::with_capacity(self.pieces.len());
        // What is drawn before any object has begun belongs to one without a name.
        let objects: Vec<Object> = [Object::default()].into_iter().chain(self.objects.iter().cloned()).collect();
        let mut object = 0;
        let mut wall = |object, ends| walls.push(Wall { ends, object, reversed: false });
        let (mut here, mut curves, mut curved) = (DVec2::ZERO, 0, 0.0);
        for piece in &self.pieces {
            let end = match piece {
                Piece::Object => {
                    object += 1;
                    continue;
                }
                Piece::Start(end) => {
                    here = *end;
                    continue;
                }
                Piece::Line(end) => *end,
                Piece::Curve(curve, end) => {
                    let n = if tolerance > 0.0 { curve.steps(tolerance) } else { f64::INFINITY };
                    curves += 1;
                    curved += n;
                    if curved > WALLS_MAX {
                        let what =
                            format!("within {} of its curves, the drawing would have more than", number(tolerance));
                        return Err(format!("{what} {WALLS_MAX} walls; give a larger tolerance (--flatten)"));
                    }
                    for k in 1..n as u32 {
                        let p = curve.at(f64::from(k) / n);
                        wall(object, [here, p]);
                        here = p;
                    }
                    *end
                }
            };
            wall(object, [here, end]);
            here = end;
        }
        Ok(Flattened { objects, walls, curves, tolerance })
    }
}

/// `x` to three digits, as people are told it; above zero.
fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::super::curves::Ellipse;
    use super::super::pen::{Drawn, Pen};
    use super::*;

    fn p(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    /// How far `q` is from the nearest wall.
    fn distance(walls: &[Wall], q: DVec2) -> f64 {
        let to = |&Wall { ends: [a, b], .. }: &Wall| {
            let along = ((q - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            q.distance(a + (b - a) * along)
        };
        walls.iter().map(to).fold(f64::INFINITY, f64::min)
    }

    /// Some curve of each kind, alone in its drawing.
    fn curves() -> Vec<Outlines> {
        let mut all = Vec::new();
        for transform in [DAffine2::IDENTITY, DAffine2::from_cols(p(2.0, 1.0), p(-0.5, 3.0), p(100.0, -7.0))] {
            let mut draw = |f: &dyn Fn(&mut Pen<'_>) -> Drawn| {
                let mut outlines = Outlines::default();
                f(&mut outlines.pen(transform)).unwrap();
                all.push(outlines);
            };
            draw(&|pen| pen.ellipse(p(1.0, 2.0), p(3.0, 0.0), p(0.0, 0.5)));
            draw(&|pen| {
                pen.start(p(1.0, 0.0))?;
                let e = Ellipse { centre: p(0.0, 0.0), a: p(1.0, 0.0), b: p(0.0, 1.0), from: 0.0, sweep: -200.0 };
                pen.ellipse_to(e, e.at(-200.0))
            });
            for inner in [&[p(0.0, 4.0)][..], &[p(9.0, 4.0), p(-9.0, 4.0)], &[p(9.0, 4.0), p(0.0, 9.0), p(1.0, -9.0)]] {
                draw(&|pen| pen.start(p(0.0, 0.0)).and_then(|()| pen.bezier_to(inner, p(1.0, 0.5))));
            }
        }
        all
    }

    #[test]
    fn walls_lie_within_the_tolerance_of_their_curve() {
        for outlines in curves() {
            let Some(Piece::Curve(curve, _)) = outlines.pieces.last() else { panic!() };
            for tolerance in [1.0, 0.1, 0.01, 1e-4] {
                let walls = outlines.flatten(Some(tolerance)).unwrap().walls;
                let far = (0..=5000).map(|k| distance(&walls, curve.at(f64::from(k) / 5000.0))).fold(0.0, f64::max);
                assert!(far <= tolerance, "{curve:?}: {far} beyond {tolerance}");
                // Not many times as many walls as needed.
                assert!(walls.len() <= 8 || far > tolerance / 20.0, "{curve:?}: {far} for {tolerance}");
                assert!(walls.windows(2).all(|w| w[0].ends[1] == w[1].ends[0]));
            }
        }
    }

    #[test]
    fn ends_are_exact_and_circles_closed() {
        let mut outlines = Outlines::default();
        let mut pen = outlines.pen(DAffine2::IDENTITY);
        pen.ellipse(p(0.1, 0.2), p(0.3, 0.0), p(0.0, 0.3)).unwrap();
        let walls = outlines.flatten(Some(1e-3)).unwrap().walls;
        assert_eq!(walls[0].ends[0], walls[walls.len() - 1].ends[1]);
        assert_eq!(walls[0].ends[0], p(0.1, 0.2) + p(0.3, 0.0));
        // The quarters are points of it, as exact as sums are.
        for q in [p(0.1, 0.2 + 0.3), p(0.1 - 0.3, 0.2), p(0.1, 0.2 - 0.3)] {
            assert!(walls.iter().any(|w| w.ends[0] == q), "{q}");
        }
    }

    #[test]
    fn tolerances_without_sense_are_refused() {
        let mut outlines = Outlines::default();
        outlines.pen(DAffine2::IDENTITY).ellipse(p(0.0, 0.0), p(3.0, 0.0), p(0.0, 3.0)).unwrap();
        for tolerance in [0.0, -1.0, f64::NAN, 1e-30] {
            let Err(what) = outlines.flatten(Some(tolerance)) else { panic!("{tolerance} was taken") };
            assert!(what.contains("give a larger tolerance (--flatten)"), "{what}");
        }
        assert_eq!(outlines.flatten(Some(1e9)).unwrap().walls.len(), 4);
    }
}
