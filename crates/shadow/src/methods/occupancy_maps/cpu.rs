//! Occupied slices as bits, and counts of fragments a slab.

use super::super::texels::{Fragment, TexelFilter, TexelMap, TexelMethod};
use super::OccupancyMapsSettings;
use crate::{ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::OccupancyMaps`].
pub type OccupancyMaps = TexelMap<Occupancy>;

/// A record is, in words of 32 bits: depth of the nearest fragment, depth of the farthest, mean optical depth of a
/// fragment (floats); a bit for each slice, from the lowest on; and a count of 16 bits for each slab, two a word.
///
/// Optical depth is the number of fragments before a point times their mean, so that all of them together are exact
/// though fragments differ. Counts stop at 65,535; the mean then makes up for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occupancy {
    resolution: u32,
    filter: TexelFilter,
    slices: u32,
    slabs: u32,
}

/// Words before the bits.
const HEADER: usize = 3;

impl Occupancy {
    fn bit_words(&self) -> usize {
        self.slices as usize / 32
    }

    /// The slice of a depth within a texel's range, and where in it the depth lies, 0 to 1.
    #[inline]
    fn slice(&self, near: f32, far: f32, depth: f32) -> (u32, f32) {
        // With one fragment, or all at one depth, there is no range.
        let part = if far > near { ((depth - near) / (far - near)).clamp(0.0, 1.0) } else { 0.0 };
        let slices = part * self.slices as f32;
        // The end of the range belongs to the last slice.
        let slice = (slices as u32).min(self.slices - 1);
        (slice, slices - slice as f32)
    }

    fn slices_per_slab(&self) -> u32 {
        self.slices / self.slabs
    }
}

/// The number in slab `slab` of packed counts.
#[inline]
fn count(counts: &[u32], slab: usize) -> u32 {
    counts[slab / 2] >> (slab % 2 * 16) & 0xffff
}

/// The bits of a slab that are set, and those of them that lie before `slice`, which is one of the slab's.
#[inline]
fn occupied(bits: &[u32], first: u32, per_slab: u32, slice: u32) -> (u32, u32) {
    if per_slab <= 32 {
        // A slab lies within one word.
        let slab = bits[(first / 32) as usize] >> (first % 32) & (u32::MAX >> (32 - per_slab));
        return (slab.count_ones(), (slab & ((1 << (slice - first)) - 1)).count_ones());
    }
    let (mut all, mut before) = (0, 0);
    for word in first / 32..(first + per_slab) / 32 {
        let slab = bits[word as usize];
        let mask = (1_u64 << slice.saturating_sub(word * 32).min(32)) - 1;
        all += slab.count_ones();
        before += (slab & mask as u32).count_ones();
    }
    (all, before)
}

/// Fragments of the slabs before `slab`, of itself, and of all.
#[inline]
fn counts_around<const WORDS: usize>(counts: &[u32], slab: u32) -> (u32, u32, u32) {
    let (mut before, mut own, mut all) = (0, 0, 0);
    for (word, packed) in counts[..WORDS].iter().enumerate() {
        for half in 0..2 {
            let (at, count) = (2 * word as u32 + half, packed >> (16 * half) & 0xffff);
            before += if at < slab { count } else { 0 };
            own += if at == slab { count } else { 0 };
            all += count;
        }
    }
    (before, own, all)
}

impl TexelMethod for Occupancy {
    type Cell = u32;

    const METHOD: ShadowMethod = ShadowMethod::OccupancyMaps;

    fn new(settings: &ShadowSettings) -> Self {
        let OccupancyMapsSettings { filter, .. } = settings.occupancy_maps;
        Self {
            resolution: settings.occupancy_maps.safe_resolution(),
            filter,
            slices: settings.occupancy_maps.safe_slices(),
            slabs: settings.occupancy_maps.safe_slabs(),
        }
    }

    fn resolution(&self) -> u32 {
        self.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.filter
    }

    fn cells(&self) -> usize {
        HEADER + self.bit_words() + self.slabs as usize / 2
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [u32]) {
        let (mut near, mut far, mut sum) = (1.0_f32, 0.0_f32, 0.0_f64);
        for fragment in fragments.iter() {
            near = near.min(fragment.depth());
            far = far.max(fragment.depth());
            sum += f64::from(fragment.optical_depth());
        }
        let (header, rest) = record.split_at_mut(HEADER);
        rest.fill(0);
        let (bits, counts) = rest.split_at_mut(self.bit_words());
        let per_slab = self.slices_per_slab();
        let mut counted = 0_u32;
        for fragment in fragments.iter() {
            let (slice, _) = self.slice(near, far, fragment.depth());
            bits[(slice / 32) as usize] |= 1 << (slice % 32);
            let slab = (slice / per_slab) as usize;
            if count(counts, slab) < 0xffff {
                counts[slab / 2] += 1 << (slab % 2 * 16);
                counted += 1;
            }
        }
        let mean = (sum / f64::from(counted.max(1))) as f32;
        header.copy_from_slice(&[near.to_bits(), far.to_bits(), mean.to_bits()]);
    }

    #[inline]
    fn depth_before(&self, _fragments: &[Fragment], record: &[u32], depth: f32) -> f32 {
        let [near, far, mean] = [record[0], record[1], record[2]].map(f32::from_bits);
        let (bits, counts) = record[HEADER..].split_at(self.bit_words());
        let (slice, part) = self.slice(near, far, depth);
        let per_slab = self.slices_per_slab();
        let slab = slice / per_slab;
        let (before, own, all) = match self.slabs {
            4 => counts_around::<2>(counts, slab),
            8 => counts_around::<4>(counts, slab),
            _ => counts_around::<8>(counts, slab),
        };
        let (occupied, passed) = occupied(bits, slab * per_slab, per_slab, slice);
        let own_bit = (bits[(slice / 32) as usize] >> (slice % 32) & 1) as f32;
        let share = (passed as f32 + part * own_bit) / occupied.max(1) as f32;
        let within = before as f32 + share * own as f32;
        // These two come before all else: where all fragments lie at one depth, slices have no meaning. Chosen rather
        // than returned early, as no branch could be foretold here.
        let count = if depth >= far { all as f32 } else { within };
        if depth <= near { 0.0 } else { count * mean }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(slices: u32, slabs: u32) -> Occupancy {
        let mut settings = ShadowSettings::default();
        settings.occupancy_maps = OccupancyMapsSettings { slices, slabs, ..settings.occupancy_maps };
        Occupancy::new(&settings)
    }

    fn filled(method: &Occupancy, fragments: &[(f32, f32)]) -> Vec<u32> {
        let mut record = vec![0; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        record
    }

    const ALL: [(u32, u32); 9] =
        [(128, 4), (128, 8), (128, 16), (256, 4), (256, 8), (256, 16), (512, 4), (512, 8), (512, 16)];

    fn ones(bits: &[u32]) -> u32 {
        bits.iter().map(|word| word.count_ones()).sum()
    }

    #[test]
    fn bits_of_a_slab_are_counted() {
        let bits = [0x8000_0001, 0xffff_ffff, 0, 0x0000_0003];
        let cases = [
            (0, 16, 0, (1, 0)),
            (0, 16, 15, (1, 1)),
            (16, 16, 31, (1, 0)),
            (32, 32, 32, (32, 0)),
            (32, 32, 63, (32, 31)),
            (40, 8, 44, (8, 4)),
            (0, 64, 33, (34, 3)),
            (64, 64, 64, (2, 0)),
            (64, 64, 97, (2, 1)),
            (0, 128, 127, (36, 36)),
            (0, 128, 31, (36, 1)),
        ];
        for (first, per_slab, slice, expected) in cases {
            assert_eq!(occupied(&bits, first, per_slab, slice), expected, "{first}, {per_slab}, {slice}");
        }
    }

    #[test]
    fn the_count_of_fragments_is_exact_at_the_borders_of_slabs_and_ramps_within_occupied_slices() {
        for (slices, slabs) in ALL {
            let method = method(slices, slabs);
            // The range is 0 to 1; a fragment in each of the first, third and last slices, and two in the middle.
            let width = 1.0 / slices as f32;
            let at = [0.0, 2.5 * width, 0.5 + 0.25 * width, 0.5 + 0.75 * width, 1.0];
            let record = filled(&method, &at.map(|z| (z, 0.5)));
            let before = |depth: f32| method.depth_before(&[], &record, depth) / 0.5;
            assert_eq!(before(0.0), 0.0);
            assert_eq!(before(0.5 * width), 0.5, "a ramp within the point's own slice");
            assert_eq!((before(1.0 * width), before(2.0 * width)), (1.0, 1.0), "none in an empty one");
            assert_eq!(before(3.0 * width), 2.0);
            assert_eq!(before(0.5), 2.0, "the border of slabs");
            assert!((before(0.5 + 0.5 * width) - 3.0).abs() < 1e-4, "two in one slice ramp together");
            assert_eq!(before(0.5 + width), 4.0);
            assert!((before(1.0 - 0.5 * width) - 4.5).abs() < 1e-4);
            assert_eq!((before(1.0), before(2.0)), (5.0, 5.0));
        }
    }

    #[test]
    fn the_farthest_fragment_lies_in_the_last_slice() {
        for (slices, slabs) in ALL {
            let method = method(slices, slabs);
            let record = filled(&method, &[(0.25, 1.0), (0.75, 1.0)]);
            let bits = &record[HEADER..HEADER + method.bit_words()];
            assert_eq!(ones(bits), 2);
            assert_eq!(bits[bits.len() - 1] >> 31, 1);
        }
    }

    #[test]
    fn fragments_at_one_depth_shadow_what_lies_behind_them_and_nothing_else() {
        for (slices, slabs) in ALL {
            let method = method(slices, slabs);
            for n in [1, 3] {
                let record = filled(&method, &vec![(0.5, 0.25); n]);
                assert_eq!(method.depth_before(&[], &record, 0.499), 0.0);
                assert_eq!(method.depth_before(&[], &record, 0.5), 0.0);
                assert_eq!(method.depth_before(&[], &record, 0.501), 0.25 * n as f32);
            }
        }
    }

    #[test]
    fn counts_that_overflow_keep_the_whole_exact() {
        let method = method(128, 8);
        let mut fragments = vec![(0.1, 1e-3); 100_000];
        fragments.push((0.9, 1e-3));
        let record = filled(&method, &fragments);
        let behind = method.depth_before(&[], &record, 2.0);
        // Rounding of a float of this size.
        assert!((behind - 100.001).abs() < 1e-4, "{behind}");
    }
}
