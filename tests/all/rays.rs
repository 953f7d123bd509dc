//! The kernel that tries all vertices: which blocks it names, and that the comparison is able to fail.

use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};
use tautline::candidates::{BLOCK, BLOCKS, Blocks, DevicePlace, LISTS_BUDGET, ListKey, MARGIN, Query};
use tautline::engine::{Engine, GpuRays, Job, Reference};
use tautline::example::{Walker, floor_plan, settled_walks};
use tautline::gpu::{GpuPass, RAYS_WGSL, TryingAll, Tuning};
use tautline::scene::Model;
use tautline::trace::SettledTrace;

use crate::support::{posts, software};

/// How many queries are asked of each list: some lanes take eight, one fewer.
const QUERIES: usize = 997;

/// Numbers from -1 to 1.
struct Draws(TestRng);

impl Draws {
    fn new() -> Self {
        Draws(TestRng::deterministic_rng(RngAlgorithm::ChaCha))
    }

    fn next(&mut self) -> f64 {
        f64::from(self.0.next_u32() as i32) / f64::from(1u32 << 31)
    }

    fn point(&mut self) -> DVec2 {
        DVec2::new(self.next(), self.next())
    }
}

/// A triangle with its apex at `pivot`, as three half-planes.
fn triangle(pivot: DVec2, a: DVec2, b: DVec2) -> [[f32; 3]; 3] {
    let (a, b) = if (a - pivot).perp_dot(b - pivot) > 0.0 { (a, b) } else { (b, a) };
    let half_plane = |normal: DVec2, on: DVec2| {
        let normal = normal.normalize();
        [normal.x as f32, normal.y as f32, (MARGIN - normal.dot(on)) as f32]
    };
    [half_plane((a - pivot).perp(), pivot), half_plane(-(b - pivot).perp(), pivot), half_plane((b - a).perp(), a)]
}

/// By how much a vertex lies inside all three, computed in f64.
fn depth([right, left, far]: &[[f32; 3]; 3], p: [f32; 2]) -> f64 {
    let side = |h: &[f32; 3]| {
        let [x, y, offset] = h.map(f64::from);
        x * f64::from(p[0]) + y * f64::from(p[1]) + offset
    };
    side(right).min(side(left)).min(side(far))
}

/// The blocks that the kernel `wgsl` names for each of some queries of a list of `len` vertices, and the truth for
/// each.
fn answers(wgsl: &str, len: usize, draws: &mut Draws) -> Vec<(Blocks, Vec<(usize, f64)>)> {
    let tuning = Tuning { queries: QUERIES, workgroup: 64 };
    let mut pass: GpuPass<TryingAll> = GpuPass::new(software(), 2, len.max(7), LISTS_BUDGET, tuning, wgsl).unwrap();
    let vertices: Vec<[f32; 2]> = (0..len).map(|_| draws.point().as_vec2().to_array()).collect();
    // Another list lies before it, so that it does not begin where its page does.
    pass.start_round();
    pass.place(ListKey(0), 7, || vec![[0.0; 2]; 7]).unwrap();
    let first = pass.place(ListKey(1), len, || vertices.clone()).unwrap();
    let triangles: Vec<_> = (0..QUERIES)
        .map(|_| {
            let pivot = draws.point();
            triangle(pivot, pivot + 0.3 * draws.point(), pivot + 0.3 * draws.point())
        })
        .collect();
    let query = |&[right, left, far]: &[[f32; 3]; 3]| Query {
        right,
        left,
        far,
        first: DevicePlace(first.0),
        count: len as u32,
        unused: 0,
    };
    let queries: Vec<Query> = triangles.iter().map(query).collect();
    let mut found = vec![Blocks::default(); QUERIES];
    pass.send(0, &queries, &[]);
    pass.collect(0, &mut found).unwrap();
    let size = BLOCK * len.div_ceil(BLOCK * BLOCKS);
    let truth = |triangle| {
        let deepest = |block: &[[f32; 2]]| block.iter().map(|&p| depth(triangle, p)).fold(f64::MIN, f64::max);
        vertices.chunks(size).map(deepest).enumerate().collect()
    };
    found.into_iter().zip(triangles.iter().map(truth)).collect()
}

/// Whether no block is missing that holds a vertex clearly inside, and none named that holds none; and how many are
/// named.
fn is_right(len: usize, (blocks, truth): &(Blocks, Vec<(usize, f64)>)) -> Option<usize> {
    let named: Vec<_> = blocks.ranks(len).collect();
    let size = BLOCK * len.div_ceil(BLOCK * BLOCKS);
    let is_named = |number: usize| named.iter().any(|ranks| ranks.start == number * size);
    // An odd number of vertices ends with half a pair, and what lies in the other half may be named.
    let may_be = |number: usize| len % 2 == 1 && number + 1 == truth.len();
    let right = |&(number, depth): &(usize, f64)| match is_named(number) {
        true => depth > -1e-6 || may_be(number),
        false => depth < 1e-6,
    };
    truth.iter().all(right).then_some(named.len())
}

