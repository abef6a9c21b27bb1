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
}

impl Targets {
    /// Memory of all textures: per sample 8 bytes for normals, 8 for colours and 4 for depth.
    pub fn memory_bytes(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * u64::from(SAMPLES) * 20
    }

    pub fn new(gpu: &Gpu, width: u32, height: u32) -> Self {
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
        }
    }
}
