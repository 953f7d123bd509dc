//! The engine of the product: a compute shader takes traces along through many legs and events, the CPU keeps the books
//! and decides what the shader is not certain of.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::dragged::{Shared, Slot};
use super::fans::bring_fans;
use crate::candidates::{Grid, Lists, Simd};
use crate::engine::hand::Hand;
use crate::engine::windows::Windows;
use crate::engine::{Engine, EngineError, Job, Phase, WINDOW};
use crate::gpu::{
    AdapterKind, AdapterSummary, CHUNK, DRAG_WGSL, Device, DragPass, GpuError, HALVES, Lane, NOTES, Room, Tuning,
};
use crate::rope::TraceRecord;
use crate::scene::{Model, Pivot};
use crate::trace::{SettledTrace, bounds};

/// What the engine is called, in either precision.
pub(super) const NAME: &str = "gpu";

/// How many rays a pivot's fan is expected to have.
const RAYS: usize = 256;

/// How many legs of a trace are brought at a time at most.
const PIECE: usize = 1 << 12;

/// The traces of a half go on on the CPU when no more than one in so many is still on its way, or [`FEW`].
const STRAGGLERS: usize = 512;

/// How many traces of a half go ahead where the device has no fans yet; each time [`MORE`] times as many.
const AHEAD: usize = 64;
const MORE: usize = 8;

/// How many traces are not worth a round.
const FEW: usize = 4;

/// Evaluates traces on a GPU, for one model.
pub struct Gpu {
    lists: Lists,
    grid: Grid,
    device: Device,
    tuning: Tuning,
    wgsl: String,
    /// Made for the first traces, and again for more.
    pass: Option<DragPass>,
}

impl Gpu {
    /// An engine for `model` on an opened adapter.
    ///
    /// # Errors
    ///
    /// What the device complains of, or what of its f32 exact ropes cannot rely on.
    pub fn new(device: Device, model: Arc<Model>) -> Result<Self, GpuError> {
        let Tuning { queries, workgroup } = device.tuning();
        // Enough for a round to be long, and few enough for their state to stay in the caches of the CPU, whose the
        // device is.
        let tuning = match device.summary().kind {
            AdapterKind::Software => Tuning { queries: queries / 8, workgroup },
            _ => Tuning { queries, workgroup },
        };
        Self::with(device, Lists::new(model).after(0), tuning, DRAG_WGSL)
    }

    /// An engine with the fans of `lists`. `tuning` takes the place of what suits the adapter, its queries being
    /// traces; `wgsl` that of `drag.wgsl`.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn with(device: Device, lists: Lists, tuning: Tuning, wgsl: &str) -> Result<Self, GpuError> {
        device.certify()?;
        let grid = Grid::new(*lists.frame());
        Ok(Gpu { lists, grid, device, tuning, wgsl: wgsl.to_owned(), pass: None })
    }

    /// The adapter on which it runs.
    pub fn adapter(&self) -> &AdapterSummary {
        self.device.summary()
    }

    /// Makes sure that there is a pass with room enough for so many traces, of so many points in all.
    fn make_room(&mut self, traces: usize, points: usize) -> Result<(), GpuError> {
        let most = DragPass::most(&self.device, self.tuning.queries);
        let model = self.lists.model();
        let room = Room {
            lanes: traces.div_ceil(HALVES).next_power_of_two().min(most.lanes),
            points: points.div_ceil(HALVES).next_power_of_two().max(CHUNK).min(most.points),
            rays: (RAYS * (model.vertices().len() + 1)).next_power_of_two().min(most.rays),
        };
        let suffices = |has: Room| has.lanes >= room.lanes && has.points >= room.points;
        if self.pass.as_ref().is_none_or(|pass| !suffices(pass.room())) {
            let places: Vec<[i32; 2]> = model.pivots().map(|pivot| self.grid.place(model.position(pivot))).collect();
            self.pass = None;
            let pass = DragPass::new(self.device.clone(), &places, room, self.tuning.workgroup, &self.wgsl)?;
            self.pass = Some(pass);
        }
        Ok(())
    }
}