#[test]
fn the_blocks_that_hold_a_vertex_are_named_and_no_others() {
    let mut draws = Draws::new();
    // Around the sizes of blocks, of words, of pages, and of lists whose blocks are longer.
    for len in [1, 15, 16, 17, 511, 512, 513, 1000, 8183, 8190, 8191, 8192, 8193, 16_400, 24_571, 40_000] {
        let mut named = 0;
        for answer in answers(RAYS_WGSL, len, &mut draws) {
            named += is_right(len, &answer).unwrap_or_else(|| panic!("{len} vertices: {answer:?}"));
        }
        assert!(named > len.min(8192) / 16, "{len} vertices: {named} blocks named");
    }
}

/// Each changes one operator of the shader, or one number.
const CHANGES: [(&str, &str); 14] = [
    ("four.right_x * p.x + four.right_y", "four.right_x * p.x - four.right_y"),
    ("four.left_y * p.y + four.left;", "four.left_y * p.y - four.left;"),
    ("four.far_x * p.x", "four.far_x + p.x"),
    ("bitcast<vec4<u32>>(left) |", "bitcast<vec4<u32>>(left) &"),
    ("vec4(a.right.y, b.right.y, c.right.y, d.right.y)", "vec4(a.right.y, c.right.y, b.right.y, d.right.y)"),
    ("query >= span.end {", "query + QUERIES > span.end {"),
    ("QUERIES * id.x", "(QUERIES - 1u) * id.x"),
    ("let b = four(query + 4u)", "let b = four(query + 3u)"),
    ("outside(a, pair.xy) & outside(a, pair.zw)", "outside(a, pair.xy) | outside(a, pair.zw)"),
    ("(inside_b >> vec4(1u))", "(inside_b << vec4(1u))"),
    ("place - 1u - list", "place - list"),
    ("- page.first + 1u) / 2u;", "- page.first) / 2u;"),
    ("list + count, page.first + PAGE", "list + count - BLOCK, page.first + PAGE"),
    ("write(query + 6u, word", "write(query + 5u, word"),
];

/// Of lists that take several pages.
const PAGED: [(&str, &str); 4] = [
    ("max(list, page.first)", "list"),
    ("(BITS * block);", "(BITS * block) + 1u;"),
    ("word], goes_on)", "word], false)"),
    ("(count + BLOCK * BLOCKS - 1u)", "(BLOCK * BLOCKS)"),
];

#[test]
fn a_kernel_with_one_operator_changed_names_other_blocks() {
    for (len, changes) in [(1001, &CHANGES[..]), (24_571, &PAGED)] {
        for (right, wrong) in changes {
            assert_eq!(RAYS_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
            let changed = RAYS_WGSL.replace(right, wrong);
            let answers = answers(&changed, len, &mut Draws::new());
            assert!(answers.iter().any(|answer| is_right(len, answer).is_none()), "{wrong:?} went unnoticed");
        }
    }
}

fn agrees(model: &Arc<Model>, traces: &[SettledTrace], queries: usize) {
    let truth = Reference::new(model.clone()).evaluate(traces, &Job::new()).unwrap();
    assert!(truth.iter().any(|record| record.events.len() > 4), "nothing happened to compare");
    let tuning = Tuning { queries, workgroup: 64 };
    let mut engine = GpuRays::with(software(), model.clone(), tuning, RAYS_WGSL).unwrap();
    let job = Job::new();
    assert!(engine.evaluate(traces, &job).unwrap() == truth, "{queries} queries a round");
    // Every leg tries every vertex, and again after each of its events.
    let legs: usize = traces.iter().map(|trace| trace.points().len() - 1).sum();
    let events: usize = truth.iter().map(|record| record.events.len()).sum();
    assert_eq!(job.tests(), ((legs + events) * model.vertices().len()) as u64);
}

#[test]
fn rounds_of_any_size_give_the_records_of_the_reference() {
    let model = Arc::new(Model::new(floor_plan(), None).unwrap());
    let traces = settled_walks(&model, Walker { step: 0.3, steps: 60, seed: 5 }, 45);
    for queries in [0, 1, 7, 8, 9, 64, 1000] {
        agrees(&model, &traces, queries);
    }
}

#[test]
fn scenes_of_several_pages_give_the_records_of_the_reference() {
    let model = posts();
    agrees(&model, &settled_walks(&model, Walker { step: 0.8, steps: 60, seed: 2 }, 40), 16);
}
