//! The kernels, and what they have in common: each lane answers one query by trying the vertices of a pivot's list.

use bytemuck::Pod;

use crate::candidates::{Blocks, DevicePlace, Found, Query};
use crate::fast::{Answer, MOST_LEGS, Question};

/// A shader of lists: what all of these share, what some of them share besides, and its own source.
macro_rules! of_lists {
    ($($file:literal),+) => {
        concat!(include_str!("../../shaders/shared/lists.wgsl"), $(include_str!(concat!("../../shaders/", $file))),+)
    };
}

/// The source of the candidate pass.
pub const SWEEP_WGSL: &str = of_lists!("shared/query.wgsl", "sweep.wgsl");

/// The source of the kernel that tries all vertices.
pub const RAYS_WGSL: &str = of_lists!("shared/query.wgsl", "rays.wgsl");

/// The source of the kernel that decides in f32.
pub const DECIDE_WGSL: &str = of_lists!("decide.wgsl");

/// A kernel: a shader, and what it is asked and answers.
pub trait Kernel {
    /// What one lane is asked; a struct of the shader.
    type Query: Pod + Send + Sync;
    /// What it answers; a struct of the shader.
    type Found: Pod + Default + Send + Sync;
    /// The name of its entry point, and of its file.
    const NAME: &'static str;
    /// The most points of a trace that come with a query; 0 for a kernel that needs none.
    const POINTS: usize;
    /// How many queries a lane takes.
    const QUERIES: u32 = 1;

    /// The query as it is sent: its list begins at `first`, its points at number `points` of the round's.
    fn placed(query: &Self::Query, first: DevicePlace, points: u32) -> Self::Query;

    /// Where the vertices to be tried begin and how many they are.
    fn tried(query: &Self::Query) -> (DevicePlace, u32);
}

/// The candidate pass, `shaders/sweep.wgsl`.
#[derive(Debug, Clone, Copy)]
pub struct Sweeping;

impl Kernel for Sweeping {
    type Query = Query;
    type Found = Found;
    const NAME: &'static str = "sweep";
    const POINTS: usize = 0;

    fn placed(query: &Query, first: DevicePlace, _: u32) -> Query {
        Query { first, ..*query }
    }

    fn tried(query: &Query) -> (DevicePlace, u32) {
        (query.first, query.count)
    }
}

/// The kernel that tries all vertices, `shaders/rays.wgsl`.
#[derive(Debug, Clone, Copy)]
pub struct TryingAll;

impl TryingAll {
    /// How many products and sums a test is: two of each for each of three half-planes.
    pub const OPERATIONS: u32 = 12;
}

impl Kernel for TryingAll {
    type Query = Query;
    type Found = Blocks;
    const NAME: &'static str = "rays";
    const POINTS: usize = 0;
    const QUERIES: u32 = 8;

    fn placed(query: &Query, first: DevicePlace, points: u32) -> Query {
        Sweeping::placed(query, first, points)
    }

    fn tried(query: &Query) -> (DevicePlace, u32) {
        Sweeping::tried(query)
    }
}

/// The kernel that decides in f32, `shaders/decide.wgsl`.
#[derive(Debug, Clone, Copy)]
pub struct Deciding;

impl Kernel for Deciding {
    type Query = Question;
    type Found = Answer;
    const NAME: &'static str = "decide";
    const POINTS: usize = MOST_LEGS + 1;

    fn placed(question: &Question, first: DevicePlace, points: u32) -> Question {
        Question { first, points, ..*question }
    }

    fn tried(question: &Question) -> (DevicePlace, u32) {
        (question.first, question.count)
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use naga::{Module, TypeInner};

    use super::super::arithmetic::Outcome;
    use super::super::buffers::PAGE_BYTES;
    use super::super::drag::DRAG_WGSL;
    use super::super::lane::{DONE, Job, Lane, NOTES, RIGHT, RUNS, STACK, STOPPED, UNWRAPPED};
    use super::super::pages::PAGE_VERTICES;
    use super::super::pass::Span;
    use super::super::peak::PEAK_WGSL;
    use super::super::probe::PROBE_WGSL;
    use super::super::sample::Sample;
    use super::*;
    use crate::candidates::{BLOCK, BLOCKS, ROOM};
    use crate::fast::{NOTHING, UNWRAP};

    fn shader(wgsl: &str) -> Module {
        naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|e| panic!("{}", e.emit_to_string(wgsl)))
    }