impl Engine for Gpu {
    fn name(&self) -> &'static str {
        NAME
    }

    fn evaluate(&mut self, traces: &[SettledTrace], job: &Job) -> Result<Vec<TraceRecord>, EngineError> {
        if bounds(traces).is_some_and(|bounds| self.lists.cover(bounds))
            && let Some(pass) = &mut self.pass
        {
            pass.forget();
        }
        let mut records: Vec<Option<TraceRecord>> = traces.iter().map(|_| None).collect();
        // Traces that touch walls are hardly ever certain, and those that cross them can meet anything.
        let suits = |trace: &SettledTrace| {
            trace.is_plain() && !trace.breaks_rules() && self.grid.holds(trace.bounds()) && trace.points().len() > 1
        };
        let (easy, hard): (Vec<usize>, Vec<usize>) = (0..traces.len()).partition(|&i| suits(&traces[i]));
        let points = easy.iter().map(|&i| traces[i].points().len().min(PIECE + 1).next_multiple_of(CHUNK)).sum();
        if !easy.is_empty() {
            self.make_room(easy.len(), points)?;
        }
        let Gpu { lists, grid, pass, .. } = self;
        let hand = || (Hand::new(lists, WINDOW, Simd::detected()), Windows::new());
        let one = |(hand, windows): &mut (Hand<'_>, Windows), i: usize| {
            Ok::<_, EngineError>((i, hand.evaluate(windows, &traces[i], job)?))
        };
        let done: Result<Vec<_>, EngineError> = hard.into_par_iter().map_init(hand, one).collect();
        done?.into_iter().for_each(|(i, record)| records[i] = Some(record));
        if let Some(pass) = pass.as_mut().filter(|_| !easy.is_empty()) {
            let shared = Shared::new(lists, grid, job, traces, &easy);
            let lanes = pass.room().lanes.min(easy.len().div_ceil(HALVES));
            let mut halves: [Half<'_>; HALVES] = std::array::from_fn(|_| Half::new(lanes, pass.has_fans()));
            let played = play(pass, &shared, &mut halves, &mut records);
            // Rounds that are still on their way after an early end: so that the next evaluation finds the device free.
            for half in 0..HALVES {
                let _ = pass.collect(half, |_, _| ());
            }
            played?;
        }
        Ok(records.into_iter().map(|r| r.expect("every trace was evaluated")).collect())
    }

    fn batch(&self) -> usize {
        HALVES * self.tuning.queries
    }

    fn remaining(&self) -> Option<usize> {
        self.lists.remaining_count()
    }

    fn forget(&mut self) {
        self.lists.forget();
        self.pass.iter_mut().for_each(DragPass::forget);
    }
}

fn play<'a>(
    pass: &mut DragPass,
    shared: &Shared<'a>,
    halves: &mut [Half<'a>; HALVES],
    records: &mut [Option<TraceRecord>],
) -> Result<(), EngineError> {
    loop {
        for (number, half) in halves.iter_mut().enumerate() {
            shared.job.go_on()?;
            half.collect(pass, number, shared)?;
            if shared.astray.load(Ordering::Relaxed) {
                return Err(pass.device().failed("it named an event that cannot be").into());
            }
            half.send(pass, number, shared);
            // What finds no room on the device goes on on the CPU, and makes room for others.
            while half.active.is_empty() && half.fill(pass, number, shared, records)? {
                shared.job.go_on()?;
                half.send(pass, number, shared);
            }
            if shared.job.is_timed() {
                // Alone on the machine, so that each phase's time is its own.
                shared.job.time(Phase::Kernel, || pass.wait(number))?;
            }
        }
        if halves.iter().all(|half| half.active.is_empty()) {
            return Ok(());
        }
    }
}

/// A half of the batch and its round.
struct Half<'a> {
    slots: Vec<Slot<'a>>,
    /// The slots that are on the device, in the order of their lanes.
    active: Vec<usize>,
    /// How many there were when the half was filled.
    filled: usize,
    /// How many slots are filled the next time.
    next: usize,
    lanes: Vec<Lane>,
}

impl<'a> Half<'a> {
    /// A half with so many slots. Where the device has no fans yet, a few traces go ahead and have them made: each
    /// stops at every pivot that is new.
    fn new(slots: usize, has_fans: bool) -> Self {
        let next = if has_fans { slots } else { AHEAD };
        let slots = (0..slots).map(|_| Slot::new()).collect();
        Half { slots, active: Vec::new(), filled: 0, next, lanes: Vec::new() }
    }

