//! Hair as clusters on the GPU: the twin of `cpu/clusters`.
//!
//! Ribs are strands of a hairstyle of their own: they are interpolated, shadowed and shaded by the kernels of strands. One kernel turns
//! them into vertices with the angles by which records are found, one computes the map of each layer of each column that may be seen,
//! and `fragments.wgsl` rasterises the layers for the passes of every transparency mode; see [`super::eye`].

mod constant;
mod kernels;

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, ShaderSource, wgpu};
use lovelock_groom::HairShading;
use lovelock_satf::{ClusterHair, ClusterShading, RibGrid, SectorRef, layout};
use lovelock_shadow::{Bounds, GpuTargets, LightFrame};

use super::frame_resources::FrameResources;
use super::hair::HairBuffers;
use super::light_kernels::LightKernels;
use super::shadow::GpuShadowStage;
use crate::clusters::{ClusterStage, cluster_share, guides_of, to_strongest_light, without_strands};
use crate::scene_light::SceneLight;
use crate::uniform::{FrameUniform, LightMaps};
use crate::{FrameInput, HairPose, PictureSettings};
use constant::{ConstantBuffers, Largest};
use kernels::{ClusterKernels, MOST_PIXELS_A_THREAD};
pub(in crate::gpu) use kernels::{ClusterVariant, FRAGMENT_PARTS, PUBLISHED_PARTS, shaders};

/// Twin of `ClusterUniform` in clusters.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(in crate::gpu) struct ClusterUniform {
    eye_depth: [f32; 4],
    light_detail: [f32; 4],
    area: [f32; 4],
    grid: [u32; 4],
    core_strength_finest_paper: [f32; 4],
    published: [f32; 4],
    entries: u32,
    pattern: u32,
    lanes: u32,
    pad: u32,
}

/// Twin of `ClusterVertex` in clusters.wgsl; never read on the CPU.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex([u32; 16]);

/// The clusters of a frame, as input of the passes over fragments.
#[derive(Clone, Debug)]
pub(in crate::gpu) struct DrawnClusters<'a> {
    pub variant: ClusterVariant,
    /// Threads of a pass.
    pub threads: u64,
    uniform: wgpu::Buffer,
    vertices: &'a wgpu::Buffer,
    maps: &'a wgpu::Buffer,
    cells: &'a wgpu::Buffer,
    crossings: &'a wgpu::Buffer,
}

impl DrawnClusters<'_> {
    /// The bindings of the passes, which are 10 to 14.
    pub fn bindings(&self) -> [(u32, wgpu::BindingResource<'_>); 5] {
        [
            (10, self.uniform.as_entire_binding()),
            (11, self.vertices.as_entire_binding()),
            (12, self.maps.as_entire_binding()),
            (13, self.cells.as_entire_binding()),
            (14, self.crossings.as_entire_binding()),
        ]
    }
}

/// What lights and places ribs.
#[derive(Clone, Copy, Debug)]
pub(super) struct RibLighting<'a> {
    /// The kernels of strand points with the tables of fibres.
    pub shading: (&'a LightKernels, HairShading, &'a wgpu::Buffer),
    /// The shader of the published light.
    pub published: &'a ShaderSource,
    pub lights: usize,
    /// The area of the hair: left, top, right and bottom.
    pub area: [f32; 4],
    /// Pixels that a metre covers at one metre.
    pub scale: f32,
    /// The least distance of the ribs from the eye, metres.
    pub nearest: f32,
}

/// Follows the clusters of a hairstyle. Kernels are compiled and buffers are made when clusters are drawn for the first time.
#[derive(Debug, Default)]
pub(super) struct Clusters {
    stage: ClusterStage,
    parts: Option<Box<Parts>>,
    frame: Option<Frame>,
}

/// What is kept from frame to frame.
#[derive(Debug)]
struct Parts {
    kernels: ClusterKernels,
    ribs: HairBuffers,
    /// The uniform of strands, for ribs.
    frame_uniform: wgpu::Buffer,
    constant: ConstantBuffers,
    /// Where the light of the ribs' points enters their cluster, if layers shadow each other.
    entries: GrowBuffer<[f32; 4]>,
    vertices: GrowBuffer<Vertex>,
    maps: GrowBuffer<[u32; 2]>,
    crossings: GrowBuffer<[u32; 2]>,
}

