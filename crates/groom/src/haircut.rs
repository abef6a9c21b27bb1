//! Cutting hair while it moves.
//!
//! A cut is stored as the part that remains of each guide, so that it survives saving, undo and another motion. The
//! guides of a cut style keep their points up to the link after the cut. The points beyond lie on the last of them,
//! with links of length zero, which the simulator skips. The remaining hair therefore has the same control points,
//! curves and frames as before, at rest and in motion, and does not jump when it is cut.

use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};

use crate::{GuideFrame, Guides, Hairstyle, StrandSet};

/// The least that a cut leaves of a strand, in links.
const STUBBLE: f32 = 0.3;
/// A cut does not apply to guides whose first root is farther than this from the recorded one, metres.
const SAME_ROOT: f32 = 0.002;

/// The shape that cuts hair, in any space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blade {
    /// Cuts hair where it first crosses to the side of a plane to which `normal` points.
    Plane {
        /// A point of the plane, metres.
        point: Vec3,
        /// Points to the side that falls off; any length but zero.
        normal: Vec3,
    },
    /// Cuts hair where it first enters a sphere.
    Sphere {
        /// Its centre, metres.
        centre: Vec3,
        /// Its radius, metres.
        radius: f32,
    },
}

impl Blade {
    /// The blade moved rigidly, for example from head space to world space.
    #[must_use]
    pub fn moved(&self, by: &Affine3A) -> Self {
        match *self {
            Self::Plane { point, normal } => {
                Self::Plane { point: by.transform_point3(point), normal: by.transform_vector3(normal) }
            }
            Self::Sphere { centre, radius } => Self::Sphere { centre: by.transform_point3(centre), radius },
        }
    }

    /// Positive where hair falls off.
    fn depth(&self, p: Vec3) -> f32 {
        match *self {
            Self::Plane { point, normal } => (p - point).dot(normal.normalize_or_zero()),
            Self::Sphere { centre, radius } => radius - p.distance(centre),
        }
    }

    /// The fraction of the way from `a` to `b` at which the blade cuts; `None` where it does not.
    fn crossing(&self, a: Vec3, b: Vec3) -> Option<f32> {
        let (da, db) = (self.depth(a), self.depth(b));
        if da > 0.0 {
            return Some(0.0);
        }
        match *self {
            Self::Plane { .. } => (db > 0.0).then(|| (da / (da - db)).clamp(0.0, 1.0)),
            Self::Sphere { centre, radius } => {
                let (from, along) = (a - centre, b - a);
                let (qa, qb, qc) =
                    (along.length_squared(), from.dot(along), from.length_squared() - radius * radius);
                let root = qb * qb - qa * qc;
                let t = (-qb - root.max(0.0).sqrt()) / qa;
                (radius > 0.0 && root > 0.0 && (0.0..=1.0).contains(&t)).then_some(t)
            }
        }
    }
}

/// The part that cuts leave of each guide of a hairstyle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Haircut {
    /// The root of the first guide, head space, metres. The cut applies only to hair with this root.
    pub first_root: Vec3,
    /// The part that remains of each guide, as a fraction of its links, 0 to 1. Empty without a cut.
    pub kept: Vec<f32>,
}

impl Haircut {
    /// The part of `style` that `blade`, in world space, leaves of the hair at `frame`. `None` if the blade meets no
    /// hair, or if the frame belongs to another style.
    pub fn of(style: &Hairstyle, frame: &GuideFrame, blade: &Blade) -> Option<Self> {
        let (guides, moved) = (&style.guides, &frame.guides);
        if moved.points_per_guide != guides.points_per_guide || moved.count() != guides.count() {
            return None;
        }
        let links = guides.points_per_guide.checked_sub(1).filter(|links| *links > 0)?;
        let kept = |guide: usize| {
            let met = (1..=links).find_map(|i| {
                let t = blade.crossing(moved.point(guide, i - 1), moved.point(guide, i))?;
                Some(((i - 1) as f32 + t) / links as f32)
            });
            met.unwrap_or(1.0)
        };
        let kept: Vec<f32> = (0..guides.count()).map(kept).collect();
        kept.iter().any(|k| *k < 1.0).then(|| Self { first_root: guides.point(0, 0), kept })
    }

    /// This cut and a later one of the same hair, combined. A later cut of other hair replaces this one.
    #[must_use]
    pub fn and(&self, later: &Self) -> Self {
        if self.kept.len() != later.kept.len() || !self.same_root(later.first_root) {
            return later.clone();
        }
        let kept = self.kept.iter().zip(&later.kept).map(|(a, b)| a.min(*b)).collect();
        Self { first_root: self.first_root, kept }
    }

