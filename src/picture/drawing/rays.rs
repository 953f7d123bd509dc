//! The rays of the pivot in a picture: what the free end must cross for the rope to wrap or unwrap next.

use glam::DVec2;

use super::canvas::{Canvas, distance};
use super::key::Entry;
use super::marks::{DOTS, RAY_DASHES};
use super::theme::Tone;
use crate::picture::ropes::towards;
use crate::rope::Moment;
use crate::scene::Model;
use crate::visibility::{Scratch, Visibility};

impl Canvas<'_> {
    /// At most `most` rays, those that lie nearest to the free end, of the wall ends that the pivot sees; and the
    /// unwrapping ray.
    ///
    /// The ray of a wall end starts there and goes away from the pivot. Where that ends at a wall, the rope's last leg
    /// cannot follow it.
    pub(super) fn rays(&mut self, model: &Model, moment: &Moment, most: usize) {
        if most == 0 {
            return;
        }
        let o = moment.rope.pivot();
        let a = self.at(moment.at);
        let ends = seen(model, moment).into_iter().map(|v| model.vertices()[v as usize]).filter(|&p| p != o);
        let mut rays: Vec<(f64, [[f64; 2]; 2])> = ends.map(|p| self.ray(o, p)).map(|ray| (gap(a, ray), ray)).collect();
        rays.retain(|(_, ray)| !self.line(ray).is_empty());
        rays.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all = rays.len();
        rays.truncate(most);
        if all > 0 {
            self.key.add(Entry::Rays((rays.len() < all).then_some((rays.len(), all))));
            let data: String = rays.iter().map(|(_, ray)| self.line(ray)).collect();
            self.svg.path(&data, &format!("fill=\"none\" {} {RAY_DASHES}", self.theme.stroke(Tone::Muted)));
        }
        if !moment.rope.contacts().is_empty() && moment.rope.prior() != o {
            let data = self.line(&self.ray(moment.rope.prior(), o));
            if !data.is_empty() {
                self.key.add(Entry::Unwrapping);
                self.svg.path(&data, &format!("fill=\"none\" {} {DOTS}", self.theme.stroke(Tone::Ink)));
            }
        }
    }

    /// The ray that starts at `p` and goes away from `o`, to beyond the picture's edge.
    fn ray(&self, o: DVec2, p: DVec2) -> [[f64; 2]; 2] {
        let [from, start] = [self.at(o), self.at(p)];
        let [x, y] = towards(from, start);
        let middle = [self.frame.width / 2.0, self.frame.height / 2.0];
        let far = distance(start, middle) + self.frame.width + self.frame.height;
        [start, [start[0] + x * far, start[1] + y * far]]
    }
}

/// The wall ends that the pivot sees; all of them where walls cannot be triangulated.
fn seen(model: &Model, moment: &Moment) -> Vec<u32> {
    let all = model.vertices().len() as u32;
    let Some(visibility) = Visibility::new(model) else { return (0..all).collect() };
    let pivot = model.pivot(moment.rope.contacts().last().map(|c| c.vertex));
    let mut seen = Vec::new();
    visibility.look(pivot, &mut Scratch::default(), &mut seen);
    seen.sort_unstable();
    seen
}

/// How far `a` lies from a ray, in pixels.
fn gap(a: [f64; 2], [start, end]: [[f64; 2]; 2]) -> f64 {
    let [x, y] = towards(start, end);
    let along = ((a[0] - start[0]) * x + (a[1] - start[1]) * y).max(0.0);
    distance(a, [start[0] + x * along, start[1] + y * along])
}
