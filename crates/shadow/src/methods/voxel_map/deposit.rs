//! Density: every sample of a strand adds its optical depth to the cell that contains it.
//!
//! Points are processed in blocks of 64. Coordinates, lengths and addresses are computed in loops over fixed-size
//! arrays, which the compiler vectorises; only the additions themselves are scalar.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
// No loop may branch.
#![allow(unsafe_code, clippy::inline_always, clippy::needless_bitwise_bool, clippy::needless_range_loop)]

use lovelock_base::simd::whole_part;
use lovelock_base::simd_versions;
use lovelock_groom::Strands;

use super::grid::{DEPTH_ONE, Grid};
use super::lattice::Lattice;
use super::layout::Layout;
use super::samples::{sample_at, sample_count};

/// Points that are transformed together; each but the last is the start of a segment.
const BLOCK: usize = 64;
/// Segments whose samples are addressed together.
const LANES: usize = 16;
/// Segments with more samples than this, among shorter ones, are processed one at a time.
const LONG: u32 = 24;
/// The most that one sample adds, in fixed point: τ = 32, twice the largest depth of a cell.
pub(super) const MAX_PER_SAMPLE: f32 = 32.0 * DEPTH_ONE;

simd_versions! {
    /// [`Deposit::run`] for the vectors of `width`.
    pub(super) fn deposit_simd(deposit: &Deposit, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
        deposit.run(strands, first, last, grid)
    }
}

/// The parameters of a deposit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deposit {
    pub layout: Layout,
    pub lattice: Lattice,
    /// Optical depth in fixed point: of a segment whose length across the light is one cell, or of a point.
    pub depth: f32,
    /// Whether each point adds `depth`, as in the paper. Otherwise each segment adds it times its length.
    pub by_point: bool,
    /// See [`VoxelDeposit::squares`](super::VoxelDeposit::squares).
    pub squares: [f32; 2],
}

/// A block of segments in window coordinates.
struct Block {
    from: [[f32; BLOCK]; 3],
    step: [[f32; BLOCK]; 3],
    /// The number of samples per segment; 0 in unused lanes.
    samples: [u32; BLOCK],
    inverse: [f32; BLOCK],
    /// Fixed-point depth of one sample.
    depth: [u32; BLOCK],
    /// Whether a point is finite and near the window.
    valid: [bool; BLOCK],
    /// Whether a lane starts no segment, because its strand or the block ends there.
    ends: [bool; BLOCK],
}

impl Block {
    const EMPTY: Self = Self {
        from: [[0.0; BLOCK]; 3],
        step: [[0.0; BLOCK]; 3],
        samples: [0; BLOCK],
        inverse: [1.0; BLOCK],
        depth: [0; BLOCK],
        valid: [false; BLOCK],
        ends: [true; BLOCK],
    };

    /// Marks the lanes of points `at..` that end a strand. Advances `strand` to the strand of the next block's first point,
    /// which is the last point of this block.
    #[inline(always)]
    fn mark_ends(&mut self, first_point: &[u32], strand: &mut usize, at: usize) {
        self.ends = [false; BLOCK];
        self.ends[BLOCK - 1] = true;
        while let Some(&after) = first_point.get(*strand + 1) {
            let after = after as usize;
            if after > at + BLOCK {
                return;
            }
            if after > at {
                self.ends[after - 1 - at] = true;
            }
            if after == at + BLOCK {
                return;
            }
            *strand += 1;
        }
    }
}

impl Deposit {
    /// Adds strands `first..last` to `grid`. Returns the number of samples.
    #[inline(always)]
    fn run(&self, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
        if first == last {
            return 0;
        }
        let (mut at, end) = (strands.first_point[first] as usize, strands.first_point[last] as usize);
        let axes = [&strands.x[..end], &strands.y[..end], &strands.z[..end]];
        let mut block = Block::EMPTY;
        let mut padded = [[f32::NAN; BLOCK]; 3];
        let mut strand = first;
        let mut samples = 0;
        while at < end {
            block.mark_ends(&strands.first_point, &mut strand, at);
            if let [Some(x), Some(y), Some(z)] = axes.map(|axis| axis[at..].first_chunk()) {
                self.fill(&mut block, [x, y, z]);
            } else {
                for (lanes, axis) in padded.iter_mut().zip(axes) {
                    lanes[..end - at].copy_from_slice(&axis[at..]);
                    lanes[end - at..].fill(f32::NAN);
                }
                self.fill(&mut block, [&padded[0], &padded[1], &padded[2]]);
            }
            // A sum that is checked for overflow is not compiled to vectors.
            samples += block.samples.iter().fold(0, |sum: u64, n| sum.wrapping_add(u64::from(*n)));
            self.scatter(&block, grid);
            // The last point is the first of the next block.
            at += BLOCK - 1;
        }
        samples
    }

    #[inline(always)]
    fn fill(&self, block: &mut Block, points: [&[f32; BLOCK]; 3]) {
        self.transform(block, points);
        if self.by_point {
            self.fill_points(block);
        } else {
            self.fill_segments(block);
        }
    }

