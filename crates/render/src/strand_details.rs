//! Properties of strand points that do not change over time.

use std::sync::Arc;

use lovelock_base::memory::list_bytes;
use lovelock_groom::fine::{FineStrand, FineStrands, lock_numbers};
use lovelock_groom::{COLOUR_SAMPLES, ColourSamples, Hairstyle, StrandColour, StrandSet, colour_along};
use rayon::prelude::*;

/// Strands per task at least.
const STRANDS_PER_TASK: usize = 256;

/// One packed word per point, and the list of segments. Rebuilt when the hairstyle changes.
#[derive(Clone, Debug, Default)]
pub(crate) struct StrandDetails {
    style: Option<Arc<Hairstyle>>,
    /// Rises when words, colours or segments change: other hairstyles may have the same.
    pub version: u64,
    /// The number of fine strands; 0 for the stored ones.
    fine: usize,
    /// See [`pack_detail`].
    pub words: Vec<u32>,
    /// The stored strand whose colours each point has, or each fine strand; empty if all have the colour of the look.
    colour_of: Vec<u32>,
    /// First point of each segment, in the order of strands.
    pub segments: Arc<Vec<u32>>,
}

impl StrandDetails {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        [&self.words, &self.colour_of, &*self.segments].into_iter().map(list_bytes).sum()
    }

    /// Rebuilds if the hairstyle has changed. Returns whether it has.
    pub fn follow(&mut self, style: &Arc<Hairstyle>) -> bool {
        if self.fine == 0 && self.style.as_ref().is_some_and(|old| Arc::ptr_eq(old, style)) {
            return false;
        }
        self.fine = 0;
        let before = self.take_lists();
        let mut segments = Vec::with_capacity(style.strands.segments());
        self.words.resize(style.strands.points(), 0);
        let locks = lock_numbers(&style.strands);
        if !style.strands.colours.is_empty() {
            let ends = style.strands.first_point.windows(2).enumerate();
            self.colour_of.extend(ends.flat_map(|(s, ends)| (ends[0]..ends[1]).map(move |_| s as u32)));
        }
        for (s, ends) in style.strands.first_point.windows(2).enumerate() {
            let (first, end) = (ends[0], ends[1]);
            segments.extend(first..end.saturating_sub(1).max(first));
            for i in first..end {
                self.words[i as usize] = pack_detail(
                    style.strands.taper.get(i as usize).copied().unwrap_or(1.0),
                    (i - first) as f32 / (end - first - 1).max(1) as f32,
                    style.strands.shade.get(s).copied().unwrap_or(0.5),
                    (i == first, i + 1 == end),
                    locks.get(s).copied().unwrap_or(0),
                );
            }
        }
        self.finish(style, &before, segments);
        true
    }

    /// Rebuilds for all strands of a list if `style` or the list has changed. Returns whether it has.
    pub fn follow_fine(&mut self, style: &Arc<Hairstyle>, fine: &FineStrands, list_changed: bool) -> bool {
        let count = fine.strands.len();
        let same_style = || {
            self.style
                .as_ref()
                .is_some_and(|old| Arc::ptr_eq(old, style) || is_alike(&old.strands, &style.strands))
        };
        let is_whole = self.fine == count && self.words.len() == count * fine.points_per_strand;
        if !list_changed && is_whole && same_style() {
            self.style = Some(Arc::clone(style));
            return false;
        }
        let before = self.take_lists();
        let set = &style.strands;
        let points = fine.points_per_strand;
        let last = points.saturating_sub(1).max(1);
        let of_strand = |i: usize| (i * points) as u32..(i * points + points.saturating_sub(1)) as u32;
        let mut segments = Vec::with_capacity(count * points.saturating_sub(1));
        segments.extend((0..count).flat_map(of_strand));
        self.words.resize(count * points, 0);
        let locks = lock_numbers(&style.strands);
        if !set.colours.is_empty() {
            self.colour_of
                .extend(fine.strands.iter().enumerate().map(|(i, strand)| colour_parent(i, strand)));
        }
        let of_strands = self.words.par_chunks_mut(points.max(1)).zip(&fine.strands);
        of_strands.with_min_len(STRANDS_PER_TASK).for_each(|(words, strand)| {
            let ends = set.first_point.get(strand.parents[0] as usize..).unwrap_or(&[]);
            let own = match ends {
                [first, end, ..] => set.taper.get(*first as usize..*end as usize).unwrap_or(&[]),
                _ => &[],
            };
            let shade = f32::from(strand.shade) / 255.0;
            let lock = locks.get(strand.parents[0] as usize).copied().unwrap_or(0);
            for (k, word) in words.iter_mut().enumerate() {
                let along = k as f32 / last as f32;
                let at = (along * own.len().saturating_sub(1) as f32).round() as usize;
                let taper = own.get(at).copied().unwrap_or(1.0);
                *word = pack_detail(taper, along, shade, (k == 0, k == last), lock);
            }
        });
        self.fine = count;
        self.finish(style, &before, segments);
        true
    }

    /// Takes the words and the colours of points, which are made anew.
    fn take_lists(&mut self) -> [Vec<u32>; 2] {
        [&mut self.words, &mut self.colour_of].map(std::mem::take)
    }

    /// Takes the style and the segments of the lists that were made anew, and compares all with what was `before`.
    fn finish(&mut self, style: &Arc<Hairstyle>, before: &[Vec<u32>; 2], segments: Vec<u32>) {
        let [words, colour_of] = before;
        let colours = self.style.as_ref().map(|style| &style.strands.colours);
        let same_colours = colours.is_some_and(|colours| *colours == style.strands.colours);
        let same_segments = *self.segments == segments;
        if !same_segments {
            self.segments = Arc::new(segments);
        }
        let same = same_segments && same_colours && *words == self.words && *colour_of == self.colour_of;
        self.version += u64::from(!same);
        self.style = Some(Arc::clone(style));
    }

    /// The colours of strands; `None` if all have the colour of the look.
    pub fn colours(&self) -> Option<PointColours<'_>> {
        let samples = self.style.as_ref()?.strands.colours.strands();
        let known = !samples.is_empty() && !self.colour_of.is_empty();
        known.then_some(PointColours { of: &self.colour_of, samples })
    }
}

