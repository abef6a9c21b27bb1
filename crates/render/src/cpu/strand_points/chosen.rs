//! Points without their light, and the light of chosen points.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use rayon::prelude::*;

use super::{
    LANES, PIECE, PointsIn, ShadedPoint, ShadedPoints, is_sparse, out_of, shade_group, shade_points, sparse,
};
use crate::cpu::view::View;

/// Places all points, in parallel, where [`shade_all`](super::shade_all) places them. Their colours are black.
pub(in crate::cpu) fn place_all(
    width: Width,
    view: &View,
    input: &PointsIn,
    shaded: ShadedPoints,
    out: &mut Vec<ShadedPoint>,
) {
    out.resize(out_of(input), ShadedPoint::default());
    let points = view.points_per_strand();
    let is_draft = shaded == ShadedPoints::Second && is_sparse(view, shaded);
    let piece = if is_draft { points * (PIECE / points).max(1) } else { PIECE };
    out.par_chunks_mut(piece).enumerate().for_each(|(k, out)| {
        place_points_simd(width, view, input, k * piece, out);
        if is_draft {
            out.chunks_mut(points).for_each(sparse::hide_between);
        }
    });
}

simd_versions! {
    /// Places points as [`shade_points`] for the vectors of `width`.
    fn place_points_simd(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) -> () {
        shade_points::<false>(view, input, first, out)
    }
}

simd_versions! {
    /// [`light_chosen`] for the vectors of `width`.
    pub(in crate::cpu) fn light_chosen_simd(
        view: &View, input: &PointsIn, chosen: &[u32], out: &mut [[f32; 3]]
    ) -> () {
        light_chosen(view, input, chosen, out)
    }
}

/// Computes the light of points by their numbers. Light that is not a number is none.
#[inline(always)]
fn light_chosen(view: &View, input: &PointsIn, chosen: &[u32], out: &mut [[f32; 3]]) {
    for (chosen, out) in chosen.chunks(LANES).zip(out.chunks_mut(LANES)) {
        let last = chosen.len() - 1;
        let mut indices = [0; LANES];
        for (lane, index) in indices.iter_mut().enumerate() {
            *index = chosen[lane.min(last)] as usize;
        }
        let (shaded, _) = shade_group::<true, 1>(view, input, &indices);
        for (out, shaded) in out.iter_mut().zip(&shaded) {
            *out = if shaded.half_width < 0.0 { [0.0; 3] } else { shaded.color };
        }
    }
}
