//! The strands of a wisp in its disks at rest.
//!
//! Places are found at twice as many cross-sections as the disks have, so that a sector also knows the strands that cross it
//! between two cross-sections, and how far they move.

use glam::Vec2;
use lovelock_groom::{Hairstyle, Wisp, WispCurve};

use crate::disk::{DiskFit, GuideSection, next, place_of};
use crate::ellipse::Ellipse;

/// This part of the strands lies within the disk; the rest are strays, which belong to the outermost layer.
const WITHIN: f32 = 0.97;
/// Passes of a short filter over the scales of the disks.
const SMOOTHING_PASSES: usize = 6;

/// Strands of a wisp at the cross-sections of its disks and halfway between them.
pub(super) struct Placed {
    /// The parameter of the last cross-section, in links.
    pub(super) end: f32,
    /// How each disk lies around its strands.
    pub(super) fits: Vec<DiskFit>,
    /// Each strand in the disk, `[strand][half sample]`: its point in the unit disk, and its width as a part of a hair's, 0
    /// beyond its ends.
    pub(super) places: Vec<(Vec2, f32)>,
    /// Cross-sections, and those halfway between them.
    pub(super) halves: usize,
}

/// Places the strands of `wisp` in disks at `halves` cross-sections, `least` as in [`crate::disk::DiskPlan`].
pub(super) fn place(style: &Hairstyle, wisp: &Wisp, halves: usize, least: f32) -> Placed {
    let set = &style.strands;
    let strands = wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize;
    let links = style.guides.points_per_guide.saturating_sub(1) as f32;
    let points = |strand: usize| set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
    let last = |strand: usize| set.guide_param[points(strand).end - 1];
    // The maximum of NaN and a number is the number.
    let end = strands.clone().map(last).fold(0.0, f32::max).min(links);
    let param = |half: usize| end * half as f32 / (halves - 1) as f32;

    // Offsets along normal and binormal, and width, then places in the disk.
    let mut places = vec![(Vec2::ZERO, 0.0); strands.len() * halves];
    for (strand, row) in strands.clone().zip(places.chunks_exact_mut(halves)) {
        let points = points(strand);
        let mut at = points.start;
        for (half, place) in row.iter_mut().enumerate() {
            let param = param(half);
            while at + 2 < points.end && set.guide_param[at + 1] < param {
                at += 1;
            }
            *place = between(style, at, param);
        }
    }

    let curve = WispCurve::at_rest(&style.guides, wisp);
    let mut fits = Vec::with_capacity(halves);
    let mut before: Option<Ellipse> = None;
    let mut radii = Vec::with_capacity(strands.len());
    for half in 0..halves {
        let section = GuideSection::of(&curve, param(half));
        let found = next(section.map, before.as_ref());
        before = Some(found);
        let ellipse = found.widened(least);

        let here = || places.iter().skip(half).step_by(halves).zip(strands.clone());
        let (mut place, mut offset, mut width) = (Vec2::ZERO, Vec2::ZERO, 0.0);
        for (&(of_strand, taper), strand) in here() {
            place += taper * place_of(set.weights[strand]);
            offset += taper * of_strand;
            width += taper;
        }
        let over = if width > 0.0 { 1.0 / width } else { 0.0 };
        let mut fit = DiskFit { place: place * over, offset: offset * over, scale: 1.0 };
        let centre = section.map * fit.place + fit.offset;
        radii.clear();
        for (i, strand) in strands.clone().enumerate() {
            let (offset, taper) = &mut places[i * halves + half];
            let point = section.map * place_of(set.weights[strand]) + *offset;
            *offset = ellipse.disk_point(point - centre);
            if *taper > 0.0 {
                radii.push(offset.length());
            }
        }
        fit.scale = holding(&mut radii);
        fits.push(fit);
    }
    smooth_scales(&mut fits);
    for row in places.chunks_exact_mut(halves) {
        for ((place, _), fit) in row.iter_mut().zip(&fits) {
            *place /= fit.scale;
        }
    }
    Placed { end, fits, places, halves }
}

/// Smooths the scales along a wisp. Which strand is the outermost changes from one cross-section to the next; without this,
/// all strands would seem to move outward and inward.
fn smooth_scales(fits: &mut [DiskFit]) {
    for _ in 0..SMOOTHING_PASSES {
        let mut before = fits.first().map_or(1.0, |fit| fit.scale);
        for i in 0..fits.len() {
            let next = fits[(i + 1).min(fits.len() - 1)].scale;
            let here = fits[i].scale;
            fits[i].scale = 0.25 * before + 0.5 * here + 0.25 * next;
            before = here;
        }
    }
}

/// The offsets and the width of a strand at `param`, between its points `at` and `at + 1`; a width of 0 beyond its ends.
fn between(style: &Hairstyle, at: usize, param: f32) -> (Vec2, f32) {
    let set = &style.strands;
    let (low, high) = (set.guide_param[at], set.guide_param[at + 1]);
    let fraction = if high > low { ((param - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    let value = |of: &[f32]| of[at] + (of[at + 1] - of[at]) * fraction;
    let offset = Vec2::new(value(&set.offset_normal), value(&set.offset_binormal));
    let there = param >= low - 1e-3 && param <= high + 1e-3 && offset.is_finite();
    if there { (offset, value(&set.taper).max(0.0)) } else { (Vec2::ZERO, 0.0) }
}

/// The radius that holds most of the strands, which are at `radii` from the centre; never so small that nothing is left of a
/// disk.
fn holding(radii: &mut [f32]) -> f32 {
    if radii.is_empty() {
        return 1.0;
    }
    let most = ((radii.len() as f32 * WITHIN) as usize).min(radii.len() - 1);
    let (_, radius, _) = radii.select_nth_unstable_by(most, f32::total_cmp);
    if radius.is_finite() { radius.max(0.02) } else { 1.0 }
}
