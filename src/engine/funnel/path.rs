//! The funnel algorithm: the shortest path through a row of portals.

use glam::DVec2;

use super::Contact;
use super::mesh::Mesh;
use super::word::Portal;
use crate::geometry::{forwards, orient};
use crate::rope::Side;

/// A point of the path: a vertex on a side of it, or one of its ends.
#[derive(Debug, Clone, Copy)]
struct Point {
    at: DVec2,
    contact: Option<Contact>,
}

/// The path so far, up to its apex, and the funnel from there: the shortest paths to both ends of the last portal, each
/// bent inwards.
#[derive(Debug, Default)]
pub(super) struct Path {
    path: Vec<Point>,
    left: Vec<Point>,
    right: Vec<Point>,
    taut: Vec<Contact>,
}

impl Path {
    /// The contacts of the shortest path from `from` through all `portals` to `to`, without those passed straight and
    /// those on which it starts or ends. O(portals).
    pub(super) fn tighten(&mut self, mesh: &Mesh, from: DVec2, portals: &[Portal], to: DVec2) -> &[Contact] {
        self.path.clear();
        self.left.clear();
        self.right.clear();
        self.path.push(Point { at: from, contact: None });
        let mut last = None;
        for &portal in portals {
            if last.is_none_or(|l: Portal| l.left != portal.left) {
                let point = Point { at: mesh.at(portal.left), contact: Some((portal.left, Side::Left)) };
                narrow(&mut self.path, &mut self.left, &mut self.right, point, -1.0);
            }
            if last.is_none_or(|l: Portal| l.right != portal.right) {
                let point = Point { at: mesh.at(portal.right), contact: Some((portal.right, Side::Right)) };
                narrow(&mut self.path, &mut self.right, &mut self.left, point, 1.0);
            }
            last = Some(portal);
        }
        // The goal closes the funnel; what remains of the side that it narrows leads to it.
        narrow(&mut self.path, &mut self.right, &mut self.left, Point { at: to, contact: None }, 1.0);
        self.path.append(&mut self.right);
        self.straighten();
        &self.taut
    }

    /// Writes the corners of the path into `taut`.
    fn straighten(&mut self) {
        self.taut.clear();
        let mut points = std::mem::take(&mut self.path);
        // A last contact on which the free end stands is no contact.
        points.dedup_by(|next, kept| next.at == kept.at);
        for three in points.windows(3) {
            let [prior, here, next] = [three[0].at, three[1].at, three[2].at];
            if !(orient(prior, here, next) == 0.0 && forwards(prior, here, next))
                && let Some(contact) = three[1].contact
            {
                self.taut.push(contact);
            }
        }
        self.path = points;
    }
}

/// Moves one side of the funnel to `p`: `near` is that side's chain and `far` the other's. `inwards` is +1 for the right
/// side, where inwards is to the left, and -1 for the left side.
fn narrow(path: &mut Vec<Point>, near: &mut Vec<Point>, far: &mut Vec<Point>, p: Point, inwards: f64) {
    while let Some(end) = near.last() {
        let prior = if near.len() > 1 { near[near.len() - 2] } else { path[path.len() - 1] };
        // On one line, p bounds the funnel as well as the end does; a true turn back round the end is never found here,
        // since the other side has then made the end an apex already.
        if orient(prior.at, end.at, p.at) * inwards < 0.0 {
            break;
        }
        near.pop();
    }
    if near.is_empty() {
        // Where p lies beyond the other side's first points, the path turns round them.
        let turned = far.iter().take_while(|corner| {
            let apex = path[path.len() - 1].at;
            let beyond = orient(apex, corner.at, p.at) * inwards > 0.0;
            if beyond {
                path.push(**corner);
            }
            beyond
        });
        let turned = turned.count();
        far.drain(..turned);
    }
    // A vertex at the apex bounds nothing.
    if near.last().or(path.last()).is_none_or(|end| end.at != p.at) {
        near.push(p);
    }
}
