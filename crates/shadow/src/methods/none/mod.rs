//! `none`: no shadow inside hair.

use glam::Vec3;

use crate::{ColumnMap, CpuShadow, ShadowError, ShadowInput, ShadowReport, ShadowSettings};

/// Every point receives all light.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoShadow;

impl CpuShadow for NoShadow {
    fn build(&mut self, _input: &ShadowInput, _settings: &ShadowSettings) -> Result<(), ShadowError> {
        Ok(())
    }

    fn transmittance(&self, _p: Vec3) -> f32 {
        1.0
    }

    fn transmittance_at(&self, _x: &[f32], _y: &[f32], _z: &[f32], out: &mut [f32]) {
        out.fill(1.0);
    }

    fn report(&self) -> ShadowReport {
        ShadowReport::default()
    }

    fn column_map(&self) -> Option<ColumnMap> {
        None
    }
}
