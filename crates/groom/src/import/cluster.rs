//! Groups strands into wisps by root position and shape.
//!
//! k-means (Lloyd 1982) with k-means++ seeding (Arthur and Vassilvitskii 2007), on features that consist of several
//! points along each strand with weights that fall toward the tip. For large grooms a sample determines the groups and
//! the other strands join the nearest one, so the time grows linearly with the number of strands.

use glam::Vec3;
use rayon::prelude::*;

use super::PlacedGroom;
use lovelock_base::random::SplitMix64;

/// Position along a strand (fraction of its length) and weight. Wisps separate at the tips as well as at the roots, but
/// a misplaced root is the most visible.
const PLACES: [(f32, f32); 5] = [(0.0, 1.0), (0.25, 0.6), (0.5, 0.5), (0.75, 0.4), (1.0, 0.35)];
/// Numbers per feature: three per point, padded to a multiple of the CPU's vector lanes.
const DIMENSIONS: usize = 16;
/// Centres that are compared side by side in vector lanes.
const LANES: usize = 8;
/// Strands that determine the centres.
const SAMPLES: usize = 4096;
const ITERATIONS: usize = 6;

type Feature = [f32; DIMENSIONS];

/// Groups the strands of `groom` into at most `wisps` groups of strand indices in ascending order. No group is empty,
/// and every strand is in exactly one.
pub(super) fn cluster(groom: &PlacedGroom, wisps: usize, seed: u32) -> Vec<Vec<u32>> {
    let strands = groom.strands();
    let features: Vec<Feature> =
        (0..strands).into_par_iter().with_min_len(256).map(|i| feature(groom.strand(i))).collect();
    // At least four samples per centre.
    let stride = strands.div_ceil(SAMPLES.max(4 * wisps)).max(1);
    let samples: Vec<Feature> = features.iter().step_by(stride).copied().collect();
    let mut centres = Centres::new(&seeds(&samples, wisps, seed));
    for _ in 0..ITERATIONS {
        let nearest = centres.nearest(&samples);
        let mut sums = vec![([0.0_f64; DIMENSIONS], 0_u32); centres.count];
        for (sample, &centre) in samples.iter().zip(&nearest) {
            let (sum, count) = &mut sums[centre as usize];
            sum.iter_mut().zip(sample).for_each(|(sum, &value)| *sum += f64::from(value));
            *count += 1;
        }
        for (centre, (sum, count)) in sums.iter().enumerate() {
            // A centre without samples keeps its position, and may gain some in the next iteration.
            if *count > 0 {
                centres.set(centre, &sum.map(|value| (value / f64::from(*count)) as f32));
            }
        }
    }
    let mut groups = vec![Vec::new(); centres.count];
    for (strand, &centre) in centres.nearest(&features).iter().enumerate() {
        groups[centre as usize].push(strand as u32);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// The points of a strand, metres, each multiplied by its weight.
fn feature(strand: &[Vec3]) -> Feature {
    let mut feature = [0.0; DIMENSIONS];
    let length = super::length(strand);
    let (mut link, mut before) = (0, 0.0);
    for (i, (fraction, weight)) in PLACES.into_iter().enumerate() {
        let wanted = fraction * length;
        let mut step = strand[link].distance(strand[link + 1]);
        while link + 2 < strand.len() && before + step < wanted {
            before += step;
            link += 1;
            step = strand[link].distance(strand[link + 1]);
        }
        let along = if step > 0.0 { ((wanted - before) / step).clamp(0.0, 1.0) } else { 0.0 };
        let place = strand[link].lerp(strand[link + 1], along);
        feature[3 * i..3 * i + 3].copy_from_slice(&(weight * place).to_array());
    }
    feature
}

/// Initial centres: samples drawn with a probability proportional to the squared distance from the earlier ones.
fn seeds(samples: &[Feature], wanted: usize, seed: u32) -> Vec<Feature> {
    let mut rng = SplitMix64::of_stream(seed, 0x3157);
    let first = (rng.unit() * samples.len() as f32) as usize;
    let mut seeds = vec![samples[first.min(samples.len() - 1)]];
    let mut nearest = vec![f32::INFINITY; samples.len()];
    while seeds.len() < wanted {
        let newest = seeds[seeds.len() - 1];
        nearest.par_iter_mut().zip(samples).with_min_len(2048).for_each(|(nearest, sample)| {
            let distance: f32 = sample.iter().zip(&newest).map(|(a, b)| (a - b) * (a - b)).sum();
            *nearest = nearest.min(distance);
        });
        let total: f64 = nearest.iter().map(|&square| f64::from(square)).sum();
        // There are fewer different strands than groups; the remaining groups would be empty.
        if total <= 0.0 {
            break;
        }
        let mut left = f64::from(rng.unit()) * total;
        let drawn = nearest.iter().position(|&square| {
            left -= f64::from(square);
            left < 0.0
        });
        // Rounding may leave a small remainder at the end; then the farthest sample is chosen.
        let drawn = drawn.unwrap_or_else(|| {
            (0..nearest.len()).fold(0, |best, i| if nearest[i] > nearest[best] { i } else { best })
        });
        seeds.push(samples[drawn]);
    }
    seeds
}

/// Centres of groups in blocks of eight. The last block is padded with centres at infinity.
struct Centres {
    count: usize,
    blocks: Vec<[[f32; LANES]; DIMENSIONS]>,
}

impl Centres {
    fn new(centres: &[Feature]) -> Self {
        let blocks = vec![[[f32::INFINITY; LANES]; DIMENSIONS]; centres.len().div_ceil(LANES)];
        let mut this = Self { count: centres.len(), blocks };
        for (index, centre) in centres.iter().enumerate() {
            this.set(index, centre);
        }
        this
    }

    fn set(&mut self, index: usize, centre: &Feature) {
        for (lanes, &value) in self.blocks[index / LANES].iter_mut().zip(centre) {
            lanes[index % LANES] = value;
        }
    }

    /// The nearest centre of each feature; of equally near ones, the first.
    fn nearest(&self, features: &[Feature]) -> Vec<u32> {
        features.par_iter().with_min_len(64).map(|feature| self.nearest_to(feature)).collect()
    }

    fn nearest_to(&self, feature: &Feature) -> u32 {
        // Finds the best of each lane, then the best of the lanes.
        let mut best = [f32::INFINITY; LANES];
        let mut best_block = [0_u32; LANES];
        for (block, index) in self.blocks.iter().zip(0_u32..) {
            let mut distance = [0.0_f32; LANES];
            for (centres, &value) in block.iter().zip(feature) {
                for lane in 0..LANES {
                    let difference = centres[lane] - value;
                    distance[lane] += difference * difference;
                }
            }
            for lane in 0..LANES {
                if distance[lane] < best[lane] {
                    best[lane] = distance[lane];
                    best_block[lane] = index;
                }
            }
        }
        let lane = (1..LANES).fold(0, |winner, lane| {
            let nearer = best[lane] < best[winner];
            let as_near_but_before = best[lane] == best[winner] && best_block[lane] < best_block[winner];
            if nearer || as_near_but_before { lane } else { winner }
        });
        best_block[lane] * LANES as u32 + lane as u32
    }
}
