//! The strands of a picture on the CPU: the stored ones, or fine ones that are made from them.

use lovelock_base::simd::Width;
use lovelock_groom::fine::{FineStrands, ParentPoints, Portion, grow_fine};
use lovelock_groom::{Hairstyle, Strands};

use crate::FrameInput;
use crate::strand_details::StrandDetails;
use crate::strand_portion::{pixels_per_metre, portion_of};
use crate::strand_values::at_points;

/// The width of a strand that is aimed at, pixels: thinner ones cost as much and can hardly be told apart.
const TARGET_PIXELS: f32 = 0.7;
/// The same in a draft.
const DRAFT_PIXELS: f32 = 1.4;
/// The length of the segments of strands that a draft aims at, pixels. Stored strands have as many as their curls need from near.
const DRAFT_SEGMENT: f32 = 2.0;
/// Strands of a draft have a multiple of so many points, so that an approaching camera does not change their number in every image.
const DRAFT_POINTS: usize = 16;
/// The most points of fine strands: about 110 bytes each with everything that drawing keeps of them.
const MAX_POINTS: u64 = 1 << 22;

/// The strands that an image draws, for other programs.
#[derive(Clone, Debug)]
pub struct DrawnHair {
    /// Their points, world space, metres.
    pub strands: Strands,
    /// Half of the width of the hairs that each point stands for, metres: what blocks light. The eye sees it as wide if
    /// `look.width_scale` and `picture.strand_opacity` are 1.
    pub half_widths: Vec<f32>,
    /// The shade of each strand, 0 to 1.
    pub shades: Vec<f32>,
}

impl DrawnHair {
    /// The strands of an image of `input` that is `height` pixels high.
    pub fn of(input: &FrameInput, height: u32) -> Self {
        let mut made = Strands::default();
        let stored = input.hair.strands(input.style, &mut made);
        let mut drawn = DrawnStrands::default();
        drawn.choose(input, height);
        drawn.grow(Width::widest(), stored, false);
        let (portion, points) =
            drawn.portion().unwrap_or_else(|| (Portion::of_all(input.style.strands.count()), 1));
        let half = 0.5 * input.look.diameter * input.look.real_hairs / portion.sum().max(1.0);
        let strands = drawn.strands(stored).clone();
        let taper = |i: usize| (drawn.details.words.get(i).copied().unwrap_or(255) & 0xff) as f32 / 255.0;
        let half_widths =
            (0..strands.points()).map(|i| half * portion.share(i / points) * taper(i)).collect();
        let shade = |&first: &u32| {
            drawn.details.words.get(first as usize).map_or(0.5, |word| (word >> 16 & 0xff) as f32 / 255.0)
        };
        let shades = strands.first_point.iter().take(strands.count()).map(shade).collect();
        Self { strands, half_widths, shades }
    }
}

/// The strands of the last picture, kept while nothing moves them.
#[derive(Debug, Default)]
pub(super) struct DrawnStrands {
    fine: FineStrands,
    parents: ParentPoints,
    strands: Strands,
    /// Constant properties of the points that are drawn, and of some more.
    pub details: StrandDetails,
    /// The part of the fine strands that is drawn, with the points of each.
    portion: Option<(Portion, usize)>,
}

impl DrawnStrands {
    /// The memory of the strands and their list, bytes.
    pub fn bytes(&self) -> u64 {
        self.fine.bytes() + self.parents.bytes() + self.strands.bytes() + self.details.bytes()
    }

    /// Chooses the strands of `input` for a picture `height` pixels high. Returns whether they are those of the last one.
    pub fn choose(&mut self, input: &FrameInput, height: u32) -> bool {
        // Makes the list of this hairstyle known, without a strand.
        self.fine.follow(input.style, 0);
        let mut most = usize::MAX;
        if input.is_draft {
            let segments = self.fine.longest_m * pixels_per_metre(input, height) / DRAFT_SEGMENT;
            // NaN is 0.
            most = (segments.clamp(1.0, 65_536.0) as usize).max(1).next_multiple_of(DRAFT_POINTS);
        }
        self.fine.limit_points(most);
        let points = self.fine.points_per_strand;
        let target = if input.is_draft { DRAFT_PIXELS } else { TARGET_PIXELS };
        let portion = portion_of(input, height, target, (points, MAX_POINTS));
        let before = std::mem::replace(&mut self.portion, portion.map(|portion| (portion, points)));
        let Some(portion) = portion else {
            self.details.follow(input.style);
            return before.is_none();
        };
        let longer = self.fine.follow(input.style, portion.drawn);
        self.details.follow_fine(input.style, &self.fine, longer);
        before.is_some_and(|(before, of)| before.drawn == portion.drawn && of == points)
    }

    /// Marks the stored strands that the chosen ones are made from, if fine ones were chosen.
    pub fn mark_parents(&self, marks: &mut [bool]) {
        let drawn = self.portion.map_or(0, |(portion, _)| portion.drawn.min(self.fine.strands.len()));
        for &parent in self.fine.strands[..drawn].iter().flat_map(|strand| &strand.parents) {
            if let Some(mark) = marks.get_mut(parent as usize) {
                *mark = true;
            }
        }
    }

    /// Makes the chosen strands from the `stored` ones of the frame, unless they are the `same` as those of the last one.
    pub fn grow(&mut self, width: Width, stored: &Strands, same: bool) {
        if let Some((portion, _)) = self.portion.filter(|_| !same) {
            grow_fine(width, &self.fine, portion.drawn, stored, &mut self.parents, &mut self.strands);
        }
    }

    /// The strands that are drawn.
    pub fn strands<'a>(&'a self, stored: &'a Strands) -> &'a Strands {
        if self.portion.is_some() { &self.strands } else { stored }
    }

    /// One number per drawn point from one per stored strand of `style`.
    pub fn at_points(&self, style: &Hairstyle, of_strands: &[f32]) -> Vec<f32> {
        let fine = self.portion.map(|(portion, points)| {
            (&self.fine.strands[..portion.drawn.min(self.fine.strands.len())], points)
        });
        at_points(&style.strands, fine, of_strands)
    }

    /// The part of the fine strands that is drawn, with the points of each; `None` for stored strands.
    pub fn portion(&self) -> Option<(Portion, usize)> {
        self.portion
    }
}