/// What the last frame drew.
#[derive(Debug)]
struct Frame {
    hair: Arc<ClusterHair>,
    share: f32,
    picture: PictureSettings,
    variant: ClusterVariant,
    uniform: ClusterUniform,
}

impl Frame {
    fn grid(&self) -> RibGrid {
        self.hair.grid
    }

    fn quads(&self) -> u64 {
        (self.hair.clusters() * self.grid().volumes()) as u64
    }

    fn vertices(&self) -> usize {
        self.hair.clusters() * self.grid().around * self.grid().points()
    }

    /// `input` with the ribs in place of the hairstyle.
    fn of_ribs<'a>(&'a self, input: &FrameInput<'a>) -> FrameInput<'a> {
        let hair = guides_of(input).map_or(input.hair, HairPose::Guides);
        FrameInput { style: &self.hair.ribs, hair, picture: &self.picture, ..*input }
    }
}

impl Clusters {
    /// Follows the hair of `input` in an image `height` pixels high. Returns its clusters and the part of its optical depth that they
    /// have, if any.
    pub fn follow(&mut self, input: &FrameInput, height: u32) -> Option<(Arc<ClusterHair>, f32)> {
        let share = cluster_share(input, height);
        self.frame = (share > 0.0).then(|| Frame {
            hair: self.stage.follow(input),
            share,
            picture: without_strands(input.picture),
            variant: ClusterVariant::of(&input.picture.clusters),
            uniform: ClusterUniform::default(),
        });
        self.frame.as_ref().map(|frame| (Arc::clone(&frame.hair), frame.share))
    }

    /// The part of the optical depth that clusters have.
    pub fn share(&self) -> f32 {
        self.frame.as_ref().map_or(0.0, |frame| frame.share)
    }

    /// The frame, if it has any cluster, and its parts.
    fn placed(&mut self) -> Option<(&mut Parts, &mut Frame)> {
        let frame = self.frame.as_mut().filter(|frame| frame.hair.clusters() > 0)?;
        Some((self.parts.as_mut()?, frame))
    }

