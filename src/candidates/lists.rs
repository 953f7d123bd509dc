//! The lists of all pivots: made on first use, shared by all threads and traces, within a memory budget.

use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError, RwLock};

use super::{Frame, List, ListKey, Query, Simd};
use glam::DVec2;

use crate::geometry::{higher, lower};
use crate::scene::{Model, Pivot};
use crate::visibility::{Scratch, Visibility};

/// How much memory the lists may take unless told otherwise: 256 MiB, enough for some 200,000 pivots.
pub const LISTS_BUDGET: usize = 256 << 20;

/// After how many queries a pivot gets a list unless told otherwise. Making one costs as much as some 30 looks that go
/// no further than their queries (about 15 us and 0.5 us at 1,000 vertices), and most pivots that are asked about 8
/// times are asked about many times more.
const WORTH_A_LIST: u32 = 8;

/// How many triangles a look for one query may take before it gives up and all that remain are tried, in scenes where
/// that is more than a 64th of the vertices: one triangle takes as long as some 150 vertices.
const TRIANGLES_A_LOOK: usize = 64;

/// How many triangles the making of a list may look at, in scenes where that is more than a quarter of the vertices:
/// several times as many as pivots see through where walls hide most of the scene. Pivots that see more try all that
/// remain.
const TRIANGLES_A_LIST: usize = 1 << 12;

/// The square of how much further a pivot's first list reaches than the queries before.
const FURTHER: f64 = 2.0;

/// Which vertices each pivot's queries try.
pub struct Lists {
    model: Arc<Model>,
    frame: Frame,
    keep_all: bool,
    /// Whether ropes may start elsewhere than at the model's anchor.
    anywhere: bool,
    budget: usize,
    worth: u32,
    /// How many triangles a look and the making of a list may take, if told.
    most: Option<usize>,
    /// The lowest and highest x and y of all pivots and queries, if they are known.
    reach: Option<(DVec2, DVec2)>,
    visibility: OnceLock<Option<Visibility>>,
    all: OnceLock<Arc<List>>,
    remaining: OnceLock<Arc<List>>,
    /// By pivot: vertices first, then the anchor.
    entries: Box<[Entry]>,
    bytes: AtomicUsize,
    /// Counts the lists made: the clock by which "recently" is told.
    made: AtomicU64,
    looks: Mutex<Vec<(Scratch, Vec<u32>)>>,
    dropping: Mutex<()>,
}

#[derive(Default)]
struct Entry {
    list: RwLock<Option<Arc<List>>>,
    /// When it was used last.
    used: AtomicU64,
    /// How often it, or one that reaches further, would have been used before it was made.
    wanted: AtomicU32,
    /// The bits of the square of how far these uses reached.
    furthest: AtomicU64,
}

impl Lists {
    /// Lists of what each pivot sees, of which none is made yet.
    pub fn new(model: Arc<Model>) -> Self {
        let entries = (0..=model.vertices().len()).map(|_| Entry::default()).collect();
        Lists {
            frame: Frame::new(&model),
            model,
            keep_all: false,
            anywhere: false,
            budget: LISTS_BUDGET,
            worth: WORTH_A_LIST,
            most: None,
            reach: None,
            visibility: OnceLock::new(),
            all: OnceLock::new(),
            remaining: OnceLock::new(),
            entries,
            bytes: AtomicUsize::new(0),
            made: AtomicU64::new(0),
            looks: Mutex::new(Vec::new()),
            dropping: Mutex::new(()),
        }
    }

    /// With all vertices in every list, as the seed of the method has it.
    #[must_use]
    pub fn keep_all(mut self) -> Self {
        self.forget();
        self.keep_all = true;
        self
    }

    /// Lists for ropes in the same scene that may start anywhere, of which none is made yet: with all that the pivots
    /// see, be it out of reach of the model's anchor.
    #[must_use]
    pub fn anywhere(&self) -> Lists {
        let Lists { keep_all, budget, worth, most, .. } = *self;
        Lists { keep_all, budget, worth, most, anywhere: true, ..Lists::new(self.model.clone()) }
    }

