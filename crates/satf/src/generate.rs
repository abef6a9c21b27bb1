//! The sectors of the database, made from seeded random strands.
//!
//! All sectors of a pattern, which differ in their optical depth alone, have the strands of one list: a denser sector has
//! the strands of the thinner ones and more. When a cluster that moves becomes denser, the record that it uses changes
//! little from bin to bin.

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_base::random::SplitMix64;

use crate::features::{Curl, depth_of, pattern};
use crate::layout::DEPTHS;
use crate::sector::{Sector, WIDTH};

const SEED: u32 = 1009;
/// Lists of strands from which the best is taken.
const CANDIDATES: usize = 4096;
/// Points for which the gaussian of a curled strand is averaged.
const ARC_POINTS: usize = 12;

/// A strand's middle within a sector, and where on its helix it begins.
#[derive(Clone, Copy, Debug, Default)]
struct Strand {
    at: Vec2,
    turn: f32,
}

/// Strands of a sector with `optical_depth`: 4 at the least depth of the database, 42 at the greatest.
fn strands_at(optical_depth: f32) -> usize {
    (2.0 + 14.0 * optical_depth.sqrt()).round() as usize
}

/// A sector of the database, and the standard deviation of its strands' gaussians.
pub(crate) struct Generated {
    pub(crate) sector: Sector,
    pub(crate) sigma: f32,
}

/// The sectors of pattern number `of` by rising optical depth.
pub(crate) fn sectors(of: usize) -> Vec<Generated> {
    let (curl, centre) = pattern(of);
    let counts = counts();
    let (_, list) = best(of, &counts, centre.into());
    counts.iter().enumerate().map(|(bin, &n)| of_strands(&list[..n], depth_of(bin), curl)).collect()
}

/// Numbers of strands of the bins of optical depth.
fn counts() -> [usize; DEPTHS] {
    std::array::from_fn(|bin| strands_at(depth_of(bin)))
}

/// The list whose first strands, as many as `counts` says, have centroids near `centre`, and the largest distance of those.
fn best(of: usize, counts: &[usize; DEPTHS], centre: Vec2) -> (f32, Vec<Strand>) {
    let mut random = SplitMix64::of_stream(SEED, of as u64);
    let most = counts[DEPTHS - 1];

    let mut best = (f32::INFINITY, Vec::new());
    for _ in 0..CANDIDATES {
        let list: Vec<Strand> = (0..most).map(|_| strand(&mut random, centre)).collect();
        let worst = farthest(&list, counts, centre);
        if worst < best.0 {
            best = (worst, list);
        }
    }
    best
}

/// A strand anywhere within the widest box around `centre` that fits into the sector, so that the mean is `centre`.
fn strand(random: &mut SplitMix64, centre: Vec2) -> Strand {
    let half = centre.min(1.0 - centre);
    let at = centre + half * Vec2::new(random.signed(), random.signed());
    Strand { at, turn: random.angle() }
}

/// The largest distance of the centroid of the first `counts` strands from `centre`.
fn farthest(list: &[Strand], counts: &[usize], centre: Vec2) -> f32 {
    let mut sum = Vec2::ZERO;
    let mut worst = 0.0_f32;
    let mut next = 0;
    for &count in counts {
        sum += list[next..count].iter().map(|strand| strand.at).sum::<Vec2>();
        next = count;
        worst = worst.max((sum / count as f32).distance(centre));
    }
    worst
}

fn of_strands(list: &[Strand], optical_depth: f32, curl: Curl) -> Generated {
    let each = optical_depth / list.len() as f32;
    // The strands' widths, side by side, cover the sector's width as often as the optical depth says.
    let sigma = Sector::sigma(0.5 * each * WIDTH);
    let mut sector = Sector::empty();
    for strand in list {
        let (radius, angle) = match curl {
            Curl::Straight => {
                sector.add(strand.at, sigma, each);
                continue;
            }
            Curl::Loose => (0.2, TAU / 3.0),
            Curl::Tight => (0.35, TAU),
        };
        // The centroid of an arc is not the centre of its circle.
        let middle = strand.turn + 0.5 * angle;
        let inward = (0.5 * angle).sin() / (0.5 * angle);
        for i in 0..ARC_POINTS {
            let turn = strand.turn + angle * (i as f32 + 0.5) / ARC_POINTS as f32;
            let from_middle = radius * (Vec2::from_angle(turn) - inward * Vec2::from_angle(middle));
            let at = strand.at + from_middle / Vec2::new(WIDTH, 1.0);
            sector.add(reflected(at), sigma, each / ARC_POINTS as f32);
        }
    }
    Generated { sector, sigma }
}

/// A point whose t lies beyond an edge, reflected back into the sector.
fn reflected(at: Vec2) -> Vec2 {
    let t = at.y.abs();
    Vec2::new(at.x, if t > 1.0 { 2.0 - t } else { t })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::PATTERNS;

    #[test]
    fn sectors_have_the_features_of_their_bins() {
        for of in 0..PATTERNS {
            let centre = Vec2::from(pattern(of).1);
            let off = best(of, &counts(), centre).0;
            assert!(off < 0.06, "{of}: {off}");
            for (bin, made) in sectors(of).iter().enumerate() {
                let (depth, wanted) = (made.sector.optical_depth(), depth_of(bin));
                assert!((depth - wanted).abs() < 1e-4 * wanted, "{of} {bin}: {depth} for {wanted}");
                // The gaussians of strands and arcs reach over the border in s, which wraps: the grid's centroid is nearer
                // to the middle than that of the strands' positions.
                let off = made.sector.centroid().distance(centre);
                assert!(off < 0.2, "{of} {bin}: {off} from {centre:?}");
            }
        }
    }
}
