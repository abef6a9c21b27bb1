//! The density grid: how much hair is where. It lets hair repel hair and move along with it.
//!
//! Bertails, Ménier and Cani (2005, section 4.1) read over-dense cells from the shadow map. This grid is
//! separate and turns with the head, so that lights do not change the motion and hair at rest does not move
//! through its cells. Sums are integers, so the order of the guides does not matter.
//!
//! The published force counts hair as published, in the one cell that contains it; the pressure needs a
//! density that changes smoothly ([`Counting`]).

mod cell;
mod direction;
mod pieces;
mod sample;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{IVec3, Vec3};

use cell::{Cell, Cells, Counts};
use lovelock_base::simd::Width;
use pieces::{Source, add_block};
use rayon::prelude::*;
pub(crate) use sample::GridStep;

use crate::block::Block;
use crate::lanes::{Map, at};
use crate::settings::{Repulsion, RepulsionMode};

/// Cells along each axis: the grid is higher than wide, because hair hangs.
pub(crate) const SIDES: IVec3 = IVec3::new(44, 60, 42);

/// The cell size is chosen such that hair that swings to all sides spans this many cells.
const SWING_CELLS: f32 = 48.0;

/// Smallest cell size, and the largest that is chosen for the swing of the hair as long as the hair at rest
/// fits, metres.
const CELL: (f32, f32) = (0.012, 0.02);

/// A deposited point represents at most this many cells along its guide (slightly more than two, so that two
/// are not rounded down) and at most this many links.
const MAX_CELLS: f32 = 2.1;
const MAX_LINKS: usize = 8;

/// Smallest size of the grid relative to the extent of the hair at rest.
const EXTENT: f32 = 1.1;

/// Fixed point: the whole hairstyle in one cell stays below this.
const FULL: f32 = (1 << 29) as f32;

/// Momentum is stored in units coarser than mass by this factor, so that 20 m/s still fits.
const MOMENTUM: f32 = 1.0 / 32.0;

/// Speeds are clamped to this, metres per second.
const FASTEST: f32 = 20.0;

/// Largest displacement by repulsion per substep, as a fraction of a cell.
const MAX_SHARE_OF_A_CELL: f32 = 0.25;

/// Largest number of tasks that deposit hair in parallel; each has its own cells, 7 MB.
const TASKS: usize = 4;

/// The constants of the grid by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 10] = [
    ("FULL", FULL as f64),
    ("MOMENTUM", MOMENTUM as f64),
    ("FASTEST_HAIR", FASTEST as f64),
    ("MAX_SHARE_OF_A_CELL", MAX_SHARE_OF_A_CELL as f64),
    ("NEAR_CENTRE", sample::NEAR_CENTRE as f64),
    ("LOST_ALONG", direction::LOST_ALONG as f64),
    ("UNIT", pieces::UNIT as f64),
    ("CELLS_X", SIDES.x as f64),
    ("CELLS_Y", SIDES.y as f64),
    ("CELLS_Z", SIDES.z as f64),
];

/// Placement of the cells, and how guides are deposited.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    min: Vec3,
    cell: f32,
    /// Every `stride`-th point of a guide represents its neighbours.
    stride: usize,
    /// Fixed-point units per metre of a guide.
    units: f32,
}

/// How a piece of hair is counted in the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Counting {
    /// Shared among the eight cells around it, trilinearly.
    Shared,
    /// As published: in the cell that contains it.
    Nearest,
}

impl Counting {
    /// The counting that the force needs.
    fn of(mode: RepulsionMode) -> Self {
        match mode {
            RepulsionMode::Pressure => Self::Shared,
            RepulsionMode::Centre => Self::Nearest,
        }
    }
}

/// The hair at rest by one way of counting.
#[derive(Clone, Copy, Debug)]
struct RestHair {
    /// The volume that it fills, cubic metres.
    volume: f32,
    /// Mass of a cell as dense as a piece of hair at rest typically finds its surroundings.
    full: f32,
}

/// Hair density and momentum on a lattice in head space.
#[derive(Clone, Debug)]
pub(crate) struct DensityGrid {
    lattice: Lattice,
    /// The contents of the cells, one set per task; the first set receives the sum. Directions are left out
    /// if nothing uses them.
    parts: Vec<Cells>,
    /// The hair at rest, by each [`Counting`].
    rest: [RestHair; 2],
    /// How the last deposit was counted.
    counting: Counting,
    /// Counts after the last deposit.
    counts: Counts,
    repulsion: Repulsion,
}