/// Whether the strands have the same constant properties, as while their guides are brushed.
fn is_alike(a: &StrandSet, b: &StrandSet) -> bool {
    a.first_point == b.first_point
        && (&a.wisp, &a.weights, &a.shade) == (&b.wisp, &b.weights, &b.shade)
        && a.taper == b.taper
        && a.colours == b.colours
}

/// The colours of strand points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PointColours<'a> {
    /// Index of the stored strand whose colours it has, for each point of stored strands or for each fine strand.
    of: &'a [u32],
    /// The colours of the stored strands.
    samples: &'a [ColourSamples],
}

impl PointColours<'_> {
    /// The colour at the fraction `along` of the strand of point `i`: what is kept of the look's, and the added absorption.
    /// `points_per_strand` is that of fine strands and 1 for stored ones.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub fn at(&self, i: usize, points_per_strand: usize, along: f32) -> [f32; 4] {
        let of = self.of.get(i / points_per_strand).map_or(usize::MAX, |&strand| strand as usize);
        match self.samples.get(of) {
            Some(samples) => colour_along(samples, along),
            None => StrandColour::BELOW.to_array(),
        }
    }

    /// The colours as words for `strand_points.wgsl`: for each entry of `of` the index of the first word of its samples, and then the
    /// samples as bits of floats.
    pub fn words(&self) -> Vec<u32> {
        let first = self.of.len() as u32;
        let each = (4 * COLOUR_SAMPLES) as u32;
        let mut words = Vec::with_capacity(self.of.len() + self.samples.len() * each as usize);
        words.extend(self.of.iter().map(|strand| first + strand * each));
        words.extend(self.samples.iter().flatten().flat_map(|colour| colour.to_array().map(f32::to_bits)));
        words
    }
}

