//! Islands: walls that hang together by common ends. What people call an obstacle.

use glam::DVec2;

use super::Scene;

/// Walls that hang together by common ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Island {
    /// The lowest number among its wall ends.
    pub vertex: u32,
    pub walls: u32,
    /// The lowest number among its wall ends that have a label; `vertex` if none has.
    pub named: u32,
    /// The middle of its first wall.
    pub middle: DVec2,
}

/// The islands of a scene, in the order of their lowest wall ends. O(walls).
pub(crate) fn all_islands(scene: &Scene) -> Vec<Island> {
    let roots = roots(scene);
    let mut of: Vec<Option<Island>> = vec![None; roots.len()];
    for (wall, &[u, _]) in scene.walls().iter().enumerate() {
        let vertex = roots[u as usize];
        let [a, b] = scene.ends(wall);
        let middle = a / 2.0 + b / 2.0;
        of[vertex as usize].get_or_insert(Island { vertex, walls: 0, named: vertex, middle }).walls += 1;
    }
    // From the last to the first, so that the first one stays.
    for (v, label) in scene.labels().into_iter().enumerate().rev() {
        if let (Some(_), Some(island)) = (label, &mut of[roots[v] as usize]) {
            island.named = v as u32;
        }
    }
    of.into_iter().flatten().collect()
}

/// For each wall end the lowest number among those that hang together with it. O(walls).
pub(crate) fn roots(scene: &Scene) -> Vec<u32> {
    // Each wall end's parent; the root has the lowest number.
    let mut parents: Vec<u32> = (0..scene.vertices().len() as u32).collect();
    fn root(parents: &mut [u32], mut v: u32) -> u32 {
        while parents[v as usize] != v {
            parents[v as usize] = parents[parents[v as usize] as usize];
            v = parents[v as usize];
        }
        v
    }
    for &[u, v] in scene.walls() {
        let (u, v) = (root(&mut parents, u), root(&mut parents, v));
        parents[u.max(v) as usize] = u.min(v);
    }
    (0..parents.len() as u32).map(|v| root(&mut parents, v)).collect()
}
