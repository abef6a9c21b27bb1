//! Kernels and buffers of clusters.

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, wgpu};

use super::constant::ConstantBuffers;
use super::frame::{Frame, Vertex};
use super::kernels::ClusterKernels;
use crate::MAX_LIGHTS;
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
    /// Where each light of the ribs' points enters their cluster, if layers shadow each other.
    pub entries: [GrowBuffer<[f32; 4]>; MAX_LIGHTS],
    /// The light of the ribs' points by its parts: see `rib_light.wgsl`.
    pub rib_light: GrowBuffer<[u32; 2]>,
    pub vertices: GrowBuffer<Vertex>,
    pub maps: GrowBuffer<u32>,
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
            entries: [(); MAX_LIGHTS].map(|()| GrowBuffer::new(gpu, "entries of light", storage)),
            rib_light: GrowBuffer::new(gpu, "light on ribs", storage),
            vertices: GrowBuffer::new(gpu, "vertices of clusters", storage),
            maps: GrowBuffer::new(gpu, "maps of layers", storage),
            crossings: GrowBuffer::new(gpu, "light through layers", storage),
        })
    }

    /// Makes room for the frame.
    pub fn fit(&mut self, gpu: &Gpu, frame: &Frame) -> Result<(), GpuError> {
        let maps = frame.map_words(frame.finest(gpu));
        let lights = frame.variant.lights();
        let crossed = if frame.variant.is_directional() { 2 * lights * frame.grid().layers } else { 0 };
        let crossings = frame.quads() * crossed as u64;
        let needed = (4 * maps).max(8 * crossings);
        if needed > gpu.most_storage_bytes() || 2 * frame.quads() > u64::from(u32::MAX) {
            return Err(GpuError::Input(format!(
                "the clusters of this hairstyle need a buffer of {needed} bytes, and {} takes at most {}: choose fewer layers or \
                 volumes, or draw on the CPU",
                gpu.info.name,
                gpu.most_storage_bytes()
            )));
        }
        let points = 2 * frame.vertices();
        for (light, entries) in self.entries.iter_mut().enumerate() {
            let used = frame.variant.has_entries() && light < lights;
            entries.reserve(gpu, if used { points } else { 0 });
        }
        self.rib_light.reserve(gpu, (1 + MAX_LIGHTS) * points);
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
        let kernel = self.kernels.entries(gpu)?;
        let points = 2 * frame.vertices() as u64;
        for (light, entries) in self.entries.iter().enumerate().take(frame.variant.lights()) {
            let mut of_light = frame.uniform;
            of_light.light = light as u32;
            let uniform = commands.constants("clusters", &of_light);
            let group = kernel.bind(
                gpu,
                &[
                    (1, self.ribs.drawn().points.as_entire_binding()),
                    (3, entries.raw().as_entire_binding()),
                    (10, uniform.as_entire_binding()),
                ],
            );
            commands.compute("shadow/entries", |pass| kernel.run(pass, &group, points));
        }
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
                (24, self.rib_light.raw().as_entire_binding()),
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
