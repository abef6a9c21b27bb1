//! Moves roots onto the skin without letting neighbouring strands cross.

use glam::{IVec3, Vec3};
use rayon::prelude::*;

use super::surface::Surface;

/// Neighbours within about this distance move together, metres.
const REACH: f32 = 0.008;
/// Up to the first distance from the part of the skin where hair grows, only that part counts; beyond the second, the
/// whole head; in between, a blend. Metres.
const EDGE: [f32; 2] = [0.005, 0.02];

/// The skin of a head: the part where hair grows, and all of it.
pub(super) struct Skin {
    pub(super) grows: Surface,
    pub(super) whole: Surface,
}

impl Skin {
    /// The point of the skin for a root. Continuous in `root`, up to the folds of the head.
    fn closest(&self, root: Vec3) -> Vec3 {
        let grows = self.grows.closest(root);
        // The whole head is at most this far away, so its closest point is within the edge as well.
        if 2.0 * grows.distance(root) < EDGE[0] {
            return grows;
        }
        let whole = self.whole.closest(root);
        let beyond = ((grows.distance(whole) - EDGE[0]) / (EDGE[1] - EDGE[0])).clamp(0.0, 1.0);
        let mixed = grows.lerp(whole, beyond * beyond * (3.0 - 2.0 * beyond));
        if beyond > 0.0 && beyond < 1.0 { self.whole.closest(mixed) } else { mixed }
    }
}

/// The shift that carries each root to the skin: the gaps averaged over neighbours, then the remaining gap.
///
/// The average preserves the order of neighbours where the skin curves away beneath them. The remaining gaps are small
/// and perpendicular to the skin.
pub(super) fn shifts(roots: &[Vec3], skin: &Skin) -> Vec<Vec3> {
    let gaps: Vec<Vec3> = roots.par_iter().map(|&root| skin.closest(root) - root).collect();
    let cells = Cells::of(roots, &gaps);
    roots
        .par_iter()
        .map(|&root| {
            let smooth = cells.mean_near(root);
            let moved = root + smooth;
            smooth + (skin.closest(moved) - moved)
        })
        .collect()
}

/// Mean gap and position of the roots in each cell of a grid, sorted by cell.
struct Cells {
    keys: Vec<IVec3>,
    places: Vec<Vec3>,
    gaps: Vec<Vec3>,
    counts: Vec<f32>,
}

impl Cells {
    fn of(roots: &[Vec3], gaps: &[Vec3]) -> Self {
        let mut order: Vec<([i32; 3], u32)> =
            roots.iter().zip(0..).map(|(&root, i)| (cell(root).to_array(), i)).collect();
        order.sort_unstable();
        let mut cells = Self { keys: Vec::new(), places: Vec::new(), gaps: Vec::new(), counts: Vec::new() };
        for run in order.chunk_by(|a, b| a.0 == b.0) {
            let count = run.len() as f32;
            let mean = |values: &[Vec3]| run.iter().map(|&(_, i)| values[i as usize]).sum::<Vec3>() / count;
            cells.keys.push(IVec3::from(run[0].0));
            cells.places.push(mean(roots));
            cells.gaps.push(mean(gaps));
            cells.counts.push(count);
        }
        cells
    }

    /// The mean gap around `root`, with weights that fall to zero at two cells' distance.
    fn mean_near(&self, root: Vec3) -> Vec3 {
        let middle = cell(root);
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for x in -1..=1 {
            for y in -1..=1 {
                // Cells that differ only in z are adjacent in the order.
                let low = (middle + IVec3::new(x, y, -1)).to_array();
                let high = (middle + IVec3::new(x, y, 1)).to_array();
                let start = self.keys.partition_point(|key| key.to_array() < low);
                for i in start..self.keys.len() {
                    if self.keys[i].to_array() > high {
                        break;
                    }
                    let near = 1.0 - self.places[i].distance_squared(root) / (4.0 * REACH * REACH);
                    if near > 0.0 {
                        let weight = near * near * self.counts[i];
                        sum += weight * self.gaps[i];
                        weights += weight;
                    }
                }
            }
        }
        if weights > 0.0 { sum / weights } else { Vec3::ZERO }
    }
}

fn cell(root: Vec3) -> IVec3 {
    (root / REACH).floor().as_ivec3()
}
