//! Bits of occupied slices, and counts of fragments per slab.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::{Fragment, SLICE, TexelFilter, TexelMap, TexelMethod};
use super::{OccupancyMapsSettings, SLAB};
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};
use lovelock_base::simd::whole_part;

/// The map of [`ShadowMethod::OccupancyMaps`].
pub type OccupancyMaps = TexelMap<Occupancy>;

/// A record consists of 32-bit words: depth of the nearest fragment, depth of the farthest one, mean optical depth of a fragment
/// (floats); one bit per slice, lowest first; and one 16-bit count per slab, two per word.
///
/// Optical depth is the number of fragments before a point times the mean optical depth, so that the total is exact although
/// fragments differ. Counts saturate at 65,535; the mean then compensates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Occupancy {
    resolution: u32,
    filter: TexelFilter,
    pub(super) slices: u32,
    pub(super) slabs: u32,
}

/// Words before the bits.
const HEADER: usize = 3;

impl Occupancy {
    pub(super) fn bit_words(&self) -> usize {
        self.slices as usize / 32
    }

    /// Base-2 logarithm of the slices per slab.
    pub(super) fn slab_shift(&self) -> u32 {
        self.slices.trailing_zeros() - self.slabs.trailing_zeros()
    }
}

/// The count of slab `slab` in packed counts.
#[inline(always)]
fn count(counts: &[u32], slab: usize) -> u32 {
    counts[slab / 2] >> (slab % 2 * 16) & 0xffff
}

/// The number of bits that are set in the slab of `slice`, and of those before it; slabs have `1 << shift` bits.
#[inline(always)]
fn occupied<const BITS: usize>(bits: &[u32; BITS], slice: u32, shift: u32) -> (u32, u32) {
    let word = (slice / 32) as usize % BITS;
    let before = bits[word] & ((1 << (slice % 32)) - 1);
    if shift <= 5 {
        // A slab lies within one word.
        let first = slice >> shift << shift;
        let slab = (u32::MAX >> (32 - (1 << shift))) << (first % 32);
        return ((bits[word] & slab).count_ones(), (before & slab).count_ones());
    }
    let first = slice >> shift << (shift - 5);
    let (mut all, mut passed) = (0, before.count_ones());
    for (at, bits) in bits.iter().enumerate() {
        let ones = bits.count_ones();
        all += if at as u32 >> (shift - 5) == slice >> shift { ones } else { 0 };
        passed += if at >= first as usize && at < word { ones } else { 0 };
    }
    (all, passed)
}

/// The number of fragments in the slabs before `slab`, in `slab` itself, and in all slabs.
#[inline(always)]
fn counts_around<const WORDS: usize>(counts: &[u32; WORDS], slab: u32) -> (u32, u32, u32) {
    let (mut before, mut all) = (0, 0);
    let bits_before = 16 * slab;
    for (word, packed) in counts.iter().enumerate() {
        // Shifts: comparisons would become branches, which are unpredictable here.
        let bits = bits_before.saturating_sub(32 * word as u32).min(32);
        let passed = packed & ((1_u64 << bits) - 1) as u32;
        before += (passed & 0xffff) + (passed >> 16);
        all += (packed & 0xffff) + (packed >> 16);
    }
    (before, count(counts, slab as usize % (2 * WORDS)), all)
}

/// [`TexelMethod::depth_before`] for a record of a known number of words: the compiler unrolls loops and removes bounds checks.
#[inline(always)]
fn depth_before<const BITS: usize, const WORDS: usize>(record: &[u32], depth: f32) -> f32 {
    let Some((header, rest)) = record.split_first_chunk::<HEADER>() else { return 0.0 };
    let Some((bits, rest)) = rest.split_first_chunk::<BITS>() else { return 0.0 };
    let Some((counts, _)) = rest.split_first_chunk::<WORDS>() else { return 0.0 };
    let [near, far, mean] = header.map(f32::from_bits);
    let (slice, part) = slice_of(32 * BITS as u32, near, far, depth);
    let shift = (32 * BITS / (2 * WORDS)).trailing_zeros();
    let (before, own, all) = counts_around(counts, slice >> shift);
    let (occupied, passed) = occupied(bits, slice, shift);
    let own_bit = (bits[(slice / 32) as usize % BITS] >> (slice % 32) & 1) as f32;
    let share = (passed as f32 + part * own_bit) / occupied.max(1) as f32;
    let within = before as f32 + share * own as f32;
    // These two cases take precedence: where all fragments have the same depth, slices have no meaning. Masks, because a
    // branch would be unpredictable.
    let count = if depth >= far { all as f32 } else { within };
    f32::from_bits((count * mean).to_bits() & 0_u32.wrapping_sub(u32::from(depth > near)))
}

