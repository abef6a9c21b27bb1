//! The strands that cast shadows: all of a hairstyle, or fewer in a draft.
//!
//! A draft draws strands by their size, which are a few thousand, but its shadow maps are built from all that the hairstyle stores. With
//! many of them that would be most of the time of the image.

use lovelock_groom::Strands;
use rayon::prelude::*;

use crate::FrameInput;

/// The most points of strands that cast shadows in a draft, about those of the default hair.
const DRAFT_POINTS: usize = 1 << 17;

/// One of how many stored strands, which have so many `points` together, casts shadows in a picture of `input`.
pub(in crate::cpu) fn caster_step(input: &FrameInput, points: usize) -> usize {
    step_of(points, input.is_draft && input.known.is_none() && input.shadow.method.sums_strands())
}

fn step_of(points: usize, is_thinned: bool) -> usize {
    if is_thinned { points.div_ceil(DRAFT_POINTS).max(1) } else { 1 }
}

/// The strands that cast shadows if one of `step` of `count` does.
pub(in crate::cpu) fn casters_of(count: usize, step: usize) -> impl Iterator<Item = usize> {
    (step / 2..count).step_by(step)
}

/// One of so many strands, evenly from all wisps.
#[derive(Debug, Default)]
pub(super) struct Casters {
    pub strands: Strands,
}

impl Casters {
    /// Takes one of `step` strands, at least two. Returns the number of strands that each stands for, by their points.
    pub fn follow(&mut self, strands: &Strands, step: usize) -> f32 {
        let points = strands.x.len().min(strands.y.len()).min(strands.z.len());
        let ends = |strand: usize| (strands.first_point[strand] as usize).min(points);
        let ranges: Vec<_> =
            casters_of(strands.count(), step).map(|strand| ends(strand)..ends(strand + 1)).collect();
        let mut first_point = Vec::with_capacity(ranges.len() + 1);
        let mut sum = 0;
        first_point.push(0);
        first_point.extend(ranges.iter().map(|range| {
            sum += range.len() as u32;
            sum
        }));
        if *self.strands.first_point != *first_point {
            self.strands.first_point = first_point.into();
        }
        let Strands { x, y, z, .. } = &mut self.strands;
        [(x, &strands.x), (y, &strands.y), (z, &strands.z)].into_par_iter().for_each(|(to, from)| {
            to.clear();
            for range in &ranges {
                to.extend_from_slice(&from[range.clone()]);
            }
        });
        if sum == 0 { 1.0 } else { points as f32 / sum as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strands of two, three and four points in turn; each point has its number in each axis.
    fn strands(count: usize) -> Strands {
        let mut first_point = vec![0];
        for strand in 0..count {
            first_point.push(first_point[strand] + 2 + strand as u32 % 3);
        }
        let axis: Vec<f32> = (0..first_point[count]).map(|i| i as f32).collect();
        Strands { first_point: first_point.into(), x: axis.clone(), y: axis.clone(), z: axis }
    }

    #[test]
    fn one_of_so_many_strands_stands_for_all() {
        let all = strands(10);
        let mut casters = Casters::default();
        let weight = casters.follow(&all, 4);
        // The strands 2 and 6.
        let expected = [5.0, 6.0, 7.0, 8.0, 18.0, 19.0];
        assert_eq!((&casters.strands.x[..], &*casters.strands.first_point), (&expected[..], &[0, 4, 6][..]));
        assert_eq!((&casters.strands.y, &casters.strands.z), (&casters.strands.x, &casters.strands.x));
        assert!((weight * 6.0 - all.points() as f32).abs() < 1e-4, "{weight}");
        assert_eq!(casters.follow(&strands(1), 3), 1.0, "fewer strands than one of so many");
        assert_eq!(casters.strands.count(), 0);
    }

    #[test]
    fn only_drafts_of_much_hair_have_fewer() {
        let (few, many) = (strands(20_000), strands(200_000));
        assert!(few.points() < DRAFT_POINTS && many.points() > 4 * DRAFT_POINTS);
        assert_eq!([&few, &many].map(|strands| step_of(strands.points(), false)), [1, 1]);
        assert_eq!(
            [&few, &many, &Strands::default()].map(|strands| step_of(strands.points(), true)),
            [1, 5, 1]
        );
    }
}