    /// Uploads what has changed, and interpolates the ribs.
    ///
    /// # Errors
    /// A kernel does not compile, or the clusters need a larger buffer than the device supports.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &FrameInput,
        height: u32,
    ) -> Result<(), GpuError> {
        if self.frame.as_ref().is_none_or(|frame| frame.hair.clusters() == 0) {
            return Ok(());
        }
        if self.parts.is_none() {
            self.parts = Some(Box::new(Parts::new(gpu)?));
        }
        let Some((parts, frame)) = self.placed() else { return Ok(()) };
        parts.constant.follow(gpu, &frame.hair);
        parts.fit(gpu, frame)?;
        parts.ribs.write(gpu, commands, &frame.of_ribs(input), height)?;
        frame.uniform = uniform_of(input, frame, parts.finest(gpu, frame));
        if frame.variant.has_entries() { parts.place_entries(gpu, commands, frame) } else { Ok(()) }
    }

    /// Bounds of the ribs: see [`HairBuffers::bounds`].
    pub fn bounds(&mut self, input: &FrameInput, axes: LightFrame, anchor: Vec3) -> Option<Bounds> {
        let (parts, frame) = self.placed()?;
        Some(parts.ribs.bounds(&frame.of_ribs(input), axes, anchor).0)
    }

    /// Encodes looking up the ribs in the maps of all lights.
    pub fn look_up(&mut self, gpu: &Gpu, commands: &mut Commands, shadow: &mut GpuShadowStage) {
        let Some((parts, frame)) = self.placed() else { return };
        let entries = frame.variant.has_entries().then(|| parts.entries.raw());
        let targets = GpuTargets {
            points: entries.unwrap_or(parts.ribs.asked()),
            stride: 1,
            count: parts.ribs.drawn().point_count,
            out: parts.ribs.transmittance(),
            sum: None,
        };
        for slot in 0..shadow.lights() {
            shadow.look_up(slot, gpu, commands, &targets);
        }
    }

    /// Uploads the uniform of the ribs.
    pub fn write_uniform(
        &mut self,
        gpu: &Gpu,
        input: &FrameInput,
        light: &SceneLight,
        size: (u32, u32),
        maps: &[LightMaps],
        texels: u32,
    ) {
        let Some((parts, frame)) = self.placed() else { return };
        let uniform = FrameUniform::new(&frame.of_ribs(input), None, light, size, maps, texels);
        gpu.upload(&parts.frame_uniform, 0, &[uniform]);
    }

    /// Encodes lighting the ribs and making vertices and maps.
    ///
    /// # Errors
    /// A kernel does not compile.
    pub fn place(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        resources: &FrameResources,
        lighting: &RibLighting,
    ) -> Result<(), GpuError> {
        let Some((parts, frame)) = self.placed() else { return Ok(()) };
        let of_ribs = FrameResources { uniform: &parts.frame_uniform, ..*resources };
        parts.ribs.shade(gpu, "draw/ribs", lighting.shading, commands, &of_ribs);
        frame.uniform.lanes = lanes(&parts.constant.largest, frame, lighting);
        frame.uniform.area = lighting.area;
        if frame.picture.clusters.shading == ClusterShading::Paper {
            let kernel = parts.kernels.published(gpu, lighting.published, lighting.lights)?;
            let uniform = commands.constants("clusters", &frame.uniform);
            parts.ribs.run_over_points(
                gpu,
                kernel,
                "draw/published-light",
                commands,
                &of_ribs,
                [(10, uniform.as_entire_binding())],
            );
        }
        parts.place_vertices(gpu, commands, frame);
        parts.fill_maps(gpu, commands, frame)
    }

    /// What the passes over fragments need, after [`Clusters::place`].
    pub fn drawn(&self, commands: &mut Commands) -> Option<DrawnClusters<'_>> {
        let frame = self.frame.as_ref().filter(|frame| frame.hair.clusters() > 0)?;
        let parts = self.parts.as_ref()?;
        Some(DrawnClusters {
            variant: frame.variant,
            threads: 2 * frame.quads() * u64::from(frame.uniform.lanes),
            uniform: commands.constants("clusters", &frame.uniform),
            vertices: parts.vertices.raw(),
            maps: parts.maps.raw(),
            cells: parts.constant.cells(),
            crossings: parts.crossings.raw(),
        })
    }

    /// Memory in use, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.parts.as_ref().map_or(0, |parts| {
            let own = [parts.entries.raw(), parts.vertices.raw(), parts.maps.raw(), parts.crossings.raw()];
            own.iter().map(|buffer| buffer.size()).sum::<u64>()
                + parts.ribs.memory_bytes()
                + parts.constant.bytes()
        })
    }
}

impl Parts {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
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

    /// The finest level of detail for which the maps of all layers fit a buffer of the device.
    fn finest(&self, gpu: &Gpu, frame: &Frame) -> u32 {
        let fits = |mip: &u32| 8 * frame.quads() * u64::from(entries_of(*mip)) <= gpu.most_storage_bytes();
        (0..layout::MIPS as u32 - 1).find(fits).unwrap_or(layout::MIPS as u32 - 1)
    }

