//! The inner loops, compiled for several widths of vectors, all of which give the same bits: a test checks it.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use glam::Vec3;
use lovelock_groom::{Strands, simd_versions};

use super::deposit::Deposit;
use super::grid::Grid;
use super::layout::Layout;
use super::lookup::Lookup;
use super::sum;
use crate::LightFrame;
use crate::bounds::Bounds;

simd_versions! {
    /// [`Bounds::of_points`].
    pub(super) fn bounds(x: &[f32], y: &[f32], z: &[f32], light: &LightFrame, anchor: Vec3) -> Bounds {
        Bounds::of_points(x, y, z, light, anchor)
    }
}

simd_versions! {
    /// [`Deposit::run`].
    pub(super) fn deposit(deposit: &Deposit, strands: &Strands, first: usize, last: usize, grid: &mut Grid) -> u64 {
        deposit.run(strands, first, last, grid)
    }
}

simd_versions! {
    /// [`sum::sum_tile`].
    pub(super) fn sum_tile(layout: &Layout, tile: usize, used: u64, cells: &mut [u32], others: &[Grid]) -> () {
        sum::sum_tile(layout, tile, used, cells, others)
    }
}

simd_versions! {
    /// [`Lookup::run`].
    pub(super) fn lookup(lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) -> () {
        lookup.run(x, y, z, out)
    }
}
