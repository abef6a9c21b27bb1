//! Kernels and buffers of clusters.

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, wgpu};

use super::constant::ConstantBuffers;
use super::frame::{Frame, Vertex, entries_of};
use super::kernels::ClusterKernels;
use crate::gpu::hair::HairBuffers;
use crate::uniform::FrameUniform;

/// What is kept from frame to frame.
#[derive(Debug)]
pub(super) struct Parts {
    pub kernels: ClusterKernels,
    pub ribs: HairBuffers,
    /// The uniform of strands, for ribs.
    pub frame_uniform: wgpu::Buffer,
    pub constant: ConstantBuffers,
    /// Where the light of the ribs' points enters their cluster, if layers shadow each other.
    pub entries: GrowBuffer<[f32; 4]>,
    pub vertices: GrowBuffer<Vertex>,
    pub maps: GrowBuffer<[u32; 2]>,
    pub crossings: GrowBuffer<[u32; 2]>,
}

impl Parts {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            kernels: ClusterKernels::new(gpu)?,
            ribs: HairBuffers::new(gpu)?,
            frame_uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame of ribs"),
                size: size_of::<FrameUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            constant: ConstantBuffers::new(gpu),
            entries: GrowBuffer::new(gpu, "entries of light", storage),
            vertices: GrowBuffer::new(gpu, "vertices of clusters", storage),
            maps: GrowBuffer::new(gpu, "maps of layers", storage),
            crossings: GrowBuffer::new(gpu, "light through layers", storage),
        })
    }

    /// Makes room for the frame.
    pub fn fit(&mut self, gpu: &Gpu, frame: &Frame) -> Result<(), GpuError> {
        let maps = frame.quads() * u64::from(entries_of(frame.finest(gpu)));
        let crossed = if frame.variant.is_directional() { 2 * frame.grid().layers as u64 } else { 0 };
        let crossings = frame.quads() * crossed;
        let needed = 8 * maps.max(crossings);
        if needed > gpu.most_storage_bytes() || 2 * frame.quads() > u64::from(u32::MAX) {
            return Err(GpuError::Input(format!(
                "the clusters of this hairstyle need a buffer of {needed} bytes, and {} takes at most {}: choose fewer layers or \
                 volumes, or draw on the CPU",
                gpu.info.name,
                gpu.most_storage_bytes()
            )));
        }
        let entries = if frame.variant.has_entries() { 2 * frame.vertices() } else { 0 };
        self.entries.reserve(gpu, entries);
        self.vertices.reserve(gpu, frame.vertices());
        self.maps.reserve(gpu, maps as usize);
        self.crossings.reserve(gpu, crossings as usize);
        Ok(())
    }

    pub fn place_entries(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        frame: &Frame,
    ) -> Result<(), GpuError> {
        let uniform = commands.constants("clusters", &frame.uniform);
        let kernel = self.kernels.entries(gpu)?;
        let group = kernel.bind(
            gpu,
            &[
                (1, self.ribs.drawn().points.as_entire_binding()),
                (3, self.entries.raw().as_entire_binding()),
                (10, uniform.as_entire_binding()),
            ],
        );
        let points = 2 * frame.vertices() as u64;
        commands.compute("shadow/entries", |pass| kernel.run(pass, &group, points));
        Ok(())
    }

    pub fn place_vertices(&self, gpu: &Gpu, commands: &mut Commands, frame: &Frame) {
        let uniform = commands.constants("clusters", &frame.uniform);
        let kernel = &self.kernels.vertices;
        let group = kernel.bind(
            gpu,
            &[
                (1, self.ribs.drawn().points.as_entire_binding()),
                (2, self.ribs.shaded().as_entire_binding()),
                (10, uniform.as_entire_binding()),
                (11, self.vertices.raw().as_entire_binding()),
            ],
        );
        commands.compute("draw/cluster-vertices", |pass| kernel.run(pass, &group, frame.vertices() as u64));
    }

    pub fn fill_maps(&mut self, gpu: &Gpu, commands: &mut Commands, frame: &Frame) -> Result<(), GpuError> {
        let uniform = commands.constants("clusters", &frame.uniform);
        let kernel = self.kernels.maps(gpu, frame.variant)?;
        let [opacities, reflectances] = self.constant.records();
        let group = kernel.bind(
            gpu,
            &[
                (1, opacities.as_entire_binding()),
                (2, reflectances.as_entire_binding()),
                (10, uniform.as_entire_binding()),
                (11, self.vertices.raw().as_entire_binding()),
                (12, self.maps.raw().as_entire_binding()),
                (13, self.constant.cells().as_entire_binding()),
                (14, self.crossings.raw().as_entire_binding()),
            ],
        );
        commands.compute("draw/cluster-maps", |pass| kernel.run(pass, &group, frame.quads()));
        Ok(())
    }
}
