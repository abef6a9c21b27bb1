//! Shadow methods on the GPU: the passes of each, in step with its definition on the processor.

mod ask;
#[cfg(test)]
pub(crate) mod layout;
mod memory;

use std::fmt::Debug;

use glam::{Mat4, Vec3};
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderPart, wgpu};

use crate::bounds::Bounds;
use crate::{LightFrame, ShadowError, ShadowReport, ShadowSettings};

pub(crate) use ask::Ask;
pub(crate) use memory::{Buffer, fits_device};

/// Strands that are on the device.
#[derive(Clone, Copy, Debug)]
pub struct GpuStrands<'a> {
    /// Positions, world space, metres: `array<vec4f>` whose last component is unused.
    pub points: &'a wgpu::Buffer,
    /// Number of points.
    pub point_count: u32,
    /// First point of each segment: `array<u32>`; the second one is the next point.
    pub segments: &'a wgpu::Buffer,
    /// Number of segments.
    pub segment_count: u32,
}

/// What a map is built from on the GPU.
#[derive(Clone, Copy, Debug)]
pub struct GpuShadowInput<'a> {
    /// The strands that cast the shadow.
    pub strands: GpuStrands<'a>,
    /// Bounds of their points along the light's axes, relative to the anchor, metres; may be a little larger.
    pub bounds: Bounds,
    /// Length of the longest strand, metres.
    pub longest_strand: f32,
    /// As [`ShadowInput::strand_width`](crate::ShadowInput::strand_width).
    pub strand_width: f32,
    /// The light's direction and axes.
    pub light: LightFrame,
    /// As [`ShadowInput::anchor`](crate::ShadowInput::anchor).
    pub anchor: Vec3,
    /// As [`ShadowInput::maps`](crate::ShadowInput::maps).
    pub maps: u32,
}

/// Points that a map is asked at, and where its answers go.
#[derive(Clone, Copy, Debug)]
pub struct GpuTargets<'a> {
    /// Positions, world space, metres: every `stride`-th of an `array<vec4f>`.
    pub points: &'a wgpu::Buffer,
    /// Items of the array from one point to the next.
    pub stride: u32,
    /// Number of points.
    pub count: u32,
    /// One word a point: four transmittances of 8 bits, the first light's in the lowest byte. Asking the map of slot *k*
    /// sets byte *k*; that of slot 0 sets the others to all light.
    pub out: &'a wgpu::Buffer,
    /// Where the sum of the bytes of slot 0 is added, if anywhere: an `array<u32>` of [`SUM_WORDS`] words, which make it
    /// together.
    pub sum: Option<&'a wgpu::Buffer>,
}

/// Words of [`GpuTargets::sum`]; twin of the constant in `ask.wgsl`.
pub const SUM_WORDS: u64 = 256;

/// What lies behind the whole hair, on the device: see [`ColumnMap`](crate::ColumnMap).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuColumns {
    /// Texels along each edge that were written, from the texture's first corner.
    pub size: u32,
    /// World position to `(u, v, depth)`, u and v in `0..1` over these texels.
    pub uv_from_world: Mat4,
}

/// A shadow method on the GPU. It holds a map a light, in slots from 0 on.
pub trait GpuShadow: Debug + Send {
    /// Encodes the passes that make the map of slot `slot`. Memory is kept from build to build.
    ///
    /// # Errors
    /// The map would take more memory than the method may use or than the device gives to one buffer; or the driver does not
    /// compile what these settings need.
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError>;

    /// Encodes asking the map of a slot, which must have been built, at many points.
    fn ask(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets);

    /// The most texels along an edge that [`GpuShadow::columns`] writes for the map of a slot; 0 where it writes none.
    fn columns_size(&self, slot: usize) -> u32;

    /// Encodes writing what lies behind the whole hair into a texture of `rgba8unorm`, at least as large as
    /// [`GpuShadow::columns_size`] says.
    fn columns(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns>;

    /// Call when the device is done with a frame: whether maps were too small for what they should hold and the frame
    /// must be drawn anew; there is more room then.
    ///
    /// # Errors
    /// What is needed is more than the method may use, or the device is lost.
    fn settle(&mut self, _gpu: &Gpu) -> Result<bool, GpuShadowError> {
        Ok(false)
    }

    /// Gives the memory of all maps back; they must be built again before they are asked.
    fn forget(&mut self, _gpu: &Gpu) {}

    /// What the last build of a slot cost and met, as far as the processor knows.
    fn report(&self, slot: usize) -> ShadowReport;

    /// The words of the map of a slot, read back: for tests and for looking into it.
    ///
    /// # Errors
    /// The device is lost.
    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError>;
}

/// Why a shadow failed on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuShadowError {
    /// It does not fit.
    #[error(transparent)]
    Shadow(#[from] ShadowError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// The file of a shader beside the Rust file that names it.
macro_rules! wgsl {
    ($folder:literal, $name:literal) => {
        lovelock_gpu::ShaderPart {
            name: concat!("crates/shadow/src/", $folder, $name),
            text: include_str!($name),
        }
    };
}
pub(crate) use wgsl;

/// The part that every shader begins with: the exponential of the processor's definitions.
pub(crate) const EXP: ShaderPart = wgsl!("gpu/", "exp.wgsl");
