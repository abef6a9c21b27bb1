//! The density grid: how much hair is where, so that hair keeps hair away and moves with it.
//!
//! Bertails, Ménier and Cani (2005, section 4.1) read over-dense cells from the shadow map. This grid is of
//! its own and turns with the head, so that no light changes the motion, and so that hair at rest lies still
//! in its cells. Sums are in integers: the order of the guides does not matter.

mod cell;
mod direction;
mod pieces;
mod sample;

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{IVec3, Vec3};

use cell::{Cell, Cells, Tally};
use lovelock_groom::simd::Width;
use pieces::{Source, add_block};
use rayon::prelude::*;
pub(crate) use sample::GridStep;

use crate::block::Block;
use crate::lanes::{Map, at};
use crate::settings::Repulsion;

/// Cells along each axis.
const SIDE: i32 = 48;

/// Smallest cell, metres, and the largest for hair to swing in, as long as hair at rest is inside.
const CELL: (f32, f32) = (0.012, 0.02);

/// A point stands for its neighbours along so many cells at most, a little more than two so that these are not rounded
/// down, and so many links.
const RUN: f32 = 2.1;
const MOST_LINKS: usize = 8;

/// So much further than hair at rest reaches from its middle the grid goes at least.
const ROOM: f32 = 1.1;

/// Fixed point: the whole hairstyle in one cell stays below this.
const FULL: f32 = (1 << 29) as f32;

/// Momentum is stored in units coarser than mass by this factor, so that 20 m/s still fits.
const MOMENTUM: f32 = 1.0 / 32.0;

/// Speeds above this count as this, metres per second.
const FASTEST: f32 = 20.0;

/// A push may not carry hair further than this part of a cell in one substep.
const MOST_OF_A_CELL: f32 = 0.25;

/// Tasks that put hair into the grid side by side, at most: each has cells of its own, 7 MB of them.
const TASKS: usize = 4;

/// Where the cells are, and what of a guide they get.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    min: Vec3,
    cell: f32,
    /// Every `stride`-th point of a guide stands for its neighbours.
    stride: usize,
    /// Fixed-point units of one metre of a guide.
    units: f32,
}

/// Hair density and momentum on a lattice in head space.
#[derive(Clone, Debug)]
pub(crate) struct DensityGrid {
    lattice: Lattice,
    /// What lies in each cell; no directions where nothing heeds them. The first has it all, the others what the other
    /// tasks have put in.
    parts: Vec<Cells>,
    rest_volume: f32,
    /// Mass of a cell as dense as hair at rest typically finds the hair around itself.
    full: f32,
    /// What was counted after the last deposit.
    tally: Tally,
    repulsion: Repulsion,
}

impl DensityGrid {
    /// A grid around the guides of `blocks` at rest.
    pub(crate) fn new(blocks: &[Block]) -> Self {
        let (mut centre, mut count, mut total, mut links) = (Vec3::ZERO, 0.0_f32, 0.0_f32, 0.0_f32);
        let mut longest = 0.0_f32;
        // A guide that is not a number says nothing about the others.
        let sound =
            |b: &Block, k: usize| b.rest.mean_link[k].is_finite() && at(&b.rest.position[0], k).is_finite();
        let lanes =
            || blocks.iter().flat_map(|b| (0..b.used).map(move |k| (b, k))).filter(|&(b, k)| sound(b, k));
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
        let reach = lanes()
            .flat_map(|(b, k)| {
                b.rest.position.iter().map(move |row| (at(row, k) - centre).abs().max_element())
            })
            .filter(|reach| reach.is_finite())
            .fold(0.0, f32::max);
        let swing = (2.0 * (radius + longest) / SIDE as f32).clamp(CELL.0, CELL.1);
        // Two cells at the rim have no neighbours to be between.
        let cell = swing.max(2.0 * ROOM * reach / (SIDE - 2) as f32);
        let link = (links / count.max(1.0)).max(1e-4);
        let points = blocks.first().map_or(0, Block::points);
        let lattice = Lattice {
            min: centre - Vec3::splat(0.5 * cell * SIDE as f32),
            cell,
            stride: ((RUN * cell / link) as usize).min(MOST_LINKS).clamp(1, (points / 2).max(1)),
            units: FULL / total.max(1e-3),
        };
        let mut grid = Self {
            lattice,
            parts: vec![Cells::new()],
            rest_volume: 0.0,
            full: FULL,
            tally: Tally::default(),
            repulsion: Repulsion::default(),
        };
        grid.fill(blocks, &Source::Rest);
        grid.learn_rest();
        // Counted anew, now that it is known what a full cell is.
        grid.fill(blocks, &Source::Rest);
        grid.rest_volume = grid.volume();
        grid
    }

