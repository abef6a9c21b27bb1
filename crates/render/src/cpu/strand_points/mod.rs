//! Projects and shades every strand point once: the twin of `strand_points.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::Vec4;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use lovelock_groom::{PigmentVariation, Strands};
use rayon::prelude::*;

use super::math::{exp, floor, max, min, saturate, smoothstep, three};
use super::view::{ShadingView, View};
use crate::MAX_LIGHTS;
use crate::strand_details::PointColours;
use crate::uniform::{FrameUniform, MAX_LIGHT};

mod chosen;
mod fibre;
mod kajiya_kay;
mod sparse;
mod two_highlights;

pub(super) use chosen::{light_chosen_simd, place_all};
pub(super) use sparse::{curve_through, decided_by, halfway};

/// Points that are shaded together.
const LANES: usize = 16;
/// Points per task.
const PIECE: usize = 1024;

/// A shaded strand point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ShadedPoint {
    /// Pixels from the left and from the top.
    pub x: f32,
    /// See `x`.
    pub y: f32,
    /// 1 at the near plane, falling to 0 at infinity.
    pub depth: f32,
    /// Half of the width of the strand, pixels; negative if the point must not be drawn.
    pub half_width: f32,
    /// Unit vector along the strand on the screen.
    pub run_x: f32,
    /// See `run_x`.
    pub run_y: f32,
    /// Colour, linear.
    pub color: [f32; 3],
    /// A hash of the strand in 0..1.
    pub hash: f32,
}

/// The input of shading.
pub(super) struct PointsIn<'a> {
    pub strands: &'a Strands,
    /// See `pack_detail`.
    pub details: &'a [u32],
    /// Four 8-bit transmittances per point.
    pub transmittance: &'a [u32],
    /// Colours of single strands, if any has another than that of the look.
    pub colours: Option<PointColours<'a>>,
}

/// Which points of fine strands scattering by fibres is computed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ShadedPoints {
    All,
    /// Every second one, and those between where light does not vary evenly.
    Needed,
    /// Every second one: a draft.
    Second,
}

/// Shades all points, in parallel.
pub(super) fn shade_all(
    width: Width,
    view: &View,
    input: &PointsIn,
    shaded: ShadedPoints,
    out: &mut Vec<ShadedPoint>,
) {
    out.resize(out_of(input), ShadedPoint::default());
    let points = view.points_per_strand();
    let is_sparse = is_sparse(view, shaded);
    let piece = if is_sparse { points * (PIECE / points).max(1) } else { PIECE };
    out.par_chunks_mut(piece).enumerate().for_each(|(k, out)| {
        if is_sparse {
            let is_draft = shaded == ShadedPoints::Second;
            sparse::shade_strands_simd(width, view, input, k * piece, is_draft, out);
        } else {
            shade_points_simd(width, view, input, k * piece, out);
        }
    });
}

/// Whether light is computed at every second point of fine strands, and between them where that is needed.
pub(super) fn is_sparse(view: &View, shaded: ShadedPoints) -> bool {
    shaded != ShadedPoints::All
        && view.points_per_strand() > 2
        && matches!(view.shading, ShadingView::Fibre(_))
}

type Lane = [f32; LANES];

/// The light that points send to the eye: all of it, or ambient light and then that of each light apart.
type Parts<const N: usize> = [[Lane; 3]; N];

/// The number of parts of the light that can be told apart.
pub(super) const PARTS: usize = 1 + MAX_LIGHTS;

/// The light of a point by its parts.
pub(super) type LitParts = [[f32; 3]; PARTS];

/// The place of ambient light, which has no `light`, or of a light among so many parts.
#[inline(always)]
const fn part_of<const N: usize>(light: Option<usize>) -> usize {
    match light {
        Some(light) if N > 1 => 1 + light,
        _ => 0,
    }
}