impl DensityGrid {
    /// A grid around the guides of `blocks` at rest.
    pub(crate) fn new(blocks: &[Block]) -> Self {
        let (mut centre, mut count, mut total, mut links) = (Vec3::ZERO, 0.0_f32, 0.0_f32, 0.0_f32);
        let mut longest = 0.0_f32;
        // Non-finite guides do not affect the others.
        let is_finite =
            |b: &Block, k: usize| b.rest.mean_link[k].is_finite() && at(&b.rest.position[0], k).is_finite();
        let lanes =
            || blocks.iter().flat_map(|b| (0..b.used).map(move |k| (b, k))).filter(|&(b, k)| is_finite(b, k));
        for (block, k) in lanes() {
            centre += at(&block.rest.position[0], k);
            count += 1.0;
            let length = block.rest.mean_link[k] * (block.points() - 1) as f32;
            total += length;
            links += block.rest.mean_link[k];
            longest = longest.max(length);
        }
        centre /= count.max(1.0);
        let radius = lanes().map(|(b, k)| (at(&b.rest.position[0], k) - centre).length()).fold(0.0, f32::max);
        let (mut low, mut high) = (Vec3::ZERO, Vec3::ZERO);
        for row in lanes().flat_map(|(b, k)| b.rest.position.iter().map(move |row| at(row, k) - centre)) {
            if row.is_finite() {
                (low, high) = (low.min(row), high.max(row));
            }
        }
        let swing = (2.0 * (radius + longest) / SWING_CELLS).clamp(CELL.0, CELL.1);
        // The outermost cells have no neighbours to interpolate with.
        let cells = (SIDES - 2).as_vec3();
        let aside = 2.0 * high.max(-low);
        let fits = (EXTENT * Vec3::new(aside.x, high.y - low.y, aside.z) / cells).max_element();
        let cell = swing.max(fits);
        // The grid is centred on the roots, lower where the hair can swing below its lower end, and higher where hair stands up.
        let half = 0.5 * cell * SIDES.as_vec3();
        let spare = half.y - cell - high.y;
        let lower = (radius + longest - half.y).max(0.0).min(spare);
        let min = centre - half - Vec3::Y * lower;
        let link = (links / count.max(1.0)).max(1e-4);
        let points = blocks.first().map_or(0, Block::points);
        let lattice = Lattice {
            min,
            cell,
            stride: ((MAX_CELLS * cell / link) as usize).min(MAX_LINKS).clamp(1, (points / 2).max(1)),
            units: FULL / total.max(1e-3),
        };
        let mut grid = Self {
            lattice,
            parts: vec![Cells::new()],
            rest: [RestHair { volume: 0.0, full: FULL }; 2],
            counting: Counting::Shared,
            counts: Counts::default(),
            repulsion: Repulsion::default(),
        };
        for counting in [Counting::Nearest, Counting::Shared] {
            grid.counting = counting;
            grid.fill(blocks, &Source::Rest);
            grid.set_rest_density();
            // Counted again, because `full` is known now.
            grid.fill(blocks, &Source::Rest);
            grid.rest[counting as usize].volume = grid.volume();
        }
        grid
    }

    /// Takes the current density as the rest density by the current counting.
    fn set_rest_density(&mut self) {
        // Cells that are empty at rest use the density that a piece of hair typically finds around itself.
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for c in self.cells() {
            let mass = f64::from(c.mass());
            sum += mass;
            squares += mass * mass;
        }
        let typical = if sum > 0.0 { (squares / sum) as f32 } else { FULL };
        self.rest[self.counting as usize].full = typical;
        for c in &mut self.parts[0].each {
            c.set_inv_rest(self.counting, 1.0 / (c.mass() as f32).max(typical));
        }
    }

    /// Deposits all blocks, with positions mapped to head space by `head_from_last` and velocities unchanged.
    /// Returns the number of over-dense cells.
    pub(crate) fn update(&mut self, blocks: &[Block], head_from_last: &Map, repulsion: Repulsion) -> u32 {
        self.repulsion = repulsion;
        self.counting = Counting::of(repulsion.mode);
        self.fill(blocks, &Source::Now { head_from_last, directed: repulsion.anisotropy > 0.0 });
        self.counts.over_dense
    }

