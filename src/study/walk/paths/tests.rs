//! Shortest paths, against all ways over all wall ends that see each other.

use super::*;
use crate::example::BuiltIn;
use crate::geometry::{opposite, orient};
use crate::study::free_space::Region;
use crate::study::random::{Purpose, Random};

/// How long the shortest way is that crosses no wall, by Dijkstra's method, looking at every wall for every two points.
/// It may slip through where walls touch.
fn shortest(model: &Model, from: DVec2, to: DVec2) -> f64 {
    let points = [model.vertices(), &[from, to]].concat();
    let sees = |a: DVec2, b: DVec2| {
        (0..model.scene().walls().len())
            .map(|wall| model.scene().ends(wall))
            .all(|[u, v]| !(opposite(orient(u, v, a), orient(u, v, b)) && opposite(orient(a, b, u), orient(a, b, v))))
    };
    let mut costs = vec![f64::INFINITY; points.len()];
    let mut is_done = vec![false; points.len()];
    costs[points.len() - 2] = 0.0;
    loop {
        let next = (0..points.len()).filter(|&i| !is_done[i]).min_by(|&i, &j| costs[i].total_cmp(&costs[j]));
        let i = next.expect("the last point is found");
        if i == points.len() - 1 || costs[i] == f64::INFINITY {
            return costs[points.len() - 1];
        }
        is_done[i] = true;
        for j in 0..points.len() {
            let cost = costs[i] + points[i].distance(points[j]);
            if cost < costs[j] && sees(points[i], points[j]) {
                costs[j] = cost;
            }
        }
    }
}

fn length(path: &[DVec2]) -> f64 {
    path.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

/// Searches for paths from goal to goal, and returns at how many wall ends they bend, and how long they and the
/// shortest ways are.
fn compare(scene: BuiltIn, seed: u64, count: usize) -> Vec<(usize, [f64; 2])> {
    let model = Arc::new(Model::new(scene.scene(seed), None).unwrap());
    let visibility = Visibility::new(&model).unwrap();
    let region = Region::reached(&model, &visibility).unwrap();
    let paths = Paths::new(&model, visibility);
    let (mut random, mut search) = (Random::new(seed, Purpose::Goal, 0), Search::default());
    let mut from = From::Anchor;
    let lengths = (0..count).filter_map(|_| {
        let to = region.draw(&mut random, |p| model.is_clear(p, p)).unwrap();
        let (start, path) = (from.at(&model), paths.find(from, to, &mut search)?);
        let bends = path.len() - 2;
        assert_eq!((path[0], path[path.len() - 1]), (start, to.at));
        assert!(path[1..path.len() - 1].iter().all(|&p| model.vertex_at(p).is_some()));
        from = From::Place(to);
        Some((bends, [length(&path), shortest(&model, start, to.at)]))
    });
    lengths.collect()
}

#[test]
fn paths_among_disjoint_walls_are_the_shortest() {
    let mut bent = 0;
    for seed in 0..12 {
        let lengths = compare(BuiltIn::Random([2, 5, 20, 60][seed as usize % 4]), seed, 12);
        assert_eq!(lengths.len(), 12);
        for (bends, [ours, shortest]) in lengths {
            // Both are sums of rounded lengths.
            assert!((ours - shortest).abs() <= 1e-12 * shortest, "seed {seed}: {ours} instead of {shortest}");
            bent += usize::from(bends > 0);
        }
    }
    assert!(bent > 50, "{bent}");
}

#[test]
fn paths_among_walls_that_touch_and_cross_are_no_shorter_than_can_be() {
    let mut equal = 0;
    for seed in 0..8 {
        for (_, [ours, shortest]) in compare(BuiltIn::Lattice(40), seed, 10) {
            assert!(ours >= shortest * (1.0 - 1e-12), "seed {seed}: {ours} instead of {shortest}");
            equal += usize::from((ours - shortest).abs() <= 1e-12 * shortest);
        }
    }
    // Where the shortest way slips between walls that touch, ours is longer.
    assert!(equal > 20, "{equal}");
}