    /// Window coordinates, and whether a point is finite and within the range of the window.
    #[inline(always)]
    fn transform(&self, block: &mut Block, points: [&[f32; BLOCK]; 3]) {
        let (lattice, anchor) = (&self.lattice, self.lattice.anchor);
        let first = lattice.first.as_vec3().to_array();
        let limit = 2.0 * lattice.resolution as f32;
        let highest = highest_inside(lattice.resolution);
        block.valid = [true; BLOCK];
        for axis in 0..3 {
            let to = lattice.axes_per_cell[axis];
            for lane in 0..BLOCK {
                let (x, y, z) =
                    (points[0][lane] - anchor.x, points[1][lane] - anchor.y, points[2][lane] - anchor.z);
                let c = (x * to.x + y * to.y + z * to.z) - first[axis];
                block.valid[lane] &= c.abs() <= limit;
                // Rounding must not move hair into the empty cells at the border. NaN becomes 1.
                let c = if c > 1.0 { c } else { 1.0 };
                block.from[axis][lane] = if c < highest { c } else { highest };
            }
        }
    }

    #[inline(always)]
    fn fill_segments(&self, block: &mut Block) {
        let mut keep = [0.0; BLOCK];
        for lane in 0..BLOCK - 1 {
            keep[lane] =
                if block.valid[lane] & block.valid[lane + 1] & !block.ends[lane] { 1.0 } else { 0.0 };
        }
        for (step, from) in block.step.iter_mut().zip(&block.from) {
            for lane in 0..BLOCK - 1 {
                step[lane] = (from[lane + 1] - from[lane]) * keep[lane];
            }
        }
        for lane in 0..BLOCK {
            let [x, y, z] = [block.step[0][lane], block.step[1][lane], block.step[2][lane]];
            let across = y * y + z * z;
            let count = sample_count((x * x + across).sqrt()) as i32 as f32;
            let inverse = 1.0 / count;
            // ℓ sinθ in cells is the length across the light.
            let counted = self.squares[0] * (x * x) + self.squares[1] * across;
            let depth = self.depth * counted.sqrt() * inverse + 0.5;
            let depth = if depth < MAX_PER_SAMPLE { depth } else { MAX_PER_SAMPLE };
            block.inverse[lane] = inverse;
            block.samples[lane] = whole_part(count * keep[lane]) as u32;
            block.depth[lane] = whole_part(depth * keep[lane]) as u32;
        }
    }

    #[inline(always)]
    fn fill_points(&self, block: &mut Block) {
        let depth = whole_part((self.depth + 0.5).min(MAX_PER_SAMPLE)) as u32;
        for lane in 0..BLOCK - 1 {
            block.samples[lane] = u32::from(block.valid[lane]);
            block.depth[lane] = if block.valid[lane] { depth } else { 0 };
        }
    }

    /// Adds all samples of a block.
    #[inline(always)]
    fn scatter(&self, block: &Block, grid: &mut Grid) {
        let shift = self.layout.group_len_shift();
        for start in (0..BLOCK).step_by(LANES) {
            let samples: &[u32; LANES] = block.samples[start..start + LANES].try_into().expect("16 lanes");
            let mut most = 0;
            for count in samples {
                most = most.max(*count);
            }
            if most > LONG && samples.iter().sum::<u32>() < most * 8 {
                self.scatter_one_by_one(block, start, grid);
                continue;
            }
            for sample in 0..most {
                let (addresses, depths) = self.addresses(block, start, sample);
                let (cells, marks) = (&mut grid.cells[..], &mut grid.marks[..]);
                for (address, depth) in addresses.iter().zip(&depths) {
                    add_to(cells, marks, shift, *address, *depth);
                }
            }
        }
    }

    /// Addresses and depths of sample `sample` of the lanes from `start` on. A lane with fewer samples adds 0 to the cell at
    /// its end.
    #[inline(always)]
    fn addresses(&self, block: &Block, start: usize, sample: u32) -> ([u32; LANES], [u32; LANES]) {
        let mut addresses = [0; LANES];
        let mut depths = [0; LANES];
        for lane in 0..LANES {
            let at = start + lane;
            let t = sample_at(sample, block.inverse[at]);
            let t = if t < 1.0 { t } else { 1.0 };
            let cell = |axis: usize| whole_part(block.from[axis][at] + block.step[axis][at] * t) as u32;
            addresses[lane] = self.layout.address(cell(0), cell(1), cell(2));
            depths[lane] = if sample < block.samples[at] { block.depth[at] } else { 0 };
        }
        (addresses, depths)
    }

    #[cold]
    fn scatter_one_by_one(&self, block: &Block, start: usize, grid: &mut Grid) {
        for lane in start..start + LANES {
            for sample in 0..block.samples[lane] {
                let t = sample_at(sample, block.inverse[lane]);
                let cell =
                    |axis: usize| whole_part(block.from[axis][lane] + block.step[axis][lane] * t) as u32;
                self.add(grid, self.layout.address(cell(0), cell(1), cell(2)), block.depth[lane]);
            }
        }
    }

    #[inline(always)]
    pub(super) fn add(&self, grid: &mut Grid, address: u32, depth: u32) {
        add_to(&mut grid.cells, &mut grid.marks, self.layout.group_len_shift(), address, depth);
    }
}

/// Adds depth to a cell and marks its group. `shift` is [`Layout::group_len_shift`].
#[inline(always)]
fn add_to(cells: &mut [u32], marks: &mut [u8], shift: u32, address: u32, depth: u32) {
    let cell = &mut cells[address as usize];
    // Saturating sums of non-negative numbers do not depend on their order either.
    *cell = cell.saturating_add(depth);
    marks[address.wrapping_shr(shift) as usize] = 1;
}

/// The largest coordinate whose cell leaves one empty cell at the end of the window.
pub(super) fn highest_inside(resolution: u32) -> f32 {
    (resolution - 1) as f32 * (1.0 - f32::EPSILON)
}
