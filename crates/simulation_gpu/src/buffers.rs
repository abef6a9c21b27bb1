//! The buffers of a step, and which content they hold.

use bytemuck::Pod;
use lovelock_gpu::{Gpu, GrowBuffer, wgpu};
use lovelock_simulation::device::{DeviceStep, FRAME_WAVES, SLOTS, STATE_ROWS, Stamp, grid_size};

/// Lists of one number per point and slot in the working memory; see `step.wgsl`.
const WORK_LISTS: u64 = 40;

/// The same in the rest data: lists, and the distances to the field.
const REST_LISTS: u64 = 23;

/// Numbers per slot in the rest data.
const PER_SLOT: u64 = 4;

/// Lists of the matrices, and numbers per slot behind them.
const MATRIX_LISTS: u64 = 9;
const FLAGS: u64 = 2;

/// Words of the report per slot.
pub(crate) const CONTACT_WORDS: u64 = 5;

/// Numbers per cell of the density grid, and words before the cells.
const CELL_NUMBERS: u64 = 11;
const FIRST_CELL: u64 = 2;

/// Numbers in each large buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sizes {
    pub(crate) state: u64,
    pub(crate) work: u64,
    pub(crate) rest: u64,
    pub(crate) matrix: u64,
}

impl Sizes {
    /// The sizes for guides in `blocks` blocks.
    pub(crate) fn of(blocks: u64, points: u64, first_free: u64, colliders: u64) -> Self {
        let slots = blocks * SLOTS as u64;
        let numbers = slots * points;
        let links = points.saturating_sub(first_free);
        let triangle = links * (links + 1) / 2;
        Self {
            state: numbers * STATE_ROWS as u64,
            work: numbers * WORK_LISTS,
            rest: numbers * (REST_LISTS + colliders) + slots * PER_SLOT,
            matrix: numbers * MATRIX_LISTS + slots * (2 * triangle + FLAGS),
        }
    }

    /// Why a buffer of at most `most` bytes is too small, if it is.
    pub(crate) fn refusal(&self, guides: u64, most: u64) -> Option<String> {
        let lists = [
            ("state", self.state),
            ("working memory", self.work),
            ("rest shape", self.rest),
            ("matrices", self.matrix),
        ];
        let (what, numbers) = lists.into_iter().max_by_key(|(_, numbers)| *numbers)?;
        let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
        (4 * numbers > most).then(|| {
            format!(
                "the graphics card cannot simulate {guides} guides: their {what} needs {} MB; must be at most {} MB",
                megabytes(4 * numbers),
                most / 1_000_000
            )
        })
    }
}

/// The number of cells of the density grid.
pub(crate) fn cells() -> u64 {
    grid_size().as_u64vec3().element_product()
}

/// Words of the density grid.
pub(crate) fn grid_words() -> u64 {
    FIRST_CELL + cells() * CELL_NUMBERS
}

/// What the matrices are computed from.
pub(crate) type Matrices = (Stamp, lovelock_simulation::device::BendingKey, lovelock_simulation::Integrator);

/// The contents that are on the device.
#[derive(Debug, Default)]
pub(crate) struct Known {
    pub(crate) guides: Option<Stamp>,
    pub(crate) distances: Option<(Stamp, Stamp)>,
    pub(crate) state: Option<Stamp>,
    pub(crate) field: Option<Stamp>,
    /// By which counting the rest density of the grid was found.
    pub(crate) density: Option<(Stamp, bool)>,
    pub(crate) matrices: Option<Matrices>,
    pub(crate) sizes: Option<Sizes>,
}

