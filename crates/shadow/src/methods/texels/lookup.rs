//! Filtered lookups of many points.
//!
//! Points go through in blocks, stage by stage: where they lie, which records they read, what these say, and
//! exponentials. Loads of one stage do not wait for each other, and most of the time goes to waiting for them.

use glam::Vec3;

use super::fragments::Fragments;
use super::frame::TexelFrame;
use super::map::TexelMethod;
use crate::exp::exp_of_minus;

/// Points that are looked up together.
const BLOCK: usize = 64;

/// A depth behind all hair.
pub(super) const BEHIND: f32 = 2.0;

/// A map that is ready to be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lookup<'a, M: TexelMethod> {
    pub method: &'a M,
    pub frame: &'a TexelFrame,
    pub fragments: &'a Fragments,
    /// One more than the number of each texel's record; 0 where it has none.
    pub slots: &'a [u32],
    pub cells: &'a [M::Cell],
}

/// What the texels around a block of points are read for: `TAPS` of them a point.
struct Taps<const TAPS: usize> {
    /// Texels, or [`OUTSIDE`].
    texels: [[u32; BLOCK]; TAPS],
    /// Depths of the points; 0 for those that are surely lit.
    depths: [f32; BLOCK],
    /// Where points lie between the centres of the texels.
    u: [f32; BLOCK],
    v: [f32; BLOCK],
}

/// The number of no texel.
const OUTSIDE: u32 = u32::MAX;

impl<M: TexelMethod> Lookup<'_, M> {
    /// Optical depth of a texel before a depth.
    #[inline]
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

    /// Transmittance of many points, by the texel that each lies in; slices of one length.
    pub(super) fn nearest(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        self.run(x, y, z, out, |p, taps: &mut Taps<1>, lane| {
            taps.texels[0][lane] = self.texel(floor(p.x), floor(p.y));
        });
    }

    /// Transmittance of many points, the bilinear mean of four texels each; slices of one length.
    pub(super) fn bilinear(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        self.run(x, y, z, out, |p, taps: &mut Taps<4>, lane| {
            let (x, y) = (p.x - 0.5, p.y - 0.5);
            let (column, row) = (floor(x), floor(y));
            (taps.u[lane], taps.v[lane]) = (x - column as f32, y - row as f32);
            let around = [(column, row), (column + 1, row), (column, row + 1), (column + 1, row + 1)];
            for (texels, (column, row)) in taps.texels.iter_mut().zip(around) {
                texels[lane] = self.texel(column, row);
            }
        });
    }

    /// The number of a texel, or [`OUTSIDE`].
    #[inline]
    fn texel(&self, column: i32, row: i32) -> u32 {
        let n = self.frame.resolution;
        let (column, row) = (column as u32, row as u32);
        if column < n && row < n { row * n + column } else { OUTSIDE }
    }

    fn run<const TAPS: usize>(
        &self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        out: &mut [f32],
        place: impl Fn(Vec3, &mut Taps<TAPS>, usize),
    ) {
        let axes = self.frame.axes();
        let end = self.frame.resolution as f32 + 1.0;
        let mut taps =
            Taps { texels: [[OUTSIDE; BLOCK]; TAPS], depths: [0.0; BLOCK], u: [0.0; BLOCK], v: [0.0; BLOCK] };
        let blocks = x.chunks(BLOCK).zip(y.chunks(BLOCK)).zip(z.chunks(BLOCK)).zip(out.chunks_mut(BLOCK));
        for (((x, y), z), out) in blocks {
            for (lane, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
                let p = axes.transform(Vec3::new(*x, *y, *z));
                // False for what is no number. Before all hair everything is lit.
                let inside = p.x > -1.0 && p.x < end && p.y > -1.0 && p.y < end && p.z > 0.0;
                taps.depths[lane] = if inside { p.z.min(BEHIND) } else { 0.0 };
                place(if inside { p } else { Vec3::ZERO }, &mut taps, lane);
            }
            self.block(&taps, out);
        }
    }

    #[inline]
    fn block<const TAPS: usize>(&self, taps: &Taps<TAPS>, out: &mut [f32]) {
        let mut light = [[1.0; BLOCK]; TAPS];
        for (texels, light) in taps.texels.iter().zip(&mut light) {
            let mut slots = [0; BLOCK];
            for (slot, texel) in slots.iter_mut().zip(texels).take(out.len()) {
                *slot = self.slots.get(*texel as usize).copied().unwrap_or(0);
            }
            let mut before = [0.0; BLOCK];
            for lane in 0..out.len() {
                if let Some(slot) = (slots[lane] as usize).checked_sub(1) {
                    before[lane] = self.depth_before(texels[lane] as usize, slot, taps.depths[lane]);
                }
            }
            for (light, before) in light.iter_mut().zip(&before) {
                *light = exp_of_minus(*before);
            }
        }
        for (lane, out) in out.iter_mut().enumerate() {
            let t = if let [a, b, c, d] = light.each_ref().map(|light| light[lane])[..] {
                let (near, far) = (mix(a, b, taps.u[lane]), mix(c, d, taps.u[lane]));
                mix(near, far, taps.v[lane])
            } else {
                light[0][lane]
            };
            *out = if t < 1.0 { t } else { 1.0 };
        }
    }
}

/// The whole number at or below `c`, which is above −2.
#[inline]
fn floor(c: f32) -> i32 {
    (c + 2.0) as i32 - 2
}

#[inline]
fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}