    /// Whether nothing was cut.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Whether the cut was made for these guides.
    pub fn fits(&self, guides: &Guides) -> bool {
        self.kept.len() == guides.count() && guides.count() > 0 && self.same_root(guides.point(0, 0))
    }

    /// The cut with every value clamped to its range; NaN leaves its guide whole.
    #[must_use]
    pub fn clamped(&self) -> Self {
        let kept = |k: &f32| if k.is_nan() { 1.0 } else { k.clamp(0.0, 1.0) };
        Self { first_root: self.first_root, kept: self.kept.iter().map(kept).collect() }
    }

    fn same_root(&self, root: Vec3) -> bool {
        self.first_root.distance(root) < SAME_ROOT
    }
}

/// `style` with shorter guides and strands: the same number of guides and of points per guide. A cut of other hair
/// changes nothing.
#[must_use]
pub fn trimmed(style: &Hairstyle, cut: &Haircut) -> Hairstyle {
    let mut out = style.clone();
    if !cut.fits(&style.guides) {
        return out;
    }
    let links = (style.guides.points_per_guide - 1) as f32;
    let kept = cut.clamped().kept;
    let set = &style.strands;
    let mut shorter = StrandSet { first_point: vec![0], ..StrandSet::default() };
    // The last point of each guide. Guides without a wisp carry no strands.
    let mut ends = vec![0.0_f32; style.guides.count()];
    for (w, wisp) in style.wisps.iter().enumerate() {
        let ends_of = wisp.guides.map(|g| kept[g as usize] * links);
        let whole = ends_of.iter().all(|end| *end >= links);
        let mut furthest = ends_of.iter().copied().fold(0.0, f32::max);
        for strand in wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize {
            let own: f32 = set.weights[strand].iter().zip(ends_of).map(|(weight, end)| weight * end).sum();
            let end = if whole { f32::INFINITY } else { own.clamp(STUBBLE.min(links), links) };
            furthest = furthest.max(copy(set, strand, end, &mut shorter));
        }
        shorter.wisp.extend(std::iter::repeat_n(w as u32, wisp.strand_count as usize));
        for g in wisp.guides {
            let end = if whole { links } else { furthest.ceil() + 1.0 };
            ends[g as usize] = ends[g as usize].max(end);
        }
    }
    let points = style.guides.points_per_guide;
    for (guide, end) in ends.into_iter().enumerate() {
        let end = if end > 0.0 { end.min(links) as usize } else { links as usize };
        let last = style.guides.point(guide, end);
        for i in guide * points + end + 1..(guide + 1) * points {
            (out.guides.x[i], out.guides.y[i], out.guides.z[i]) = (last.x, last.y, last.z);
        }
    }
    // A cut takes away the colours of the tips.
    let tip = |set: &StrandSet, strand: usize| set.guide_param[set.first_point[strand + 1] as usize - 1];
    shorter.colours =
        set.colours.shortened(|strand| tip(&shorter, strand) / tip(set, strand).max(f32::MIN_POSITIVE));
    out.strands = shorter;
    out
}

/// Copies a strand up to the parameter `end`; returns the parameter of its last point.
fn copy(set: &StrandSet, strand: usize, end: f32, out: &mut StrandSet) -> f32 {
    let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
    let inside = range.clone().skip(1).take_while(|&i| set.guide_param[i] < end - 1e-4).count() + 1;
    let mut push = |i: usize, t: f32| {
        let mix =
            |values: &[f32]| if t > 0.0 { values[i] + (values[i + 1] - values[i]) * t } else { values[i] };
        out.guide_param.push(mix(&set.guide_param));
        out.offset_normal.push(mix(&set.offset_normal));
        out.offset_binormal.push(mix(&set.offset_binormal));
        out.offset_tangent.push(mix(&set.offset_tangent));
        out.taper.push(mix(&set.taper));
    };
    for i in range.start..range.start + inside {
        push(i, 0.0);
    }
    let last = range.start + inside - 1;
    if last + 1 < range.end {
        let (a, b) = (set.guide_param[last], set.guide_param[last + 1]);
        push(last, ((end - a) / (b - a).max(1e-6)).clamp(1e-3, 1.0));
    }
    out.first_point.push(out.guide_param.len() as u32);
    out.weights.push(set.weights[strand]);
    out.shade.push(set.shade[strand]);
    out.guide_param.last().copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
