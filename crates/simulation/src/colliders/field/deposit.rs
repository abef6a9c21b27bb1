//! How the body gets into the cells of its [`Occupancy`]: places near the skin or inside are carried along,
//! sixteen side by side, and tell the cells around of themselves.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use glam::{IVec3, Vec3};
use lovelock_groom::simd::{Width, whole_part};
use lovelock_groom::simd_versions;
use lovelock_motion::FieldWeights;

use super::cells::{Grid, NONE, UNSPARING, WIDEST};
use super::weightings::{Joints, Weightings};
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, fold, greater, put, row_done};

/// Places that are deposited, a row at a time: where they are at rest, and their slots and weightings. What
/// fills up the last row has slot 0, which is the head's.
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

/// A cell with probes in it: the one nearest to its middle.
#[derive(Clone, Copy, Debug)]
struct Occupied {
    index: u32,
    at: IVec3,
    place: Vec3,
    squared: f32,
    slot: u16,
}

/// The place among the occupied cells of one that is none of them.
const FREE: u32 = u32::MAX;

/// The cells with probes at one end of a step.
#[derive(Clone, Debug)]
pub(super) struct End {
    occupied: Vec<Occupied>,
    /// For each cell its place among them.
    own: Vec<u32>,
    /// Where each probe is; empty where nothing is known of this end.
    pub(super) places: Vec<Lane3>,
}

impl End {
    pub(super) fn new(cells: usize) -> Self {
        Self { occupied: Vec::new(), own: vec![FREE; cells], places: Vec::new() }
    }

    pub(super) fn forget(&mut self) {
        self.places.clear();
    }
}

const _: () =
    assert!(2 * (WIDEST + UNSPARING) < LANES as i32, "the cells around one along x fit in a row of lanes");

/// The number of each lane.
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
    /// Puts the probes where `joints` have them.
    pub(super) fn place_probes(probes: &Probes, grid: &Grid, joints: &Joints, end: &mut End) -> () {
        place_all(probes, grid, joints, end)
    }
}

simd_versions! {
    /// The square of the longest way of a probe from one end to the other.
    pub(super) fn furthest(ends: &[End; 2]) -> f32 {
        longest_way(ends)
    }
}

simd_versions! {
    /// Tells the cells around the occupied ones of the nearest of these; `skip` leaves out the start of the
    /// step.
    pub(super) fn spread_all(
        grid: &Grid,
        ends: &[End],
        nearest: &mut [u32],
        touched: &mut (IVec3, IVec3),
        width: i32,
    ) -> () {
        spread(grid, ends, nearest, touched, width)
    }
}

#[inline(always)]
fn place_all(probes: &Probes, grid: &Grid, joints: &Joints, end: &mut End) {
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
            // Written so that what is not a number is outside.
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
            let found = Occupied { index: index as u32, at: cell, place: at(&place, k), squared, slot };
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
fn longest_way(ends: &[End; 2]) -> f32 {
    let mut most = ZERO;
    for (a, b) in ends[0].places.iter().zip(&ends[1].places) {
        for k in 0..LANES {
            most[k] = greater(most[k], (at(b, k) - at(a, k)).length_squared());
        }
    }
    fold(most, greater)
}

#[inline(always)]
fn spread(grid: &Grid, ends: &[End], nearest: &mut [u32], touched: &mut (IVec3, IVec3), width: i32) {
    for end in ends {
        for cell in &end.occupied {
            let (from, to) = grid.around(cell.at, width);
            *touched = (touched.0.min(from), touched.1.max(to));
            let first = grid.low + (from.as_vec3() + 0.5) * grid.cell - cell.place;
            let wide = (to.x - from.x + 1) as f32;
            // Squares along x, which all rows have; what is beyond the last cell is not written.
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
                    row_done();
                }
            }
        }
    }
}