/// The stored strand whose colours the fine strand with number `i` has: one of its parents, most often the first. So the colours of
/// neighbours mix, and no strand of another colour stands for all hair around it.
fn colour_parent(i: usize, strand: &FineStrand) -> u32 {
    let random = (i as u32).wrapping_mul(0x9e37_79b9) >> 28;
    strand.parents[[0, 1, 2][usize::from(random >= 10) + usize::from(random >= 13)]]
}

/// Taper, position along the strand (0 root, 1 tip) and shade in 8 bits each, then whether the point is the first and whether it
/// is the last of its strand, and a random number of the lock in 6 bits.
fn pack_detail(taper: f32, along: f32, shade: f32, (first, last): (bool, bool), lock: u8) -> u32 {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u32;
    byte(taper)
        | byte(along) << 8
        | byte(shade) << 16
        | u32::from(first) << 24
        | u32::from(last) << 25
        | u32::from(lock) << 26
}

#[cfg(test)]
mod tests {
    use lovelock_groom::{GroomSettings, PlainHead, StrandColours, grow};

    use super::*;

    #[test]
    fn fine_strands_keep_the_share_of_coloured_ones_and_mix_with_their_neighbours() {
        let settings = GroomSettings { wisps: 40, strands_per_wisp: 30, ..GroomSettings::default() };
        let mut style = grow(&settings, &PlainHead.scalp(32), &PlainHead).expect("hair");
        let white = [StrandColour::BELOW.faded(0.0); COLOUR_SAMPLES];
        let is_white = |strand: usize| strand * 7 % 10 < 3;
        let of = |strand| if is_white(strand) { white } else { ColourSamples::default() };
        style.strands.colours = StrandColours::new((0..style.strands.count()).map(of).collect());
        let style = Arc::new(style);
        let mut fine = FineStrands::default();
        fine.follow(&style, 12_000);
        let mut details = StrandDetails::default();
        details.follow_fine(&style, &fine, true);
        let colours = details.colours().expect("colours");
        let points = fine.points_per_strand;
        let kept: Vec<f32> =
            (0..fine.strands.len()).map(|i| colours.at(i * points + points / 2, points, 0.5)[0]).collect();
        let share = kept.iter().filter(|kept| **kept == 0.0).count() as f32 / kept.len() as f32;
        // Children of white strands that are not white.
        let stored = style.strands.count();
        let children = fine.strands.iter().zip(&kept).skip(stored);
        let of_white: Vec<f32> = children
            .filter(|(strand, _)| is_white(strand.parents[0] as usize))
            .map(|(_, kept)| *kept)
            .collect();
        let mixed = of_white.iter().filter(|kept| **kept == 1.0).count() as f32 / of_white.len() as f32;
        println!("{share} white, {mixed} of the children of white strands are not");
        assert!((share - 0.3).abs() < 0.03, "{share}");
        assert!(mixed > 0.15 && mixed < 0.4, "{mixed}");
        // Nothing is made anew for the same strands and colours, as while guides are brushed.
        let version = details.version;
        let mut again = (*style).clone();
        again.guides.x[5] += 0.01;
        assert!(!details.follow_fine(&Arc::new(again), &fine, false) && details.version == version);
        assert!(details.follow_fine(&style, &fine, true) && details.version == version, "the same again");
        let mut other = (*style).clone();
        other.strands.taper.iter_mut().for_each(|taper| *taper *= 0.5);
        assert!(details.follow_fine(&Arc::new(other), &fine, false) && details.version == version + 1);
        let mut other = (*style).clone();
        other.strands.colours = StrandColours::default();
        assert!(details.follow_fine(&Arc::new(other), &fine, false) && details.version == version + 2);
        // Stored strands have their own.
        details.follow(&style);
        let colours = details.colours().expect("colours");
        for (strand, ends) in style.strands.first_point.windows(2).enumerate() {
            let wanted = if is_white(strand) { 0.0 } else { 1.0 };
            assert_eq!(colours.at(ends[1] as usize - 1, 1, 1.0)[0], wanted);
        }
        let words = colours.words();
        let last = words[style.strands.points() - 1] as usize;
        assert_eq!(last + 4 * COLOUR_SAMPLES, words.len(), "the samples of the last strand are last");
    }
}
