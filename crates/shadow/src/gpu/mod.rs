//! Shadow methods on the GPU. Each computes what its definition on the CPU computes.

mod lookup;
mod memory;

use std::fmt::Debug;

use glam::{Mat4, Vec3};
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderPart, wgpu};

use crate::bounds::Bounds;
use crate::{LightFrame, ShadowError, ShadowReport, ShadowSettings};

pub(crate) use lookup::{PointLookup, projected_constant};
pub(crate) use memory::{Buffer, fits_device};

/// Strands in GPU memory.
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

/// The input of a build on the GPU.
#[derive(Clone, Copy, Debug)]
pub struct GpuShadowInput<'a> {
    /// The strands that cast the shadow.
    pub strands: GpuStrands<'a>,
    /// Bounds of their points along the light's axes, relative to the anchor, metres. They may be a little larger.
    pub bounds: Bounds,
    /// The same along the axes of the world, for the methods that are [in the world](crate::ShadowMethod::in_world). Others do not read
    /// it.
    pub extent: Bounds,
    /// Length of the longest strand, metres.
    pub longest_strand: f32,
    /// As [`ShadowInput::strand_width`](crate::ShadowInput::strand_width).
    pub strand_width: f32,
    /// As [`ShadowInput::extinction_scale`](crate::ShadowInput::extinction_scale).
    pub extinction_scale: f32,
    /// The light's direction and axes.
    pub light: LightFrame,
    /// As [`ShadowInput::anchor`](crate::ShadowInput::anchor).
    pub anchor: Vec3,
    /// As [`ShadowInput::maps`](crate::ShadowInput::maps).
    pub maps: u32,
    /// The bounds along the axes of each of the light's [`LightFrame::samples`], if there are several.
    pub sample_bounds: &'a [Bounds],
    /// The list of fragments that this map adds its own to, of several maps of one light: only [`gpu_shadow`](crate::gpu_shadow) sets it.
    pub shared_list: Option<SharedList>,
    /// As [`ShadowInput::projected`](crate::ShadowInput::projected): only [`gpu_shadow`](crate::gpu_shadow) sets it.
    pub projected: Option<GpuProjected>,
}

/// One list of fragments of several maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharedList {
    /// The slot of the first of the maps, which holds it.
    pub of: usize,
    /// Their number.
    pub maps: u32,
}

/// What is known of strands that were projected from a light. The fourth coordinate of a point is a factor on the width of its strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuProjected {
    /// Distance of the plane, metres.
    pub plane: f32,
    /// Distance from the light of depth 0, metres.
    pub start: f32,
    /// Slots that are in use.
    pub slots: u32,
}

impl GpuShadowInput<'_> {
    /// Slots that are in use.
    pub(crate) fn slots(&self) -> usize {
        self.projected.map_or(self.maps, |projected| projected.slots).max(1) as usize
    }
}

/// Points to look up, and the buffers for the results.
#[derive(Clone, Copy, Debug)]
pub struct GpuTargets<'a> {
    /// Positions, world space, metres: every `stride`-th of an `array<vec4f>`.
    pub points: &'a wgpu::Buffer,
    /// Items of the array from one point to the next.
    pub stride: u32,
    /// Number of points.
    pub count: u32,
    /// One word per point: four 8-bit transmittances, the first light in the lowest byte. A lookup in slot *k* sets byte *k*;
    /// a lookup in slot 0 sets the other bytes to full transmittance.
    pub out: &'a wgpu::Buffer,
    /// If set, an `array<u32>` of [`SUM_WORDS`] words whose total is increased by the bytes of slot 0.
    pub sum: Option<&'a wgpu::Buffer>,
    /// The byte that is written, if it is not that of the slot: only [`gpu_shadow`](crate::gpu_shadow) sets it.
    pub byte: Option<u32>,
    /// How the points are projected before they are looked up: only [`gpu_shadow`](crate::gpu_shadow) sets it.
    pub projected: Option<&'a ProjectedTargets>,
}

/// How points are projected before they are looked up, and for which light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedTargets {
    /// A point near the hair, world space, and the light's axes.
    pub anchor: Vec3,
    /// See `anchor`.
    pub axes: [Vec3; 3],
    /// The anchor, seen from the light along the axes.
    pub offset: Vec3,
    /// Distance of the plane, metres.
    pub plane: f32,
    /// Planes of the light: 1 or 6.
    pub sides: u32,
    /// The plane whose points are looked up.
    pub side: u32,
    /// Bits of the planes without hair, whose points are lit.
    pub lit: u32,
    /// The slot of the light.
    pub slot: u32,
}

