//! Filtered lookups of many points.
//!
//! Blocks of points go through stages: placement, addresses of records, optical depths, and exponentials. The loads of one
//! stage do not depend on each other, which hides their latency, the largest part of the time.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(unsafe_code, clippy::inline_always, clippy::needless_range_loop, clippy::needless_bitwise_bool)]

use glam::Vec3;
use lovelock_base::numbers::mix;
use lovelock_base::simd::whole_part;
use lovelock_base::simd_versions;

use super::fragments::Fragments;
use super::frame::TexelFrame;
use super::method::TexelMethod;
use crate::exp::exp_of_minus;

/// Points that are looked up together.
const BLOCK: usize = 64;

/// A depth behind all hair.
pub(super) const BEHIND: f32 = 2.0;

/// A map that can be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lookup<'a, M: TexelMethod> {
    pub method: &'a M,
    pub frame: &'a TexelFrame,
    pub fragments: &'a Fragments,
    /// The index of the record of each texel plus 1; 0 where it has none.
    pub slots: &'a [u32],
    pub cells: &'a [M::Cell],
}

/// The texels around a block of points, `TAPS` per point.
struct Taps<const TAPS: usize> {
    /// Texels, or [`OUTSIDE`].
    texels: [[u32; BLOCK]; TAPS],
    /// Depths of the points; 0 for those that are known to be lit.
    depths: [f32; BLOCK],
    /// The positions of points between the centres of the texels.
    u: [f32; BLOCK],
    v: [f32; BLOCK],
}

/// The index that stands for no texel.
const OUTSIDE: u32 = u32::MAX;

impl<M: TexelMethod> Lookup<'_, M> {
    /// Optical depth of a texel before a depth.
    #[inline(always)]
    fn depth_before(&self, texel: usize, slot: usize, depth: f32) -> f32 {
        let cells = self.method.cells();
        let record = &self.cells[slot * cells..(slot + 1) * cells];
        let fragments = if M::READS_FRAGMENTS { self.fragments.texel(texel) } else { &[] };
        self.method.depth_before(fragments, record, depth)
    }

    /// Transmittance of all hair of a texel.
    pub(super) fn behind(&self, texel: usize) -> f32 {
        let slot = (self.slots[texel] as usize).checked_sub(1);
        slot.map_or(1.0, |slot| exp_of_minus(self.depth_before(texel, slot, BEHIND)))
    }

    /// The index of a texel, or [`OUTSIDE`].
    #[inline(always)]
    fn texel(&self, column: i32, row: i32) -> u32 {
        let n = self.frame.resolution;
        let (column, row) = (column as u32, row as u32);
        // No short-circuit: a branch would prevent vectorisation.
        if (column < n) & (row < n) { row.wrapping_mul(n).wrapping_add(column) } else { OUTSIDE }
    }

    /// Transmittance of many points, from the texel that contains each (one tap) or as the bilinear mean of the four texels around
    /// it. With `JITTER`, points are first moved by up to half a texel. All slices have the same length.
    #[inline(always)]
    fn run<const TAPS: usize, const JITTER: bool>(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        let axes = self.frame.axes();
        let end = self.frame.resolution as f32 + 1.0;
        let mut taps =
            Taps { texels: [[OUTSIDE; BLOCK]; TAPS], depths: [0.0; BLOCK], u: [0.0; BLOCK], v: [0.0; BLOCK] };
        let blocks = x.chunks(BLOCK).zip(y.chunks(BLOCK)).zip(z.chunks(BLOCK)).zip(out.chunks_mut(BLOCK));
        for (((x, y), z), out) in blocks {
            let (x, y, z) = (block_of(x), block_of(y), block_of(z));
            for lane in 0..BLOCK {
                let p = axes.transform(Vec3::new(x[lane], y[lane], z[lane]));
                // False for NaN. Points before all hair are lit.
                let inside = (p.x > -1.0) & (p.x < end) & (p.y > -1.0) & (p.y < end) & (p.z > 0.0);
                let depth = if p.z < BEHIND { p.z } else { BEHIND };
                taps.depths[lane] = if inside { depth } else { 0.0 };
                let [u, v] = if JITTER { place_hash([x[lane], y[lane], z[lane]]) } else { [0.5; 2] };
                let (x, y) = if inside { (p.x + (u - 0.5), p.y + (v - 0.5)) } else { (0.0, 0.0) };
                if TAPS == 1 {
                    taps.texels[0][lane] = self.texel(floor(x), floor(y));
                    continue;
                }
                let (x, y) = (x - 0.5, y - 0.5);
                let (column, row) = (floor(x), floor(y));
                (taps.u[lane], taps.v[lane]) = (x - column as f32, y - row as f32);
                for (tap, texels) in taps.texels.iter_mut().enumerate() {
                    texels[lane] = self.texel(column + (tap % 2) as i32, row + (tap / 2) as i32);
                }
            }
            self.block(&taps, out);
        }
    }

    #[inline(always)]
    fn block<const TAPS: usize>(&self, taps: &Taps<TAPS>, out: &mut [f32]) {
        let mut light = [[1.0; BLOCK]; TAPS];
        for (texels, light) in taps.texels.iter().zip(&mut light) {
            let mut slots = [0; BLOCK];
            for (slot, texel) in slots.iter_mut().zip(texels).take(out.len()) {
                *slot = self.slots.get(*texel as usize).copied().unwrap_or(0);
            }
            // Records are scattered in memory: all of a block are prefetched before the first one is read.
            let cells = self.method.cells();
            for (slot, depth) in slots.iter().zip(&taps.depths) {
                let first = (*slot as usize).wrapping_sub(1).wrapping_mul(cells);
                for cell in self.method.reads(*depth) {
                    prefetch(self.cells, first.wrapping_add(cell));
                }
            }
            let mut before = [0.0; BLOCK];
            for lane in 0..out.len().min(BLOCK) {
                if let Some(slot) = (slots[lane] as usize).checked_sub(1) {
                    before[lane] = self.depth_before(texels[lane] as usize, slot, taps.depths[lane]);
                }
            }
            for (light, before) in light.iter_mut().zip(&before) {
                *light = exp_of_minus(*before);
            }
        }
        let mut mean = light[0];
        if let [a, b, c, d] = &light[..] {
            for lane in 0..BLOCK {
                let (near, far) = (mix(a[lane], b[lane], taps.u[lane]), mix(c[lane], d[lane], taps.u[lane]));
                mean[lane] = mix(near, far, taps.v[lane]);
            }
        }
        for (out, t) in out.iter_mut().zip(&mean) {
            *out = if *t < 1.0 { *t } else { 1.0 };
        }
    }
}

