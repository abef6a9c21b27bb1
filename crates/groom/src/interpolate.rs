//! Interpolates strands from guides: the stage of each frame between simulation and drawing.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use crate::frame::{Lanes, WispCurve, catmull_rom, locate};
use crate::{GuideFrame, Hairstyle, StrandSet, Strands, Wisp};

/// Points that are computed side by side, in the lanes of vector instructions.
const LANES: usize = 8;
/// A run of wisps with fewer points is not handed to another thread.
const POINTS_PER_TASK: usize = 4096;

/// Buffers that a thread reuses for all wisps and frames.
#[derive(Default)]
struct Scratch {
    curve: WispCurve,
    /// Blended control points of the current strand, with phantom points.
    controls: Vec<[f32; 3]>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Writes every strand of `style`, moved by the guides of `frame`, to `strands`, in world space.
///
/// Each point is `sum_g(weight_g * guide_g(u)) + frame(u) * offset` as in [`StrandSet`](crate::StrandSet), evaluated by
/// [`WispCurve`]. Wisps are shared among rayon's threads; the result has the same bytes for any number of them. Later
/// calls with the same style allocate nothing.
///
/// # Panics
/// If `frame` has fewer guides than the style, or the style fails [`Hairstyle::check`].
pub fn interpolate(style: &Hairstyle, frame: &GuideFrame, strands: &mut Strands) {
    let set = &style.strands;
    if *strands.first_point != *set.first_point {
        strands.first_point = Arc::from(set.first_point.as_slice());
    }
    let points = set.points();
    for axis in [&mut strands.x, &mut strands.y, &mut strands.z] {
        axis.resize(points, 0.0);
    }
    let out = Slices { x: &mut strands.x, y: &mut strands.y, z: &mut strands.z };
    run(style, frame, &style.wisps, 0, out);
}

/// The coordinates of consecutive points.
struct Slices<'a> {
    x: &'a mut [f32],
    y: &'a mut [f32],
    z: &'a mut [f32],
}

impl<'a> Slices<'a> {
    fn split_at(self, at: usize) -> (Slices<'a>, Slices<'a>) {
        let (x0, x1) = self.x.split_at_mut(at);
        let (y0, y1) = self.y.split_at_mut(at);
        let (z0, z1) = self.z.split_at_mut(at);
        (Slices { x: x0, y: y0, z: z0 }, Slices { x: x1, y: y1, z: z1 })
    }
}

/// Halves `wisps` until few are left, then computes those; `out` begins at point `start` of the style.
fn run(style: &Hairstyle, frame: &GuideFrame, wisps: &[Wisp], start: usize, out: Slices<'_>) {
    if wisps.len() < 2 || out.x.len() <= POINTS_PER_TASK {
        return SCRATCH.with_borrow_mut(|scratch| wisps_into(style, frame, wisps, start, out, scratch));
    }
    let first_point_of = |w: usize| style.strands.first_point[wisps[w].first_strand as usize] as usize;
    let half = start + out.x.len() / 2;
    let (mut low, mut high) = (1, wisps.len() - 1);
    while low < high {
        let middle = usize::midpoint(low, high);
        if first_point_of(middle) < half {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    let (left, right) = wisps.split_at(low);
    let cut = first_point_of(low);
    let (out_left, out_right) = out.split_at(cut - start);
    rayon::join(|| run(style, frame, left, start, out_left), || run(style, frame, right, cut, out_right));
}

fn wisps_into(
    style: &Hairstyle,
    frame: &GuideFrame,
    wisps: &[Wisp],
    start: usize,
    out: Slices<'_>,
    scratch: &mut Scratch,
) {
    let set = &style.strands;
    let Slices { x, y, z } = out;
    for wisp in wisps.iter().filter(|w| w.strand_count > 0) {
        scratch.curve.place(&style.guides, wisp, &style.widest, &frame.guides, frame.world_from_head);
        let first = wisp.first_strand as usize;
        for strand in first..first + wisp.strand_count as usize {
            scratch.curve.blend_controls(set.weights[strand], &mut scratch.controls);
            let (begin, end) = (set.first_point[strand] as usize, set.first_point[strand + 1] as usize);
            let mut from = begin;
            while from < end {
                // The last block of a strand begins early enough to be full, and computes some points twice.
                let block = if end - begin >= LANES { from.min(end - LANES) } else { from };
                let range = block..end.min(block + LANES);
                let points = block_of(&scratch.curve, &scratch.controls, set, range.clone());
                let placed = range.start - start..range.end - start;
                store(&mut x[placed.clone()], &points[0]);
                store(&mut y[placed.clone()], &points[1]);
                store(&mut z[placed], &points[2]);
                from = block + LANES;
            }
        }
    }
}

/// The points of `range`, at most [`LANES`] of one strand.
#[inline]
fn block_of(curve: &WispCurve, controls: &[[f32; 3]], set: &StrandSet, range: Range<usize>) -> Lanes<LANES> {
    let links = curve.points_per_guide() - 1;
    let u = load(&set.guide_param[range.clone()]);
    let mut p = [0; LANES];
    let mut t = [0.0; LANES];
    for lane in 0..LANES {
        (p[lane], t[lane]) = locate(u[lane], links);
    }
    let [normal, binormal, tangent] = curve.axes(p, t);
    let mut point = catmull_rom(controls, p, t);
    let along_normal = load(&set.offset_normal[range.clone()]);
    let along_binormal = load(&set.offset_binormal[range.clone()]);
    let along_tangent = load(&set.offset_tangent[range]);
    for axis in 0..3 {
        for lane in 0..LANES {
            point[axis][lane] += normal[axis][lane] * along_normal[lane]
                + binormal[axis][lane] * along_binormal[lane]
                + tangent[axis][lane] * along_tangent[lane];
        }
    }
    point
}

/// Up to [`LANES`] values, padded with zeros.
#[inline]
fn load(values: &[f32]) -> [f32; LANES] {
    <[f32; LANES]>::try_from(values).unwrap_or_else(|_| {
        let mut all = [0.0; LANES];
        all[..values.len()].copy_from_slice(values);
        all
    })
}

/// Stores as many of `values` as fit.
#[inline]
fn store(to: &mut [f32], values: &[f32; LANES]) {
    match <&mut [f32; LANES]>::try_from(&mut *to) {
        Ok(whole) => *whole = *values,
        Err(_) => to.copy_from_slice(&values[..to.len()]),
    }
}
