//! From guides to strands: the stage of every frame between the simulator and the picture.

use std::cell::RefCell;
use std::sync::Arc;

use glam::Vec3A;

use crate::frame::{WispCurve, catmull_rom, locate};
use crate::{GuideFrame, Hairstyle, Strands, Wisp};

/// Points below which a run of wisps is not worth handing to another thread.
const POINTS_PER_TASK: usize = 4096;

/// Buffers that a thread reuses from wisp to wisp and frame to frame.
#[derive(Default)]
struct Scratch {
    curve: WispCurve,
    /// Blended control points of the strand at hand, phantoms included.
    controls: Vec<Vec3A>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Moves every strand of `style` with the guides of `frame`, into `strands`, in world space.
///
/// Each point is `sum_g(weight_g * guide_g(u)) + frame(u) * offset` as [`StrandSet`](crate::StrandSet) says, by
/// [`WispCurve`]. Wisps are shared among rayon's threads; the result has the same bytes for any number of them.
/// Nothing is allocated once `strands` has been used with the style.
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
    let out = Slices {
        x: &mut strands.x,
        y: &mut strands.y,
        z: &mut strands.z,
    };
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

/// Halves `wisps` until they are few, then moves them; `out` begins at point `start` of the style.
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
    rayon::join(
        || run(style, frame, left, start, out_left),
        || run(style, frame, right, cut, out_right),
    );
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
    let last = style.guides.points_per_guide.saturating_sub(1);
    for wisp in wisps.iter().filter(|w| w.strand_count > 0) {
        scratch
            .curve
            .place(&style.guides, wisp, &frame.guides, frame.world_from_head);
        let first = wisp.first_strand as usize;
        for strand in first..first + wisp.strand_count as usize {
            scratch
                .curve
                .blend_controls(set.weights[strand], &mut scratch.controls);
            let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
            let placed = range.start - start..range.end - start;
            let from = set.guide_param[range.clone()]
                .iter()
                .zip(&set.offset_normal[range.clone()])
                .zip(&set.offset_binormal[range.clone()])
                .zip(&set.offset_tangent[range]);
            let to = x[placed.clone()]
                .iter_mut()
                .zip(&mut y[placed.clone()])
                .zip(&mut z[placed]);
            for ((((&u, &along_normal), &along_binormal), &along_tangent), ((x, y), z)) in from.zip(to) {
                let (p, t) = locate(u, last);
                let c: &[Vec3A; 4] = scratch.controls[p..p + 4].try_into().expect("four controls");
                let (normal, binormal, tangent) = scratch.curve.axes(p, t);
                let point = catmull_rom(*c, t)
                    + (normal * along_normal + binormal * along_binormal + tangent * along_tangent);
                (*x, *y, *z) = (point.x, point.y, point.z);
            }
        }
    }
}