/// Prefetches an item into the cache, if it exists.
#[inline(always)]
fn prefetch<T>(of: &[T], at: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = of.get(at) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch is a hint that reads nothing, and the address is that of an item.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(item).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (of, at);
}

/// A block of coordinates; the last one of a list is padded with zeros.
#[inline(always)]
fn block_of(axis: &[f32]) -> [f32; BLOCK] {
    axis.try_into().unwrap_or_else(|_| {
        let mut lanes = [0.0; BLOCK];
        lanes[..axis.len()].copy_from_slice(axis);
        lanes
    })
}

simd_versions! {
    /// Transmittance of many points, from the texel that contains each.
    pub(super) fn nearest<M: TexelMethod>(
        lookup: &Lookup<M>, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32],
    ) -> () {
        lookup.run::<1, false>(x, y, z, out)
    }
}

simd_versions! {
    /// Transmittance of many points, from the texel that contains each after it is moved by up to half a texel.
    pub(super) fn jittered<M: TexelMethod>(
        lookup: &Lookup<M>, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32],
    ) -> () {
        lookup.run::<1, true>(x, y, z, out)
    }
}

simd_versions! {
    /// Transmittance of many points, the bilinear mean of four texels each.
    pub(super) fn bilinear<M: TexelMethod>(
        lookup: &Lookup<M>, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32],
    ) -> () {
        lookup.run::<4, false>(x, y, z, out)
    }
}

/// Two hash values from 0 to 1 of a position, the same within a cube of an eighth of a millimetre: PCG in three
/// dimensions (Jarzynski, Olano 2020, "Hash Functions for GPU Rendering"). Twin of `place_hash` in lookup.wgsl.
#[inline(always)]
pub(crate) fn place_hash(p: [f32; 3]) -> [f32; 2] {
    // The conversion saturates, and NaN becomes 0.
    let cell = |c: f32| (c * 8192.0).floor() as i32 as u32;
    let scatter = |c: u32| c.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let [mut x, mut y, mut z] = [scatter(cell(p[0])), scatter(cell(p[1])), scatter(cell(p[2]))];
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    [x, y, z] = [x ^ (x >> 16), y ^ (y >> 16), z ^ (z >> 16)];
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    let part = |c: u32| (c >> 8) as f32 * (1.0 / 16_777_216.0);
    [part(x), part(y)]
}

/// The floor of `c`, which is above −2 and below 2^26.
#[inline(always)]
fn floor(c: f32) -> i32 {
    whole_part(c + 2.0) - 2
}
