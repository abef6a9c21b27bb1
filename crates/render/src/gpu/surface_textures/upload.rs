//! The images of a body on the device, with all levels.

use lovelock_gpu::{Gpu, wgpu};
use lovelock_motion::Wrap;

use crate::textures::{BodyTextures, Chain, Content, Sampling, Texture};

/// The textures in the order of the chains, and the samplers that they need.
#[derive(Debug)]
pub(super) struct Uploaded {
    views: Vec<wgpu::TextureView>,
    samplers: Vec<(Sampling, wgpu::Sampler)>,
    white: wgpu::TextureView,
    plain: wgpu::Sampler,
}

impl Uploaded {
    pub fn new(gpu: &Gpu) -> Self {
        let white = texture(gpu, Content::Data, [1, 1], &[&[255; 4]]);
        Self { views: Vec::new(), samplers: Vec::new(), white, plain: sampler(gpu, Sampling::default()) }
    }

    /// Replaces all textures.
    pub fn write(&mut self, gpu: &Gpu, textures: &BodyTextures) {
        // The old ones are freed first.
        self.views.clear();
        self.views.extend(textures.chains.iter().map(|chain| upload(gpu, chain)));
        self.samplers.clear();
        for of in &textures.of {
            for texture in of.uses().into_iter().flatten() {
                if !self.samplers.iter().any(|(known, _)| *known == texture.sampling) {
                    self.samplers.push((texture.sampling, sampler(gpu, texture.sampling)));
                }
            }
        }
    }

    /// The texture and the sampler of a use, or white.
    pub fn of(&self, texture: Option<&Texture>) -> (&wgpu::TextureView, &wgpu::Sampler) {
        let found = texture.and_then(|texture| {
            let (_, sampler) = self.samplers.iter().find(|(known, _)| *known == texture.sampling)?;
            Some((self.views.get(texture.chain)?, sampler))
        });
        found.unwrap_or((&self.white, &self.plain))
    }
}

/// Uploads the levels that the device allows.
fn upload(gpu: &Gpu, chain: &Chain) -> wgpu::TextureView {
    let side = gpu.max_picture_side();
    let first = chain.levels.iter().position(|level| level.size.iter().all(|&size| size <= side));
    let levels = &chain.levels[first.unwrap_or(chain.levels.len() - 1)..];
    let texels: Vec<&[u8]> = levels.iter().map(|level| &level.texels[..]).collect();
    texture(gpu, chain.content, levels[0].size, &texels)
}

fn texture(gpu: &Gpu, content: Content, [width, height]: [u32; 2], levels: &[&[u8]]) -> wgpu::TextureView {
    let format = match content {
        Content::Color | Content::ColorByOpacity | Content::Mask(_) => wgpu::TextureFormat::Rgba8UnormSrgb,
        Content::Data => wgpu::TextureFormat::Rgba8Unorm,
    };
    let texture = gpu.create_texture(&wgpu::TextureDescriptor {
        label: Some("texture of the body"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in levels.iter().enumerate() {
        gpu.upload_level(&texture, level as u32, texels);
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn sampler(gpu: &Gpu, sampling: Sampling) -> wgpu::Sampler {
    let [across, down] = sampling.wrap.map(|wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    });
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture of the body"),
        address_mode_u: across,
        address_mode_v: down,
        mag_filter: if sampling.is_nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear },
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}