    /// Takes the traces that were on the device as far as it took them, and those that it was not certain of a bit
    /// further. When few are left they go on to the end of their piece.
    fn collect(&mut self, pass: &mut DragPass, number: usize, shared: &Shared<'a>) -> Result<(), EngineError> {
        if self.active.is_empty() {
            return Ok(());
        }
        let first = pass.first_point(number);
        let Half { slots, active, filled, .. } = self;
        let mut on = chosen(slots, active);
        pass.collect(number, |lanes, notes| {
            shared.job.time(Phase::Update, || {
                on.par_iter_mut().zip(lanes).zip(notes.par_chunks(NOTES)).with_min_len(16).for_each_init(
                    || shared.hand(),
                    |hand, ((slot, lane), notes)| slot.collect(hand, shared, first, lane, notes),
                );
            });
        })?;
        active.retain(|&slot| slots[slot].is_on_its_way());
        if active.len() <= (*filled / STRAGGLERS).max(FEW) {
            finish_pieces(slots, active, shared);
            active.clear();
        }
        Ok(())
    }

    /// Gives every slot a piece of its trace, or of the next one where that is done; false if there are none left.
    fn fill(
        &mut self,
        pass: &mut DragPass,
        number: usize,
        shared: &Shared<'a>,
        records: &mut [Option<TraceRecord>],
    ) -> Result<bool, GpuError> {
        let Half { slots, active, filled, next, .. } = self;
        // So that every slot finds room for a piece, as far as a chunk goes.
        let fair = pass.room().points / slots.len().min(*next).max(1) / CHUNK * CHUNK;
        let most = PIECE.min(fair.max(CHUNK) - 1);
        let mut taken = 0;
        let mut with_piece = Vec::with_capacity(slots.len());
        let mut any = false;
        for (i, slot) in slots.iter_mut().enumerate().take(*next) {
            if let Some((done, record)) = slot.next_trace(shared) {
                records[done] = Some(record);
            }
            let Some(chunks) = slot.take_piece(taken, most) else { continue };
            any = true;
            if taken + chunks * CHUNK > pass.room().points {
                slot.put_back();
                break;
            }
            taken += chunks * CHUNK;
            with_piece.push(i);
        }
        shared.job.time(Phase::Upload, || {
            let parts: Vec<_> = with_piece.iter().map(|&i| (slots[i].chunks(), slots[i].points())).collect();
            pass.bring_points(number, &parts, |points, chunk, places| {
                let points = &points[chunk * CHUNK..];
                places.iter_mut().zip(points).for_each(|(place, &p)| *place = shared.grid.place(p));
            })?;
            chosen(slots, &with_piece)
                .par_iter_mut()
                .with_min_len(16)
                .for_each_init(|| shared.hand(), |hand, slot| slot.position(hand, shared));
            Ok::<_, GpuError>(())
        })?;
        *active = with_piece;
        active.retain(|&slot| slots[slot].is_on_its_way());
        *filled = active.len();
        *next = next.saturating_mul(MORE);
        Ok(any)
    }

    /// Sends the traces that are on their way. Those whose fans find no room go on on the CPU.
    fn send(&mut self, pass: &mut DragPass, number: usize, shared: &Shared<'a>) {
        let Half { slots, active, lanes, .. } = self;
        shared.job.time(Phase::Upload, || {
            let model = shared.lists.model();
            let bring = |pass: &mut DragPass, slots: &[Slot<'a>]| {
                let pivots: BTreeSet<Pivot> = active.iter().map(|&i| slots[i].pivot(model)).collect();
                bring_fans(pass, shared, pivots)
            };
            if !bring(pass, slots) {
                pass.forget();
                bring(pass, slots);
            }
            let heads = pass.heads();
            let (on, off): (Vec<usize>, Vec<usize>) =
                active.iter().partition(|&&i| heads[slots[i].pivot(model).index()].has_fan());
            finish_pieces(slots, &off, shared);
            *active = on;
            lanes.clear();
            let first = pass.first_point(number);
            for &i in &*active {
                lanes.push(slots[i].lane(first, i));
                let (below, stack) = slots[i].take_stack();
                pass.bring_stack(number, i, below, &stack);
            }
            pass.send(number, lanes);
        });
    }
}

/// Takes the traces of these slots to the end of their pieces, on the CPU.
fn finish_pieces<'a>(slots: &mut [Slot<'a>], numbers: &[usize], shared: &Shared<'a>) {
    let mut left = chosen(slots, numbers);
    left.par_iter_mut().for_each_init(|| shared.hand(), |hand, slot| slot.finish_piece(hand, shared));
}

/// The items of these numbers, which increase.
fn chosen<'s, T>(items: &'s mut [T], numbers: &[usize]) -> Vec<&'s mut T> {
    let mut numbers = numbers.iter().peekable();
    let is_chosen = |(i, _): &(usize, &mut T)| numbers.next_if_eq(&i).is_some();
    items.iter_mut().enumerate().filter(is_chosen).map(|(_, item)| item).collect()
}
