//! The render targets of the body.

use lovelock_gpu::{Gpu, wgpu};

/// Samples per pixel: supported by every WebGPU device for every format in use.
pub(super) const SAMPLES: u32 = 4;
/// Normals and transmittance of hair.
pub(super) const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Uint;
/// Colour, and 1 where hair grows.
pub(super) const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The textures for one size of picture.
#[derive(Debug)]
pub(super) struct Targets {
    pub width: u32,
    pub height: u32,
    pub normals: wgpu::TextureView,
    pub colors: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    /// What materials add: bumped normal, material and occlusion; colour in shade and emitted light.
    pub materials: Option<[wgpu::TextureView; 2]>,
}

impl Targets {
    /// Memory of all textures: per sample 8 bytes for normals, 8 for colours, 4 for depth and 16 for materials.
    pub fn memory_bytes(&self) -> u64 {
        let bytes = if self.materials.is_some() { 36 } else { 20 };
        u64::from(self.width) * u64::from(self.height) * u64::from(SAMPLES) * bytes
    }

    /// Textures for a size of picture, with those of materials if it has any.
    pub fn new(gpu: &Gpu, [width, height]: [u32; 2], has_materials: bool) -> Self {
        let make = |label, format| {
            let texture = gpu.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: SAMPLES,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            width,
            height,
            normals: make("normals", NORMAL_FORMAT),
            colors: make("colours", COLOR_FORMAT),
            depth: make("depths", DEPTH_FORMAT),
            materials: has_materials
                .then(|| [make("materials", NORMAL_FORMAT), make("colours of materials", NORMAL_FORMAT)]),
        }
    }
}
