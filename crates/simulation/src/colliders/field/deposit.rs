//! Deposits the body into the cells of its [`Occupancy`](super::occupancy::Occupancy): probes near the skin
//! or inside are carried along with the joints, sixteen at a time, and spread to the cells around them.
// `unsafe` is used by the macro, which calls functions that require CPU features after checking for them.
#![allow(unsafe_code)]

use glam::{IVec3, Vec3};
use lovelock_base::simd::whole_part;
use lovelock_base::simd_versions;
use lovelock_motion::FieldWeights;

use super::cells::{CellGrid, NONE, UNCULLED_WIDTH, WIDEST};
use super::weightings::{Joints, Weightings};
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, fold, greater, put, row_barrier};

/// Probes, a row at a time: their rest positions, slots and weightings. Padding in the last row has slot 0,
/// which is the head's.
#[derive(Clone, Debug)]
pub(super) struct Probes {
    rest: Vec<Lane3>,
    slots: Vec<[u16; LANES]>,
    weightings: Weightings,
}

impl Probes {
    pub(super) fn new(probes: &[(Vec3, u16, FieldWeights)]) -> Self {
        let (mut all_rest, mut all_slots) = (Vec::new(), Vec::new());
        for row in probes.chunks(LANES) {
            let (mut rest, mut slots) = (ZERO3, [0; LANES]);
            for (k, &(place, slot, _)) in row.iter().enumerate() {
                put(&mut rest, k, place);
                slots[k] = slot;
            }
            all_rest.push(rest);
            all_slots.push(slots);
        }
        let weights: Vec<_> = probes.iter().map(|&(.., weights)| weights).collect();
        Self { rest: all_rest, slots: all_slots, weightings: Weightings::new(&weights) }
    }

    pub(super) fn rows(&self) -> usize {
        self.rest.len()
    }
}

/// An occupied cell, with the probe nearest to its centre.
#[derive(Clone, Copy, Debug)]
struct OccupiedCell {
    index: u32,
    at: IVec3,
    place: Vec3,
    squared: f32,
    slot: u16,
}

/// Index of a cell that is not occupied.
const FREE: u32 = u32::MAX;

/// The occupied cells at the start or at the end of a step.
#[derive(Clone, Debug)]
pub(super) struct StepEnd {
    occupied: Vec<OccupiedCell>,
    /// For each cell its index in `occupied`.
    own: Vec<u32>,
    /// Position of each probe; empty if unknown.
    pub(super) places: Vec<Lane3>,
}

impl StepEnd {
    pub(super) fn new(cells: usize) -> Self {
        Self { occupied: Vec::new(), own: vec![FREE; cells], places: Vec::new() }
    }

    pub(super) fn discard(&mut self) {
        self.places.clear();
    }
}

const _: () = assert!(
    2 * (WIDEST + UNCULLED_WIDTH) < LANES as i32,
    "the cells around one along x fit in a row of lanes"
);

/// The index of each lane.
const FROM_0: Lane = {
    let mut lane = ZERO;
    let mut k = 0;
    while k < LANES {
        lane.0[k] = k as f32;
        k += 1;
    }
    lane
};

simd_versions! {
    /// Moves the probes to where `joints` carry them.
    pub(super) fn place_probes(probes: &Probes, grid: &CellGrid, joints: &Joints, end: &mut StepEnd) -> () {
        place_all(probes, grid, joints, end)
    }
}

simd_versions! {
    /// The square of the longest path of a probe from the start to the end of the step.
    pub(super) fn longest_path_squared(ends: &[StepEnd; 2]) -> f32 {
        longest_path(ends)
    }
}

simd_versions! {
    /// Spreads the occupied cells of `ends` to the cells within `width`, keeping the nearest in each.
    pub(super) fn spread_all(
        grid: &CellGrid,
        ends: &[StepEnd],
        nearest: &mut [u32],
        touched: &mut (IVec3, IVec3),
        width: i32,
    ) -> () {
        spread(grid, ends, nearest, touched, width)
    }
}

