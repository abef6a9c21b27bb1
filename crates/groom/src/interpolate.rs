//! Interpolates strands from guides: the stage of each frame between simulation and drawing.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;

use crate::frame::{Lanes, WispCurve, catmull_rom, locate};
use crate::{GuideFrame, Guides, Hairstyle, StrandSet, Strands, Wisp};

/// Points that are computed side by side, in the lanes of vector instructions.
const LANES: usize = 16;
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
    fit(style, strands);
    let computed = AtomicBool::new(false);
    Job { width: Width::widest(), style, frame, before: None, needed: None, computed: &computed }
        .run(strands, None);
}

/// Makes room for the strands of `style`.
fn fit(style: &Hairstyle, strands: &mut Strands) {
    let set = &style.strands;
    if *strands.first_point != *set.first_point {
        strands.first_point = Arc::from(set.first_point.as_slice());
    }
    let points = set.points();
    for axis in [&mut strands.x, &mut strands.y, &mut strands.z] {
        axis.resize(points, 0.0);
    }
}

/// The strands that follow guides from frame to frame. Only those that are needed are computed, and of these only those that have moved.
#[derive(Debug, Default)]
pub struct FollowingStrands {
    strands: Strands,
    /// What they were made from.
    of: Option<(Arc<Hairstyle>, GuideFrame)>,
    /// Whether each strand is out of date.
    is_stale: Vec<bool>,
    has_computed: bool,
}

impl FollowingStrands {
    /// The strands of `style` for the guides of `frame`; see [`interpolate`]. If `needed` tells so for each strand, only some of them are up
    /// to date.
    ///
    /// # Panics
    /// As [`interpolate`].
    pub fn follow(
        &mut self,
        style: &Arc<Hairstyle>,
        frame: &GuideFrame,
        needed: Option<&[bool]>,
    ) -> &Strands {
        let Self { strands, of, is_stale, has_computed } = self;
        let needed = needed.filter(|needed| needed.len() == style.strands.count());
        let before = of.as_ref().map(|(old, then)| (old, then)).filter(|before| {
            is_comparable(*before, (style, frame)) && is_stale.len() == style.strands.count()
        });
        if before.is_none() {
            fit(style, strands);
            is_stale.clear();
            is_stale.resize(style.strands.count(), true);
        }
        let computed = AtomicBool::new(false);
        Job { width: Width::widest(), style, frame, before, needed, computed: &computed }
            .run(strands, Some(is_stale));
        *has_computed = computed.into_inner();
        match of {
            Some((old, then)) => {
                old.clone_from(style);
                then.clone_from(frame);
            }
            none => *none = Some((Arc::clone(style), frame.clone())),
        }
        strands
    }

    /// The strands of the last call.
    pub fn strands(&self) -> &Strands {
        &self.strands
    }

    /// Whether the last call computed any strand.
    pub fn has_computed(&self) -> bool {
        self.has_computed
    }

    /// The memory of the strands and of the guides, bytes.
    pub fn bytes(&self) -> u64 {
        let guides = self.of.as_ref().map_or(0, |(_, frame)| {
            [&frame.guides.x, &frame.guides.y, &frame.guides.z].into_iter().map(list_bytes).sum()
        });
        self.strands.bytes() + guides + list_bytes(&self.is_stale)
    }
}

/// A hairstyle and its guides in a frame.
type Placed<'a> = (&'a Arc<Hairstyle>, &'a GuideFrame);

/// Whether strands can have stayed where they are from one frame to another: the head has, and there are as many strands and points.
fn is_comparable((old, then): Placed<'_>, (style, frame): Placed<'_>) -> bool {
    let layout = |frame: &GuideFrame| {
        let guides = &frame.guides;
        (guides.points_per_guide, [guides.x.len(), guides.y.len(), guides.z.len()])
    };
    let same_strands = || {
        let (a, b) = (&old.strands, &style.strands);
        old.wisps == style.wisps
            && a.first_point == b.first_point
            && (a.weights.len(), a.points()) == (b.weights.len(), b.points())
            && old.guides.points_per_guide == style.guides.points_per_guide
            && old.guides.x.len() == style.guides.x.len()
    };
    then.world_from_head == frame.world_from_head
        && layout(then) == layout(frame)
        && (Arc::ptr_eq(old, style) || same_strands())
}

