//! The published loop: density, transmittance and filter with one array each, on one thread, in single precision.
//!
//! This is the program that the paper describes in sections 3.1 to 3.3, for `lovelock bench voxel-map`, which times
//! [`VoxelMap`](super::VoxelMap) against it. [`mod@super::reference`] is the same map in double precision, for tests.

use glam::Vec3;
use lovelock_groom::Strands;

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
#[derive(Clone, Debug)]
pub struct PublishedMap {
    resolution: usize,
    order: CellOrder,
    density: Vec<f32>,
    transmittance: Vec<f32>,
}

impl PublishedMap {
    /// An empty map of `resolution` cells along each edge.
    pub fn new(resolution: u32, order: CellOrder) -> Self {
        let resolution = resolution as usize;
        let cells = resolution.pow(3);
        Self { resolution, order, density: vec![0.0; cells], transmittance: vec![1.0; cells] }
    }

    /// Fills the density and composites the transmittance of every cell. One point adds an optical depth of `depth_per_point` to its
    /// cell (the paper's `f ds`). The lattice must have the resolution of this map and contain all points.
    pub fn build(&mut self, lattice: &Lattice, strands: &Strands, depth_per_point: f32) {
        let n = self.resolution;
        self.density.fill(0.0);
        for point in 0..strands.points() {
            let (cell, _) = cell(lattice, strands.point(point));
            let at = self.address(cell);
            self.density[at] += 1.0;
        }
        let first = lattice.wrapped(lattice.first)[0];
        for j in 0..n {
            for k in 0..n {
                let mut previous = 1.0;
                // From the slice closest to the light to the farthest one, across the border of the modulo.
                for i in (first..n).chain(0..first) {
                    let at = self.address([i, j, k]);
                    let density = self.density[at];
                    if density != 0.0 {
                        previous *= (-density * depth_per_point).exp();
                    }
                    self.transmittance[at] = previous;
                }
            }
        }
    }

    /// The filtered transmittance of every point of `strands`: trilinear, between a cell and those before it on each axis.
    pub fn filter(&self, lattice: &Lattice, strands: &Strands, out: &mut [f32]) {
        for (point, out) in out.iter_mut().enumerate() {
            let (cell, within) = cell(lattice, strands.point(point));
            let before = cell.map(|c| if c == 0 { self.resolution - 1 } else { c - 1 });
            let [x, y, z] = within.to_array();
            let mut sum = 0.0;
            for (i, a) in [(before[0], 1.0 - x), (cell[0], x)] {
                for (j, b) in [(before[1], 1.0 - y), (cell[1], y)] {
                    for (k, c) in [(before[2], 1.0 - z), (cell[2], z)] {
                        sum += a * b * c * self.transmittance[self.address([i, j, k])];
                    }
                }
            }
            *out = sum;
        }
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
            map.build(&lattice, &strands, depth);
            let mut out = vec![0.0; strands.points()];
            map.filter(&lattice, &strands, &mut out);
            for (point, found) in out.into_iter().enumerate() {
                let wanted = reference.transmittance(strands.point(point));
                assert!((f64::from(found) - wanted).abs() < 2e-5, "{order:?}, {point}: {found}, {wanted}");
                shaded += usize::from(wanted < 0.5);
            }
        }
        assert!(shaded > 100, "{shaded} points are dark");
    }
}
