//! The density grid: how much hair is where, so that hair keeps hair away and moves with it.
//!
//! Bertails, Ménier and Cani (2005, section 4.1) read over-dense cells from the shadow map. This grid is of
//! its own and turns with the head, so that no light changes the motion, and so that hair at rest lies still
//! in its cells. Sums are in integers: the order of the guides does not matter.

mod direction;
mod pieces;
mod volume;

use glam::{IVec3, Mat3, Vec3};

use direction::{crossing, drawn_to, push_across};
use lovelock_groom::simd::Width;
use pieces::{CHUNK, Cell, Piece, Pieces, add_all};
use rayon::prelude::*;

use crate::block::Block;
use crate::lanes::{LANES, Lane, Lane3, ZERO3, at, put};
use crate::settings::{Repulsion, RepulsionMode};
use crate::solver::Plan;
use crate::trilinear::{gradient, weights};

/// Cells along each axis.
const SIDE: i32 = 48;

/// Smallest and largest cell, metres.
const CELL: (f32, f32) = (0.012, 0.02);

/// Fixed point: the whole hairstyle in one cell stays below this.
const FULL: f32 = (1 << 29) as f32;

/// Momentum is stored in units coarser than mass by this factor, so that 20 m/s still fits.
const MOMENTUM: f32 = 1.0 / 32.0;

/// Speeds above this count as this, metres per second.
const FASTEST: f32 = 20.0;

/// A push may not carry hair further than this part of a cell in one substep.
const MOST_OF_A_CELL: f32 = 0.25;

/// What one point learns from the grid, in head space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// Away from over-dense places, 1/m: to be multiplied by the strength.
    pub(crate) push: Vec3,
    /// Mean velocity of the hair around, metres per second, in the axes that were deposited.
    pub(crate) mean_velocity: Vec3,
    /// How much of the hair around crosses the direction that was asked for; 0 where that is heeded by nothing.
    pub(crate) crossing: f32,
}