/// What is interpolated.
#[derive(Clone, Copy)]
struct Job<'a> {
    width: Width,
    style: &'a Hairstyle,
    frame: &'a GuideFrame,
    /// The frame that the output contains already, with strands of the same layout.
    before: Option<Placed<'a>>,
    /// Whether each strand is needed; all are if this is not given.
    needed: Option<&'a [bool]>,
    /// Set when a strand is computed.
    computed: &'a AtomicBool,
}

impl Job<'_> {
    fn run(&self, strands: &mut Strands, is_stale: Option<&mut [bool]>) {
        let out = Slices { x: &mut strands.x, y: &mut strands.y, z: &mut strands.z, is_stale };
        run(self, &self.style.wisps, [0, 0], out);
    }

    /// Whether `wisp` is where it was in the frame before.
    fn stays(&self, wisp: &Wisp) -> bool {
        let Some((old, then)) = self.before else { return false };
        let (style, frame) = (self.style, self.frame);
        let points = frame.guides.points_per_guide;
        let of_guide = |guide: u32| guide as usize * points..(guide as usize + 1) * points;
        // Numbers that are not equal to themselves count as moved.
        let same_guide = |a: &Guides, b: &Guides, guide: u32| {
            let of = of_guide(guide);
            a.x[of.clone()] == b.x[of.clone()]
                && a.y[of.clone()] == b.y[of.clone()]
                && a.z[of.clone()] == b.z[of]
        };
        if !wisp.guides.iter().all(|&guide| same_guide(&then.guides, &frame.guides, guide)) {
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
        wisp.guides.iter().all(|&guide| same_guide(&old.guides, &style.guides, guide))
            && old.widest.get(own.clone()) == style.widest.get(own)
            && a.weights[strands.clone()] == b.weights[strands]
            && same(&a.guide_param, &b.guide_param)
            && same(&a.offset_normal, &b.offset_normal)
            && same(&a.offset_binormal, &b.offset_binormal)
            && same(&a.offset_tangent, &b.offset_tangent)
    }
}

/// Consecutive strands: the coordinates of their points, and whether each is out of date. All are computed if that is not given.
struct Slices<'a> {
    x: &'a mut [f32],
    y: &'a mut [f32],
    z: &'a mut [f32],
    is_stale: Option<&'a mut [bool]>,
}

impl<'a> Slices<'a> {
    fn split_at(self, strand: usize, point: usize) -> (Slices<'a>, Slices<'a>) {
        let (x0, x1) = self.x.split_at_mut(point);
        let (y0, y1) = self.y.split_at_mut(point);
        let (z0, z1) = self.z.split_at_mut(point);
        let (s0, s1) = self.is_stale.map(|is_stale| is_stale.split_at_mut(strand)).unzip();
        (Slices { x: x0, y: y0, z: z0, is_stale: s0 }, Slices { x: x1, y: y1, z: z1, is_stale: s1 })
    }
}

/// Halves `wisps` until few are left, then computes those; `out` begins with the strand and the point `start` of the style.
fn run(job: &Job<'_>, wisps: &[Wisp], start: [usize; 2], out: Slices<'_>) {
    if wisps.len() < 2 || out.x.len() <= POINTS_PER_TASK {
        return SCRATCH.with_borrow_mut(|scratch| wisps_into(job, wisps, start, out, scratch));
    }
    let first_point_of = |w: usize| job.style.strands.first_point[wisps[w].first_strand as usize] as usize;
    let half = start[1] + out.x.len() / 2;
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
    let cut = [wisps[low].first_strand as usize, first_point_of(low)];
    let (out_left, out_right) = out.split_at(cut[0] - start[0], cut[1] - start[1]);
    rayon::join(|| run(job, left, start, out_left), || run(job, right, cut, out_right));
}

