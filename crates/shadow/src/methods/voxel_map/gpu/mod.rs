//! The voxel map on the GPU: density with integer atomics, one thread per segment; sums along the light, one thread per column.
//!
//! Cells hold the same integers as on the CPU.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, read_buffer, wgpu};

use super::cpu::fixed_point_depth;
use super::{Lattice, VoxelDeposit, VoxelFilter, VoxelMapSettings};
use crate::gpu::{
    Buffer, GpuColumns, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup, RAY, fits_device,
    projected_constant, wgsl,
};
use crate::{ShadowMethod, ShadowReport, ShadowSettings};

const FRAME: ShaderPart = wgsl!("methods/voxel_map/gpu/", "frame.wgsl");
const DEPOSIT: ShaderPart = wgsl!("methods/voxel_map/gpu/", "deposit.wgsl");
const SUM: ShaderPart = wgsl!("methods/voxel_map/gpu/", "sum.wgsl");
const QUERY: [ShaderPart; 2] = [FRAME, wgsl!("methods/voxel_map/gpu/", "query.wgsl")];

/// The names of the passes in statistics.
const DENSITY_PASS: &str = "shadow/density";
const SUM_PASS: &str = "shadow/sum";

/// Twin of `VoxelUniform` in frame.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct VoxelUniform {
    anchor: Vec3,
    deposit: f32,
    along: Vec3,
    first_along: f32,
    row: Vec3,
    first_row: f32,
    column: Vec3,
    first_column: f32,
    edge: u32,
    segments: u32,
    points: u32,
    reads: u32,
    squares: [f32; 2],
    plane: f32,
    start: f32,
}

impl VoxelUniform {
    fn new(lattice: &Lattice, deposit: f32, input: &GpuShadowInput, settings: &VoxelMapSettings) -> Self {
        let first = lattice.first.as_vec3();
        let [along, row, column] = lattice.axes_per_cell;
        Self {
            anchor: lattice.anchor,
            deposit,
            along,
            first_along: first.x,
            row,
            first_row: first.y,
            column,
            first_column: first.z,
            edge: lattice.resolution,
            segments: input.strands.segment_count,
            points: input.strands.point_count,
            reads: match settings.filter {
                VoxelFilter::Centred => 0,
                VoxelFilter::Paper => 1,
                VoxelFilter::Closest => 2,
            },
            squares: settings.deposit.squares(),
            plane: input.projected.map_or(0.0, |projected| projected.plane),
            start: input.projected.map_or(0.0, |projected| projected.start),
        }
    }
}

/// [`ShadowMethod::VoxelMap`] on the GPU.
#[derive(Debug)]
pub(crate) struct GpuVoxelMap {
    segments: Kernel,
    points: Kernel,
    sum: Kernel,
    lookup: PointLookup,
    /// One bit per cell, needed during a build. All lights share the buffer.
    full: Buffer,
    maps: Vec<Map>,
}

/// The map of one light.
#[derive(Debug)]
struct Map {
    uniform: wgpu::Buffer,
    cells: Buffer,
    lattice: Option<Lattice>,
    report: ShadowReport,
}

impl Map {
    /// An empty map: everything is lit.
    fn new(gpu: &Gpu) -> Self {
        Self {
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("voxels"),
                size: size_of::<VoxelUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            cells: Buffer::new(gpu, "voxel map"),
            lattice: None,
            report: ShadowReport::default(),
        }
    }

    /// The bindings of a query.
    fn resources(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(0, self.uniform.as_entire_binding()), (3, self.cells.raw().as_entire_binding())]
    }
}

fn deposit_source() -> ShaderSource {
    ShaderSource::new(&[FRAME, RAY, DEPOSIT])
}

fn sum_source() -> ShaderSource {
    ShaderSource::new(&[FRAME, SUM])
}

impl GpuVoxelMap {
    pub(crate) fn new(gpu: &Gpu, projected: bool) -> Result<Self, GpuError> {
        let constants = [projected_constant(projected)];
        let deposit = |entry| Kernel::specialised(gpu, DENSITY_PASS, &deposit_source(), entry, &constants);
        Ok(Self {
            segments: deposit("deposit_segments")?,
            points: deposit("deposit_points")?,
            sum: Kernel::new(gpu, SUM_PASS, &sum_source(), "sum_columns")?,
            lookup: PointLookup::new(gpu, &QUERY, true, &constants)?,
            full: Buffer::new(gpu, "full voxels"),
            maps: Vec::new(),
        })
    }

