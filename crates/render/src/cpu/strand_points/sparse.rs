//! Light at every second point of fine strands, and between them only where it does not vary evenly.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::ops::RangeInclusive;

use lovelock_base::simd_versions;

use super::{LANES, PointsIn, ShadedPoint, shade_group};
use crate::cpu::math::{max, three};
use crate::cpu::view::View;

/// The largest sixteenth of the second differences of four points, as a part of their light, for which light in their middle is that of a
/// curve through them. It bounds how far the curve is from the mean of the middle two: about 1/255 of an image.
const EVEN: f32 = 0.02;
/// Light that counts as so much at least.
const DARK: f32 = 0.02;
/// The largest difference between a transmittance and the mean of its neighbours for which light is interpolated, in bytes.
const EVEN_BYTES: i32 = 4;

simd_versions! {
    /// [`shade_strands`] for the vectors of `width`.
    pub(super) fn shade_strands_simd(
        view: &View, input: &PointsIn, first: usize, is_draft: bool, out: &mut [ShadedPoint]
    ) -> () {
        shade_strands(view, input, first, is_draft, out)
    }
}

/// Shades whole fine strands from the point `first` on. In a draft, light between points is always the mean of both.
#[inline(always)]
fn shade_strands(view: &View, input: &PointsIn, first: usize, is_draft: bool, out: &mut [ShadedPoint]) {
    let points = view.points_per_strand();
    for (strand, out) in out.chunks_mut(points).enumerate() {
        place_strand(view, input, first + strand * points, out);
    }
    let mut waiting = [0; LANES];
    let mut count = 0;
    for start in (0..out.len()).step_by(points) {
        let end = (start + points).min(out.len());
        for k in (1..end - start - 1).step_by(2) {
            let here = &out[start..end];
            let found = if is_draft {
                Some(mean(here, k))
            } else {
                curve(here, &input.transmittance[first + start..], k)
            };
            if let Some(color) = found {
                out[start + k].color = color;
                continue;
            }
            waiting[count] = start + k;
            count += 1;
            if count == LANES {
                shade_waiting(view, input, first, &waiting, out);
                count = 0;
            }
        }
    }
    if count > 0 {
        let last = waiting[count - 1];
        waiting[count..].fill(last);
        shade_waiting(view, input, first, &waiting, out);
    }
}

/// Shades points of the strands from `first` on.
#[inline(always)]
fn shade_waiting(
    view: &View,
    input: &PointsIn,
    first: usize,
    waiting: &[usize; LANES],
    out: &mut [ShadedPoint],
) {
    let mut indices = *waiting;
    for index in &mut indices {
        *index += first;
    }
    let (shaded, _) = shade_group::<true, 1>(view, input, &indices);
    for (&index, shaded) in waiting.iter().zip(shaded) {
        out[index] = shaded;
    }
}

/// Places all points of a strand, and shades every second one and the last.
#[inline(always)]
fn place_strand(view: &View, input: &PointsIn, first: usize, out: &mut [ShadedPoint]) {
    let last = out.len() - 1;
    let mut indices = [0; LANES];
    for start in (0..=last.div_ceil(2)).step_by(LANES) {
        for (lane, index) in indices.iter_mut().enumerate() {
            *index = first + (2 * (start + lane)).min(last);
        }
        let (shaded, _) = shade_group::<true, 1>(view, input, &indices);
        for (index, shaded) in indices.iter().zip(shaded) {
            out[index - first] = shaded;
        }
    }
    for start in (0..last.div_ceil(2)).step_by(LANES) {
        for (lane, index) in indices.iter_mut().enumerate() {
            *index = first + (2 * (start + lane) + 1).min(last);
        }
        let (placed, _) = shade_group::<false, 1>(view, input, &indices);
        for (index, mut placed) in indices.iter().zip(placed) {
            let k = index - first;
            // Of an even number of points the last one is odd, and shaded already.
            if k < last {
                if out[k - 1].half_width < 0.0 || out[k + 1].half_width < 0.0 {
                    placed.half_width = -1.0;
                }
                out[k] = placed;
            }
        }
    }
}

/// The mean light of the points before and after.
#[inline(always)]
fn mean(strand: &[ShadedPoint], k: usize) -> [f32; 3] {
    halfway(strand[k - 1].color, strand[k + 1].color)
}

/// The mean of the light of two points.
#[inline(always)]
pub(in crate::cpu) fn halfway(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    three(|c| 0.5 * (a[c] + b[c]))
}

/// The points, every second one of a range, whose light decides that of the point `i` of fine strands: of `points` points each and `count` in
/// all. `None` if its own light is always computed.
pub(in crate::cpu) fn decided_by(
    i: usize,
    (points, count): (usize, usize),
    is_draft: bool,
) -> Option<RangeInclusive<usize>> {
    let start = i - i % points;
    let (k, len) = (i - start, points.min(count - start));
    let reach = if is_draft { 1 } else { 3 };
    let is_between = k % 2 == 1 && k >= reach && k + reach < len;
    is_between.then(|| i - reach..=i + reach)
}

