//! The rows of all blocks as flat lists.

use super::{DeviceStep, SLOTS};
use crate::block::{Block, NO_ROPE};
use crate::lanes::{Lane, Lane3};

/// Numbers per point and slot of [`DeviceStep::write_state`].
pub const STATE_ROWS: usize = 18;
/// The first of them: positions and velocities.
pub const MOTION_ROWS: usize = 6;
/// Numbers per point and slot of a part of the state.
const PART_ROWS: usize = 3;

/// Appends rows of vectors.
fn put3(out: &mut Vec<f32>, rows: &[Lane3]) {
    for axis in rows.iter().flatten() {
        out.extend_from_slice(&axis[..]);
    }
}

/// Appends rows of numbers.
fn put1(out: &mut Vec<f32>, rows: &[Lane]) {
    for row in rows {
        out.extend_from_slice(&row[..]);
    }
}

/// The parts of the state, each for all blocks before the next.
fn parts(block: &Block) -> [&[Lane3]; 6] {
    let Block { position, velocity, bend, contact_push, coupled, skin, .. } = block;
    [position, velocity, bend, contact_push, &coupled.directions, skin]
}

fn parts_mut(block: &mut Block) -> [&mut [Lane3]; 6] {
    let Block { position, velocity, bend, contact_push, coupled, skin, .. } = block;
    [position, velocity, bend, contact_push, &mut coupled.directions, skin]
}

/// The numbers of part `n` of block `b` of `count`, which has `points` points per guide.
fn part_of(state: &[f32], n: usize, (b, count): (usize, usize), points: usize) -> &[f32] {
    let size = points * PART_ROWS * SLOTS;
    &state[(n * count + b) * size..][..size]
}

/// Reads the parts of block `b` of `count` that the rows of a state contain, which are the first ones.
pub(super) fn read_state(block: &mut Block, b: usize, count: usize, state: &[f32]) {
    let points = block.points();
    let read = state.len() / (count * points * PART_ROWS * SLOTS).max(1);
    for (n, rows) in parts_mut(block).into_iter().enumerate().take(read) {
        let from = part_of(state, n, (b, count), points);
        for (axis, numbers) in rows.iter_mut().flatten().zip(from.chunks_exact(SLOTS)) {
            axis.copy_from_slice(numbers);
        }
    }
    if PART_ROWS * read == STATE_ROWS {
        settle(block);
    }
}

/// Reads the parts behind positions and velocities, where the positions are those of the state: guides that were reset keep theirs.
pub(crate) fn read_rest(block: &mut Block, b: usize, count: usize, state: &[f32]) {
    let points = block.points();
    let mut is_same = [true; SLOTS];
    let there = part_of(state, 0, (b, count), points);
    for (axis, numbers) in block.position.iter().flatten().zip(there.chunks_exact(SLOTS)) {
        for (k, same) in is_same.iter_mut().enumerate() {
            *same &= axis[k].to_bits() == numbers[k].to_bits();
        }
    }
    for (n, rows) in parts_mut(block).into_iter().enumerate().skip(MOTION_ROWS / PART_ROWS) {
        let from = part_of(state, n, (b, count), points);
        for (axis, numbers) in rows.iter_mut().flatten().zip(from.chunks_exact(SLOTS)) {
            for k in (0..SLOTS).filter(|k| is_same[*k]) {
                axis[k] = numbers[k];
            }
        }
    }
    settle(block);
}

/// Brings up to date what follows from the state.
fn settle(block: &mut Block) {
    block.coupled.invalidate_factor();
    block.has_contact_push = block.any_contact_push();
}

impl DeviceStep<'_> {
    /// Writes the state: six lists of vectors, which are positions relative to the head's place at the end of the last step, metres;
    /// velocities, metres per second; rest bends in the frame of the last substep; displacements by contacts that still
    /// act; link directions for which lengths were factorised, in head space; and rest positions of the nearest skin.
    pub fn write_state(&self, out: &mut Vec<f32>) {
        out.clear();
        out.reserve(self.numbers() * STATE_ROWS);
        for part in 0..6 {
            for block in self.blocks {
                put3(out, parts(block)[part]);
            }
        }
    }

    /// Writes what does not change during a motion: lists of vectors with the positions, link directions, bends and supports at
    /// rest; lists of numbers with link lengths, their inverses, distances from the middle of the lock, strengths of ties,
    /// factors on stiffness, hold, damping and friction, places and distances in ropes; and per block and slot the mean link, 1 in
    /// slots of guides, 1 in slots of locks, and the rope, -1 for none.
    pub fn write_guides(&self, out: &mut Vec<f32>) {
        out.clear();
        for part in 0..4 {
            for block in self.blocks {
                let rest = &block.rest;
                put3(out, [&rest.position, &rest.direction, &rest.bend, &rest.support][part]);
            }
        }
        for part in 0..4 {
            for block in self.blocks {
                let rest = &block.rest;
                put1(out, [&rest.length, &rest.inv_length, &rest.lock_radius, &block.tie_hold][part]);
            }
        }
        for part in 0..4 {
            for block in self.blocks {
                match &block.factors {
                    Some(all) => put1(out, [&all.stiffness, &all.hold, &all.damping, &all.friction][part]),
                    None => fill(out, block, 1.0),
                }
            }
        }
        for part in 0..2 {
            for block in self.blocks {
                match &block.in_rope {
                    Some(found) => put1(out, [&found.place, &found.radius][part]),
                    None => fill(out, block, -1.0),
                }
            }
        }
        for block in self.blocks {
            out.extend_from_slice(&block.rest.mean_link[..]);
        }
        for block in self.blocks {
            out.extend((0..SLOTS).map(|k| f32::from(u8::from(k < block.used))));
        }
        for block in self.blocks {
            out.extend((0..SLOTS).map(|k| f32::from(u8::from(k < 3 * block.locks))));
        }
        for block in self.blocks {
            let rope = |k: usize| block.in_rope.as_ref().map_or(NO_ROPE, |found| found.rope[k]);
            out.extend((0..SLOTS).map(|k| if rope(k) == NO_ROPE { -1.0 } else { rope(k) as f32 }));
        }
    }

    /// Writes the signed distances at rest, metres: a list to the field, the largest number without one, and for each block one
    /// list after the other to each collider.
    pub fn write_distances(&self, out: &mut Vec<f32>) {
        out.clear();
        for block in self.blocks {
            if block.field_distance.is_empty() {
                fill(out, block, f32::MAX);
            } else {
                put1(out, &block.field_distance);
            }
        }
        for block in self.blocks {
            put1(out, &block.rest_distance);
        }
    }
}

/// Appends as many numbers as a list of `block` has.
fn fill(out: &mut Vec<f32>, block: &Block, value: f32) {
    out.resize(out.len() + block.points() * SLOTS, value);
}
