//! Density of strands that were projected from a light: the twin of the same branch of `deposit.wgsl`.

use std::ops::Range;

use glam::Vec3;
use lovelock_groom::Strands;

use super::deposit::{Deposit, MAX_PER_SAMPLE, highest_inside};
use super::grid::Grid;
use super::samples::{sample_at, sample_count};
use crate::ProjectedStrands;
use crate::perspective::{MAX_WIDENING, Ray};

/// Adds strands to `grid`. Returns the number of samples.
pub(super) fn deposit_projected(
    deposit: &Deposit,
    (strands, projected): (&Strands, &ProjectedStrands),
    range: Range<usize>,
    grid: &mut Grid,
) -> u64 {
    let lattice = &deposit.lattice;
    let highest = highest_inside(lattice.resolution);
    // Rounding must not move hair into the empty cells at the border.
    let held = |p: Vec3| p.clamp(Vec3::ONE, Vec3::splat(highest));
    let add = |grid: &mut Grid, p: Vec3, depth: f32| {
        let [i, j, k] = p.to_array().map(|c| c as u32);
        let depth = (depth + 0.5).min(MAX_PER_SAMPLE) as u32;
        deposit.add(grid, deposit.layout.address(i, j, k), depth);
    };
    let mut samples = 0;
    for ends in strands.first_point[range.start..=range.end].windows(2) {
        let (first, end) = (ends[0] as usize, ends[1] as usize);
        if deposit.by_point {
            for point in first..end {
                let p = lattice.window_from_world(strands.point(point));
                if lattice.holds(p) {
                    let denser = projected.widths[point].min(MAX_WIDENING * MAX_WIDENING);
                    add(grid, held(p), deposit.depth * denser);
                    samples += 1;
                }
            }
            continue;
        }
        for point in first..end.saturating_sub(1) {
            let ends = [point, point + 1].map(|point| strands.point(point));
            let [from, to] = ends.map(|p| lattice.window_from_world(p));
            if !(lattice.holds(from) && lattice.holds(to)) {
                continue;
            }
            let ray = Ray::new(projected, ends, point);
            let start = held(from);
            let step = held(to) - start;
            let across = step.y * step.y + step.z * step.z;
            let count = sample_count((step.x * step.x + across).sqrt());
            let inverse = 1.0 / count as f32;
            let counted = [deposit.squares[0] * (step.x * step.x), deposit.squares[1] * across];
            for sample in 0..count {
                let t = sample_at(sample, inverse).min(1.0);
                let [distance, width] = ray.at(t);
                // The axes of projected strands are those of their coordinates.
                let along = lattice.window_from_world(Vec3::new(distance, 0.0, 0.0)).x;
                let place = start + step * t;
                // Lengths on the plane are as much longer as widths; lengths along the light are not.
                let each = deposit.depth * (counted[0] * (width * width) + counted[1]).sqrt() * inverse;
                add(grid, held(Vec3::new(along, place.y, place.z)), each * width);
            }
            samples += u64::from(count);
        }
    }
    samples
}