/// Points to shade.
struct ShadedFrom<'a> {
    here: &'a [Lane; 3],
    /// Unit vectors along the strand and toward the eye.
    tangent: &'a [Lane; 3],
    to_eye: &'a [Lane; 3],
    /// Sine and cosine of the eye's inclination to the plane across the strand.
    sin_v: Lane,
    cos_v: Lane,
    /// Factor on the absorption of the look.
    pigment: Lane,
    /// The absorption.
    absorption: &'a [Lane; 3],
    /// Whether strands have colours of their own: then the absorption is not that factor times that of the look.
    has_colours: bool,
    /// See [`turn_variance`].
    turn: Lane,
    /// Four 8-bit transmittances.
    packed: [i32; LANES],
}

/// The width with which a strand is drawn, pixels.
///
/// Many fine strands below a pixel let through `exp(-opacity * sum of widths)`, whatever their number: one of them is drawn so narrow
/// that it does the same. From half a pixel on it blends into the width itself.
#[inline(always)]
fn thin(width: f32, opacity: f32, fine: bool) -> f32 {
    let narrow = (1.0 - exp(-opacity * width)) / max(opacity, 1e-3);
    let narrow = narrow + (width - narrow) * smoothstep(0.5, 2.0, width);
    if fine { narrow } else { width }
}

/// Variance that the turn of a strand at a point adds to its longitudinal lobes, where the segments before and after it are `first` and
/// `second`.
///
/// A point stands for directions over half of both segments. A turn by `a` between them, spread evenly, has the variance `a^2 / 12`,
/// and a mirrored direction turns twice as far. Without it the highlight of a bent strand is a row of dots.
#[inline(always)]
fn turn_variance(first: [f32; 3], second: [f32; 3]) -> f32 {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let lengths = dot(first, first) * dot(second, second);
    // The ends of a strand have one segment.
    let cos = if lengths > 1e-30 { dot(first, second) / lengths.sqrt() } else { 1.0 };
    // The square of a small angle is twice what its cosine lacks.
    2.0 / 3.0 * max(1.0 - cos, 0.0)
}

/// The number of complete points: strands and hairstyle should have the same size, but surplus points are ignored.
fn out_of(input: &PointsIn) -> usize {
    let Strands { x, y, z, .. } = input.strands;
    x.len().min(y.len()).min(z.len()).min(input.details.len()).min(input.transmittance.len())
}

simd_versions! {
    /// [`shade_points`] for the vectors of `width`.
    fn shade_points_simd(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) -> () {
        shade_points::<true>(view, input, first, out)
    }
}

simd_versions! {
    /// [`shade_parts`] for the vectors of `width`.
    fn shade_parts_simd(
        view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint], lit: &mut [LitParts]
    ) -> () {
        shade_parts(view, input, first, out, lit)
    }
}

/// Shades all points, in parallel, and tells the parts of their light apart.
pub(super) fn shade_all_parts(
    width: Width,
    view: &View,
    input: &PointsIn,
    out: &mut Vec<ShadedPoint>,
    lit: &mut Vec<LitParts>,
) {
    out.resize(out_of(input), ShadedPoint::default());
    lit.resize(out.len(), LitParts::default());
    let pieces = out.par_chunks_mut(PIECE).zip(lit.par_chunks_mut(PIECE));
    pieces.enumerate().for_each(|(k, (out, lit))| {
        shade_parts_simd(width, view, input, k * PIECE, out, lit);
    });
}

/// Shades the points from `first` on, and tells the parts of their light apart.
#[inline(always)]
fn shade_parts(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint], lit: &mut [LitParts]) {
    for (group, (out, lit)) in out.chunks_mut(LANES).zip(lit.chunks_mut(LANES)).enumerate() {
        let indices = std::array::from_fn(|lane| first + group * LANES + lane);
        let (shaded, parts) = shade_group::<true, PARTS>(view, input, &indices);
        out.copy_from_slice(&shaded[..out.len()]);
        for (lane, lit) in lit.iter_mut().enumerate() {
            for (part, from) in lit.iter_mut().zip(&parts) {
                *part = three(|c| min(from[c][lane], MAX_LIGHT));
            }
        }
    }
}

