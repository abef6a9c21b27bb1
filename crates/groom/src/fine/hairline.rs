//! The edge of the hair: fine strands there are often short, fine hairs that begin a little outside, so that hair ends gradually on the
//! skin and not in a line.

use std::collections::HashMap;

use glam::Vec3;
use lovelock_base::random::SplitMix64;

use super::strand::{FineStrand, Shape};

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
const MOST_STRANDS: usize = 20_000;

/// How near a stored strand is to the edge of the hair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Edge {
    /// 0 inside, 1 at the edge.
    pub share: f32,
    /// The strand's length at rest, metres.
    pub length: f32,
}

/// The edge of hair with these shapes of strands at rest.
pub(super) fn edges_of(shapes: &[Shape]) -> Vec<Edge> {
    if shapes.len() > MOST_STRANDS {
        return vec![Edge::default(); shapes.len()];
    }
    let cell = |p: Vec3| (p / AROUND).floor().to_array().map(|x| x as i32);
    let mut cells: HashMap<[i32; 3], Vec<Vec3>> = HashMap::new();
    for shape in shapes.iter().filter(|shape| shape[0].is_finite()) {
        cells.entry(cell(shape[0])).or_default().push(shape[0]);
    }
    let edge = |&[root, middle, tip]: &Shape| {
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
        // A few roots say nothing of an edge.
        let off = if count < 6 { 0.0 } else { sum.length() / (count as f32 * AROUND) };
        let along = ((off - BEYOND_MIDDLE[0]) / (BEYOND_MIDDLE[1] - BEYOND_MIDDLE[0])).clamp(0.0, 1.0);
        let length = root.distance(middle) + middle.distance(tip);
        let share = along * along * (3.0 - 2.0 * along);
        if length.is_finite() { Edge { share, length } } else { Edge::default() }
    };
    shapes.iter().map(edge).collect()
}

/// Makes some of the children of a strand at the edge short hairs.
pub(super) fn shorten(strand: &mut FineStrand, edge: Edge, random: &mut SplitMix64) {
    if random.unit() >= SHORT_HAIRS * edge.share {
        return;
    }
    let length = LENGTHS[0] + (LENGTHS[1] - LENGTHS[0]) * random.unit() * random.unit();
    let fraction = length / edge.length.max(1e-3);
    if fraction >= f32::from(strand.length) / 65_535.0 {
        return;
    }
    strand.length = (fraction * 65_535.0) as u16;
    for weights in &mut strand.weights {
        // The neighbours of a root at the edge lie inside, so negative weights lead outside.
        let weight = (-OUTSIDE * random.unit() * 127.0) as i8;
        *weights = [weight; 4];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strands of 20 cm on a square of 10 cm, 4 mm apart.
    fn square() -> Vec<Shape> {
        let at = |i: i32| Vec3::new((i % 26) as f32 * 0.004, 0.0, (i / 26) as f32 * 0.004);
        (0..26 * 26).map(|i| [0.0, 0.1, 0.2].map(|y| at(i) + Vec3::Y * y)).collect()
    }

    #[test]
    fn only_roots_near_the_edge_are_at_the_edge() {
        let shapes = square();
        let edges = edges_of(&shapes);
        for (shape, edge) in shapes.iter().zip(&edges) {
            let inside =
                [shape[0].x, 0.1 - shape[0].x, shape[0].z, 0.1 - shape[0].z].into_iter().fold(1.0, f32::min);
            assert!((edge.length - 0.2).abs() < 1e-5);
            if inside < 0.001 {
                assert!(edge.share > 0.8, "{inside}: {edge:?}");
            } else if inside > AROUND {
                assert!(edge.share < 0.01, "{inside}: {edge:?}");
            }
        }
        assert!(edges_of(&[]).is_empty());
        assert_eq!(edges_of(&[[Vec3::NAN; 3]]), [Edge::default()]);
        assert_eq!(edges_of(&shapes[..1])[0].share, 0.0, "a single strand");
    }

    #[test]
    fn short_hairs_are_short_and_rare_inside() {
        let mut random = SplitMix64::of_stream(1, 2);
        let mut count = |share: f32, length: f32| {
            let edge = Edge { share, length };
            let mut short = 0;
            for _ in 0..1000 {
                let mut strand =
                    FineStrand { length: u16::MAX, weights: [[3; 4]; 2], ..FineStrand::default() };
                shorten(&mut strand, edge, &mut random);
                if strand.length < u16::MAX {
                    short += 1;
                    assert!(f32::from(strand.length) / 65_535.0 * length <= LENGTHS[1] + 1e-4);
                    assert!(strand.weights.as_flattened().iter().all(|w| *w <= 0));
                } else {
                    assert_eq!(strand.weights, [[3; 4]; 2]);
                }
            }
            short
        };
        assert_eq!(count(0.0, 0.2), 0);
        assert!((540..660).contains(&count(1.0, 0.2)));
        assert!((240..360).contains(&count(0.5, 0.2)));
        assert_eq!(count(1.0, 0.004), 0, "hair that is shorter already");
    }
}
