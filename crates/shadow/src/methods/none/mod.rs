//! `none`: no shadow inside hair.

use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderPart, ShaderSource, wgpu};

use super::method::{MapKind, Method};
use super::texels::TexelFrame;
use crate::gpu::{
    GpuColumns, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup, projected_constant, wgsl,
};
use crate::{ColumnMap, CpuShadow, RayStructure, ShadowError, ShadowInput, ShadowReport, ShadowSettings};

pub(super) static METHOD: Method = Method {
    id: "none",
    label: "None",
    description: "No shadow inside hair: every strand receives all light.",
    source: None,
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::None,
    size: |_| None,
    words: |_| 0,
    marks: &[],
    settings: |_| None,
    // Compared over the texels of the exact method.
    footprint: |input, settings, bounds| TexelFrame::new(input, settings.exact.clamped().resolution, bounds),
    counts_points: |_| false,
    sums_strands: false,
    in_world: false,
    cpu: || Box::new(NoShadow),
    gpu: |_, gpu, projected| Ok(Box::new(GpuNoShadow::new(gpu, projected)?)),
    shaders: GpuNoShadow::shaders,
};

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

    fn along_ray(&self, _p: Vec3) -> RayStructure {
        RayStructure::default()
    }
}

const QUERY: ShaderPart = wgsl!("methods/none/", "query.wgsl");

/// The method on the GPU.
#[derive(Debug)]
pub(crate) struct GpuNoShadow(PointLookup);

impl GpuNoShadow {
    pub(crate) fn new(gpu: &Gpu, projected: bool) -> Result<Self, GpuError> {
        PointLookup::new(gpu, &[QUERY], false, &[projected_constant(projected)]).map(Self)
    }

    pub(crate) fn shaders() -> Vec<(String, ShaderSource)> {
        PointLookup::shaders(&[QUERY], false)
    }
}

impl GpuShadow for GpuNoShadow {
    fn build(
        &mut self,
        _slot: usize,
        _gpu: &Gpu,
        _commands: &mut Commands,
        _input: &GpuShadowInput,
        _settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        self.0.run(gpu, commands, slot, &[], targets);
    }

    fn columns_size(&self, _slot: usize) -> u32 {
        0
    }

    fn columns(
        &mut self,
        _map: (usize, usize),
        _gpu: &Gpu,
        _commands: &mut Commands,
        _into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        None
    }

    fn report(&self, _slot: usize) -> ShadowReport {
        ShadowReport::default()
    }

    fn map_words(&self, _slot: usize, _gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        Ok(Vec::new())
    }
}
