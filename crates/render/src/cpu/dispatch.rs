//! The inner loops, compiled for several widths of vectors.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use lovelock_groom::simd_versions;

use super::backdrop::Ground;
use super::body_depth::{Band, draw_band};
use super::hair::blend::{BlendState, BlendTile, blend_segments};
use super::hair::list::{ListTile, list_segments};
use super::points::{PointsIn, ShadedPoint, shade_points};
use super::surface::raster::{Occlusion, SurfaceSamples, TriangleTile, raster_triangles};
use super::surface::shade::{SurfaceBatch, shade_batch};
use super::tile::{PixelsIn, finish_pixels};
use super::view::View;

simd_versions! {
    /// [`draw_band`].
    pub(super) fn depth_band(input: &Band, rows: &mut [f32], blocks: &mut [[f32; 2]]) -> () {
        draw_band(input, rows, blocks)
    }
}

simd_versions! {
    /// [`shade_points`].
    pub(super) fn points(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) -> () {
        shade_points(view, input, first, out)
    }
}

simd_versions! {
    /// [`raster_triangles`].
    pub(super) fn triangles(input: &TriangleTile, out: &mut SurfaceSamples, hidden: &mut Occlusion) -> () {
        raster_triangles(input, out, hidden)
    }
}

simd_versions! {
    /// [`shade_batch`].
    pub(super) fn surface(view: &View, batch: &mut SurfaceBatch) -> () {
        shade_batch(view, batch)
    }
}

simd_versions! {
    /// [`blend_segments`].
    pub(super) fn blend(input: &BlendTile, out: &mut BlendState) -> () {
        blend_segments(input, out)
    }
}

simd_versions! {
    /// [`list_segments`].
    pub(super) fn list(input: &ListTile, out: &mut super::hair::list::Fragments) -> () {
        list_segments(input, out)
    }
}

simd_versions! {
    /// [`Ground::new`].
    pub(super) fn ground(view: &View, origin: [f32; 2]) -> Option<Ground> {
        Ground::new(view, origin)
    }
}

simd_versions! {
    /// [`finish_pixels`].
    pub(super) fn finish(view: &View, input: &PixelsIn, out: &mut [u8]) -> () {
        finish_pixels(view, input, out)
    }
}