fn wisps_into(
    job: &Job<'_>,
    wisps: &[Wisp],
    [first_strand, start]: [usize; 2],
    mut out: Slices<'_>,
    scratch: &mut Scratch,
) {
    let Job { width, style, frame, needed, .. } = *job;
    let set = &style.strands;
    for wisp in wisps.iter().filter(|wisp| wisp.strand_count > 0) {
        let first = wisp.first_strand as usize;
        let strands = first..first + wisp.strand_count as usize;
        if let Some(is_stale) = &mut out.is_stale
            && !job.stays(wisp)
        {
            is_stale[first - first_strand..strands.end - first_strand].fill(true);
        }
        let mut is_placed = false;
        for strand in strands {
            if let Some(is_stale) = &mut out.is_stale {
                let is_stale = &mut is_stale[strand - first_strand];
                if !*is_stale || needed.is_some_and(|needed| !needed[strand]) {
                    continue;
                }
                *is_stale = false;
            }
            if !std::mem::replace(&mut is_placed, true) {
                job.computed.store(true, Ordering::Relaxed);
                scratch.curve.place(&style.guides, wisp, &style.widest, &frame.guides, frame.world_from_head);
            }
            scratch.curve.blend_controls(set.weights[strand], &mut scratch.controls);
            let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
            let placed = range.start - start..range.end - start;
            let to = [&mut out.x[placed.clone()], &mut out.y[placed.clone()], &mut out.z[placed]];
            strand_into_simd(width, &scratch.curve, &scratch.controls, set, range, to);
        }
    }
}

simd_versions! {
    /// [`strand_into`] for the vectors of `width`.
    fn strand_into_simd(
        curve: &WispCurve,
        controls: &[[f32; 3]],
        set: &StrandSet,
        range: Range<usize>,
        to: [&mut [f32]; 3],
    ) -> () {
        strand_into(curve, controls, set, range, to)
    }
}

/// Writes the points of one strand, which are those in `range` of all.
#[inline(always)]
fn strand_into(
    curve: &WispCurve,
    controls: &[[f32; 3]],
    set: &StrandSet,
    range: Range<usize>,
    [x, y, z]: [&mut [f32]; 3],
) {
    let (begin, end) = (range.start, range.end);
    let mut from = begin;
    while from < end {
        // The last block of a strand begins early enough to be full, and computes some points twice.
        let block = if end - begin >= LANES { from.min(end - LANES) } else { from };
        let range = block..end.min(block + LANES);
        let points = block_of(curve, controls, set, range.clone());
        let placed = range.start - begin..range.end - begin;
        store(&mut x[placed.clone()], &points[0]);
        store(&mut y[placed.clone()], &points[1]);
        store(&mut z[placed], &points[2]);
        from = block + LANES;
    }
}

/// The points of `range`, at most [`LANES`] of one strand.
#[inline(always)]
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
#[inline(always)]
fn load(values: &[f32]) -> [f32; LANES] {
    <[f32; LANES]>::try_from(values).unwrap_or_else(|_| {
        let mut all = [0.0; LANES];
        all[..values.len()].copy_from_slice(values);
        all
    })
}