/// Hair density and momentum on a lattice in head space.
#[derive(Clone, Debug)]
pub(crate) struct DensityGrid {
    min: Vec3,
    cell: f32,
    /// Every `stride`-th point of a guide stands for its neighbours.
    stride: usize,
    /// Fixed-point units of one metre of a guide.
    units: f32,
    /// What lies in each cell; no directions where nothing heeds them.
    cells: Vec<Cell>,
    /// Working memory of the deposit, one of each block.
    pieces: Vec<Pieces>,
    /// One over the density at rest, where there is some, and over a typical one elsewhere.
    inv_rest: Vec<f32>,
    rest_volume: f32,
    /// Mass of a cell as dense as hair at rest typically finds the hair around itself.
    full: f32,
    /// The box of cells that hold hair, inclusive; empty where `low > high`.
    low: IVec3,
    high: IVec3,
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
        let cell = (2.0 * (radius + longest) / SIDE as f32).clamp(CELL.0, CELL.1);
        let link = (links / count.max(1.0)).max(1e-4);
        let size = (SIDE * SIDE * SIDE) as usize;
        let mut grid = Self {
            min: centre - Vec3::splat(0.5 * cell * SIDE as f32),
            cell,
            stride: ((1.4 * cell / link) as usize).clamp(1, 8),
            units: FULL / total.max(1e-3),
            cells: vec![Cell::EMPTY; size],
            pieces: Vec::new(),
            inv_rest: vec![0.0; size],
            rest_volume: 0.0,
            full: FULL,
            low: IVec3::MAX,
            high: IVec3::MIN,
            repulsion: Repulsion::default(),
        };
        grid.fill(blocks, |block, i, k| (at(&block.rest.position[i], k), Vec3::ZERO, Vec3::ZERO));
        grid.learn_rest();
        grid.rest_volume = grid.volume();
        grid
    }

    /// Takes the density that is in the grid for the one at rest.
    fn learn_rest(&mut self) {
        // The density that a piece of hair typically finds around itself stands in where none is at rest.
        let (mut sum, mut squares) = (0.0_f64, 0.0_f64);
        for c in &self.cells {
            let mass = f64::from(c.mass());
            sum += mass;
            squares += mass * mass;
        }
        let typical = if sum > 0.0 { (squares / sum) as f32 } else { FULL };
        self.full = typical;
        for (inv, c) in self.inv_rest.iter_mut().zip(&self.cells) {
            *inv = 1.0 / (c.mass() as f32).max(typical);
        }
    }

    /// Deposits all blocks anew, with positions in head space by `head_from_last` and velocities as they are.
    /// Gives the number of over-dense cells.
    pub(crate) fn update(
        &mut self,
        blocks: &[Block],
        head_from_last: &crate::lanes::Map,
        repulsion: Repulsion,
    ) -> u32 {
        self.repulsion = repulsion;
        let directed = repulsion.anisotropy > 0.0;
        self.fill(blocks, |block, i, k| {
            let (p, t) =
                (at(&block.position[i], k), if directed { tangent(block, i, k) } else { Vec3::ZERO });
            (head_from_last.apply(p), at(&block.velocity[i], k), head_from_last.rotate(t))
        });
        self.over_dense()
    }

    /// The volume that the hair in the grid fills, cubic metres; see [`volume::volume`].
    pub(crate) fn volume(&self) -> f32 {
        volume::volume(
            self.held_rows().flat_map(|row| &self.cells[row]).map(Cell::mass),
            self.full,
            self.cell,
        )
    }

    /// The volume that the hair fills at rest, cubic metres.
    pub(crate) fn volume_at_rest(&self) -> f32 {
        self.rest_volume
    }

    /// Whether hair learns anything from the grid.
    fn acts(&self) -> bool {
        (self.repulsion.strength > 0.0 || self.repulsion.cohesion > 0.0) && self.low.cmple(self.high).all()
    }

    /// The runs of cells that may hold hair.
    fn held_rows(&self) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> + use<> {
        let (low, high) = (self.low, self.high);
        (low.z..=high.z).flat_map(move |z| {
            (low.y..=high.y).map(move |y| {
                let row = index(IVec3::new(low.x, y, z));
                row..=row + (high.x - low.x) as usize
            })
        })
    }

    fn clear(&mut self) {
        for row in self.held_rows() {
            self.cells[row].fill(Cell::EMPTY);
        }
        (self.low, self.high) = (IVec3::MAX, IVec3::MIN);
    }

    fn over_dense(&self) -> u32 {
        let inv_threshold = 1.0 / self.repulsion.threshold;
        let over = |i: &usize| self.cells[*i].mass() as f32 * self.inv_rest[*i] * inv_threshold > 1.0;
        self.held_rows().flatten().filter(over).count() as u32
    }

    fn fill(&mut self, blocks: &[Block], state: impl Fn(&Block, usize, usize) -> (Vec3, Vec3, Vec3) + Sync) {
        self.clear();
        let mut pieces = std::mem::take(&mut self.pieces);
        pieces.resize_with(blocks.len(), Pieces::default);
        let grid = &*self;
        pieces.par_iter_mut().zip(blocks).for_each(|(pieces, block)| {
            pieces.clear();
            // The middle of each run of points, so that the whole chain is covered evenly.
            for i in (1 + (grid.stride - 1) / 2..block.points()).step_by(grid.stride) {
                for k in 0..block.used {
                    // Beyond the end of a guide that was cut there is no hair.
                    if block.rest.inv_length[i][k] > 0.0 {
                        let (p, v, t) = state(block, i, k);
                        grid.place(p, v, t, block.rest.mean_link[k] * grid.stride as f32, pieces);
                    }
                }
            }
        });
        for block in &pieces {
            self.low = self.low.min(block.low);
            self.high = self.high.max(block.high);
        }
        let width = Width::widest();
        self.cells
            .par_chunks_mut(CHUNK)
            .enumerate()
            .for_each(|(chunk, cells)| add_all(width, &pieces, chunk, cells));
        self.pieces = pieces;
    }

    /// The corner of the eight cells around `p`, and the fractions in between; `None` outside the grid.
    #[inline]
    fn around(&self, p: Vec3) -> Option<(IVec3, Vec3)> {
        let q = (p - self.min) / self.cell - 0.5;
        // Written so that what is not a number is outside.
        let inside = q.min_element() >= 0.0 && q.max_element() < (SIDE - 1) as f32 && q.is_finite();
        if !inside {
            return None;
        }
        let corner = q.as_ivec3();
        Some((corner, q - corner.as_vec3()))
    }

    /// Puts a piece of hair at `p` on its way into the grid.
    #[inline]
    fn place(&self, p: Vec3, v: Vec3, t: Vec3, length: f32, out: &mut Pieces) {
        let Some((corner, fraction)) = self.around(p) else { return };
        let velocity = v.clamp(Vec3::splat(-FASTEST), Vec3::splat(FASTEST)) * MOMENTUM;
        if velocity.is_finite() && t.is_finite() {
            out.push(corner, Piece::new(corner, fraction, length * self.units, velocity, t));
        }
    }

    /// What hair at `p` that runs along `t`, both in head space, learns from the grid; `None` where there is none
    /// around.
    #[inline]
    pub(crate) fn sample(&self, p: Vec3, t: Vec3) -> Option<Sample> {
        let (corner, f) = self.around(p)?;
        let base = index(corner);
        let inv_threshold = 1.0 / self.repulsion.threshold;
        let mut sums = [0.0_f32; 4];
        let mut excess = [0.0_f32; 8];
        let mut crowded = false;
        for (n, (offset, weight)) in OFFSETS.iter().zip(weights(f)).enumerate() {
            let cell = &self.cells[base + offset];
            for (sum, value) in sums.iter_mut().zip(cell.motion()) {
                *sum += weight * value as f32;
            }
            let over = cell.mass() as f32 * self.inv_rest[base + offset] * inv_threshold - 1.0;
            excess[n] = over.max(0.0);
            crowded |= over > 0.0;
        }
        if sums[0] < 1.0 {
            return None;
        }
        let mean_velocity = Vec3::new(sums[1], sums[2], sums[3]) / (sums[0] * MOMENTUM);
        let mut across = 0.0;
        if crowded && self.repulsion.anisotropy > 0.0 {
            let mut directions = [0.0_f32; 6];
            for (offset, weight) in OFFSETS.iter().zip(weights(f)) {
                for (sum, value) in directions.iter_mut().zip(self.cells[base + offset].directions()) {
                    *sum += weight * value as f32;
                }
            }
            across = crossing(&directions, sums[0], t);
        }
        let push = match self.repulsion.mode {
            _ if !crowded => Vec3::ZERO,
            RepulsionMode::Pressure => -gradient(&excess, f) / self.cell,
            RepulsionMode::Centre => self.away_from_centre(p),
        };
        Some(Sample { push, mean_velocity, crossing: across })
    }

    /// The published force: away from the centre of the cell that `p` is in, where that cell is over-dense;
    /// faded at the centre, where it would be singular, and at the faces, where it would jump.
    fn away_from_centre(&self, p: Vec3) -> Vec3 {
        let cell = ((p - self.min) / self.cell).as_ivec3().clamp(IVec3::ZERO, IVec3::splat(SIDE - 1));
        let i = index(cell);
        let excess = self.cells[i].mass() as f32 * self.inv_rest[i] / self.repulsion.threshold - 1.0;
        let out = p - (self.min + (cell.as_vec3() + 0.5) * self.cell);
        let fade = (1.0 - 2.0 * out.abs().max_element() / self.cell).max(0.0);
        out * (excess.max(0.0) * fade / (out.length().max(0.1 * self.cell) * self.cell))
    }

    /// Adds the grid's part to the forces of a block, whose positions are still those of the last step.
    pub(crate) fn act(&self, block: &mut Block, plan: &Plan, cohesion: f32) {
        for keep in &mut block.keep {
            *keep = Lane::splat(1.0);
        }
        if !self.acts() {
            return;
        }
        let count = block.points();
        let mut from = 0;
        let mut row = self.sample_row(block, plan, 0);
        while from + 1 < count {
            let to = (from + self.stride).min(count - 1);
            let next = self.sample_row(block, plan, to);
            for i in from..if to + 1 == count { count } else { to } {
                let t = (i - from) as f32 / (to - from) as f32;
                let (mut push, mut keep) = (block.push[i], block.keep[i]);
                for k in 0..LANES {
                    let dv = at(&row.dv, k).lerp(at(&next.dv, k), t);
                    let mean = at(&row.mean, k).lerp(at(&next.mean, k), t);
                    let relaxed = (at(&push, k) + dv) * (1.0 - cohesion) + mean * cohesion;
                    put(&mut push, k, relaxed);
                    keep[k] = 1.0 - cohesion;
                }
                block.push[i] = push;
                block.keep[i] = keep;
            }
            (row, from) = (next, to);
        }
    }

    fn sample_row(&self, block: &Block, plan: &Plan, i: usize) -> SampleRow {
        let mut out = SampleRow { dv: ZERO3, mean: block.velocity[i] };
        let most = MOST_OF_A_CELL * self.cell / plan.h;
        let turn: Mat3 = plan.last_head.turn;
        // The published force knows no directions.
        let anisotropy = match self.repulsion.mode {
            RepulsionMode::Pressure => self.repulsion.anisotropy,
            RepulsionMode::Centre => 0.0,
        };
        for k in 0..LANES {
            let t = tangent(block, i, k);
            let p = plan.head_from_last.apply(at(&block.position[i], k));
            if let Some(sample) = self.sample(p, plan.head_from_last.rotate(t)) {
                let push = push_across(turn * sample.push, t, sample.crossing, anisotropy);
                let dv = push * (self.repulsion.strength * plan.h);
                put(&mut out.dv, k, dv.clamp_length_max(most));
                let mean = drawn_to(sample.mean_velocity, at(&block.velocity[i], k), t, anisotropy);
                put(&mut out.mean, k, mean);
            }
        }
        out
    }
}

/// What a row of points learns from the grid: the change of velocity a substep, and the neighbours' mean.
struct SampleRow {
    dv: Lane3,
    mean: Lane3,
}

/// Unit direction of the hair at a point; 0 where it has none.
#[inline]
fn tangent(block: &Block, i: usize, k: usize) -> Vec3 {
    let (a, b) = (i.saturating_sub(1), (i + 1).min(block.points() - 1));
    (at(&block.position[b], k) - at(&block.position[a], k)).normalize_or_zero()
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
