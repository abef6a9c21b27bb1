//! The edge of the hair: fine strands there are often short, fine hairs that begin a little outside, so that hair ends gradually on the
//! skin and not in a line.

use std::collections::HashMap;

use glam::Vec3;
use lovelock_base::random::SplitMix64;
use rayon::prelude::*;

use super::strand::FineStrand;

/// Roots within this distance tell whether a root is at the edge, metres.
const AROUND: f32 = 0.014;
/// Distances of the mean of the roots around, as fractions of [`AROUND`], at which the edge begins and where it is. The mean over half a
/// disc lies `4 / (3 pi)` of its radius from the centre.
const BEYOND_MIDDLE: [f32; 2] = [0.12, 0.4];
/// Share of short hairs among the fine strands at the edge itself.
const SHORT_HAIRS: f32 = 0.6;
/// Lengths of short hairs, metres.
const LENGTHS: [f32; 2] = [0.005, 0.028];
/// How far short hairs begin outside of their parent at most, as a weight on the way from each of its two neighbours.
const OUTSIDE: f32 = 0.5;
/// Hairstyles of more strands have the hairline that they were groomed with.
const MAX_STRANDS: usize = 20_000;

/// Fewer roots nearby do not tell an edge from a gap between strands.
const FEWEST_ROOTS: u32 = 6;

/// How near each strand with one of these roots is to the edge of the hair: 0 inside, 1 at the edge.
pub(super) fn edges_of(roots: &[Vec3]) -> Vec<f32> {
    if roots.len() > MAX_STRANDS {
        return vec![0.0; roots.len()];
    }
    let cell = |p: Vec3| (p / AROUND).floor().to_array().map(|x| x as i32);
    let mut cells: HashMap<[i32; 3], Vec<Vec3>> = HashMap::new();
    for &root in roots.iter().filter(|root| root.is_finite()) {
        cells.entry(cell(root)).or_default().push(root);
    }
    let edge = |&root: &Vec3| {
        let (mut sum, mut count) = (Vec3::ZERO, 0_u32);
        let at = cell(root);
        for near in (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]) {
            let key: [i32; 3] = std::array::from_fn(|axis| at[axis].saturating_add(near[axis]));
            for other in cells.get(&key).into_iter().flatten() {
                let offset = *other - root;
                if offset.length_squared() < AROUND * AROUND {
                    sum += offset;
                    count += 1;
                }
            }
        }
        let off = if count < FEWEST_ROOTS { 0.0 } else { sum.length() / (count as f32 * AROUND) };
        let along = ((off - BEYOND_MIDDLE[0]) / (BEYOND_MIDDLE[1] - BEYOND_MIDDLE[0])).clamp(0.0, 1.0);
        along * along * (3.0 - 2.0 * along)
    };
    roots.par_iter().map(edge).collect()
}

/// Makes some of the children of a strand at the edge short hairs. `edge` is how near it is to the edge.
pub(super) fn shorten(strand: &mut FineStrand, edge: f32, random: &mut SplitMix64) {
    if random.unit() >= SHORT_HAIRS * edge {
        return;
    }
    let length = LENGTHS[0] + (LENGTHS[1] - LENGTHS[0]) * random.unit() * random.unit();
    strand.length = (length / FineStrand::SHORT_METRES * 65_535.0) as u16;
    strand.is_short = 1;
    for weights in &mut strand.weights {
        // The neighbours of a root at the edge lie inside, so negative weights lead outside.
        let weight = (-OUTSIDE * random.unit() * 127.0) as i8;
        *weights = [weight; 4];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Roots on a square of 10 cm, 4 mm apart.
    fn square() -> Vec<Vec3> {
        let at = |i: i32| Vec3::new((i % 26) as f32 * 0.004, 0.0, (i / 26) as f32 * 0.004);
        (0..26 * 26).map(at).collect()
    }

    #[test]
    fn only_roots_near_the_edge_are_at_the_edge() {
        let roots = square();
        for (root, edge) in roots.iter().zip(edges_of(&roots)) {
            let inside = [root.x, 0.1 - root.x, root.z, 0.1 - root.z].into_iter().fold(1.0, f32::min);
            if inside < 0.001 {
                assert!(edge > 0.8, "{inside}: {edge}");
            } else if inside > AROUND {
                assert!(edge < 0.01, "{inside}: {edge}");
            }
        }
        assert!(edges_of(&[]).is_empty());
        assert_eq!(edges_of(&[Vec3::NAN]), [0.0]);
        assert_eq!(edges_of(&roots[..1]), [0.0], "a single strand");
    }

    #[test]
    fn short_hairs_are_short_and_rare_inside() {
        let mut random = SplitMix64::of_stream(1, 2);
        let mut count = |edge: f32| {
            let mut short = 0;
            for _ in 0..1000 {
                let mut strand =
                    FineStrand { length: u16::MAX, weights: [[3; 4]; 2], ..FineStrand::default() };
                shorten(&mut strand, edge, &mut random);
                if strand.is_short == 1 {
                    short += 1;
                    assert!(strand.fraction(|| 0.2) * 0.2 <= LENGTHS[1] + 1e-4);
                    assert!(strand.weights.as_flattened().iter().all(|w| *w <= 0));
                    assert_eq!(strand.fraction(|| 0.004), 1.0, "hair that is shorter already");
                    assert!([0.0, f32::NAN].map(|length| strand.fraction(|| length)) == [1.0; 2]);
                } else {
                    assert_eq!((strand.weights, strand.length), ([[3; 4]; 2], u16::MAX));
                }
            }
            short
        };
        assert_eq!(count(0.0), 0);
        assert!((540..660).contains(&count(1.0)));
        assert!((240..360).contains(&count(0.5)));
    }
}
