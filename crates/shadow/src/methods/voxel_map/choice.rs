//! The voxel map with the slices of the settings.

use glam::Vec3;
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderSource, wgpu};

use super::VoxelSlices;
use super::adaptive::{AdaptiveMap, Columns};
use super::cpu::VoxelMap;
use super::gpu::GpuVoxelMap;
use crate::gpu::{GpuColumns, GpuList, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets};
use crate::methods::texels::TexelShadow;
use crate::{ColumnMap, CpuShadow, RayStructure, ShadowError, ShadowInput, ShadowReport, ShadowSettings};

/// [`ShadowMethod::VoxelMap`](crate::ShadowMethod::VoxelMap) on the CPU.
#[derive(Clone, Debug)]
pub(super) enum VoxelShadow {
    Uniform(VoxelMap),
    Adaptive(AdaptiveMap),
}

impl Default for VoxelShadow {
    fn default() -> Self {
        Self::Uniform(VoxelMap::default())
    }
}

impl VoxelShadow {
    fn map(&self) -> &dyn CpuShadow {
        match self {
            Self::Uniform(map) => map,
            Self::Adaptive(map) => map,
        }
    }
}

impl CpuShadow for VoxelShadow {
    fn build(&mut self, input: &ShadowInput, settings: &ShadowSettings) -> Result<(), ShadowError> {
        // The old map is freed before the new one is made.
        match (&self, settings.voxel_map.slices) {
            (Self::Adaptive(_), VoxelSlices::Uniform) => *self = Self::default(),
            (Self::Uniform(_), VoxelSlices::Adaptive) => *self = Self::Adaptive(AdaptiveMap::default()),
            _ => {}
        }
        match self {
            Self::Uniform(map) => map.build(input, settings),
            Self::Adaptive(map) => map.build(input, settings),
        }
    }

    fn transmittance(&self, p: Vec3) -> f32 {
        self.map().transmittance(p)
    }

    fn transmittance_at(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        self.map().transmittance_at(x, y, z, out);
    }

    fn report(&self) -> ShadowReport {
        self.map().report()
    }

    fn column_map(&self) -> Option<ColumnMap> {
        self.map().column_map()
    }

    fn along_ray(&self, p: Vec3) -> RayStructure {
        self.map().along_ray(p)
    }
}

/// [`ShadowMethod::VoxelMap`](crate::ShadowMethod::VoxelMap) on the GPU.
#[derive(Debug)]
pub(super) struct GpuVoxelShadow {
    uniform: GpuVoxelMap,
    /// Compiled when it is first used.
    adaptive: Option<TexelShadow<Columns>>,
    is_adaptive: bool,
    projected: bool,
}

impl GpuVoxelShadow {
    /// For the strands themselves, or for projected ones.
    pub(super) fn new(gpu: &Gpu, projected: bool) -> Result<Self, GpuError> {
        Ok(Self { uniform: GpuVoxelMap::new(gpu, projected)?, adaptive: None, is_adaptive: false, projected })
    }

    /// Every composed shader with its label.
    pub(super) fn shaders() -> Vec<(String, ShaderSource)> {
        let of_columns = TexelShadow::<Columns>::shaders().into_iter();
        let adaptive = of_columns.map(|(label, source)| (format!("adaptive {label}"), source));
        GpuVoxelMap::shaders().into_iter().chain(adaptive).collect()
    }

    fn map(&self) -> &dyn GpuShadow {
        match &self.adaptive {
            Some(map) if self.is_adaptive => map,
            _ => &self.uniform,
        }
    }

    fn map_mut(&mut self) -> &mut dyn GpuShadow {
        match &mut self.adaptive {
            Some(map) if self.is_adaptive => map,
            _ => &mut self.uniform,
        }
    }
}

impl GpuShadow for GpuVoxelShadow {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let adaptive = settings.voxel_map.slices == VoxelSlices::Adaptive;
        if adaptive != self.is_adaptive {
            self.forget(gpu);
            self.is_adaptive = adaptive;
        }
        if adaptive && self.adaptive.is_none() {
            self.adaptive = Some(TexelShadow::new(gpu, self.projected)?);
        }
        self.map_mut().build(slot, gpu, commands, input, settings)
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        self.map_mut().look_up(slot, gpu, commands, targets);
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.map().columns_size(slot)
    }

    fn columns(
        &mut self,
        map: (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        self.map_mut().columns(map, gpu, commands, into)
    }

    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        self.map().list(slot)
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        self.map_mut().settle(gpu, heads)
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.map_mut().forget(gpu);
    }

    fn report(&self, slot: usize) -> ShadowReport {
        self.map().report(slot)
    }

    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        self.map().map_words(slot, gpu)
    }
}