    /// With a memory budget in bytes; the lists not used for longest go first.
    #[must_use]
    pub fn budget(mut self, bytes: usize) -> Self {
        self.budget = bytes;
        self
    }

    /// With a list for each pivot after that many queries about it; 0 for at once.
    #[must_use]
    pub fn after(mut self, queries: u32) -> Self {
        self.worth = queries;
        self
    }

    /// With looks, and the making of lists, given up after that many triangles: then [`remaining`](Self::remaining)
    /// vertices are tried.
    #[must_use]
    pub fn at_most(mut self, triangles: usize) -> Self {
        self.most = Some(triangles);
        self
    }

    /// Gets ready for traces inside a box from `low` to `high`: walls out of reach of all traces are left out of the
    /// triangulation. Returns whether what was made before had to be dropped, because these go further than any before.
    ///
    /// If lists were used before the first call, their triangulation holds all walls: the call then changes nothing.
    pub fn cover(&mut self, (low, high): (DVec2, DVec2)) -> bool {
        let anchor = self.model.anchor();
        let (mut low, mut high) = (lower(low, anchor), higher(high, anchor));
        let is_made = self.visibility.get().is_some();
        if is_made && self.reach.is_none_or(|(l, h)| l.cmple(low).all() && h.cmpge(high).all()) {
            return false;
        }
        if let Some((l, h)) = self.reach {
            (low, high) = (lower(low, l), higher(high, h));
        }
        if is_made {
            // A good deal further, so that this is rarely done.
            let more = (high - low) / 2.0;
            (low, high) = (low - more, high + more);
            self.forget();
        }
        self.reach = Some((low, high));
        is_made
    }

    /// Drops all lists and the triangulation from which they were made.
    pub fn forget(&mut self) {
        self.reach = None;
        self.visibility.take();
        self.all.take();
        self.remaining.take();
        self.entries.iter_mut().for_each(|entry| *entry = Entry::default());
        *self.bytes.get_mut() = 0;
        *self.made.get_mut() = 0;
    }

