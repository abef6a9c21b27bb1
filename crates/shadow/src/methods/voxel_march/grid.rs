//! Sparse density: bricks of 8³ cells where there is hair.
//!
//! A brick holds 9³ numbers, its own cells and the first ones of the bricks behind it, so that all cells around a place lie in one brick.

use glam::{UVec3, Vec3};

use super::lattice::{BRICK, Lattice};

/// Numbers along its edge.
pub(super) const STORED: u32 = BRICK as u32 + 1;
/// Numbers of a brick.
pub(super) const BRICK_WORDS: usize = (STORED * STORED * STORED) as usize;

/// Optical depth 1 of a cell, in the fixed-point format of density. Sums of integers do not depend on their order.
pub(super) const DEPTH_ONE: f32 = (1 << 20) as f32;
/// The most that one sample adds, and the most that a cell is read as: an optical depth of 32.
pub(super) const MOST: u32 = 1 << 25;

/// The places of a cell: in its own brick, and at the end of up to seven others.
#[inline]
pub(super) fn places(lattice: &Lattice, cell: UVec3) -> impl Iterator<Item = (u32, u32)> {
    let (bricks, own, within) = (lattice.bricks, cell / BRICK as u32, cell % BRICK as u32);
    (0..8_u32).filter_map(move |which| {
        let before = UVec3::new(which & 1, which >> 1 & 1, which >> 2);
        // On an axis on which the cell is the first of its brick, it is also the last of the one before.
        let is_there = (before.cmpeq(UVec3::ZERO) | within.cmpeq(UVec3::ZERO)).all();
        let brick = (is_there && own.cmpge(before).all()).then(|| own - before)?;
        let at = within + before * BRICK as u32;
        Some((brick_at(bricks, brick), at.x + STORED * (at.y + STORED * at.z)))
    })
}

/// The place of a brick in the index.
#[inline]
pub(super) fn brick_at(bricks: UVec3, brick: UVec3) -> u32 {
    (brick.z * bricks.y + brick.y) * bricks.x + brick.x
}

/// A grid that can be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Density<'a> {
    pub lattice: &'a Lattice,
    /// The number of each brick of the window plus 1; 0 where there is no hair.
    pub index: &'a [u32],
    /// [`BRICK_WORDS`] numbers of each brick.
    pub cells: &'a [u32],
}

/// What lies around a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Around {
    /// Outside the window.
    Nothing,
    /// The first corner of a brick without hair, from which the place was subtracted half a cell.
    Empty(Vec3),
    /// Optical depth of a cell, in fixed point.
    Hair(f32),
}

impl Density<'_> {
    /// Density between the centres of cells, at a place of the window less half a cell, in cells.
    #[inline]
    pub fn at(&self, q: Vec3) -> Around {
        let bricks = self.lattice.bricks;
        let brick = (q * (1.0 / BRICK as f32)).floor();
        // False for NaN.
        if !(brick.cmpge(Vec3::ZERO).all() && brick.cmplt(bricks.as_vec3()).all()) {
            return Around::Nothing;
        }
        let corner = brick * BRICK as f32;
        let number = self.index[brick_at(bricks, brick.as_uvec3()) as usize];
        let Some(number) = number.checked_sub(1) else { return Around::Empty(corner) };
        let within = q - corner;
        let cell = within.as_uvec3().min(UVec3::splat(BRICK as u32 - 1));
        let part = within - cell.as_vec3();
        let first = number as usize * BRICK_WORDS + (cell.x + STORED * (cell.y + STORED * cell.z)) as usize;
        let row = |at: usize| {
            let read = |at: usize| self.cells[at].min(MOST) as f32;
            mix(read(at), read(at + 1), part.x)
        };
        let (y, z) = (STORED as usize, (STORED * STORED) as usize);
        let near = mix(row(first), row(first + y), part.y);
        let far = mix(row(first + z), row(first + z + y), part.y);
        Around::Hair(mix(near, far, part.z))
    }
}

#[inline]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Bounds;

    #[test]
    fn a_cell_lies_in_every_brick_that_reads_it() {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(1.0), ignored: 0 };
        let lattice = Lattice::new(Vec3::ZERO, 16, &bounds);
        for (cell, count) in
            [([9, 10, 11], 1), ([8, 10, 11], 2), ([8, 8, 9], 4), ([16, 8, 8], 8), ([0, 1, 2], 1)]
        {
            let cell = UVec3::from(cell);
            assert_eq!(places(&lattice, cell).count(), count, "{cell}");
            // Every brick reads the cell where it is full.
            let mut index = vec![0; lattice.count()];
            let mut cells = Vec::new();
            for (number, (brick, at)) in places(&lattice, cell).enumerate() {
                index[brick as usize] = number as u32 + 1;
                cells.resize((number + 1) * BRICK_WORDS, 0);
                cells[number * BRICK_WORDS + at as usize] = 1000;
            }
            let density = Density { lattice: &lattice, index: &index, cells: &cells };
            for off in
                [Vec3::ZERO, Vec3::splat(0.25), Vec3::new(-0.5, 0.0, 0.5), Vec3::new(0.0, -0.75, -0.25)]
            {
                let q = cell.as_vec3() + off;
                if q.min_element() < 0.0 {
                    continue;
                }
                let expected = 1000.0 * (1.0 - off.abs()).element_product();
                assert_eq!(density.at(q), Around::Hair(expected), "{cell} {off}");
            }
        }
        let density = Density { lattice: &lattice, index: &vec![0; lattice.count()], cells: &[] };
        assert_eq!(density.at(Vec3::splat(9.0)), Around::Empty(Vec3::splat(8.0)));
        for nowhere in [Vec3::NAN, Vec3::splat(-0.5), Vec3::splat(1e30)] {
            assert_eq!(density.at(nowhere), Around::Nothing, "{nowhere}");
        }
    }
}