/// Shades the points from `first` on, or places them alone.
#[inline(always)]
fn shade_points<const LIT: bool>(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) {
    for (group, out) in out.chunks_mut(LANES).enumerate() {
        let mut indices = [0; LANES];
        for (lane, index) in indices.iter_mut().enumerate() {
            *index = first + group * LANES + lane;
        }
        let (shaded, _) = shade_group::<LIT, 1>(view, input, &indices);
        out.copy_from_slice(&shaded[..out.len()]);
    }
}

/// Points and their neighbours on the strand.
struct Group {
    here: [Lane; 3],
    before: [Lane; 3],
    after: [Lane; 3],
    /// See `pack_detail`.
    detail: [i32; LANES],
    /// Four 8-bit transmittances.
    packed: [i32; LANES],
}

impl Group {
    #[inline(always)]
    fn gather(input: &PointsIn, indices: &[usize; LANES]) -> Self {
        let Strands { x, y, z, .. } = input.strands;
        let last = out_of(input) - 1;
        let mut group = Self {
            here: [[0.0; LANES]; 3],
            before: [[0.0; LANES]; 3],
            after: [[0.0; LANES]; 3],
            detail: [0; LANES],
            packed: [0; LANES],
        };
        for lane in 0..LANES {
            let i = indices[lane].min(last);
            let word = input.details[i];
            let (a, b) = (
                i.saturating_sub(1 - (word >> 24 & 1) as usize),
                (i + 1 - (word >> 25 & 1) as usize).min(last),
            );
            group.detail[lane] = word as i32;
            group.packed[lane] = input.transmittance[i] as i32;
            for (axis, from) in [x, y, z].into_iter().enumerate() {
                group.here[axis][lane] = from[i];
                group.before[axis][lane] = from[a];
                group.after[axis][lane] = from[b];
            }
        }
        group
    }

    /// Unit vectors along the strands and toward the eye.
    #[inline(always)]
    fn directions(&self, eye: [f32; 3]) -> [[Lane; 3]; 2] {
        let mut tangent = [[0.0; LANES]; 3];
        let mut to_eye = [[0.0; LANES]; 3];
        let mut tangent_squared = [0.0; LANES];
        let mut eye_squared = [0.0; LANES];
        for axis in 0..3 {
            for lane in 0..LANES {
                let t = self.after[axis][lane] - self.before[axis][lane];
                let v = eye[axis] - self.here[axis][lane];
                tangent_squared[lane] += t * t;
                eye_squared[lane] += v * v;
                (tangent[axis][lane], to_eye[axis][lane]) = (t, v);
            }
        }
        for lane in 0..LANES {
            tangent_squared[lane] = 1.0 / max(tangent_squared[lane].sqrt(), 1e-9);
            eye_squared[lane] = 1.0 / max(eye_squared[lane].sqrt(), 1e-3);
        }
        for axis in 0..3 {
            for lane in 0..LANES {
                tangent[axis][lane] *= tangent_squared[lane];
                to_eye[axis][lane] *= eye_squared[lane];
            }
        }
        [tangent, to_eye]
    }

    /// Whether the neighbours of a point are finitely far from each other. Between others there is no direction, and so no light.
    #[inline(always)]
    fn is_straight(&self, lane: usize) -> bool {
        let [x, y, z] = three(|axis| self.after[axis][lane] - self.before[axis][lane]);
        (x + y + z) * 0.0 == 0.0
    }

    /// See [`turn_variance`].
    #[inline(always)]
    fn turns(&self) -> Lane {
        let mut turn = [0.0; LANES];
        for lane in 0..LANES {
            let first = three(|axis| self.here[axis][lane] - self.before[axis][lane]);
            let second = three(|axis| self.after[axis][lane] - self.here[axis][lane]);
            turn[lane] = turn_variance(first, second);
        }
        turn
    }
}