    /// The model whose vertices are listed.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The frame of the lists' coordinates.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// How many lists have been made so far, those made again counted again.
    pub fn made(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// How much memory the lists take, in bytes.
    pub fn bytes(&self) -> usize {
        self.bytes.load(Ordering::Relaxed)
    }

    /// The list of all vertices, for traces that cross walls.
    pub fn all(&self) -> &Arc<List> {
        let all = 0..self.model.vertices().len() as u32;
        self.all.get_or_init(|| Arc::new(List::of_any(&self.model, &self.frame, all)))
    }

    /// The list of all vertices at which a rope can turn whose free end keeps to the rules and goes no further than
    /// these lists were told: that of [`all`](Self::all) where [`keeps_all`](Self::keeps_all). See
    /// [`Visibility::only_required`].
    pub fn remaining(&self) -> &Arc<List> {
        self.remaining.get_or_init(|| {
            let visibility = if self.keep_all { None } else { self.visibility() };
            let left_out = |remaining: &Vec<u32>| remaining.len() < self.model.vertices().len();
            match visibility.map(Visibility::listed).filter(left_out) {
                Some(remaining) => Arc::new(List::of_any(&self.model, &self.frame, remaining.into_iter())),
                None => Arc::clone(self.all()),
            }
        })
    }

    /// How many vertices [`remaining`](Self::remaining) has; `None` before anything was asked that takes knowing which.
    /// Makes nothing.
    pub fn remaining_count(&self) -> Option<usize> {
        let all = self.model.vertices().len();
        match (self.keep_all, self.visibility.get()) {
            (true, _) | (_, Some(None)) => Some(all),
            (_, Some(Some(visibility))) => Some(visibility.listed().len()),
            (_, None) => None,
        }
    }

    /// Whether every pivot has the list of [`all`](Self::all) vertices: because that was asked for, or because the
    /// scene cannot be triangulated.
    pub fn keeps_all(&self) -> bool {
        self.keep_all || self.visibility().is_none()
    }

    /// The key of `list`, which is that of `pivot`: the pivots' own lists come first, then that of the
    /// [`remaining`](Self::remaining) vertices and that of [`all`](Self::all).
    pub fn key(&self, pivot: Pivot, list: &Arc<List>) -> ListKey {
        let pivots = self.entries.len();
        let key = match list.is_of_any() {
            false => pivot.index(),
            true if Arc::ptr_eq(list, self.all()) => pivots + 1,
            true => pivots,
        };
        ListKey(key as u32)
    }

    /// How many [`key`](Self::key)s there are: each is less than that.
    pub fn keys(&self) -> usize {
        self.entries.len() + 2
    }

    /// The list of `pivot`, for queries whose points are all no
    /// further from it than the square root of `squared`, in the scene's unit; infinity for any. `None` as long as that
    /// is not worth making: then [`look_into`](Self::look_into) answers.
    ///
    /// A pivot's first list goes a little further than its queries so far; the second goes all the way. See
    /// [`Visibility::look`] for what is in it and what making it costs.
    pub fn of(&self, pivot: Pivot, squared: f64) -> Option<Arc<List>> {
        let entry = &self.entries[pivot.index()];
        let list = entry.list.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(list) = list.as_ref().filter(|list| list.reaches(squared)) {
            // Written only if it changes, so that the threads need not take it from each other.
            if entry.used.load(Ordering::Relaxed) != self.made() {
                entry.used.store(self.made(), Ordering::Relaxed);
            }
            return Some(Arc::clone(list));
        }
        if self.keeps_all() {
            return Some(Arc::clone(self.all()));
        }
        // Bits of numbers that are not negative compare as the numbers do.
        let furthest = f64::from_bits(entry.furthest.fetch_max(squared.to_bits(), Ordering::Relaxed)).max(squared);
        if entry.wanted.fetch_add(1, Ordering::Relaxed) < self.worth {
            return None;
        }
        let reach = if list.is_none() { FURTHER * furthest } else { f64::INFINITY };
        drop(list);
        Some(self.make(pivot, reach))
    }

    /// Adds the candidates of a query about `pivot` to `found`, without a list of its own, and returns how many
    /// vertices were tried.
    ///
    /// Looks through the triangles of the scene's triangulation in which the query lies, or tries all that remain where
    /// that is less.
    pub fn look_into(
        &self,
        pivot: Pivot,
        query: &Query,
        simd: Simd,
        scratch: &mut Scratch,
        found: &mut Vec<u32>,
    ) -> usize {
        if let Some(visibility) = self.visibility() {
            let [right, left, far] = [query.right, query.left, query.far].map(|h| h.map(f64::from));
            let outside = |p: DVec2| {
                let p = self.frame.place(p);
                let is_outside = |[x, y, offset]: [f64; 3]| u8::from(x * p.x + y * p.y + offset < 0.0);
                is_outside(right) | is_outside(left) << 1 | is_outside(far) << 2
            };
            let most = self.most.unwrap_or(TRIANGLES_A_LOOK.max(self.model.vertices().len() / 64));
            if let Some(tried) = visibility.look_into(pivot, outside, most, scratch, found) {
                return tried;
            }
        }
        found.clear();
        let remaining = self.remaining();
        simd.sweep(remaining, query, remaining.len(), found);
        remaining.len()
    }

    fn visibility(&self) -> Option<&Visibility> {
        let made = || match self.reach {
            Some(reach) => Visibility::within(&self.model, reach),
            None => Visibility::new(&self.model),
        };
        let required = |seen: Visibility| if self.anywhere { seen } else { seen.only_required() };
        self.visibility.get_or_init(|| made().map(required)).as_ref()
    }

    #[cold]
    fn make(&self, pivot: Pivot, reach: f64) -> Arc<List> {
        let pool = || self.looks.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut scratch, mut seen) = pool().pop().unwrap_or_default();
        let n = self.model.vertices().len();
        let visibility = self.visibility().expect("where there is none, all pivots have one list");
        let most = self.most.unwrap_or(TRIANGLES_A_LIST.max(n / 4));
        let at = self.model.position(pivot);
        let looked = if reach == f64::INFINITY {
            visibility.look_into(pivot, |_| 0, most, &mut scratch, &mut seen)
        } else {
            visibility.look_into(pivot, octagon(at, reach.sqrt()), most, &mut scratch, &mut seen)
        };
        let list = match looked {
            Some(_) => Arc::new(List::about(&self.model, &self.frame, at, reach, &seen)),
            None => Arc::clone(self.remaining()),
        };
        pool().push((scratch, seen));
        let entry = &self.entries[pivot.index()];
        {
            // All of it under the lock, so that nobody drops a list whose bytes do not count yet.
            let mut slot = entry.list.write().unwrap_or_else(PoisonError::into_inner);
            if let Some(list) = slot.as_ref().filter(|list| list.reaches(reach)) {
                // Another thread has made it meanwhile.
                return Arc::clone(list);
            }
            entry.wanted.store(0, Ordering::Relaxed);
            entry.used.store(self.made.fetch_add(1, Ordering::Relaxed), Ordering::Relaxed);
            self.bytes.fetch_add(own_bytes(&list), Ordering::Relaxed);
            if let Some(shorter) = slot.replace(Arc::clone(&list)) {
                self.bytes.fetch_sub(own_bytes(&shorter), Ordering::Relaxed);
            }
        }
        if self.bytes() > self.budget {
            self.drop_some();
        }
        list
    }