    /// The volume that the hair in the grid fills, cubic metres: `V = sum(min(m / m_full, 1))` cells.
    ///
    /// `m_full = sum m^2 / sum m` at rest is the density that a piece of hair finds around itself on average.
    /// A denser cell counts once, a sparser one by its relative density. Compressed hair thus loses volume,
    /// and hair that flies apart gains no more than it would have if it were nowhere denser than that. The
    /// sum is of integers, so the order does not matter.
    pub(crate) fn volume(&self) -> f32 {
        (self.counts.fullness as f64 / f64::from(self.full_mass()) * f64::from(self.lattice.cell).powi(3))
            as f32
    }

    /// The volume that the hair fills at rest, cubic metres.
    pub(crate) fn volume_at_rest(&self) -> f32 {
        self.rest[self.counting as usize].volume
    }

    /// The lowest corner, the cell size, the spacing of deposited points along a guide, and the units per metre.
    pub(crate) fn lattice_numbers(&self) -> (Vec3, f32, usize, f32) {
        let Lattice { min, cell, stride, units } = self.lattice;
        (min, cell, stride, units)
    }

    /// The mass of a full cell by the counting of `mode`.
    pub(crate) fn full_by(&self, mode: RepulsionMode) -> f32 {
        self.rest[Counting::of(mode) as usize].full
    }

    /// Writes the inverse rest density of each cell by the counting of `mode`.
    pub(crate) fn write_rest_density(&self, mode: RepulsionMode, out: &mut Vec<f32>) {
        out.clear();
        out.extend(self.cells().iter().map(|cell| cell.inv_rest(Counting::of(mode))));
    }

    /// The volume of hair whose cells sum up to `fullness` by the counting of `mode`, and that at rest, cubic metres.
    pub(crate) fn volumes(&self, mode: RepulsionMode, fullness: u32) -> (f32, f32) {
        let rest = self.rest[Counting::of(mode) as usize];
        let full = f64::from(rest.full.clamp(1.0, 2e9) as i32);
        let cell = f64::from(self.lattice.cell);
        ((f64::from(fullness) / full * cell.powi(3)) as f32, rest.volume)
    }

    /// Mass of a cell as dense as a piece of hair at rest typically finds its surroundings.
    fn full(&self) -> f32 {
        self.rest[self.counting as usize].full
    }

    /// The mass at which a cell is full.
    fn full_mass(&self) -> i32 {
        self.full().clamp(1.0, 2e9) as i32
    }

    /// Whether there is hair to affect.
    fn has_effect(&self) -> bool {
        self.counts.held > 0
    }

    /// The contents of the cells.
    fn cells(&self) -> &[Cell] {
        &self.parts[0].each
    }

    /// Clears the grid, deposits all hair and counts.
    fn fill(&mut self, blocks: &[Block], source: &Source) {
        let tasks = rayon::current_num_threads().min(TASKS).min(blocks.len()).max(1);
        self.parts.resize_with(tasks, Cells::new);
        let (lattice, counting) = (self.lattice, self.counting);
        let (width, next) = (Width::widest(), AtomicUsize::new(0));
        self.parts.par_iter_mut().for_each(|cells| {
            cells.begin();
            // It does not matter which task adds a block.
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                add_block(width, &lattice, counting, source, block, cells);
            }
        });
        let (most, inv_threshold) = (self.full_mass(), 1.0 / self.repulsion.threshold);
        let Some((all, others)) = self.parts.split_first_mut() else { return };
        self.counts = all.gather(others, counting, most, inv_threshold);
    }
}

/// Offsets of the eight cells around a point from the first, x fastest.
const OFFSETS: [usize; 8] = {
    let (y, z) = (SIDES.x as usize, (SIDES.x * SIDES.y) as usize);
    [0, 1, y, y + 1, z, z + 1, z + y, z + y + 1]
};

fn index(cell: IVec3) -> usize {
    ((cell.z * SIDES.y + cell.y) * SIDES.x + cell.x) as usize
}

#[cfg(test)]
mod tests;