/// The buffers of a step.
#[derive(Debug)]
pub(crate) struct Buffers {
    pub(crate) state: GrowBuffer<f32>,
    pub(crate) work: GrowBuffer<f32>,
    pub(crate) rest: GrowBuffer<f32>,
    pub(crate) matrix: GrowBuffer<f32>,
    pub(crate) grid: GrowBuffer<i32>,
    pub(crate) density: GrowBuffer<f32>,
    pub(crate) field: GrowBuffer<u32>,
    pub(crate) body: GrowBuffer<u32>,
    pub(crate) frame: GrowBuffer<f32>,
    pub(crate) report: GrowBuffer<u32>,
    pub(crate) known: Known,
    /// Working memory for lists that are uploaded.
    numbers: Vec<f32>,
    words: Vec<u32>,
}

impl Buffers {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        fn list<T: Pod>(gpu: &Gpu, label: &'static str) -> GrowBuffer<T> {
            GrowBuffer::new(gpu, label, wgpu::BufferUsages::STORAGE)
        }
        Self {
            state: list(gpu, "guide state"),
            work: list(gpu, "guide work"),
            rest: list(gpu, "guide rest"),
            matrix: list(gpu, "guide matrices"),
            grid: list(gpu, "density grid"),
            density: list(gpu, "rest density"),
            field: list(gpu, "field"),
            body: list(gpu, "body"),
            frame: list(gpu, "simulation frame"),
            report: list(gpu, "contacts"),
            known: Known::default(),
            numbers: Vec::new(),
            words: Vec::new(),
        }
    }

    /// Makes room for the guides of `step` and uploads what has changed. Returns the offsets in the frame, and whether the
    /// matrices must be computed.
    pub(crate) fn fill(
        &mut self,
        gpu: &Gpu,
        step: &DeviceStep,
        sizes: Sizes,
    ) -> (lovelock_simulation::device::FrameOffsets, bool) {
        let Self { numbers, words, known, .. } = self;
        if known.sizes != Some(sizes) {
            *known = Known { sizes: Some(sizes), field: known.field, ..Known::default() };
            self.state.reserve(gpu, sizes.state as usize);
            self.work.reserve(gpu, sizes.work as usize);
            self.rest.reserve(gpu, sizes.rest as usize);
            self.matrix.reserve(gpu, sizes.matrix as usize);
            self.grid.reserve(gpu, grid_words() as usize);
            self.report.reserve(gpu, step.blocks() * SLOTS * CONTACT_WORDS as usize);
        }
        let guides = step.guides_stamp();
        if known.guides != Some(guides) {
            step.write_guides(numbers);
            gpu.upload(self.rest.raw(), 0, numbers);
            known.guides = Some(guides);
        }
        if known.distances != Some((guides, step.distances_stamp())) {
            step.write_distances(numbers);
            let lists = (REST_LISTS - 1) * step.numbers() as u64;
            let before = lists + (step.blocks() * SLOTS) as u64 * PER_SLOT;
            gpu.upload(self.rest.raw(), 4 * before, numbers);
            known.distances = Some((guides, step.distances_stamp()));
        }
        let counting = (guides, step.counts_nearest());
        if known.density != Some(counting) {
            step.write_rest_density(numbers);
            self.density.write(gpu, numbers);
            known.density = Some(counting);
        }
        if let Some(field) = step.field() {
            if known.field != Some(field.stamp()) {
                field.write_rest(words);
                self.field.write(gpu, words);
                known.field = Some(field.stamp());
            }
            field.write_step(words);
            self.body.write(gpu, words);
        }
        let matrices = (guides, step.bends(), step.integrator());
        let mut stale = known.matrices != Some(matrices);
        known.matrices = Some(matrices);
        if known.state != Some(step.state_stamp()) {
            step.write_state(numbers);
            gpu.upload(self.state.raw(), 0, numbers);
            // The lengths are factorised again for the directions of this state.
            stale = true;
        }
        // Until the step has succeeded.
        known.state = None;
        let offsets = step.write_frame(numbers);
        debug_assert!(offsets.solids - offsets.wind == FRAME_WAVES as u32, "the wind has another size");
        self.frame.write(gpu, numbers);
        (offsets, stale)
    }
}
