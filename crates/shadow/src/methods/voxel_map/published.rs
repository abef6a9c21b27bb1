//! The published loop: density, transmittance and filter with one array each, in single precision.
//!
//! This is the program that the paper describes in sections 3.1 to 3.3, for `lovelock bench voxel-map`, which times
//! [`VoxelMap`](super::VoxelMap) against it. It uses the threads of the current pool; on one it is the plain loop.
//! [`mod@super::reference`] is the same map in double precision, for tests.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::Vec3;
use lovelock_groom::Strands;
use rayon::prelude::*;

use super::lattice::Lattice;

/// The order in which cells are stored. Both give the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellOrder {
    /// `[i][j][k]`, as the paper writes its indices. A step along the light is a step of N² cells in memory.
    AsPrinted,
    /// `[j][k][i]`: the cells of a column along the light follow each other in memory.
    AlongLight,
}

/// The map of the published loop. Its memory is reused from build to build: two numbers per cell.
#[derive(Debug)]
pub struct PublishedMap {
    resolution: usize,
    order: CellOrder,
    /// Points per cell.
    density: Vec<AtomicU32>,
    /// The bits of an `f32`. Columns are interleaved, so threads that write different columns share the list; a relaxed store is a
    /// plain one.
    transmittance: Vec<AtomicU32>,
}

/// Points per task where there are several threads.
const POINTS_PER_TASK: usize = 4096;

impl PublishedMap {
    /// An empty map of `resolution` cells along each edge.
    pub fn new(resolution: u32, order: CellOrder) -> Self {
        let resolution = resolution as usize;
        let cells = |value: u32| (0..resolution.pow(3)).map(|_| AtomicU32::new(value)).collect();
        Self { resolution, order, density: cells(0), transmittance: cells(1.0_f32.to_bits()) }
    }

    /// Fills the density and composites the transmittance of every cell. One point adds an optical depth of `depth_per_point` to its
    /// cell (the paper's `f ds`). The lattice must have the resolution of this map and contain all points.
    pub fn build(&mut self, lattice: &Lattice, strands: &Strands, depth_per_point: f32) {
        let n = self.resolution;
        if rayon::current_num_threads() == 1 {
            self.density.iter_mut().for_each(|count| *count.get_mut() = 0);
            for point in 0..strands.points() {
                let at = self.address(cell(lattice, strands.point(point)).0);
                *self.density[at].get_mut() += 1;
            }
        } else {
            self.density.par_iter_mut().with_min_len(n * n).for_each(|count| *count.get_mut() = 0);
            // Counts are whole numbers, which add up to the same in any order.
            (0..strands.points()).into_par_iter().with_min_len(POINTS_PER_TASK).for_each(|point| {
                let at = self.address(cell(lattice, strands.point(point)).0);
                self.density[at].fetch_add(1, Ordering::Relaxed);
            });
        }
        let first = lattice.wrapped(lattice.first)[0];
        (0..n).into_par_iter().for_each(|j| {
            for k in 0..n {
                let mut previous = 1.0_f32;
                // From the slice closest to the light to the farthest one, across the border of the modulo.
                for i in (first..n).chain(0..first) {
                    let at = self.address([i, j, k]);
                    let density = self.density[at].load(Ordering::Relaxed);
                    if density != 0 {
                        previous *= (-(density as f32) * depth_per_point).exp();
                    }
                    self.transmittance[at].store(previous.to_bits(), Ordering::Relaxed);
                }
            }
        });
    }

    /// The filtered transmittance of every point of `strands`: trilinear, between a cell and those before it on each axis.
    pub fn filter(&self, lattice: &Lattice, strands: &Strands, out: &mut [f32]) {
        out.par_iter_mut().with_min_len(POINTS_PER_TASK).enumerate().for_each(|(point, out)| {
            let (cell, within) = cell(lattice, strands.point(point));
            let before = cell.map(|c| if c == 0 { self.resolution - 1 } else { c - 1 });
            let [x, y, z] = within.to_array();
            let mut sum = 0.0;
            for (i, a) in [(before[0], 1.0 - x), (cell[0], x)] {
                for (j, b) in [(before[1], 1.0 - y), (cell[1], y)] {
                    for (k, c) in [(before[2], 1.0 - z), (cell[2], z)] {
                        let at = self.address([i, j, k]);
                        sum += a * b * c * f32::from_bits(self.transmittance[at].load(Ordering::Relaxed));
                    }
                }
            }
            *out = sum;
        });
    }

    fn address(&self, [i, j, k]: [usize; 3]) -> usize {
        let n = self.resolution;
        match self.order {
            CellOrder::AsPrinted => (i * n + j) * n + k,
            CellOrder::AlongLight => (j * n + k) * n + i,
        }
    }
}

/// The cell of `p` by the paper's mapping Ψ, and the position within it, 0 to 1. Coordinates are rounded as in
/// [`VoxelMap`](super::VoxelMap), so that a point on the border of two cells falls into the same one.
fn cell(lattice: &Lattice, p: Vec3) -> ([usize; 3], Vec3) {
    let window = lattice.window_from_world(p);
    let whole = window.floor();
    (lattice.wrapped(lattice.first + whole.as_ivec3()), window - whole)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::voxel_map::reference::{Addressing, DenseMap};
    use crate::voxel_map::{VoxelDeposit, VoxelFilter};
    use crate::{LightFrame, ShadowInput, ShadowSettings};

    #[test]
    fn both_orders_give_the_transmittance_of_the_reference_in_double_precision() {
        let mut strands = Strands { first_point: Arc::from([0, 1000]), ..Strands::default() };
        for point in 0..1000 {
            let turn = point as f32 * 2.399_963;
            strands.x.push(0.1 * turn.cos());
            strands.y.push(1.0 + 0.1 * (0.37 * turn).sin());
            strands.z.push(0.1 * (1.9 * turn).sin());
        }
        let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        let input = ShadowInput {
            strands: &strands,
            strand_width: 1e-3,
            extinction_scale: 0.15,
            light,
            anchor: Vec3::Y,
            maps: 1,
            projected: None,
        };
        let mut settings = ShadowSettings::default();
        settings.voxel_map.resolution = 32;
        settings.voxel_map.deposit = VoxelDeposit::PointCount;
        settings.voxel_map.filter = VoxelFilter::Paper;
        settings.voxel_map.point_extinction = 200.0;
        let reference = DenseMap::build(&input, &settings, Addressing::Psi);
        let lattice = reference.lattice;
        let depth = input.extinction_scale * settings.voxel_map.point_extinction * lattice.cell_size;
        let mut shaded = 0;
        for order in [CellOrder::AsPrinted, CellOrder::AlongLight] {
            let mut map = PublishedMap::new(lattice.resolution, order);
            // Twice, because a build starts from the memory of the one before.
            map.build(&lattice, &strands, depth);
            let mut on = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let mut out = vec![0.0_f32; strands.points()];
                pool.install(|| {
                    map.build(&lattice, &strands, depth);
                    map.filter(&lattice, &strands, &mut out);
                });
                out
            };
            let out = on(1);
            assert!(on(3) == out, "{order:?}: the same on several threads");
            for (point, found) in out.into_iter().enumerate() {
                let wanted = reference.transmittance(strands.point(point));
                assert!((f64::from(found) - wanted).abs() < 2e-5, "{order:?}, {point}: {found}, {wanted}");
                shaded += usize::from(wanted < 0.5);
            }
        }
        assert!(shaded > 100, "{shaded} points are dark");
    }
}