    /// Makes room for the frame.
    fn fit(&mut self, gpu: &Gpu, frame: &Frame) -> Result<(), GpuError> {
        let maps = frame.quads() * u64::from(entries_of(self.finest(gpu, frame)));
        let crossed = if frame.variant.is_directional() { 2 * frame.grid().layers as u64 } else { 0 };
        let crossings = frame.quads() * crossed;
        let needed = 8 * maps.max(crossings);
        if needed > gpu.most_storage_bytes() || 2 * frame.quads() > u64::from(u32::MAX) {
            return Err(GpuError::Input(format!(
                "the clusters of this hairstyle need a buffer of {needed} bytes, and {} takes at most {}: choose fewer layers or \
                 volumes, or draw by the processor",
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

    fn place_entries(&mut self, gpu: &Gpu, commands: &mut Commands, frame: &Frame) -> Result<(), GpuError> {
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

    fn place_vertices(&self, gpu: &Gpu, commands: &mut Commands, frame: &Frame) {
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

    fn fill_maps(&mut self, gpu: &Gpu, commands: &mut Commands, frame: &Frame) -> Result<(), GpuError> {
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

/// Entries of a map with texels from level `finest` on: a header, and a texel of each neighbour.
fn entries_of(finest: u32) -> u32 {
    (layout::TEXELS as u32 >> finest) + 3
}

/// The uniform without what depends on the image.
fn uniform_of(input: &FrameInput, frame: &Frame, finest: u32) -> ClusterUniform {
    let settings = &input.picture.clusters;
    let RibGrid { layers, around, along } = frame.grid();
    let opacity = input.picture.strand_opacity;
    let depth = frame.share * opacity * lovelock_satf::strand_width(input.look, frame.hair.strands);
    ClusterUniform {
        eye_depth: input.camera.eye.extend(depth).to_array(),
        light_detail: to_strongest_light(input.lights).extend(settings.detail).to_array(),
        area: [0.0; 4],
        // Each fits, because the vertices fit a buffer.
        grid: [around, along, layers, frame.hair.clusters()].map(|n| n as u32),
        core_strength_finest_paper: [
            frame.hair.core,
            settings.shadow_strength,
            finest as f32,
            f32::from(u8::from(settings.shading == ClusterShading::Paper)),
        ],
        published: [settings.diffuse, settings.primary, settings.secondary, 0.0],
        entries: entries_of(finest),
        pattern: SectorRef::literal(1.0).index / layout::DEPTHS as u32,
        lanes: 1,
        pad: 0,
    }
}

/// The most threads per triangle.
const MOST_LANES: u32 = 64;
/// How much larger than at rest volumes may become in each direction.
const GROWN: f32 = 2.0;

/// Threads per triangle, so that none has too many pixels.
fn lanes(largest: &Largest, frame: &Frame, lighting: &RibLighting) -> u32 {
    let [left, top, right, bottom] = lighting.area;
    let scale = lighting.scale / lighting.nearest.max(0.05);
    let [along, across] = [largest.along, largest.across].map(|metres| GROWN * metres * scale + 2.0);
    let most = (along * across).min((right - left) * (bottom - top));
    // Each pixel of a shadowed layer has a loop of its own.
    let steps = most * (1 + frame.variant.shadow_steps(frame.grid().layers)) as f32;
    // NaN gives one.
    ((steps / MOST_PIXELS_A_THREAD).ceil() as u32).clamp(1, MOST_LANES)
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::check_shader;
    use naga::TypeInner;

    use super::*;

    fn layout_in_shader(name: &str) -> Vec<usize> {
        let (_, source) = shaders().into_iter().next().expect("a shader");
        let module = check_shader(&source).expect("valid");
        let (_, ty) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
            .unwrap_or_else(|| panic!("no structure {name}"));
        let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no structure") };
        members.iter().map(|m| m.offset as usize).chain([*span as usize]).collect()
    }

    #[test]
    fn structures_have_the_layout_of_the_shader() {
        assert_eq!(
            layout_in_shader("ClusterUniform"),
            [
                offset_of!(ClusterUniform, eye_depth),
                offset_of!(ClusterUniform, light_detail),
                offset_of!(ClusterUniform, area),
                offset_of!(ClusterUniform, grid),
                offset_of!(ClusterUniform, core_strength_finest_paper),
                offset_of!(ClusterUniform, published),
                offset_of!(ClusterUniform, entries),
                offset_of!(ClusterUniform, pattern),
                offset_of!(ClusterUniform, lanes),
                size_of::<ClusterUniform>(),
            ]
        );
        // Only shaders access it, but Rust allocates it.
        assert_eq!(layout_in_shader("ClusterVertex").last(), Some(&size_of::<Vertex>()));
    }
}
