//! Interpolates strands from guides: the stage of each frame between simulation and drawing.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use lovelock_base::memory::list_bytes;

use crate::frame::{Lanes, WispCurve, catmull_rom, locate};
use crate::{GuideFrame, Guides, Hairstyle, StrandSet, Strands, Wisp};

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
    run(&Job { style, frame, before: None }, &style.wisps, 0, out);
}

/// The strands that follow guides from frame to frame. Those of wisps that have not moved are kept.
#[derive(Debug, Default)]
pub struct FollowingStrands {
    strands: Strands,
    /// What they were made from.
    of: Option<(Arc<Hairstyle>, GuideFrame)>,
}

impl FollowingStrands {
    /// The strands of `style` for the guides of `frame`; see [`interpolate`].
    ///
    /// # Panics
    /// As [`interpolate`].
    pub fn follow(&mut self, style: &Arc<Hairstyle>, frame: &GuideFrame) -> &Strands {
        let before = self.of.as_ref().filter(|(old, then)| is_comparable((old, then), (style, frame)));
        if let Some((old, then)) = before {
            let out = Slices { x: &mut self.strands.x, y: &mut self.strands.y, z: &mut self.strands.z };
            run(&Job { style, frame, before: Some((old, then)) }, &style.wisps, 0, out);
        } else {
            interpolate(style, frame, &mut self.strands);
        }
        match &mut self.of {
            Some((old, then)) => {
                old.clone_from(style);
                then.clone_from(frame);
            }
            none => *none = Some((Arc::clone(style), frame.clone())),
        }
        &self.strands
    }

    /// The strands of the last call.
    pub fn strands(&self) -> &Strands {
        &self.strands
    }

    /// The memory of the strands and of the guides, bytes.
    pub fn bytes(&self) -> u64 {
        let guides = self.of.as_ref().map_or(0, |(_, frame)| {
            [&frame.guides.x, &frame.guides.y, &frame.guides.z].into_iter().map(list_bytes).sum()
        });
        self.strands.bytes() + guides
    }
}

/// Whether strands can have stayed where they are from one frame to another: the head has, and there are as many strands and points.
fn is_comparable(
    (old, then): (&Arc<Hairstyle>, &GuideFrame),
    (style, frame): (&Arc<Hairstyle>, &GuideFrame),
) -> bool {
    let layout = |frame: &GuideFrame| {
        let guides = &frame.guides;
        (guides.points_per_guide, [guides.x.len(), guides.y.len(), guides.z.len()])
    };
    let same_strands = || {
        old.wisps == style.wisps
            && old.strands.first_point == style.strands.first_point
            && old.strands.weights.len() == style.strands.weights.len()
            && old.guides.points_per_guide == style.guides.points_per_guide
            && old.widest.len() == style.widest.len()
    };
    then.world_from_head == frame.world_from_head
        && layout(then) == layout(frame)
        && (Arc::ptr_eq(old, style) || same_strands())
}

/// What is interpolated, and what the output contains already: strands of the same layout from another style and frame.
#[derive(Clone, Copy)]
struct Job<'a> {
    style: &'a Hairstyle,
    frame: &'a GuideFrame,
    before: Option<(&'a Arc<Hairstyle>, &'a GuideFrame)>,
}

impl Job<'_> {
    /// Whether the strands of `wisp` are there already.
    fn has(&self, wisp: &Wisp) -> bool {
        let Some((old, then)) = self.before else { return false };
        let (style, frame) = (self.style, self.frame);
        let points = frame.guides.points_per_guide;
        let of_guide = |guide: u32| guide as usize * points..(guide as usize + 1) * points;
        // Numbers that are not equal to themselves count as moved.
        let same_guides = |a: &Guides, b: &Guides, guide: u32| {
            let of = of_guide(guide);
            a.x[of.clone()] == b.x[of.clone()]
                && a.y[of.clone()] == b.y[of.clone()]
                && a.z[of.clone()] == b.z[of]
        };
        if !wisp.guides.iter().all(|&guide| same_guides(&then.guides, &frame.guides, guide)) {
            return false;
        }
        if std::ptr::eq(&raw const **old, style) {
            return true;
        }
        let (a, b) = (&old.strands, &style.strands);
        let strands = wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize;
        let places = b.first_point[strands.start] as usize..b.first_point[strands.end] as usize;
        let same = |a: &[f32], b: &[f32]| a[places.clone()] == b[places.clone()];
        let own = of_guide(wisp.guides[0]);
        wisp.guides.iter().all(|&guide| same_guides(&old.guides, &style.guides, guide))
            && old.widest.get(own.clone()) == style.widest.get(own)
            && a.weights[strands.clone()] == b.weights[strands]
            && same(&a.guide_param, &b.guide_param)
            && same(&a.offset_normal, &b.offset_normal)
            && same(&a.offset_binormal, &b.offset_binormal)
            && same(&a.offset_tangent, &b.offset_tangent)
    }
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
fn run(job: &Job<'_>, wisps: &[Wisp], start: usize, out: Slices<'_>) {
    if wisps.len() < 2 || out.x.len() <= POINTS_PER_TASK {
        return SCRATCH.with_borrow_mut(|scratch| wisps_into(job, wisps, start, out, scratch));
    }
    let first_point_of = |w: usize| job.style.strands.first_point[wisps[w].first_strand as usize] as usize;
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
    rayon::join(|| run(job, left, start, out_left), || run(job, right, cut, out_right));
}

fn wisps_into(job: &Job<'_>, wisps: &[Wisp], start: usize, out: Slices<'_>, scratch: &mut Scratch) {
    let Job { style, frame, .. } = *job;
    let set = &style.strands;
    let Slices { x, y, z } = out;
    for wisp in wisps.iter().filter(|w| w.strand_count > 0 && !job.has(w)) {
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