/// Pixels from the left and from the top, and distances in front of the eye.
#[inline(always)]
fn project(uniform: &FrameUniform, p: &[Lane; 3]) -> [Lane; 3] {
    let [clip_x, clip_y, _, clip_w] = rows(uniform.clip_from_world);
    let mut to = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        let at = [p[0][lane], p[1][lane], p[2][lane]];
        let w = dot4(clip_w, at);
        let inverse = 1.0 / max(w, 1e-4);
        to[0][lane] = (dot4(clip_x, at) * inverse * 0.5 + 0.5) * uniform.size.x;
        to[1][lane] = (0.5 - dot4(clip_y, at) * inverse * 0.5) * uniform.size.y;
        to[2][lane] = w;
    }
    to
}

/// Unit vectors on the screen from the points of `from` to those of `to`.
#[inline(always)]
fn runs(from: &[Lane; 3], to: &[Lane; 3]) -> [Lane; 2] {
    let mut run = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        let (dx, dy) = (to[0][lane] - from[0][lane], to[1][lane] - from[1][lane]);
        let length = (dx * dx + dy * dy).sqrt();
        let inverse = if length > 1e-4 { 1.0 / length } else { 0.0 };
        run[0][lane] = dx * inverse;
        run[1][lane] = if length > 1e-4 { dy * inverse } else { 1.0 };
    }
    run
}

/// The light that points reflect toward the eye, in `N` parts.
#[inline(always)]
fn light_of<const N: usize>(
    view: &View,
    input: &PointsIn,
    indices: &[usize; LANES],
    group: &Group,
) -> Parts<N> {
    let uniform = view.uniform;
    let [tangent, to_eye] = group.directions(uniform.eye.to_array());
    let mut sin_v = [0.0; LANES];
    let mut cos_v = [0.0; LANES];
    for lane in 0..LANES {
        sin_v[lane] = tangent[0][lane] * to_eye[0][lane]
            + tangent[1][lane] * to_eye[1][lane]
            + tangent[2][lane] * to_eye[2][lane];
        cos_v[lane] = max(1.0 - sin_v[lane] * sin_v[lane], 0.0).sqrt();
    }
    let pigment = pigment_of(view, &group.detail);
    let mut absorption = [[0.0; LANES]; 3];
    let look = uniform.absorption.to_array();
    for c in 0..3 {
        for lane in 0..LANES {
            absorption[c][lane] = look[c] * pigment[lane];
        }
    }
    if let Some(colours) = &input.colours {
        let points = view.points_per_strand();
        color(view, colours, (indices, points), &group.detail, &mut absorption);
    }
    let from = ShadedFrom {
        here: &group.here,
        tangent: &tangent,
        to_eye: &to_eye,
        sin_v,
        cos_v,
        pigment,
        absorption: &absorption,
        has_colours: input.colours.is_some(),
        turn: group.turns(),
        packed: group.packed,
    };
    match &view.shading {
        ShadingView::Fibre(fibre) => fibre::shade(view, fibre, &from),
        ShadingView::TwoHighlights => two_highlights::shade(view, &from),
        ShadingView::KajiyaKay => kajiya_kay::shade(view, &from),
    }
}

