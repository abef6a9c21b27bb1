//! The grid and the march on the GPU: bricks with hair are marked, numbered by one workgroup, and filled with integer atomics.
//!
//! The first light builds the grid, and all others read it. How many bricks hold hair is known only when the device has numbered them:
//! a list that was too short is made again, as the lists of fragments of other methods are.

mod grid;

use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};
use lovelock_base::settings::Settings;
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderPart, ShaderSource, wgpu};

use self::grid::{GpuGrid, Share};
use super::bricks::depth_per_cell;
use super::cpu::MOST_COLUMNS;
use super::{Lattice, VoxelMarchSettings};
use crate::gpu::{
    GpuColumns, GpuList, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup, wgsl,
};
use crate::world::{COLUMNS, ColumnViews, ToLight, WorldLight};
use crate::{ShadowReport, ShadowSettings};

const FRAME: ShaderPart = wgsl!("methods/voxel_march/gpu/", "frame.wgsl");
const QUERY: [ShaderPart; 3] = [FRAME, wgsl!("methods/voxel_march/gpu/", "query.wgsl"), COLUMNS];

/// Twin of `MarchUniform` in frame.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct MarchUniform {
    anchor: Vec3,
    per_cell: f32,
    start: Vec3,
    each: f32,
    bricks: UVec3,
    segments: u32,
    light: Vec3,
    radius: f32,
    step: f32,
    jitter: u32,
    room: u32,
    unused: u32,
}

impl MarchUniform {
    fn new(lattice: &Lattice, input: &GpuShadowInput, settings: &VoxelMarchSettings) -> Self {
        let to_light = ToLight::of(&input.light);
        let (light, radius) = to_light.source.unwrap_or((to_light.toward, -1.0));
        Self {
            anchor: lattice.anchor,
            per_cell: 1.0 / lattice.cell_size,
            start: lattice.start(),
            each: depth_per_cell(input.extinction_scale, input.strand_width, lattice.cell_size),
            bricks: lattice.bricks,
            segments: input.strands.segment_count,
            light,
            radius,
            step: settings.step,
            jitter: u32::from(settings.jitter),
            room: 0,
            unused: 0,
        }
    }
}

/// [`ShadowMethod::VoxelMarch`](crate::ShadowMethod::VoxelMarch) on the GPU.
#[derive(Debug)]
pub(crate) struct GpuVoxelMarch {
    grid: GpuGrid,
    lookup: PointLookup,
    lights: Vec<WorldLight>,
    /// What the grid was built of.
    source: Option<Source>,
}

/// The hair of a grid: lights with the same share it.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    points: wgpu::Buffer,
    segments: wgpu::Buffer,
    /// Without the light.
    uniform: MarchUniform,
}

impl Source {
    fn new(input: &GpuShadowInput, uniform: MarchUniform) -> Self {
        let uniform = MarchUniform { light: Vec3::ZERO, radius: 0.0, ..uniform };
        let (points, segments) = (input.strands.points.clone(), input.strands.segments.clone());
        Self { points, segments, uniform }
    }
}

impl GpuVoxelMarch {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            grid: GpuGrid::new(gpu)?,
            lookup: PointLookup::new(gpu, &QUERY, true, &[])?,
            lights: Vec::new(),
            source: None,
        })
    }

    /// Every composed shader with its label.
    pub(crate) fn shaders() -> Vec<(String, ShaderSource)> {
        GpuGrid::shaders().into_iter().chain(PointLookup::shaders(&QUERY, true)).collect()
    }

    /// The bindings of a query.
    fn resources<'a>(&'a self, light: &'a WorldLight) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        let [index, list] = self.grid.resources();
        vec![(0, light.uniform.as_entire_binding()), index, list]
    }

    /// Frees the grid. Everything is lit for all lights up to `slot`, and for those that were there.
    fn clear(&mut self, gpu: &Gpu, slot: usize) {
        let lights = self.lights.len().max(slot + 1);
        self.lights.clear();
        self.lights.resize_with(lights, || WorldLight::new::<MarchUniform>(gpu));
        self.source = None;
        self.grid.free(gpu);
    }
}

