//! The voxel map in plain code: dense, in double precision, one loop per step of the paper.
//!
//! Tests compare the fast map with it. It also implements the addressing of the paper. It is for tests and benchmarks only,
//! because building one takes a hundred times as long.

use glam::{IVec3, Vec3};
use lovelock_groom::Strands;

use super::lattice::Lattice;
use super::samples::{sample_at, sample_count};
use super::{VoxelDeposit, VoxelFilter};
use crate::bounds::Bounds;
use crate::cpu::safe_extinction;
use crate::{ShadowInput, ShadowSettings};

/// How cells are addressed. Both give the same shadow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Addressing {
    /// By coordinates in the window.
    Window,
    /// By the paper's mapping Ψ, modulo *N*.
    Psi,
}

/// A dense map of optical depth.
#[derive(Clone, Debug)]
pub struct DenseMap {
    /// The placement of its cells.
    pub lattice: Lattice,
    /// Optical depth added to each cell, `[i][j][k]` with i along the light.
    pub density: Vec<f64>,
    /// Optical depth from the light to the back face of each cell, the cell included.
    pub depth: Vec<f64>,
    addressing: Addressing,
    filter: VoxelFilter,
}

impl DenseMap {
    /// Builds the map of `input`.
    pub fn build(input: &ShadowInput, settings: &ShadowSettings, addressing: Addressing) -> Self {
        let Strands { x, y, z, .. } = input.strands;
        let bounds = Bounds::of_points(x, y, z, &input.light, input.anchor);
        Self::build_in(Lattice::new(input, &settings.voxel_map, &bounds), input, settings, addressing)
    }

    /// Builds the map of `input` in a given window.
    pub fn build_in(
        lattice: Lattice,
        input: &ShadowInput,
        settings: &ShadowSettings,
        addressing: Addressing,
    ) -> Self {
        let n = lattice.resolution as usize;
        let filter = settings.voxel_map.filter;
        let mut map =
            Self { lattice, density: vec![0.0; n * n * n], depth: vec![0.0; n * n * n], addressing, filter };
        let scale = f64::from(safe_extinction(input.extinction_scale));
        match settings.voxel_map.deposit {
            VoxelDeposit::Length => {
                map.deposit_lengths(input, scale, |step| f64::from(step.y).hypot(f64::from(step.z)));
            }
            VoxelDeposit::Isotropic => {
                map.deposit_lengths(input, scale, |step| {
                    step.as_dvec3().length() * std::f64::consts::FRAC_PI_4
                });
            }
            VoxelDeposit::PointCount => {
                let f = scale * f64::from(settings.voxel_map.point_extinction);
                map.deposit_points(input, f * f64::from(lattice.cell_size));
            }
        }
        map.sum_along_light();
        map
    }

    /// `τ_cell = s_ext Σ w ℓ sinθ / ds²`: in cells, the area across the light is 1 and `ℓ sinθ` is the length of the
    /// segment's projection along the light. `counted` of a segment is the length that counts, in cells.
    fn deposit_lengths(&mut self, input: &ShadowInput, scale: f64, counted: impl Fn(Vec3) -> f64) {
        let per_cell = scale * f64::from(input.strand_width.max(0.0)) / f64::from(self.lattice.cell_size);
        for ends in input.strands.first_point.windows(2) {
            for point in ends[0] as usize + 1..ends[1] as usize {
                let from = self.lattice.window_from_world(input.strands.point(point - 1));
                let to = self.lattice.window_from_world(input.strands.point(point));
                if !(self.lattice.holds(from) && self.lattice.holds(to)) {
                    continue;
                }
                let step = to - from;
                let count = sample_count((step.x * step.x + step.y * step.y + step.z * step.z).sqrt());
                let projected = counted(step);
                for sample in 0..count {
                    self.add(
                        from + step * sample_at(sample, 1.0 / count as f32),
                        per_cell * projected / f64::from(count),
                    );
                }
            }
        }
    }