/// The points of `indices`, with their colours or black, and the `N` parts of their light.
#[inline(always)]
fn shade_group<const COLORED: bool, const N: usize>(
    view: &View,
    input: &PointsIn,
    indices: &[usize; LANES],
) -> ([ShadedPoint; LANES], Parts<N>) {
    let uniform = view.uniform;
    let group = Group::gather(input, indices);
    let at = project(uniform, &group.here);
    let (at_before, at_after) = (project(uniform, &group.before), project(uniform, &group.after));
    let run = runs(&at_before, &at_after);
    let parts = if COLORED { light_of(view, input, indices, &group) } else { [[[0.0; LANES]; 3]; N] };
    let mut sum = parts[0];
    for part in &parts[1..] {
        for c in 0..3 {
            for lane in 0..LANES {
                sum[c][lane] += part[c][lane];
            }
        }
    }
    // The last of fine strands fade.
    let points_per_strand = uniform.points_per_strand.max(1);
    let fine = points_per_strand > 1;
    let mut hash = [0.0; LANES];
    let mut half_width = [0.0; LANES];
    for lane in 0..LANES {
        let taper = (group.detail[lane] & 0xff) as f32 * (1.0 / 255.0);
        let shade = (group.detail[lane] >> 16 & 0xff) as f32 * (1.0 / 255.0);
        hash[lane] = shade * 37.0 - floor(shade * 37.0);
        let w = at[2][lane];
        let visible = (w > 0.02) & (at_before[2][lane] > 0.02) & (at_after[2][lane] > 0.02);
        let strand = indices[lane] as u32 / points_per_strand;
        let share = saturate((uniform.fade_end - strand as f32) * uniform.fade_slope);
        let width = uniform.strand_width * taper * share * uniform.pixels_per_metre / max(w, 1e-3);
        let wide = 0.5 * thin(width, uniform.opacity, fine);
        // A NaN point is not drawn: every comparison with it is false.
        let known = if COLORED {
            !(sum[0][lane] + sum[1][lane] + sum[2][lane]).is_nan()
        } else {
            group.is_straight(lane)
        };
        let drawn = visible & (at[0][lane].abs() < 1e6) & (at[1][lane].abs() < 1e6) & known;
        half_width[lane] = if drawn { wide } else { -1.0 };
    }
    let mut out = [ShadedPoint::default(); LANES];
    for (lane, out) in out.iter_mut().enumerate() {
        *out = ShadedPoint {
            x: at[0][lane],
            y: at[1][lane],
            depth: crate::camera::NEAR_METRES / max(at[2][lane], 1e-4),
            half_width: half_width[lane],
            run_x: run[0][lane],
            run_y: run[1][lane],
            color: three(|c| min(sum[c][lane], MAX_LIGHT)),
            hash: hash[lane],
        };
    }
    (out, parts)
}

/// Changes the `absorption` that points have by the look to that of their strands.
///
/// The variation between strands acts on all pigment; what else varies in the look acts on its own alone.
#[inline(always)]
fn color(
    view: &View,
    colours: &PointColours,
    (indices, points_per_strand): (&[usize; LANES], usize),
    detail: &[i32; LANES],
    absorption: &mut [Lane; 3],
) {
    let variation = view.uniform.variation;
    let of = PigmentVariation { variation, ..PigmentVariation::default() };
    for lane in 0..LANES {
        let along = (detail[lane] >> 8 & 0xff) as f32 * (1.0 / 255.0);
        let shade = (detail[lane] >> 16 & 0xff) as f32 * (1.0 / 255.0);
        let [kept, added @ ..] = colours.at(indices[lane], points_per_strand, along);
        let varied = of.varied(shade);
        for c in 0..3 {
            absorption[c][lane] = absorption[c][lane] * kept + added[c] * varied;
        }
    }
}

/// Pigment of strands at points, as a factor on that of the hair.
#[inline(always)]
fn pigment_of(view: &View, detail: &[i32; LANES]) -> Lane {
    let uniform = view.uniform;
    let of = PigmentVariation {
        variation: uniform.variation,
        tip_lightening: uniform.tip_lightening,
        grey: uniform.grey,
        highlights: uniform.highlights,
        lightening: uniform.lightening,
    };
    let mut pigment = [0.0; LANES];
    for lane in 0..LANES {
        let along = (detail[lane] >> 8 & 0xff) as f32 * (1.0 / 255.0);
        let shade = (detail[lane] >> 16 & 0xff) as f32 * (1.0 / 255.0);
        pigment[lane] = of.factor(along, shade, detail[lane] >> 26 & 0x3f);
    }
    pigment
}

/// The rows of a matrix.
fn rows(m: glam::Mat4) -> [Vec4; 4] {
    [m.row(0), m.row(1), m.row(2), m.row(3)]
}

#[inline(always)]
fn dot4(row: Vec4, p: [f32; 3]) -> f32 {
    row.x * p[0] + row.y * p[1] + row.z * p[2] + row.w
}
