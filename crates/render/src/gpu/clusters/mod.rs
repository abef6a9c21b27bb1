//! Hair as clusters on the GPU: the twin of `cpu/clusters`.
//!
//! Ribs are strands of a hairstyle of their own: they are interpolated, shadowed and shaded by the kernels of strands. One kernel turns
//! them into vertices with the angles by which records are found, one computes the map of each layer of each column that may be seen,
//! and `fragments.wgsl` rasterises the layers for the passes of every transparency mode; see [`super::eye`].

mod constant;
mod frame;
mod kernels;
mod parts;

use std::sync::Arc;

use glam::{Vec3, vec2};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, ShaderSource, wgpu};
use lovelock_satf::{ClusterHair, ClusterShading};
use lovelock_shadow::{Bounds, GpuTargets, LightFrame};

use super::frame_resources::FrameResources;
use super::hair::PointShading;
use super::light_kernels::LightSet;
use super::shadow::GpuShadowStage;
use crate::clusters::{ClusterStage, cluster_share, without_strands};
use crate::scene_light::SceneLight;
use crate::uniform::{FrameUniform, LightMaps};
use crate::{FrameInput, Light, MAX_LIGHTS};
use frame::{ClusterUniform, Frame, lanes, uniform_of};
use kernels::RibVariant;
pub(in crate::gpu) use kernels::{ClusterVariant, FRAGMENT_PARTS, RIB_PARTS, shaders};
use parts::Parts;

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
    pub shading: PointShading<'a>,
    /// The shader of the light on ribs.
    pub rib_light: &'a ShaderSource,
    pub lights: LightSet,
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

impl Clusters {
    /// Follows the hair of `input` in an image `height` pixels high. Returns its clusters and the part of its optical depth that they
    /// have, if any.
    pub fn follow(&mut self, input: &FrameInput, height: u32) -> Option<(Arc<ClusterHair>, f32)> {
        let share = cluster_share(input, height);
        self.frame = (share > 0.0).then(|| Frame {
            hair: self.stage.follow(input),
            share,
            picture: without_strands(input.picture),
            variant: ClusterVariant::of(
                &input.picture.clusters,
                Light::enabled(input.lights).take(MAX_LIGHTS).count(),
            ),
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
        frame.uniform = uniform_of(input, frame, frame.finest(gpu));
        if frame.variant.has_entries() { parts.place_entries(gpu, commands, frame) } else { Ok(()) }
    }

    /// Bounds of the ribs: see [`super::hair::HairBuffers::bounds`].
    pub fn bounds(&mut self, input: &FrameInput, axes: LightFrame, anchor: Vec3) -> Option<Bounds> {
        let (parts, frame) = self.placed()?;
        Some(parts.ribs.bounds(&frame.of_ribs(input), axes, anchor).0)
    }

    /// Encodes looking up the ribs in the maps of all lights.
    pub fn look_up(&mut self, gpu: &Gpu, commands: &mut Commands, shadow: &mut GpuShadowStage) {
        let Some((parts, frame)) = self.placed() else { return };
        for slot in 0..shadow.lights() {
            let entries = parts.entries.get(slot).filter(|_| frame.variant.has_entries());
            let targets = GpuTargets {
                points: entries.map_or(parts.ribs.asked(), GrowBuffer::raw),
                stride: 1,
                count: parts.ribs.drawn().point_count,
                out: parts.ribs.transmittance(),
                sum: None,
                byte: None,
                projected: None,
            };
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
        parts.ribs.shade(gpu, "draw/ribs", lighting.shading, commands, &of_ribs)?;
        frame.uniform.lanes =
            lanes(parts.constant.largest, frame, lighting.area, lighting.scale / lighting.nearest.max(0.05));
        let [left, top, right, bottom] = lighting.area;
        (frame.uniform.low, frame.uniform.high) = (vec2(left, top), vec2(right, bottom));
        let is_published = frame.picture.clusters.shading == ClusterShading::Paper;
        let variant = RibVariant {
            lights: lighting.lights,
            as_strands: (!is_published).then_some(lighting.shading.model),
            colored: parts.ribs.is_colored(),
        };
        let kernel = parts.kernels.rib_light(gpu, lighting.rib_light, variant)?;
        let uniform = commands.constants("clusters", &frame.uniform);
        let more = [(10, uniform.as_entire_binding()), (24, parts.rib_light.raw().as_entire_binding())];
        parts.ribs.light(gpu, kernel, "draw/rib-light", lighting.shading, commands, (&of_ribs, more));
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
            let own = [parts.rib_light.raw(), parts.vertices.raw(), parts.maps.raw(), parts.crossings.raw()];
            own.into_iter()
                .chain(parts.entries.iter().map(GrowBuffer::raw))
                .map(wgpu::Buffer::size)
                .sum::<u64>()
                + parts.ribs.memory_bytes()
                + parts.constant.bytes()
        })
    }
}
