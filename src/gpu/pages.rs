//! Where lists of vertices lie on the device: in pages, each as large as a uniform binding.

use std::ops::Range;

use wgpu::BufferUsages;

use super::Device;
use super::buffers::{PAGE_BYTES, binding};
use crate::candidates::{DevicePlace, ListKey};

/// The size of a page's header, the first of its places and three unused numbers.
const HEADER_BYTES: u64 = 16;

/// How many vertices a page holds; `PAGE` in the shader.
pub(super) const PAGE_VERTICES: u32 = ((PAGE_BYTES - HEADER_BYTES) / 8) as u32;

/// How many pages share a buffer, if no list needs more and the budget allows: 1 MiB.
const BLOCK_PAGES: u32 = 16;

/// The place of no list.
const NOWHERE: DevicePlace = DevicePlace(u32::MAX);

/// The pages, in blocks made as they are needed, and which lists lie where.
///
/// Places are numbered through all pages. A list lies in one page if it can, else it begins a page and goes on through
/// the next ones of its block. When all blocks that the budget allows are full, the one not used for longest is
/// emptied.
pub(super) struct Pages {
    layout: wgpu::BindGroupLayout,
    blocks: Vec<Block>,
    /// How many pages a block has.
    size: u32,
    most_blocks: usize,
    /// The place of each list by its key, or [`NOWHERE`].
    places: Vec<DevicePlace>,
    /// The block that is being filled.
    open: usize,
    round: u64,
    /// How often a block was emptied to make room.
    emptied: u64,
}

struct Block {
    buffer: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    /// How many of its places are taken, from the first on.
    filled: u32,
    /// The lists that lie in it.
    lists: Vec<ListKey>,
    /// The round in which it was used last.
    used: u64,
}