    /// The paper's `κ ds = f d ds` with *d* the number of points in the cell.
    fn deposit_points(&mut self, input: &ShadowInput, depth: f64) {
        for point in 0..input.strands.points() {
            let p = self.lattice.window_from_world(input.strands.point(point));
            if self.lattice.holds(p) {
                self.add(p, depth);
            }
        }
    }

    fn add(&mut self, p: Vec3, depth: f64) {
        // Rounding must not move hair into the empty cells at the border.
        let cell = p.floor().as_ivec3().clamp(IVec3::ONE, IVec3::splat(self.lattice.resolution as i32 - 2));
        let at = self.address(cell);
        self.density[at] += depth;
    }

    /// The index at which a cell of the window is stored.
    fn address(&self, cell: IVec3) -> usize {
        let n = self.lattice.resolution as usize;
        let [i, j, k] = match self.addressing {
            Addressing::Window => cell.to_array().map(|c| c as usize),
            Addressing::Psi => self.lattice.wrapped(self.lattice.first + cell),
        };
        (i * n + j) * n + k
    }

    /// Equation 3 in terms of optical depth: an inclusive sum from the slice nearest to the light to the farthest.
    fn sum_along_light(&mut self) {
        let n = self.lattice.resolution as i32;
        for j in 0..n {
            for k in 0..n {
                let mut depth = 0.0;
                for i in 0..n {
                    let at = self.address(IVec3::new(i, j, k));
                    depth += self.density[at];
                    self.depth[at] = depth;
                }
            }
        }
    }

    /// Optical depth at the back face of a cell of the window: 0 before the first slice, and that of the border beside the
    /// window.
    fn back_face(&self, i: i32, j: i32, k: i32) -> f64 {
        let last = self.lattice.resolution as i32 - 1;
        if i < 0 {
            return 0.0;
        }
        self.depth[self.address(IVec3::new(i, j, k).clamp(IVec3::ZERO, IVec3::splat(last)))]
    }

    /// Filtered transmittance at `p`.
    pub fn transmittance(&self, p: Vec3) -> f64 {
        if self.filter == VoxelFilter::Closest && p.is_finite() {
            return self.unfiltered(p);
        }
        let n = self.lattice.resolution as f32;
        let p = self.lattice.window_from_world(p);
        if !p.is_finite() {
            return 1.0;
        }
        let along = p.x.clamp(0.0, n);
        let i = (along as i32).min(n as i32 - 1);
        let along = f64::from(along) - f64::from(i);
        // The value of a column belongs to its centre; as printed in the paper, to its far edge.
        let lead = if self.filter == VoxelFilter::Paper { 1.0 } else { 0.5 };
        let (y, z) = ((p.y - lead).clamp(-1.0, n), (p.z - lead).clamp(-1.0, n));
        let (j, k) = (y.floor(), z.floor());
        let mut sum = 0.0;
        for (dj, wj) in [(0, 1.0 - f64::from(y - j)), (1, f64::from(y - j))] {
            for (dk, wk) in [(0, 1.0 - f64::from(z - k)), (1, f64::from(z - k))] {
                let front = self.back_face(i - 1, j as i32 + dj, k as i32 + dk);
                let back = self.back_face(i, j as i32 + dj, k as i32 + dk);
                sum += wj
                    * wk
                    * if self.filter == VoxelFilter::Paper {
                        (1.0 - along) * (-front).exp() + along * (-back).exp()
                    } else {
                        (-(front + (back - front) * along)).exp()
                    };
            }
        }
        sum
    }

    /// Unfiltered transmittance of the cell that contains `p`.
    fn unfiltered(&self, p: Vec3) -> f64 {
        let cell = self.lattice.window_from_world(p).floor().as_ivec3();
        (-self.back_face(cell.x, cell.y, cell.z)).exp()
    }
}
