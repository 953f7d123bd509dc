//! The shader that decides in f32 against its scalar twin, bit for bit.

use glam::{DVec2, Vec2};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tautline::candidates::{LISTS_BUDGET, ListKey, Rank};
use tautline::fast::{Answer, MOST_LEGS, NOBODY, NOTHING, Question, UNWRAP, decide};
use tautline::gpu::{DECIDE_WGSL, Deciding, Device, GpuPass, Tuning};

use crate::support::{posts, software};

/// Questions whose numbers are whole and small, so that no product is rounded, however a device fuses: coordinates to
/// 40 put many points on the rays of vertices.
fn whole_questions() -> impl Strategy<Value = (Vec<Vec2>, Vec<(Question, Vec<Vec2>)>)> {
    let point = |size: i8| [-size..=size, -size..=size].prop_map(|[x, y]| Vec2::new(x.into(), y.into()));
    let sign = prop_oneof![Just(-1.0f32), Just(0.0), Just(1.0)];
    let wedge = [point(1), point(1), point(1)];
    let turn = (point(9), sign.clone(), any::<bool>(), prop::option::of(0..60u32));
    let points = prop::collection::vec(point(40), 2..=MOST_LEGS + 1);
    let question = (wedge, 0..99u8, point(2), turn, (point(9), sign), 0..60u32, points);
    let question = question.prop_map(
        |([right, left, ahead], reach, origin, (start, dir, wrapped, barred), (way, back), count, points)| {
            let (barred, legs) = (barred.map_or(NOBODY, Rank), points.len() as u32 - 1);
            let (wrapped, reach) = (wrapped.into(), reach.into());
            (
                Question {
                    right,
                    left,
                    ahead,
                    origin,
                    start,
                    way,
                    reach,
                    dir,
                    back,
                    wrapped,
                    count,
                    legs,
                    barred,
                    ..Question::default()
                },
                points,
            )
        },
    );
    (prop::collection::vec(point(30), 60), prop::collection::vec(question, 1..40))
}

/// What the device makes of questions about vertices from place `first` on.
fn ask(pass: &mut GpuPass<Deciding>, vertices: &[Vec2], asked: &[(Question, Vec<Vec2>)]) -> Vec<Answer> {
    pass.start_round();
    let first =
        pass.place(ListKey::default(), vertices.len(), || vertices.iter().map(Vec2::to_array).collect()).unwrap();
    let mut points: Vec<[f32; 2]> = vec![];
    let mut questions = vec![];
    for (question, own) in asked {
        questions.push(Question { first, points: points.len() as u32, ..*question });
        points.extend(own.iter().map(Vec2::to_array));
    }
    pass.send(0, &questions, &points);
    let mut answers = vec![Answer::default(); asked.len()];
    pass.collect(0, &mut answers).unwrap();
    answers
}

/// Whether the device with this shader and the twin answer alike; in how many ways events are met is counted.
fn twins_agree(device: &Device, wgsl: &str, cases: u32) -> Result<[usize; 3], String> {
    let tuning = Tuning { queries: 64, workgroup: 64 };
    let mut pass = GpuPass::<Deciding>::new(device.clone(), 1, 60, LISTS_BUDGET, tuning, wgsl).unwrap();
    let config = ProptestConfig { cases, failure_persistence: None, max_shrink_iters: 0, ..ProptestConfig::default() };
    let counts = std::cell::RefCell::new(([0; 3], &mut pass));
    let result = TestRunner::new(config).run(&whole_questions(), |(vertices, asked)| {
        let (met, pass) = &mut *counts.borrow_mut();
        pass.forget();
        for (answer, (question, points)) in ask(pass, &vertices, &asked).iter().zip(&asked) {
            let twin = decide(question, points, &vertices[..question.count as usize]);
            prop_assert_eq!(answer, &twin);
            met[match twin.leg {
                NOTHING => 0,
                _ if twin.place == UNWRAP => 1,
                _ => 2,
            }] += 1;
        }
        Ok(())
    });
    let (met, _) = counts.into_inner();
    result.map(|()| met).map_err(|error| error.to_string())
}

