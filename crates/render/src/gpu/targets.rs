//! The textures that a picture is drawn in.

use lovelock_gpu::wgpu;

/// Samples a pixel: what every WebGPU device can do with every format used here.
pub(super) const SAMPLES: u32 = 4;
pub(super) const HDR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
pub(super) const OUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The textures of one size of picture.
#[derive(Debug)]
pub(super) struct Targets {
    pub width: u32,
    pub height: u32,
    /// Linear light, several samples a pixel.
    pub color: wgpu::TextureView,
    /// Depth, several samples a pixel.
    pub depth: wgpu::TextureView,
    /// Linear light, one sample a pixel.
    pub resolved: wgpu::TextureView,
    /// The finished picture, sRGB encoded.
    pub out: wgpu::Texture,
    pub out_view: wgpu::TextureView,
}

impl Targets {
    pub fn new(device: &wgpu::Device, width: u32, height: u32) -> Self {
        let make = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let attachment = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let color = make("linear samples", HDR_FORMAT, SAMPLES, attachment);
        let depth =
            make("depth samples", DEPTH_FORMAT, SAMPLES, attachment | wgpu::TextureUsages::TEXTURE_BINDING);
        let resolved = make("linear", HDR_FORMAT, 1, attachment | wgpu::TextureUsages::TEXTURE_BINDING);
        let out = make(
            "picture",
            OUT_FORMAT,
            1,
            attachment | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
        );
        Self {
            width,
            height,
            color: view(&color),
            depth: view(&depth),
            resolved: view(&resolved),
            out_view: view(&out),
            out,
        }
    }
}
