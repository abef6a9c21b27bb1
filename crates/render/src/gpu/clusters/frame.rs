//! What a frame draws of clusters, and the uniform of their kernels.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use lovelock_gpu::Gpu;
use lovelock_satf::{ClusterHair, ClusterShading, RibGrid, SectorRef, layout};

use super::constant::Largest;
use super::kernels::{ClusterVariant, MAX_PIXELS_A_THREAD};
use crate::clusters::{pose_by_guides, to_lights};
use crate::{FrameInput, MAX_LIGHTS, PictureSettings};

/// Twin of `ClusterUniform` in clusters.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ClusterUniform {
    eye: Vec3,
    depth: f32,
    pub low: Vec2,
    pub high: Vec2,
    around: u32,
    along: u32,
    layers: u32,
    count: u32,
    core: f32,
    shadow_strength: f32,
    finest: f32,
    as_published: u32,
    matt: f32,
    primary: f32,
    secondary: f32,
    detail: f32,
    entries: u32,
    pattern: u32,
    pub lanes: u32,
    pub light: u32,
    to_lights: [Vec4; MAX_LIGHTS],
}

/// Twin of `ClusterVertex` in clusters.wgsl; never read on the CPU.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Vertex([u32; 36]);

/// What the last frame drew.
#[derive(Debug)]
pub(super) struct Frame {
    pub hair: Arc<ClusterHair>,
    pub share: f32,
    pub picture: PictureSettings,
    pub variant: ClusterVariant,
    pub uniform: ClusterUniform,
}

impl Frame {
    /// How each cluster is divided.
    pub fn grid(&self) -> RibGrid {
        self.hair.grid
    }

    /// Layers of all columns.
    pub fn quads(&self) -> u64 {
        (self.hair.clusters() * self.grid().volumes()) as u64
    }

    /// Vertices of all clusters.
    pub fn vertices(&self) -> usize {
        self.hair.clusters() * self.grid().around * self.grid().points()
    }

    /// The finest level of detail for which the maps of all layers fit a buffer of the device.
    pub fn finest(&self, gpu: &Gpu) -> u32 {
        let fits = |mip: &u32| 4 * self.map_words(*mip) <= gpu.most_storage_bytes();
        let last = layout::MIPS as u32 - 1;
        (0..last).find(fits).unwrap_or(last)
    }

    /// Words of the maps of all layers, with texels from level `finest` on. Twin of `entry_words` in layer.wgsl.
    pub fn map_words(&self, finest: u32) -> u64 {
        let entry_words = 1 + self.variant.lights().max(1) as u64;
        self.quads() * u64::from(entries_of(finest)) * entry_words
    }

    /// `input` with the ribs in place of the hairstyle.
    pub fn of_ribs<'a>(&'a self, input: &FrameInput<'a>) -> FrameInput<'a> {
        FrameInput { style: &self.hair.ribs, hair: pose_by_guides(input), picture: &self.picture, ..*input }
    }
}

/// Entries of a map with texels from level `finest` on: a header, and a texel of each neighbour.
pub(super) fn entries_of(finest: u32) -> u32 {
    (layout::TEXELS as u32 >> finest) + 3
}

/// The uniform without what depends on the image.
pub(super) fn uniform_of(input: &FrameInput, frame: &Frame, finest: u32) -> ClusterUniform {
    let settings = &input.picture.clusters;
    // Each fits, because the vertices fit a buffer.
    let [around, along, layers, count] = {
        let RibGrid { layers, around, along } = frame.grid();
        [around, along, layers, frame.hair.clusters()].map(|n| n as u32)
    };
    let opacity = input.picture.strand_opacity;
    ClusterUniform {
        eye: input.camera.eye,
        depth: frame.share * opacity * lovelock_satf::strand_width(&input.look, frame.hair.strands),
        low: Vec2::ZERO,
        high: Vec2::ZERO,
        around,
        along,
        layers,
        count,
        core: frame.hair.core,
        shadow_strength: settings.shadow_strength,
        finest: finest as f32,
        as_published: u32::from(settings.shading == ClusterShading::Paper),
        matt: settings.diffuse,
        primary: settings.primary,
        secondary: settings.secondary,
        detail: settings.detail,
        entries: entries_of(finest),
        pattern: SectorRef::literal(1.0).index / layout::DEPTHS as u32,
        lanes: 1,
        light: 0,
        to_lights: {
            let mut all = [Vec4::ZERO; MAX_LIGHTS];
            all.iter_mut().zip(to_lights(input)).for_each(|(to, light)| *to = light.extend(0.0));
            all
        },
    }
}

/// The most threads per triangle.
const MAX_LANES: u64 = 64;
/// How much larger than at rest volumes may become in each direction.
const GROWN: f32 = 2.0;

/// Threads per triangle for hair in an area of the image (left, top, right, bottom), in which a metre has at most `scale` pixels.
pub(super) fn lanes(
    largest: Largest,
    frame: &Frame,
    [left, top, right, bottom]: [f32; 4],
    scale: f32,
) -> u32 {
    let [along, across] = [largest.along, largest.across].map(|metres| GROWN * metres * scale + 2.0);
    let most = (along * across).min((right - left) * (bottom - top));
    // No thread has too many pixels. Each pixel of a shadowed layer has a loop of its own.
    let steps = most * (1 + frame.variant.shadow_steps(frame.grid().layers)) as f32;
    // The number of a thread has 32 bits.
    let room = u64::from(u32::MAX) / (2 * frame.quads()).max(1);
    // NaN gives one.
    ((steps / MAX_PIXELS_A_THREAD).ceil() as u32).clamp(1, room.clamp(1, MAX_LANES) as u32)
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::super::kernels::shaders;
    use super::*;

    /// The layout of a structure that all these shaders have.
    fn layout_of(name: &str) -> Vec<usize> {
        let (_, source) = shaders().into_iter().next().expect("a shader");
        layout_in_shader(&source, name)
    }

    #[test]
    fn structures_have_the_layout_of_the_shader() {
        assert_eq!(
            layout_of("ClusterUniform"),
            [
                offset_of!(ClusterUniform, eye),
                offset_of!(ClusterUniform, depth),
                offset_of!(ClusterUniform, low),
                offset_of!(ClusterUniform, high),
                offset_of!(ClusterUniform, around),
                offset_of!(ClusterUniform, along),
                offset_of!(ClusterUniform, layers),
                offset_of!(ClusterUniform, count),
                offset_of!(ClusterUniform, core),
                offset_of!(ClusterUniform, shadow_strength),
                offset_of!(ClusterUniform, finest),
                offset_of!(ClusterUniform, as_published),
                offset_of!(ClusterUniform, matt),
                offset_of!(ClusterUniform, primary),
                offset_of!(ClusterUniform, secondary),
                offset_of!(ClusterUniform, detail),
                offset_of!(ClusterUniform, entries),
                offset_of!(ClusterUniform, pattern),
                offset_of!(ClusterUniform, lanes),
                offset_of!(ClusterUniform, light),
                offset_of!(ClusterUniform, to_lights),
                size_of::<ClusterUniform>(),
            ]
        );
        // Only shaders access it, but Rust allocates it.
        assert_eq!(layout_of("ClusterVertex").last(), Some(&size_of::<Vertex>()));
    }
}