    /// Drops the lists not used for longest until a quarter of the budget is free, so that this is rarely done.
    /// O(pivots + lists log lists).
    #[cold]
    fn drop_some(&self) {
        // One thread does it; the others go on meanwhile.
        let Ok(_dropping) = self.dropping.try_lock() else { return };
        let has_list = |e: &Entry| e.list.read().unwrap_or_else(PoisonError::into_inner).is_some();
        let lists = self.entries.iter().zip(0..).filter(|(entry, _)| has_list(entry));
        let mut oldest: Vec<(u64, usize)> = lists.map(|(e, pivot)| (e.used.load(Ordering::Relaxed), pivot)).collect();
        oldest.sort_unstable();
        for (_, pivot) in oldest {
            if self.bytes() <= self.budget / 4 * 3 {
                break;
            }
            let dropped = self.entries[pivot].list.write().unwrap_or_else(PoisonError::into_inner).take();
            self.entries[pivot].wanted.store(0, Ordering::Relaxed);
            self.bytes.fetch_sub(dropped.map_or(0, |d| own_bytes(&d)), Ordering::Relaxed);
        }
    }
}

/// What a list counts for: nothing if it is for any pivot, since those there are once.
fn own_bytes(list: &List) -> usize {
    if list.is_of_any() { 0 } else { list.bytes() }
}

/// Bits for the sides of an octagon about `o` outside which a point lies; all that is within `radius` lies inside.
fn octagon(o: DVec2, radius: f64) -> impl Fn(DVec2) -> u8 {
    // A little larger, so that what is within `radius` lies inside whichever way the sums are rounded.
    let side = radius * (1.0 + 2f64.powi(-40));
    let corner = side * std::f64::consts::SQRT_2;
    move |p| {
        let DVec2 { x, y } = p - o;
        let sides = [(x, side), (y, side), (x + y, corner), (x - y, corner)];
        sides.iter().fold(0, |bits, &(d, far)| bits << 2 | u8::from(d > far) << 1 | u8::from(d < -far))
    }
}