impl Pages {
    /// Pages for `lists` lists, of at most `largest` vertices each, within a budget in bytes; two blocks
    /// are the least.
    pub(super) fn new(opened: &Device, lists: usize, largest: usize, budget: usize) -> Self {
        let layout = opened.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("page"),
            entries: &[binding(0, wgpu::BufferBindingType::Uniform, true)],
        });
        let affordable = (budget as u64 / 2 / PAGE_BYTES).min(u64::from(BLOCK_PAGES)) as u32;
        let size = affordable.max((largest as u32).div_ceil(PAGE_VERTICES)).max(1);
        // All places fit into a u32.
        let most = (u32::MAX / PAGE_VERTICES / size) as u64;
        let most_blocks = (budget as u64 / (u64::from(size) * PAGE_BYTES)).clamp(2, most) as usize;
        let places = vec![NOWHERE; lists];
        Pages { layout, blocks: Vec::new(), size, most_blocks, places, open: 0, round: 0, emptied: 0 }
    }

    pub(super) fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// How many bytes a block has.
    pub(super) fn block_bytes(&self) -> u64 {
        u64::from(self.size) * PAGE_BYTES
    }

    /// Starts a round: what is placed from now on stays until the next one starts.
    pub(super) fn start_round(&mut self) {
        self.round += 1;
    }

    /// The place of the list of this key, of `len` vertices; it is written there first, with their `coordinates`, if it
    /// is not. `None` if all blocks hold lists of this round and none has room left.
    pub(super) fn place(
        &mut self,
        opened: &Device,
        key: ListKey,
        len: usize,
        coordinates: impl FnOnce() -> Vec<[f32; 2]>,
    ) -> Option<DevicePlace> {
        let known = self.places[key.0 as usize];
        if known != NOWHERE {
            let block = (known.0 / self.block_places()) as usize;
            self.blocks[block].used = self.round;
            return Some(known);
        }
        // An empty list takes a place too, so that it lies in the block in which it is.
        let size = (len as u32).max(1);
        let start = match self.blocks.get(self.open).and_then(|block| self.fit(block.filled, size)) {
            Some(start) => start,
            None => {
                self.open = self.free_block(opened)?;
                0
            }
        };
        let place = DevicePlace(self.open as u32 * self.block_places() + start);
        self.write(opened, place, &coordinates());
        let block = &mut self.blocks[self.open];
        // Even, so that the next list begins at an even place too.
        block.filled = (start + size).next_multiple_of(2);
        block.used = self.round;
        block.lists.push(key);
        self.places[key.0 as usize] = place;
        Some(place)
    }

    fn block_places(&self) -> u32 {
        self.size * PAGE_VERTICES
    }

    /// Where in a block a list of `size` vertices can begin, if `filled` of its places are taken.
    fn fit(&self, filled: u32, size: u32) -> Option<u32> {
        let in_page = filled % PAGE_VERTICES;
        let start = if in_page + size <= PAGE_VERTICES { filled } else { filled.next_multiple_of(PAGE_VERTICES) };
        (start + size <= self.block_places()).then_some(start)
    }

    /// An empty block: a new one while the budget allows, else that not used for longest, emptied.
    fn free_block(&mut self, opened: &Device) -> Option<usize> {
        if self.blocks.len() < self.most_blocks {
            self.blocks.push(self.new_block(opened));
            return Some(self.blocks.len() - 1);
        }
        let (oldest, block) = self.blocks.iter().enumerate().min_by_key(|(_, block)| block.used)?;
        if block.used == self.round {
            return None;
        }
        self.empty(oldest);
        self.emptied += 1;
        Some(oldest)
    }

    pub(super) fn emptied(&self) -> u64 {
        self.emptied
    }

    fn empty(&mut self, block: usize) {
        let block = &mut self.blocks[block];
        block.lists.drain(..).for_each(|key| self.places[key.0 as usize] = NOWHERE);
        block.filled = 0;
    }

    /// Empties all blocks.
    pub(super) fn forget(&mut self) {
        (0..self.blocks.len()).for_each(|block| self.empty(block));
        self.open = 0;
    }

    fn new_block(&self, opened: &Device) -> Block {
        let buffer = opened.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pages"),
            size: self.block_bytes(),
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let page = wgpu::BufferBinding { buffer: &buffer, offset: 0, size: wgpu::BufferSize::new(PAGE_BYTES) };
        let bindings = opened.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("pages"),
            layout: &self.layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::Buffer(page) }],
        });
        for page in 0..self.size {
            let first = (self.blocks.len() as u32 * self.size + page) * PAGE_VERTICES;
            opened.queue.write_buffer(&buffer, u64::from(page) * PAGE_BYTES, bytemuck::bytes_of(&[first, 0, 0, 0]));
        }
        Block { buffer, bindings, filled: 0, lists: Vec::new(), used: 0 }
    }

    /// Writes `coordinates` from `first` on, page by page.
    fn write(&self, opened: &Device, first: DevicePlace, coordinates: &[[f32; 2]]) {
        let mut rest = coordinates;
        let mut place = first.0;
        while !rest.is_empty() {
            let (page, in_page) = (place / PAGE_VERTICES, place % PAGE_VERTICES);
            let (now, later) = rest.split_at(rest.len().min((PAGE_VERTICES - in_page) as usize));
            let (block, page) = (&self.blocks[(page / self.size) as usize], u64::from(page % self.size));
            let offset = page * PAGE_BYTES + HEADER_BYTES + 8 * u64::from(in_page);
            opened.queue.write_buffer(&block.buffer, offset, bytemuck::cast_slice(now));
            place += now.len() as u32;
            rest = later;
        }
    }

    /// What to bind for `page`: the group and its dynamic offset.
    pub(super) fn binding(&self, page: u32) -> (&wgpu::BindGroup, u32) {
        (&self.blocks[(page / self.size) as usize].bindings, page % self.size * PAGE_BYTES as u32)
    }
}

/// The pages on which the `count` vertices from `first` on lie; at least one.
pub(super) fn pages_of(first: DevicePlace, count: u32) -> Range<u32> {
    let begin = first.0 / PAGE_VERTICES;
    begin..(first.0 + count).div_ceil(PAGE_VERTICES).max(begin + 1)
}
