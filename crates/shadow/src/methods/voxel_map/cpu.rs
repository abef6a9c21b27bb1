//! The quick voxel map.

use glam::Vec3;

use super::reference::{Addressing, DenseMap};
use crate::{ColumnMap, CpuShadow, ShadowInput, ShadowReport, ShadowSettings};

/// A voxel map; everything is lit until it is built.
#[derive(Clone, Debug, Default)]
pub struct VoxelMap {
    dense: Option<DenseMap>,
}

impl CpuShadow for VoxelMap {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) {
        self.dense = Some(DenseMap::build(input, settings, Addressing::Window));
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.dense.as_ref().map_or(1.0, |dense| dense.transmittance(p) as f32)
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.transmittance(Vec3::new(x[i], y[i], z[i]));
        }
    }

    fn report(&self) -> ShadowReport {
        ShadowReport::default()
    }

    fn column_map(&self) -> Option<ColumnMap> {
        None
    }
}
