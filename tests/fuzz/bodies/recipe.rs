//! Makes a scene and traces of any bytes.

use std::sync::Arc;

use arbitrary::{Result, Unstructured};
use glam::DVec2;
use tautline::geometry::check_point;
use tautline::scene::{Model, Scene};
use tautline::trace::{SettledTrace, Trace, settle};

/// More walls and more steps take time and find nothing that fewer do not.
const WALLS_MAX: usize = 60;
const STEPS_MAX: usize = 60;

/// A model, and traces that keep to the rules as well as the same with all their steps; `None` where the anchor stands
/// in a wall.
pub(super) fn recipe(input: &[u8]) -> Option<(Arc<Model>, Vec<SettledTrace>)> {
    let mut pieces = Pieces { bytes: Unstructured::new(input), places: vec![DVec2::ZERO] };
    let (mut walls, mut anchor, mut steps) = (Vec::new(), DVec2::ZERO, vec![Vec::new()]);
    while !pieces.bytes.is_empty() {
        match pieces.bytes.int_in_range(0..=5).ok()? {
            0 => walls.push([pieces.place().ok()?, pieces.place().ok()?]),
            // From where the last place is.
            1 => walls.push([pieces.last(), pieces.place().ok()?]),
            2 => {
                let [a, c] = [pieces.place().ok()?, pieces.place().ok()?];
                let corners = [a, DVec2::new(c.x, a.y), c, DVec2::new(a.x, c.y)];
                walls.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
            }
            3 => anchor = pieces.place().ok()?,
            4 => steps.last_mut()?.push(pieces.place().ok()?),
            _ => steps.push(Vec::new()),
        }
    }
    walls.truncate(WALLS_MAX);
    let model = Arc::new(Model::new(Scene::new(walls).expect("places are taken"), Some(anchor)).ok()?);
    let mut traces = Vec::new();
    for mut points in steps.into_iter().take(3) {
        points.truncate(STEPS_MAX);
        if !points.is_empty() {
            traces.push(settle(&model, &lawful(&model, &points)));
            traces.push(settle(&model, &Trace { id: 1, points }));
        }
    }
    Some((model, traces))
}

/// The trace through those of the points, one after the other, that keep to the rules; it starts at the anchor.
fn lawful(model: &Model, points: &[DVec2]) -> Trace {
    let mut trace = Trace { id: 0, points: vec![model.anchor()] };
    for &point in points {
        trace.points.push(point);
        if settle(model, &trace).violation().is_some() {
            trace.points.pop();
        }
    }
    trace
}

/// What is left of the input, and the places so far, never none.
struct Pieces<'a> {
    bytes: Unstructured<'a>,
    places: Vec<DVec2>,
}

impl Pieces<'_> {
    fn last(&self) -> DVec2 {
        self.places[self.places.len() - 1]
    }

    fn earlier(&mut self) -> Result<DVec2> {
        let number: u8 = self.bytes.arbitrary()?;
        Ok(self.places[usize::from(number) % self.places.len()])
    }

    /// The next place, by itself or by earlier ones: what is degenerate is seldom hit by chance. Drawn to within the
    /// limits of coordinates.
    fn place(&mut self) -> Result<DVec2> {
        let place = match self.bytes.int_in_range(0..=6)? {
            0 => DVec2::from(self.bytes.arbitrary::<[i8; 2]>()?.map(f64::from)) / 4.0,
            1 => {
                let (by, exponent): ([i16; 2], u8) = self.bytes.arbitrary()?;
                self.last() + DVec2::from(by.map(f64::from)) * 0.5f64.powi(exponent.into())
            }
            2 => self.earlier()?,
            3 => {
                let near = self.earlier()?;
                nudged(near, self.bytes.arbitrary()?)
            }
            4 => {
                let [a, b] = [self.earlier()?, self.earlier()?];
                let (at, ulps): (i16, [i8; 2]) = self.bytes.arbitrary()?;
                nudged(a + (b - a) * (f64::from(at) / 64.0), ulps)
            }
            // Of any size, as far as sizes are taken.
            5 => {
                let sized =
                    |(fraction, exponent): (i8, i16)| f64::from(fraction) * 2f64.powi(i32::from(exponent) % 450);
                self.bytes.arbitrary::<[(i8, i16); 2]>()?.map(sized).into()
            }
            _ => self.bytes.arbitrary::<[f64; 2]>()?.into(),
        };
        let place = check_point(place).unwrap_or(DVec2::new(legal(place.x), legal(place.y)));
        self.places.push(place);
        Ok(place)
    }
}

/// As many units in the last place further on.
fn nudged(p: DVec2, ulps: [i8; 2]) -> DVec2 {
    let nudge = |c: f64, ulps: i8| f64::from_bits(c.to_bits().wrapping_add_signed(ulps.into()));
    DVec2::new(nudge(p.x, ulps[0]), nudge(p.y, ulps[1]))
}

/// The same sign and fraction with an exponent that is taken.
fn legal(c: f64) -> f64 {
    let exponent = (c.to_bits() >> 52 & 0x7ff) % 950 + 1023 - 450;
    f64::from_bits(c.to_bits() & !(0x7ff << 52) | exponent << 52)
}