    /// Every composed shader with its label.
    pub(crate) fn shaders() -> Vec<(String, ShaderSource)> {
        let passes = [(DENSITY_PASS.to_owned(), deposit_source()), (SUM_PASS.to_owned(), sum_source())];
        passes.into_iter().chain(PointLookup::shaders(&QUERY, true)).collect()
    }
}

impl GpuShadow for GpuVoxelMap {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let ours = &settings.voxel_map;
        let placed = (input.light, input.anchor);
        let lattice = Lattice::place(placed, || input.longest_strand, ours, &input.bounds);
        let cells = u64::from(lattice.resolution).pow(3);
        // Frees the maps of lights that were removed.
        self.maps.truncate(input.slots());
        while self.maps.len() <= slot {
            self.maps.push(Map::new(gpu));
        }
        if let Err(error) = fits_device(gpu, ShadowMethod::VoxelMap, 4 * cells) {
            self.maps[slot] = Map::new(gpu);
            return Err(error.into());
        }
        self.full.fit(gpu, cells / 32);
        let map = &mut self.maps[slot];
        map.cells.fit(gpu, cells);
        map.lattice = Some(lattice);
        map.report = ShadowReport {
            memory_bytes: map.cells.bytes(),
            cells_total: cells,
            cell_size: lattice.cell_size,
            points_ignored: input.bounds.ignored,
            scratch_bytes: self.full.bytes(),
            ..ShadowReport::default()
        };
        let depth = fixed_point_depth((input.extinction_scale, input.strand_width), settings, &lattice);
        let uniform = VoxelUniform::new(&lattice, depth, input, ours);
        gpu.upload(&map.uniform, 0, &[uniform]);

        let encoder = commands.encoder();
        encoder.clear_buffer(map.cells.raw(), 0, Some(4 * cells));
        encoder.clear_buffer(self.full.raw(), 0, Some(cells / 8));
        let mut resources = map.resources().to_vec();
        resources.extend([
            (1, input.strands.points.as_entire_binding()),
            (2, input.strands.segments.as_entire_binding()),
            (4, self.full.raw().as_entire_binding()),
        ]);
        let (kernel, threads) = match ours.deposit {
            VoxelDeposit::Length | VoxelDeposit::Isotropic => (&self.segments, input.strands.segment_count),
            VoxelDeposit::PointCount => (&self.points, input.strands.point_count),
        };
        let group = kernel.bind(gpu, &resources);
        commands.compute(DENSITY_PASS, |pass| kernel.run(pass, &group, u64::from(threads)));
        let group = self.sum.bind(gpu, &resources);
        let columns = u64::from(lattice.resolution).pow(2);
        commands.compute(SUM_PASS, |pass| self.sum.run(pass, &group, columns));
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let Some(map) = self.maps.get(slot) else { return };
        self.lookup.run(gpu, commands, slot, &map.resources(), targets);
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.maps.get(slot).and_then(|map| map.lattice).map_or(0, |lattice| lattice.resolution)
    }

    fn columns(
        &mut self,
        (slot, _): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let map = self.maps.get(slot)?;
        let lattice = map.lattice?;
        self.lookup.write_columns(gpu, commands, &map.resources(), lattice.resolution, into);
        Some(GpuColumns { size: lattice.resolution, uv_from_world: lattice.uv_from_world() })
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.maps.clear();
        self.full.fit(gpu, 0);
    }

    fn report(&self, slot: usize) -> ShadowReport {
        self.maps.get(slot).map_or_else(ShadowReport::default, |map| map.report)
    }

    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(Map { cells, lattice: Some(lattice), .. }) = self.maps.get(slot) else {
            return Ok(Vec::new());
        };
        let mut words = vec![0; (lattice.resolution as usize).pow(3)];
        read_buffer(gpu, cells.raw(), &mut words)?;
        Ok(words)
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
            offset_of!(VoxelUniform, anchor),
            offset_of!(VoxelUniform, deposit),
            offset_of!(VoxelUniform, along),
            offset_of!(VoxelUniform, first_along),
            offset_of!(VoxelUniform, row),
            offset_of!(VoxelUniform, first_row),
            offset_of!(VoxelUniform, column),
            offset_of!(VoxelUniform, first_column),
            offset_of!(VoxelUniform, edge),
            offset_of!(VoxelUniform, segments),
            offset_of!(VoxelUniform, points),
            offset_of!(VoxelUniform, reads),
            offset_of!(VoxelUniform, squares),
            offset_of!(VoxelUniform, plane),
            offset_of!(VoxelUniform, start),
            size_of::<VoxelUniform>(),
        ];
        for (label, source) in GpuVoxelMap::shaders() {
            assert_eq!(layout_in_shader(&source, "VoxelUniform"), expected, "{label}");
        }
    }
}