#[inline(always)]
fn place_all(probes: &Probes, grid: &CellGrid, joints: &Joints, end: &mut StepEnd) {
    for cell in end.occupied.drain(..) {
        end.own[cell.index as usize] = FREE;
    }
    end.places.clear();
    let size = grid.size.as_vec3();
    for ((rest, slots), row) in probes.rest.iter().zip(&probes.slots).zip(probes.weightings.rows()) {
        let map = probes.weightings.mixed(row, joints);
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz, shift @ ..] = map;
        let to = |n: usize, x: Lane, y: Lane, z: Lane| {
            rest[0].times(x).plus(rest[1].times(y)).plus(rest[2].times(z)).plus(shift[n])
        };
        let place = [to(0, xx, yx, zx), to(1, xy, yy, zy), to(2, xz, yz, zz)];
        end.places.push(place);
        let (mut cells, mut squared, mut inside) = ([[0; LANES]; 3], ZERO, [false; LANES]);
        for k in 0..LANES {
            let q = (at(&place, k) - grid.low) * grid.inv_cell;
            // Written so that NaN is outside.
            inside[k] = (q.x >= 0.0)
                & (q.y >= 0.0)
                & (q.z >= 0.0)
                & (q.x < size.x)
                & (q.y < size.y)
                & (q.z < size.z)
                & (slots[k] != 0);
            let (x, y, z) = (whole_part(q.x), whole_part(q.y), whole_part(q.z));
            (cells[0][k], cells[1][k], cells[2][k]) = (x, y, z);
            let off = (Vec3::new(x as f32, y as f32, z as f32) + 0.5 - q) * grid.cell;
            squared[k] = off.length_squared();
        }
        for k in 0..LANES {
            if !inside[k] {
                continue;
            }
            let cell = IVec3::new(cells[0][k], cells[1][k], cells[2][k]);
            let index = grid.row(cell.y, cell.z) + cell.x as usize;
            let own = &mut end.own[index];
            let (squared, slot) = (squared[k], slots[k]);
            let found = OccupiedCell { index: index as u32, at: cell, place: at(&place, k), squared, slot };
            match end.occupied.get_mut(*own as usize) {
                Some(known) if squared < known.squared => *known = found,
                Some(_) => {}
                None => {
                    *own = end.occupied.len() as u32;
                    end.occupied.push(found);
                }
            }
        }
    }
}

#[inline(always)]
fn longest_path(ends: &[StepEnd; 2]) -> f32 {
    let mut most = ZERO;
    for (a, b) in ends[0].places.iter().zip(&ends[1].places) {
        for k in 0..LANES {
            most[k] = greater(most[k], (at(b, k) - at(a, k)).length_squared());
        }
    }
    fold(most, greater)
}

#[inline(always)]
fn spread(grid: &CellGrid, ends: &[StepEnd], nearest: &mut [u32], touched: &mut (IVec3, IVec3), width: i32) {
    for end in ends {
        for cell in &end.occupied {
            let (from, to) = grid.around(cell.at, width);
            *touched = (touched.0.min(from), touched.1.max(to));
            let first = grid.low + (from.as_vec3() + 0.5) * grid.cell - cell.place;
            let wide = (to.x - from.x + 1) as f32;
            // Squares along x are the same for all rows; lanes beyond the last cell are not written.
            let (mut along, mut slot) = (ZERO, [NONE; LANES]);
            for k in 0..LANES {
                let x = first.x + FROM_0[k] * grid.cell;
                along[k] = x * x;
                slot[k] = if FROM_0[k] < wide { u32::from(cell.slot) } else { NONE };
            }
            for z in from.z..=to.z {
                for y in from.y..=to.y {
                    let off_y = first.y + (y - from.y) as f32 * grid.cell;
                    let off_z = first.z + (z - from.z) as f32 * grid.cell;
                    let across = off_y * off_y + off_z * off_z;
                    let row = grid.row(y, z) + from.x as usize;
                    let Some(cells) = nearest[row..].first_chunk_mut::<LANES>() else { continue };
                    let mut own = *cells;
                    for k in 0..LANES {
                        let near = (across + along[k]).to_bits() & !0xffff | slot[k];
                        own[k] = if near < own[k] { near } else { own[k] };
                    }
                    *cells = own;
                    row_barrier();
                }
            }
        }
    }
}