    /// The size of a struct of the shader and the names and offsets of its members.
    fn layout(module: &Module, name: &str) -> (u32, Vec<(String, u32)>) {
        let ty =
            module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).unwrap_or_else(|| panic!("no {name}"));
        let TypeInner::Struct { members, span } = &ty.1.inner else { panic!("{name} is no struct") };
        (*span, members.iter().map(|m| (m.name.clone().unwrap(), m.offset)).collect())
    }

    #[test]
    fn the_shaders_are_valid() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        for wgsl in [SWEEP_WGSL, RAYS_WGSL, DECIDE_WGSL, DRAG_WGSL, PROBE_WGSL, PEAK_WGSL] {
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&shader(wgsl)).unwrap();
        }
    }

    /// The members of a host struct with their offsets.
    macro_rules! members {
        ($ty:ty: $($member:ident),*) => {
            vec![$((stringify!($member).to_owned(), offset_of!($ty, $member) as u32)),*]
        };
    }

    #[test]
    fn host_and_shaders_lay_their_structs_out_alike() {
        let module = shader(SWEEP_WGSL);
        let query = (size_of::<Query>() as u32, members!(Query: right, first, left, count, far, unused));
        assert_eq!(layout(&module, "Query"), query);
        assert_eq!(layout(&module, "Found"), (size_of::<Found>() as u32, members!(Found: count, places)));
        let module = shader(RAYS_WGSL);
        assert_eq!(layout(&module, "Query"), query);
        assert_eq!(layout(&module, "Blocks"), (size_of::<Blocks>() as u32, members!(Blocks: words)));
        let module = shader(DECIDE_WGSL);
        let question = members!(
            Question: right, left, ahead, origin, start, way, reach, dir, back, wrapped, first, count, points, legs,
            barred
        );
        let (size, members) = layout(&module, "Question");
        assert_eq!((size, &members[..question.len()]), (size_of::<Question>() as u32, &question[..]));
        assert_eq!(
            layout(&module, "Answer"),
            (size_of::<Answer>() as u32, members!(Answer: leg, place, dir, unused, at))
        );
        let module = shader(DRAG_WGSL);
        let lane = members!(
            Lane: point, last, pivot, low, depth, deeper, does, events, way, back, farthest, number
        );
        let (size, members) = layout(&module, "Lane");
        assert_eq!((size, &members[..lane.len()]), (size_of::<Lane>() as u32, &lane[..]));
        let job = members!(Job: lanes, turns, looks, anchor);
        assert_eq!(layout(&module, "Job"), (size_of::<Job>() as u32, job));
        let module = shader(PROBE_WGSL);
        let sample = members!(Sample: normal, p, q, a, b, origin, offset, dir);
        assert_eq!(layout(&module, "Sample"), (size_of::<Sample>() as u32, sample));
        let outcome = members!(Outcome: product, sum, least, holds, shapes);
        assert_eq!(layout(&module, "Result"), (size_of::<Outcome>() as u32, outcome));
        for wgsl in [SWEEP_WGSL, RAYS_WGSL, DECIDE_WGSL] {
            let module = shader(wgsl);
            let (size, span) = layout(&module, "Span");
            assert_eq!((size, &span[..2]), (size_of::<Span>() as u32, &members!(Span: first, end)[..]));
            let (size, page) = layout(&module, "Page");
            assert_eq!(u64::from(size), PAGE_BYTES);
            assert_eq!(page.last(), Some(&("pairs".to_owned(), PAGE_BYTES as u32 - 8 * PAGE_VERTICES)));
            assert_eq!(page[0], ("first".to_owned(), 0));
        }
    }

    #[test]
    fn host_and_shaders_agree_on_numbers() {
        assert!(SWEEP_WGSL.contains(&format!("count < {ROOM}u")));
        for wgsl in [SWEEP_WGSL, RAYS_WGSL, DECIDE_WGSL] {
            assert!(wgsl.contains(&format!("const PAGE: u32 = {PAGE_VERTICES}u;")));
        }
        assert!(RAYS_WGSL.contains(&format!("const QUERIES: u32 = {}u;", TryingAll::QUERIES)));
        assert!(RAYS_WGSL.contains(&format!("const BLOCK: u32 = {BLOCK}u;")));
        assert!(RAYS_WGSL.contains(&format!("const BLOCKS: u32 = {BLOCKS}u;")));
        for (name, number) in
            [("STACK", STACK as u32), ("LOG", NOTES as u32), ("RUNS", RUNS), ("DONE", DONE), ("STOPPED", STOPPED)]
        {
            assert!(DRAG_WGSL.contains(&format!("const {name}: u32 = {number}u;")), "{name}");
        }
        assert!(DRAG_WGSL.contains(&format!("const UNWRAP: u32 = {UNWRAPPED:#x}u;")));
        assert!(DRAG_WGSL.contains(&format!("{RIGHT:#x}u")));
        assert!(DECIDE_WGSL.contains(&format!("const NOTHING: u32 = {NOTHING:#x}u;")));
        assert!(DECIDE_WGSL.contains(&format!("const UNWRAP: u32 = {:#x}u;", UNWRAP.0)));
        assert!(DECIDE_WGSL.contains(&format!("const MARGIN: f32 = {};", 2f64.powi(-18))));
    }
}