impl GpuShadow for GpuVoxelMarch {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let settings = settings.voxel_march.clamped();
        let lattice = Lattice::new(input.anchor, settings.resolution, &input.extent);
        let mut uniform = MarchUniform::new(&lattice, input, &settings);
        let source = Source::new(input, uniform);
        self.lights.truncate(input.slots());
        // The hair of the first light is new in each frame.
        if slot == 0 || self.source.as_ref() != Some(&source) {
            let share =
                Share { limit_bytes: settings.memory_limit_bytes, bricks_of_window: lattice.count() as u64 };
            if let Err(error) = self.grid.begin(gpu, commands, share) {
                self.clear(gpu, slot);
                return Err(error.into());
            }
            uniform.room = self.grid.room() as u32;
            let buffer = commands.constants("voxel march", &uniform);
            self.grid.build(gpu, commands, &buffer, input);
            self.source = Some(source);
        }
        uniform.room = self.grid.room() as u32;
        while self.lights.len() <= slot {
            self.lights.push(WorldLight::new::<MarchUniform>(gpu));
        }
        let size = (settings.resolution.min(MOST_COLUMNS), 2.0 * lattice.cell_size);
        let light = &mut self.lights[slot];
        gpu.upload(&light.uniform, 0, &[uniform]);
        light.columns = ColumnViews::new(&input.light, input.anchor, size, &input.bounds);
        light.report = ShadowReport {
            // Lights share the grid.
            memory_bytes: if slot == 0 { self.grid.memory_bytes() } else { 0 },
            cells_total: u64::from(settings.resolution).pow(3),
            cell_size: lattice.cell_size,
            points_ignored: input.extent.ignored,
            ..ShadowReport::default()
        };
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let Some(light) = self.lights.get(slot) else {
            return;
        };
        self.lookup.run(gpu, commands, slot, &self.resources(light), targets);
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.lights.get(slot).map_or(0, |light| light.columns.size())
    }

    fn column_sides(&self, slot: usize) -> usize {
        self.lights.get(slot).map_or(1, |light| light.columns.0.len().max(1))
    }

    fn columns(
        &mut self,
        (slot, side): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let light = self.lights.get(slot)?;
        light.write_columns(side, (&self.lookup, self.resources(light)), (gpu, commands), into)
    }

    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        // All lights share the list of the first one.
        (slot == 0 && self.source.is_some()).then(|| self.grid.list())
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        let Some(&head) = heads.first().filter(|_| self.source.is_some()) else { return Ok(false) };
        match self.grid.settle(gpu, head) {
            Ok((needed_bytes, short)) => {
                if let Some(light) = self.lights.first_mut() {
                    light.report.needed_bytes = needed_bytes;
                    light.report.memory_bytes = self.grid.memory_bytes();
                }
                Ok(short)
            }
            Err(error) => {
                self.clear(gpu, 0);
                Err(error.into())
            }
        }
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.clear(gpu, 0);
        self.lights.clear();
    }

    fn report(&self, slot: usize) -> ShadowReport {
        self.lights.get(slot).map_or_else(ShadowReport::default, |light| light.report)
    }

    fn map_words(&self, _slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        self.grid.words(gpu)
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use lovelock_gpu::layout_in_shader;

    #[test]
    fn the_uniform_has_the_layout_of_every_shader() {
        let expected = [
            offset_of!(MarchUniform, anchor),
            offset_of!(MarchUniform, per_cell),
            offset_of!(MarchUniform, start),
            offset_of!(MarchUniform, each),
            offset_of!(MarchUniform, bricks),
            offset_of!(MarchUniform, segments),
            offset_of!(MarchUniform, light),
            offset_of!(MarchUniform, radius),
            offset_of!(MarchUniform, step),
            offset_of!(MarchUniform, jitter),
            offset_of!(MarchUniform, room),
            size_of::<MarchUniform>(),
        ];
        for (label, source) in GpuVoxelMarch::shaders() {
            assert_eq!(layout_in_shader(&source, "MarchUniform"), expected, "{label}");
        }
    }

    #[test]
    fn the_numbers_of_bricks_are_those_of_the_cpu() {
        use super::super::grid::{BRICK_WORDS, DEPTH_ONE, MOST, STORED};
        use super::super::lattice::BRICK;
        for line in [
            format!("const BRICK: u32 = {BRICK}u;"),
            format!("const STORED: u32 = {STORED}u;"),
            format!("const BRICK_WORDS: u32 = {BRICK_WORDS}u;"),
            format!("const DEPTH_ONE: f32 = {DEPTH_ONE:.1};"),
            format!("const MOST: u32 = {MOST}u;"),
        ] {
            assert!(FRAME.text.contains(&line), "{line}");
        }
    }
}