    /// Takes the density that is in the grid for the one at rest.
    fn learn_rest(&mut self) {
        // The density that a piece of hair typically finds around itself stands in where none is at rest.
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for c in self.cells() {
            let mass = f64::from(c.mass());
            sum += mass;
            squares += mass * mass;
        }
        let typical = if sum > 0.0 { (squares / sum) as f32 } else { FULL };
        self.full = typical;
        for c in &mut self.parts[0].each {
            c.set_inv_rest(1.0 / (c.mass() as f32).max(typical));
        }
    }

    /// Deposits all blocks anew, with positions in head space by `head_from_last` and velocities as they are.
    /// Gives the number of over-dense cells.
    pub(crate) fn update(&mut self, blocks: &[Block], head_from_last: &Map, repulsion: Repulsion) -> u32 {
        self.repulsion = repulsion;
        self.fill(blocks, &Source::Now { head_from_last, directed: repulsion.anisotropy > 0.0 });
        self.tally.over_dense
    }

    /// The volume that the hair in the grid fills, cubic metres:
    /// `V = sum(min(m / m_full, 1))` cells.
    ///
    /// `m_full = sum m^2 / sum m` at rest is the mass of a cell that is as dense as hair at rest, on the average over the
    /// hair, finds the hair around itself. A cell that is fuller counts once, one that is emptier by its fullness. So
    /// hair that is pressed together loses volume, and hair that flies apart gains none beyond what it would have if it
    /// were nowhere denser than that. The sum is of integers: the order does not matter.
    pub(crate) fn volume(&self) -> f32 {
        (self.tally.fullness as f64 / f64::from(self.most()) * f64::from(self.lattice.cell).powi(3)) as f32
    }

    /// The volume that the hair fills at rest, cubic metres.
    pub(crate) fn volume_at_rest(&self) -> f32 {
        self.rest_volume
    }

    /// The mass at which a cell is full.
    fn most(&self) -> i32 {
        self.full.clamp(1.0, 2e9) as i32
    }

    /// Whether hair learns anything from the grid.
    fn acts(&self) -> bool {
        (self.repulsion.strength > 0.0 || self.repulsion.cohesion > 0.0) && self.tally.held > 0
    }

    /// What lies in each cell.
    fn cells(&self) -> &[Cell] {
        &self.parts[0].each
    }

    /// Empties the grid, puts all hair into it, and counts.
    fn fill(&mut self, blocks: &[Block], source: &Source) {
        let tasks = rayon::current_num_threads().min(TASKS).min(blocks.len()).max(1);
        self.parts.resize_with(tasks, Cells::new);
        let (lattice, width, next) = (self.lattice, Width::widest(), AtomicUsize::new(0));
        self.parts.par_iter_mut().for_each(|cells| {
            cells.begin();
            // Who adds a block does not matter.
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                add_block(width, &lattice, source, block, cells);
            }
        });
        let (most, inv_threshold) = (self.most(), 1.0 / self.repulsion.threshold);
        let Some((all, others)) = self.parts.split_first_mut() else { return };
        self.tally = all.gather(others, most, inv_threshold);
    }
}

/// Where the eight cells of a corner are from the first, x fastest.
const OFFSETS: [usize; 8] = {
    let (y, z) = (SIDE as usize, (SIDE * SIDE) as usize);
    [0, 1, y, y + 1, z, z + 1, z + y, z + y + 1]
};

fn index(cell: IVec3) -> usize {
    ((cell.z * SIDE + cell.y) * SIDE + cell.x) as usize
}

#[cfg(test)]
mod tests;
