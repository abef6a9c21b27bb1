//! Bounds of the strands of one instant, told from the guides.
//!
//! Maps are sized on the processor while the strands may live on the device. Along one direction the farthest strand is
//! searched for best first: what a wisp may reach at most is told from its guides and its longest offset; then what each
//! link of it may reach, from the hull of its curves; and of the few links that may reach farthest, the points are made.

mod polygon;
mod search;

use std::ops::Range;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use crate::frame::locate;
use crate::{GuideFrame, Hairstyle, StrandSet, Strands, Wisp, interpolate};
use polygon::Polygon;

/// What bounds the strands of a hairstyle at any instant; made once for a hairstyle.
#[derive(Clone, Debug)]
pub struct StrandBounds {
    style: Arc<Hairstyle>,
    wisps: Vec<WispReach>,
    /// Of each of them, each link.
    links: Vec<LinkReach>,
    /// Points of the strands in the order of wisps and links.
    points: Vec<u32>,
    longest_strand: f32,
}

/// What a wisp's strands reach.
#[derive(Clone, Copy, Debug)]
struct WispReach {
    wisp: Wisp,
    weights: Polygon,
    /// Longest offset, metres.
    offset: f32,
}

/// What a wisp's strands reach within one link.
#[derive(Clone, Copy, Debug, Default)]
struct LinkReach {
    /// Index of its first point, and how many there are.
    first: u32,
    count: u32,
    /// Longest offset, metres.
    offset: f32,
    /// Largest fraction of the link.
    end: f32,
}

impl StrandBounds {
    /// Looks through all strands of a hairstyle. One that fails [`Hairstyle::check`] has no bounds.
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
                bounds.look_through(&style.strands, wisp, style.guides.points_per_guide - 1);
            }
        }
        bounds
    }

    /// Length of the longest strand at rest, metres; 0 where there is none.
    pub fn longest_strand(&self) -> f32 {
        self.longest_strand
    }

    /// The smallest and the largest coordinates along `axes`, relative to `anchor`, of all points that [`interpolate`]
    /// makes of the guides; metres, for axes of length 1. At each end they are too large by three hundredths of the guides'
    /// extent at most, and some millionths of the distance from the origin, unless very many strands end in one plane.
    ///
    /// Points that are not finite, or farther than 10 km away along an axis, are left out. `None` where nothing is left, or
    /// where the guides are not those of the hairstyle.
    pub fn along(&self, frame: &GuideFrame, axes: [Vec3; 3], anchor: Vec3) -> Option<(Vec3, Vec3)> {
        let (rest, moved) = (&self.style.guides, &frame.guides);
        let is_ours = moved.points_per_guide == rest.points_per_guide
            && [&moved.x, &moved.y, &moved.z].iter().all(|axis| axis.len() == rest.x.len());
        if !is_ours || self.wisps.is_empty() {
            return None;
        }
        let sizes = search::sizes_of_guides(moved);
        let mut spans = [None; 3];
        spans.par_iter_mut().zip(axes).for_each(|(span, axis)| {
            *span = search::span(self, frame, &sizes, axis, anchor);
        });
        let [(low_x, high_x), (low_y, high_y), (low_z, high_z)] = [spans[0]?, spans[1]?, spans[2]?];
        Some((Vec3::new(low_x, low_y, low_z), Vec3::new(high_x, high_y, high_z)))
    }

    /// Adds one wisp, unless it has no strands.
    fn look_through(&mut self, set: &StrandSet, wisp: Wisp, links: usize) {
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
            // What is no number makes points that are none, which are left out.
            reach.offset = reach.offset.max(offset_of(i));
        }
        // Sorted by counting.
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

/// Length of the longest strand of a hairstyle at rest, metres. Strands that are not finite count for nothing.
fn longest_at_rest(style: &Hairstyle) -> f32 {
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    let lengths = strands.first_point.par_windows(2).map(|ends| {
        let points = ends[0] as usize + 1..ends[1] as usize;
        points.map(|i| strands.point(i).distance(strands.point(i - 1))).sum::<f32>()
    });
    lengths.filter(|length| length.is_finite()).reduce(|| 0.0, f32::max)
}