/// Stores as many of `values` as fit.
#[inline(always)]
fn store(to: &mut [f32], values: &[f32; LANES]) {
    match <&mut [f32; LANES]>::try_from(&mut *to) {
        Ok(whole) => *whole = *values,
        Err(_) => to.copy_from_slice(&values[..to.len()]),
    }
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;

    use super::*;
    use crate::{GroomSettings, PlainHead, Preset, grow};

    fn style() -> Arc<Hairstyle> {
        let settings =
            GroomSettings { wisps: 40, strands_per_wisp: 6, ..GroomSettings::preset(Preset::Curly) };
        Arc::new(grow(&settings, &PlainHead.scalp(40), &PlainHead).expect("a preset grows"))
    }

    fn bits(strands: &Strands) -> [Vec<u32>; 3] {
        [&strands.x, &strands.y, &strands.z].map(|axis| axis.iter().map(|v| v.to_bits()).collect())
    }

    fn whole(style: &Hairstyle, frame: &GuideFrame) -> [Vec<u32>; 3] {
        let mut strands = Strands::default();
        interpolate(style, frame, &mut strands);
        bits(&strands)
    }

    #[test]
    fn all_widths_give_the_same_bits() {
        let style = style();
        let frame = GuideFrame::at_rest(&style.guides, Affine3A::from_rotation_x(0.3), 0.0);
        let expected = whole(&style, &frame);
        for &width in Width::ALL.iter().filter(|width| width.is_available()) {
            let mut strands = Strands::default();
            fit(&style, &mut strands);
            let computed = AtomicBool::new(false);
            Job { width, style: &style, frame: &frame, before: None, needed: None, computed: &computed }
                .run(&mut strands, None);
            assert!(bits(&strands) == expected, "{width:?}");
        }
    }

    #[test]
    fn strands_that_stay_are_kept_and_the_others_are_those_of_the_frame() {
        let mut style = style();
        let points = style.guides.points_per_guide;
        let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::from_rotation_y(0.2), 0.0);
        let mut following = FollowingStrands::default();
        assert!(bits(following.follow(&style, &frame, None)) == whole(&style, &frame));
        assert!(following.has_computed());
        following.follow(&style, &frame, None);
        assert!(!following.has_computed(), "nothing has moved");
        // One wisp moves.
        let guide = style.wisps[7].guides[1] as usize;
        frame.guides.x[guide * points + 9] += 0.01;
        let before = bits(following.follow(&style, &frame, None));
        assert!(before == whole(&style, &frame));
        // A style in which strands of another wisp lie elsewhere, and the guides of a third one at rest.
        let mut other = Hairstyle::clone(&style);
        let strand = style.wisps[3].first_strand as usize;
        other.strands.offset_normal[style.strands.first_point[strand] as usize + 4] += 0.02;
        other.guides.z[style.wisps[5].guides[0] as usize * points + 1] += 0.03;
        style = Arc::new(other);
        let after = bits(following.follow(&style, &frame, None));
        assert!(after == whole(&style, &frame) && after != before);
        // Of strands that move, only those that are needed are up to date, until others are.
        frame.guides.y.iter_mut().for_each(|y| *y += 0.05);
        let needed: Vec<bool> = (0..style.strands.count()).map(|strand| strand % 3 == 0).collect();
        let expected = whole(&style, &frame);
        let some = bits(following.follow(&style, &frame, Some(&needed)));
        for (strand, ends) in style.strands.first_point.windows(2).enumerate() {
            let of = ends[0] as usize..ends[1] as usize;
            assert_eq!(some[1][of.clone()] == expected[1][of], needed[strand], "strand {strand}");
        }
        assert!(bits(following.follow(&style, &frame, None)) == expected);
        assert!(following.has_computed(), "the others, although nothing has moved");
        // A head that turns moves all, and so does a style with other strands.
        frame.world_from_head = Affine3A::from_rotation_z(0.1);
        assert!(bits(following.follow(&style, &frame, None)) == whole(&style, &frame));
        let fewer = GroomSettings { wisps: 30, strands_per_wisp: 4, ..GroomSettings::preset(Preset::Smooth) };
        let fewer = Arc::new(grow(&fewer, &PlainHead.scalp(40), &PlainHead).expect("a preset grows"));
        let frame = GuideFrame::at_rest(&fewer.guides, Affine3A::IDENTITY, 0.0);
        assert!(bits(following.follow(&fewer, &frame, None)) == whole(&fewer, &frame));
    }

    #[test]
    fn numbers_that_are_not_finite_count_as_moved() {
        let style = style();
        let mut frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        frame.guides.x[100] = f32::NAN;
        let mut following = FollowingStrands::default();
        for _ in 0..2 {
            assert!(bits(following.follow(&style, &frame, None)) == whole(&style, &frame));
        }
    }
}