/// Words of [`GpuTargets::sum`]; twin of the constant in `lookup.wgsl`.
pub const SUM_WORDS: u64 = 256;

/// The transmittance behind the whole hair in GPU memory; see [`ColumnMap`](crate::ColumnMap).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuColumns {
    /// Texels along each edge that were written, from the first corner of the texture.
    pub size: u32,
    /// As [`ColumnMap::uv_from_world`](crate::ColumnMap::uv_from_world), u and v in `0..1` over these texels.
    pub uv_from_world: Mat4,
}

/// A list of fragments on the device, or another count that comes back with a frame.
#[derive(Clone, Copy, Debug)]
pub struct GpuList<'a> {
    /// Holds its head: the number of fragments modulo 2³², and a multiple of 2¹⁶ below the number, divided by 2¹⁶.
    pub buffer: &'a wgpu::Buffer,
    /// The first byte of the head.
    pub at: u64,
    /// The number of fragments that it can hold.
    pub room: u64,
}

impl GpuList<'_> {
    /// The number of fragments in a head. Each of at most 2¹⁶ workgroups loses less than 2¹⁶ in the second word, so the number lies
    /// between that word times 2¹⁶ and 2³² more; the first word determines it.
    pub fn fragments([low, high]: [u32; 2]) -> u64 {
        let base = u64::from(high) << 16;
        base + u64::from(low.wrapping_sub(base as u32))
    }
}

/// A shadow method on the GPU. It holds one map per light, in slots that count from 0.
pub trait GpuShadow: Debug + Send {
    /// Encodes the passes that build the map of slot `slot`. Memory is reused from build to build.
    ///
    /// # Errors
    /// The map would use more memory than the limit of the method or than one buffer of the device; or the driver cannot compile
    /// the kernels for these settings.
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError>;

    /// Encodes looking up many points in the map of a slot, which must have been built.
    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets);

    /// The most texels along an edge that [`GpuShadow::columns`] writes for the map of a slot; 0 if it writes none.
    fn columns_size(&self, slot: usize) -> u32;

    /// The maps of transmittance behind all hair of a slot: one, or one per side of a cube around its light.
    fn column_sides(&self, _slot: usize) -> usize {
        1
    }

    /// Encodes writing the transmittance behind the whole hair, of a slot and one of its sides, into a texture of `rgba8unorm` with at
    /// least [`GpuShadow::columns_size`] texels along each edge.
    fn columns(
        &mut self,
        map: (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns>;

    /// The list of fragments of the map of a slot, if its length is known only once the device has built it.
    fn list(&self, _slot: usize) -> Option<GpuList<'_>> {
        None
    }

    /// Takes the heads of the lists of slots 0, 1, … of a finished frame. Lists that were too short are enlarged, the result is `true`,
    /// and the frame must be rendered again.
    ///
    /// # Errors
    /// The maps need more than the limit of the method or than the device supports.
    fn settle(&mut self, _gpu: &Gpu, _heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        Ok(false)
    }

    /// Frees the memory of all maps. They must be built again before the next lookup.
    fn forget(&mut self, _gpu: &Gpu) {}

    /// Statistics of the last build of a slot, as far as the CPU can determine them.
    fn report(&self, slot: usize) -> ShadowReport;

    /// Reads back the words of the map of a slot, for tests and for inspection.
    ///
    /// # Errors
    /// The device is lost.
    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError>;
}

/// Why a shadow failed on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum GpuShadowError {
    /// The map does not fit into memory.
    #[error(transparent)]
    Shadow(#[from] ShadowError),
    /// The device failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}

/// A shader file beside the Rust file that names it.
macro_rules! wgsl {
    ($folder:literal, $name:literal) => {
        lovelock_gpu::ShaderPart {
            name: concat!("crates/shadow/src/", $folder, $name),
            text: include_str!($name),
        }
    };
}
pub(crate) use wgsl;

/// The first part of every shader: the exponential function of the definitions on the CPU.
pub(crate) const EXP: ShaderPart = wgsl!("gpu/", "exp.wgsl");

/// What projected pieces of strands are along rays of the light; see [`crate::perspective`].
pub(crate) const RAY: ShaderPart = wgsl!("gpu/", "ray.wgsl");
