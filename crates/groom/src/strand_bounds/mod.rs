//! Bounds of the strands at one instant, derived from the guides.
//!
//! Maps are sized on the CPU, while the strands may exist only on the GPU. The farthest strand along one direction is
//! found by a best-first search. An upper bound for each wisp follows from its guides and its longest offset, a tighter
//! one for each link from the hull of its curves. Points are evaluated only for the few links with the largest bounds.

mod polygon;
mod search;

use std::ops::Range;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use crate::frame::{locate, narrowed_guides};
use crate::{GuideFrame, Hairstyle, StrandSet, Strands, Wisp, interpolate};
use polygon::Polygon;

/// Bounds of the strands of a hairstyle at any instant; made once per hairstyle.
#[derive(Clone, Debug)]
pub struct StrandBounds {
    style: Arc<Hairstyle>,
    wisps: Vec<WispReach>,
    /// The links of each of these wisps.
    links: Vec<LinkReach>,
    /// Indices of the strands' points, sorted by wisp and link.
    points: Vec<u32>,
    longest_strand: f32,
}

/// Bounds of a wisp's strands.
#[derive(Clone, Copy, Debug)]
struct WispReach {
    wisp: Wisp,
    weights: Polygon,
    /// Longest offset, metres.
    offset: f32,
}

/// Bounds of a wisp's strands within one link.
#[derive(Clone, Copy, Debug, Default)]
struct LinkReach {
    /// Index of its first point, and the number of points.
    first: u32,
    count: u32,
    /// Longest offset, metres.
    offset: f32,
    /// Largest position along the link, as a fraction.
    end: f32,
}

impl StrandBounds {
    /// Examines all strands of a hairstyle. A hairstyle that fails [`Hairstyle::check`] has no bounds.
    pub fn new(style: &Arc<Hairstyle>) -> Self {
        let mut bounds = Self {
            style: Arc::clone(style),
            wisps: Vec::new(),
            links: Vec::new(),
            points: Vec::new(),
            longest_strand: 0.0,
        };
        if style.check().is_ok() {
            bounds.longest_strand = longest_at_rest(style);
            for &wisp in &style.wisps {
                bounds.add_wisp(&style.strands, wisp, style.guides.points_per_guide - 1);
            }
        }
        bounds
    }

    /// Length of the longest strand at rest, metres; 0 without strands.
    pub fn longest_strand(&self) -> f32 {
        self.longest_strand
    }

    /// The smallest and largest coordinates along `axes`, relative to `anchor`, of all points that [`interpolate`]
    /// makes from the guides; metres, for axes of length 1. Each end is too large by at most three hundredths of the
    /// guides' extent plus some millionths of the distance from the origin, unless very many strands end in one plane.
    ///
    /// Points that are not finite, or farther than 10 km away along an axis, are ignored. `None` if no points are left,
    /// or if the guides belong to another hairstyle.
    pub fn along(&self, frame: &GuideFrame, axes: [Vec3; 3], anchor: Vec3) -> Option<(Vec3, Vec3)> {
        let (rest, moved) = (&self.style.guides, &frame.guides);
        let is_ours = moved.points_per_guide == rest.points_per_guide
            && [&moved.x, &moved.y, &moved.z].iter().all(|axis| axis.len() == rest.x.len());
        if !is_ours || self.wisps.is_empty() {
            return None;
        }
        let sizes = search::sizes_of_guides(moved);
        let narrowed: Vec<_> = self
            .wisps
            .par_iter()
            .with_min_len(32)
            .map(|reach| narrowed_guides(moved, &reach.wisp, &self.style.widest))
            .collect();
        let mut spans = [None; 3];
        spans.par_iter_mut().zip(axes).for_each(|(span, axis)| {
            *span = search::span(self, frame, &sizes, &narrowed, axis, anchor);
        });
        let [(low_x, high_x), (low_y, high_y), (low_z, high_z)] = [spans[0]?, spans[1]?, spans[2]?];
        Some((Vec3::new(low_x, low_y, low_z), Vec3::new(high_x, high_y, high_z)))
    }

    /// Adds one wisp, unless it has no strands.
    fn add_wisp(&mut self, set: &StrandSet, wisp: Wisp, links: usize) {
        let Some(weights) = Polygon::of_wisp(set, &wisp) else { return };
        let strands = strands_of(&wisp);
        let points = set.first_point[strands.start] as usize..set.first_point[strands.end] as usize;
        let offset_of = |i: usize| {
            Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]).length()
        };
        let begin = self.links.len();
        self.links.resize(begin + links, LinkReach::default());
        let reaches = &mut self.links[begin..];
        for i in points.clone() {
            let (p, t) = locate(set.guide_param[i], links);
            let reach = &mut reaches[p];
            reach.count += 1;
            reach.end = reach.end.max(t);
            // NaN gives points that are not finite, which are ignored.
            reach.offset = reach.offset.max(offset_of(i));
        }
        // Counting sort.
        let mut next = self.points.len() as u32;
        for reach in reaches.iter_mut() {
            reach.first = next;
            next += reach.count;
            reach.count = 0;
        }
        self.points.resize(next as usize, 0);
        for i in points {
            let reach = &mut reaches[locate(set.guide_param[i], links).0];
            self.points[(reach.first + reach.count) as usize] = i as u32;
            reach.count += 1;
        }
        let offset = reaches.iter().map(|reach| reach.offset).fold(0.0, f32::max);
        self.wisps.push(WispReach { wisp, weights, offset });
    }
}

/// The indices of a wisp's strands.
fn strands_of(wisp: &Wisp) -> Range<usize> {
    let first = wisp.first_strand as usize;
    first..first + wisp.strand_count as usize
}

/// Length of the longest strand of a hairstyle at rest, metres. Strands that are not finite are ignored.
fn longest_at_rest(style: &Hairstyle) -> f32 {
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let lengths = strands.first_point.par_windows(2).map(|ends| {
        let points = ends[0] as usize + 1..ends[1] as usize;
        points.map(|i| strands.point(i).distance(strands.point(i - 1))).sum::<f32>()
    });
    lengths.filter(|length| length.is_finite()).reduce(|| 0.0, f32::max)
}