#[test]
fn the_shader_and_its_twin_answer_alike() {
    let met = twins_agree(&software(), DECIDE_WGSL, 300).unwrap();
    assert!(met.iter().all(|&count| count > 100), "{met:?}");
}

/// Each changes one operator or number of the shader.
const CHANGES: [(&str, &str); 24] = [
    ("u.x * v.y - u.y * v.x", "u.x * v.y + u.y * v.x"),
    ("u.x * v.x + u.y * v.y", "u.x * v.x - u.y * v.y"),
    ("min(sides, question.reach", "max(sides, question.reach"),
    ("cross_of(way, a) >= 0.0", "cross_of(way, a) > 0.0"),
    ("is_left(p, a) == after", "is_left(p, a) != after"),
    ("select(-1.0, 1.0, after)", "select(1.0, -1.0, after)"),
    ("select(0.0, dir, cross_of(a - p, b - p) * dir >= 0.0)", "select(0.0, dir, cross_of(a - p, b - p) * dir > 0.0)"),
    ("question.wrapped == 1u", "question.wrapped == 0u"),
    ("turn > 0.0 ||", "turn < 0.0 ||"),
    ("(dir > 0.0) && cross_of(a - p, b - p) * dir >= 0.0", "(dir > 0.0) && cross_of(a - p, b - p) * dir > 0.0"),
    ("number != question.barred", "number == question.barred"),
    ("order > 0.0 ||", "order < 0.0 ||"),
    ("dot_of(p, q - p) > 0.0", "dot_of(p, q - p) < 0.0"),
    ("question.first + numbers[i], dir", "numbers[i], dir + 0.5"),
    ("dot_of(question.way, b) > 0.0, was_past", "dot_of(question.way, b) < 0.0, was_past"),
    ("let crosses = cross_of(a, b) * question.back >= 0.0", "let crosses = cross_of(a, b) * question.back > 0.0"),
    ("cross_of(question.start, question.way) * question.back > 0.0", "cross_of(question.start, question.way) > 0.0"),
    ("question.dir == question.back", "question.dir != question.back"),
    ("met.at) * question.back > 0.0", "met.at) * question.back >= 0.0"),
    ("question.back != 0.0 &&", "question.back == 0.0 &&"),
    ("place + 1u < end", "place + 2u < end"),
    ("place += 2u", "place += 4u"),
    ("count > KEPT - 2u", "count > KEPT"),
    ("        a = b;", "        a = b + vec2<f32>(1.0, 0.0);"),
];

#[test]
fn a_shader_with_one_operator_changed_does_not_answer_like_the_twin() {
    let device = software();
    for (right, wrong) in CHANGES {
        assert_eq!(DECIDE_WGSL.matches(right).count(), 1, "{right:?} stands in the shader once");
        let changed = DECIDE_WGSL.replace(right, wrong);
        // It ends with the first question that tells them apart; some changes show in one of a hundred only.
        assert!(twins_agree(&device, &changed, 10_000).is_err(), "{wrong:?} in the place of {right:?} went unnoticed");
    }
}

#[test]
fn lists_of_several_pages_are_decided_over_all_of_them() {
    let model = posts();
    let device = software();
    let vertices: Vec<Vec2> =
        model.vertices().iter().map(|v| ((*v * 8.0).round() / 8.0 - DVec2::splat(50.0)).as_vec2()).collect();
    let tuning = Tuning { queries: 64, workgroup: 64 };
    let mut pass = GpuPass::new(device, 1, vertices.len(), LISTS_BUDGET, tuning, DECIDE_WGSL).unwrap();
    let asked: Vec<_> = (0..40u32)
        .map(|i| {
            let at = |k: u32| Vec2::new(((i * 37 + k * 11) % 97) as f32 - 48.0, ((i * 53 + k * 29) % 89) as f32 - 44.0);
            let points: Vec<_> = (0..5).map(at).collect();
            let count = 500 * i + 1;
            (Question { reach: 1.0, legs: 4, count, barred: NOBODY, ..Question::default() }, points)
        })
        .collect();
    let answers = ask(&mut pass, &vertices, &asked);
    for (answer, (question, points)) in answers.iter().zip(&asked) {
        assert_eq!(*answer, decide(question, points, &vertices[..question.count as usize]));
    }
}
