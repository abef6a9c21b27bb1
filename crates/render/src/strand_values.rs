//! Numbers of strands as numbers of the points that are drawn.

use lovelock_groom::StrandSet;
use lovelock_groom::fine::FineStrand;

/// One number per drawn point from one per stored strand. `fine` are the fine strands that are drawn in place of the stored ones, with the
/// points of each. Strands without a number have none.
pub(crate) fn at_points(
    set: &StrandSet,
    fine: Option<(&[FineStrand], usize)>,
    of_strands: &[f32],
) -> Vec<f32> {
    let mut out = Vec::new();
    if let Some((strands, points)) = fine {
        out.reserve(strands.len() * points);
        for strand in strands {
            out.extend(std::iter::repeat_n(strand.blend(of_strands), points));
        }
    } else {
        out.reserve(set.points());
        for (strand, ends) in set.first_point.windows(2).enumerate() {
            let value = of_strands.get(strand).copied().unwrap_or(f32::NAN);
            out.extend(std::iter::repeat_n(value, ends[1].saturating_sub(ends[0]) as usize));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_the_number_of_their_strand_and_fine_strands_lie_between() {
        let set = StrandSet { first_point: vec![0, 2, 5], ..StrandSet::default() };
        assert_eq!(at_points(&set, None, &[0.25, 1.0]), [0.25, 0.25, 1.0, 1.0, 1.0]);
        assert!(at_points(&set, None, &[0.25])[2].is_nan());
        let stored = FineStrand { parents: [1; 3], ..FineStrand::default() };
        // 0.2 + 1 * (1 - 0.2) * 0 + 64/127 * (1 - 0.2)
        let between = FineStrand {
            parents: [0, 0, 1],
            weights: [[127, 0, 0, 0], [64, 0, 0, 0]],
            ..FineStrand::default()
        };
        let found = at_points(&set, Some((&[stored, between], 3)), &[0.2, 1.0]);
        assert_eq!(found[..3], [1.0; 3]);
        let expected = 0.2 + 0.8 * 64.0 / 127.0;
        assert!(
            found[3..].iter().all(|value| (value - expected).abs() < 1e-6) && found.len() == 6,
            "{found:?}"
        );
    }
}