/// Marks the points between two others as not drawn if one of these is not: in a draft they have no light of their own.
pub(super) fn hide_between(strand: &mut [ShadedPoint]) {
    for k in (1..strand.len().saturating_sub(1)).step_by(2) {
        if strand[k - 1].half_width < 0.0 || strand[k + 1].half_width < 0.0 {
            strand[k].half_width = -1.0;
        }
    }
}

/// The light of a point on the cubic curve through that of its neighbours and of the next ones, with their transmittances `lit`; `None` if
/// it does not vary evenly there, or if there are too few.
#[inline(always)]
fn curve(strand: &[ShadedPoint], lit: &[u32], k: usize) -> Option<[f32; 3]> {
    if k < 3 || k + 3 >= strand.len() {
        return None;
    }
    let around = [k - 3, k - 1, k + 1, k + 3].map(|at| &strand[at]);
    // A point that is not drawn has no light.
    if around.iter().any(|point| point.half_width < 0.0) {
        return None;
    }
    curve_through(around.map(|point| point.color), [k - 1, k, k + 1].map(|at| lit[at]))
}

/// The light in the middle of four points on the cubic curve through theirs; `None` if it does not vary evenly there. `lit` are the
/// transmittances of the second, of the middle, and of the third.
#[inline(always)]
pub(in crate::cpu) fn curve_through([a, b, c, d]: [[f32; 3]; 4], lit: [u32; 3]) -> Option<[f32; 3]> {
    let [before, here, after] = lit.map(|packed| packed.to_le_bytes().map(i32::from));
    let is_even =
        (0..4).all(|light| (2 * here[light] - before[light] - after[light]).abs() <= 2 * EVEN_BYTES);
    if !is_even {
        return None;
    }
    let found = three(|i| (9.0 * (b[i] + c[i]) - (a[i] + d[i])) * (1.0 / 16.0));
    // Both second differences: at an edge between the middle two they cancel each other in the curve.
    let is_near = |i: usize| {
        let (a, b, c, d) = (a[i], b[i], c[i], d[i]);
        let bent = (a - 2.0 * b + c).abs() + (b - 2.0 * c + d).abs();
        bent * (1.0 / 16.0) <= EVEN * max(0.5 * (b + c), DARK)
    };
    (is_near(0) && is_near(1) && is_near(2)).then(|| found.map(|light| max(light, 0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strand(light: impl Fn(f32) -> f32) -> Vec<ShadedPoint> {
        let point =
            |k: usize| ShadedPoint { color: [light(k as f32); 3], half_width: 1.0, ..Default::default() };
        (0..9).map(point).collect()
    }

    #[test]
    fn light_that_varies_evenly_is_interpolated_and_a_highlight_is_not() {
        let open = [u32::MAX; 9];
        // A gentle arch: the curve is within a thousandth of it.
        let arch = strand(|k| 0.5 + 0.01 * k - 0.002 * (k - 4.0).powi(2));
        for k in [3, 5] {
            let [found, ..] = curve(&arch, &open, k).expect("even light");
            assert!((found - arch[k].color[0]).abs() < 1e-3, "{k}: {found}");
        }
        assert_eq!(curve(&arch, &open, 1), None, "the ends are shaded");
        assert_eq!(curve(&arch, &open, 7), None);
        // The edge of a highlight between the second and the third shaded point.
        assert_eq!(curve(&strand(|k| if k > 4.5 { 2.0 } else { 0.5 }), &open, 5), None);
        assert_eq!(curve(&strand(|k| 0.5 + 0.3 * (0.9 * k).sin()), &open, 5), None);
        // One shaded point in the shadow of a strand.
        let mut shadowed = open;
        shadowed[5] = 0xffff_ff00;
        assert_eq!(curve(&arch, &shadowed, 5), None);
        let mut hidden = arch;
        hidden[6].half_width = -1.0;
        assert_eq!(curve(&hidden, &open, 5), None);
    }

    #[test]
    fn points_between_others_are_decided_by_them_and_the_ends_of_strands_are_not() {
        // Two strands of nine points, of which the second is cut off after six.
        let between = |is_draft: bool| -> Vec<_> {
            (0..15).filter_map(|i| Some((i, decided_by(i, (9, 15), is_draft)?))).collect()
        };
        assert_eq!(between(false), [(3, 0..=6), (5, 2..=8)]);
        let draft = [1_usize, 3, 5, 7, 10, 12].map(|i| (i, i - 1..=i + 1));
        assert_eq!(between(true), draft);
        assert!((0..9).all(|i| decided_by(i, (1, 9), false).is_none()), "stored strands");
        // As where light is computed for whole strands.
        let arch = strand(|k| 0.5 + 0.01 * k);
        let decided = |k: &usize| curve(&arch, &[u32::MAX; 9], *k).is_some();
        assert_eq!((1..8).step_by(2).filter(decided).collect::<Vec<_>>(), [3, 5]);
    }

    #[test]
    fn in_a_draft_points_beside_one_that_is_not_drawn_are_not_drawn_either() {
        let mut points = strand(|_| 1.0);
        points[4].half_width = -1.0;
        hide_between(&mut points);
        let hidden = points.iter().enumerate().filter(|(_, point)| point.half_width < 0.0);
        assert_eq!(hidden.map(|(k, _)| k).collect::<Vec<_>>(), [3, 4, 5]);
        hide_between(&mut []);
    }
}