/// The slice, out of `slices`, that contains a depth within a texel's range, and the position in it, 0 to 1.
#[inline(always)]
fn slice_of(slices: u32, near: f32, far: f32, depth: f32) -> (u32, f32) {
    // With one fragment, or all at one depth, the range is empty and this is NaN or infinite: any slice will do. The GPU
    // multiplies by the inverse too.
    let part = (depth - near) * (1.0 / (far - near));
    let part = if part > 0.0 { part } else { 0.0 };
    let part = if part < 1.0 { part } else { 1.0 } * slices as f32;
    // The end of the range belongs to the last slice.
    let slice = (whole_part(part) as u32).min(slices - 1);
    (slice, part - slice as f32)
}

impl TexelMethod for Occupancy {
    type Cell = u32;

    const METHOD: ShadowMethod = ShadowMethod::OccupancyMaps;

    fn new(settings: &ShadowSettings) -> Self {
        let OccupancyMapsSettings { resolution, filter, slices, slabs } = settings.occupancy_maps.clamped();
        Self { resolution, filter, slices, slabs }
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
        let mut counted = 0_u32;
        for fragment in fragments.iter() {
            let (slice, _) = slice_of(self.slices, near, far, fragment.depth());
            bits[(slice / 32) as usize] |= 1 << (slice % 32);
            let slab = (slice >> self.slab_shift()) as usize;
            if count(counts, slab) < 0xffff {
                counts[slab / 2] += 1 << (slab % 2 * 16);
                counted += 1;
            }
        }
        let mean = (sum / f64::from(counted.max(1))) as f32;
        header.copy_from_slice(&[near.to_bits(), far.to_bits(), mean.to_bits()]);
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[u32], depth: f32) -> f32 {
        match (self.slices, self.slabs) {
            (128, 4) => depth_before::<4, 2>(record, depth),
            (128, 8) => depth_before::<4, 4>(record, depth),
            (128, _) => depth_before::<4, 8>(record, depth),
            (256, 4) => depth_before::<8, 2>(record, depth),
            (256, 8) => depth_before::<8, 4>(record, depth),
            (256, _) => depth_before::<8, 8>(record, depth),
            (_, 4) => depth_before::<16, 2>(record, depth),
            (_, 8) => depth_before::<16, 4>(record, depth),
            _ => depth_before::<16, 8>(record, depth),
        }
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[u32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let Some((header, rest)) = record.split_first_chunk::<HEADER>() else { return };
        let [near, far, mean] = header.map(f32::from_bits);
        let (bits, counts) = rest.split_at(self.bit_words());
        let depth = |slice: u32| near + (far - near) * (slice as f32 / self.slices as f32);
        let per_slab = 1 << self.slab_shift();
        for slab in 0..self.slabs {
            let optical_depth = count(counts, slab as usize) as f32 * mean;
            put(SLAB, [slab, slab + 1].map(|end| depth(end * per_slab)), optical_depth);
        }
        let is_set = |slice: u32| bits[(slice / 32) as usize] >> (slice % 32) & 1 != 0;
        for slice in (0..self.slices).filter(|slice| is_set(*slice)) {
            let slab = slice / per_slab;
            let occupied = (slab * per_slab..(slab + 1) * per_slab).filter(|slice| is_set(*slice)).count();
            let share = count(counts, slab as usize) as f32 * mean / occupied as f32;
            put(SLICE, [depth(slice), depth(slice + 1)], share);
        }
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
            (0, 4, (1, 0)),
            (15, 4, (1, 1)),
            (31, 4, (1, 0)),
            (32, 5, (32, 0)),
            (63, 5, (32, 31)),
            (44, 3, (8, 4)),
            (33, 6, (34, 3)),
            (64, 6, (2, 0)),
            (97, 6, (2, 1)),
            (127, 7, (36, 36)),
            (31, 7, (36, 1)),
            (127, 5, (2, 2)),
        ];
        for (slice, shift, expected) in cases {
            assert_eq!(occupied(&bits, slice, shift), expected, "{slice} of {}", 1 << shift);
        }
    }

    #[test]
    fn the_count_of_fragments_is_exact_at_the_borders_of_slabs_and_ramps_within_occupied_slices() {
        for (slices, slabs) in ALL {
            let method = method(slices, slabs);
            // The range is 0 to 1; one fragment each in the first, third and last slice, and two in the middle.
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
