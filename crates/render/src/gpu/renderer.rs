//! One picture from top to bottom.

use std::sync::Arc;

use lovelock_gpu::{Gpu, Stopwatch, read_texture_rgba8, wgpu};

use super::hair::HairBuffers;
use super::pipelines::Pipelines;
use super::surface::SurfaceBuffers;
use super::targets::Targets;
use crate::light_view::{bounding_sphere, light_view};
use crate::picture::check_size_for;
use crate::shadow_stage::ShadowStage;
use crate::uniform::{FrameUniform, LightMaps};
use crate::{FrameInput, FrameStats, MAX_LIGHTS, Picture, RenderError};

/// Draws pictures on a GPU, and keeps what it needs for the next one.
#[derive(Debug)]
pub struct GpuRenderer {
    gpu: Arc<Gpu>,
    pipelines: Pipelines,
    shadow: ShadowStage,
    hair: HairBuffers,
    surface: SurfaceBuffers,
    columns: Columns,
    compare: wgpu::Sampler,
    linear: wgpu::Sampler,
    uniform: wgpu::Buffer,
    targets: Option<Targets>,
}

impl GpuRenderer {
    /// Compiles what drawing needs.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: Arc<Gpu>) -> Result<Self, RenderError> {
        let pipelines = gpu.checked(|| Pipelines::new(&gpu))??;
        let device = &gpu.device;
        let linear = wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        };
        Ok(Self {
            shadow: ShadowStage::default(),
            hair: HairBuffers::new(&gpu),
            surface: SurfaceBuffers::new(&gpu, &pipelines),
            columns: Columns::new(device, 1),
            compare: device.create_sampler(&wgpu::SamplerDescriptor {
                compare: Some(wgpu::CompareFunction::LessEqual),
                ..linear
            }),
            linear: device.create_sampler(&linear),
            uniform: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame"),
                size: size_of::<FrameUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            targets: None,
            pipelines,
            gpu,
        })
    }

    /// The device that it draws on.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Draws `input` at `width` by `height` pixels and reads the picture back.
    ///
    /// # Errors
    /// A size out of range, or a device that is lost.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        let mut stats = self.draw(input, width, height)?;
        let watch = Stopwatch::start();
        if let Some(targets) = &self.targets {
            read_texture_rgba8(&self.gpu, &targets.out, &mut picture.rgba)?;
        }
        (picture.width, picture.height) = (width, height);
        stats.draw_ms += watch.ms();
        Ok(stats)
    }

    /// Draws `input` at `width` by `height` pixels into a texture that stays on the device.
    fn draw(&mut self, input: &FrameInput, width: u32, height: u32) -> Result<FrameStats, RenderError> {
        check_size_for(width, height, self.gpu.max_picture_side())?;
        if !input.picture.transparency.is_on_gpu() {
            return Err(RenderError::Transparency(input.picture.transparency));
        }
        let watch = Stopwatch::start();
        self.shadow.run(input)?;
        let shadow_ms = watch.ms();

        let watch = Stopwatch::start();
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let transparency = input.picture.transparency;
        self.hair.write(&self.gpu, &self.pipelines, input, &self.shadow.at_points);
        self.surface.write(&self.gpu, input.body, &self.shadow.at_vertices);
        self.columns.write(&self.gpu, &self.shadow);

        let (center, radius) = bounding_sphere(input.body.map_or(&[], |(_, skin)| &skin.positions));
        let mut maps = Vec::with_capacity(MAX_LIGHTS);
        for light in input.lights.iter().filter(|light| light.enabled).take(MAX_LIGHTS) {
            let view = light_view(light.clamped().direction, center, radius, self.surface.texels);
            let columns_from_world =
                self.columns.scale(self.shadow.columns_from_world(maps.len()), maps.len());
            maps.push(LightMaps { columns_from_world, ..view });
        }
        let uniform = FrameUniform::new(input, width, height, &maps, self.surface.texels);
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));

        if self.targets.as_ref().is_none_or(|t| (t.width, t.height) != (width, height)) {
            self.targets = Some(Targets::new(device, width, height));
        }
        let Some(targets) = &self.targets else {
            return Ok(FrameStats::default());
        };
        let frame = self.frame_group();
        let tone = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tone map"),
            layout: &self.pipelines.tone_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&targets.resolved),
            }],
        });

        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        for (k, map) in maps.iter().enumerate() {
            self.surface.draw_depth(&self.gpu, &self.pipelines, &mut encoder, k, map.shadow_from_world);
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("strand points"),
                timestamp_writes: None,
            });
            self.hair.shade(&self.pipelines, &mut pass, &frame);
        }
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("picture"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &targets.color,
                    depth_slice: None,
                    resolve_target: Some(&targets.resolved),
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Discard,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &targets.depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&self.pipelines.backdrop);
            pass.set_bind_group(0, &frame, &[]);
            pass.draw(0..3, 0..1);
            self.surface.draw(&self.pipelines, &mut pass, &frame);
            self.hair.draw(&self.pipelines, &mut pass, &frame, transparency);
        }
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("tone map"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &targets.out_view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipelines.tone_map);
            pass.set_bind_group(0, &frame, &[]);
            pass.set_bind_group(1, &tone, &[]);
            pass.draw(0..3, 0..1);
        }
        queue.submit([encoder.finish()]);
        Ok(FrameStats {
            shadow_ms,
            draw_ms: watch.ms(),
            draw: None,
            segments: u64::from(self.hair.segment_count()),
            shadow_bytes: self.shadow.bytes,
            mean_transmittance: self.shadow.mean,
        })
    }

    fn frame_group(&self) -> wgpu::BindGroup {
        let resources = [
            self.uniform.as_entire_binding(),
            wgpu::BindingResource::TextureView(&self.surface.depth),
            wgpu::BindingResource::Sampler(&self.compare),
            wgpu::BindingResource::TextureView(&self.columns.view),
            wgpu::BindingResource::Sampler(&self.linear),
        ];
        let entries: Vec<_> = resources
            .into_iter()
            .enumerate()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: binding as u32, resource })
            .collect();
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &self.pipelines.frame_layout,
            entries: &entries,
        })
    }
}

/// What all hair lets through, a layer a light, for surfaces far behind it.
#[derive(Debug)]
struct Columns {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    sizes: [u32; MAX_LIGHTS],
}

impl Columns {
    fn new(device: &wgpu::Device, size: u32) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("hair columns"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: MAX_LIGHTS as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Self { texture, view, sizes: [0; MAX_LIGHTS] }
    }

    fn write(&mut self, gpu: &Gpu, shadow: &ShadowStage) {
        let most = shadow.columns.iter().flatten().map(|map| map.size).max().unwrap_or(1).max(1);
        if most > self.texture.width() {
            *self = Self::new(&gpu.device, most);
        }
        self.sizes = [0; MAX_LIGHTS];
        for (k, map) in shadow.columns.iter().enumerate() {
            let Some(map) = map else { continue };
            let bytes: Vec<u8> =
                map.transmittance.iter().map(|t| (t.clamp(0.0, 1.0) * 255.0 + 0.5) as u8).collect();
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    origin: wgpu::Origin3d { x: 0, y: 0, z: k as u32 },
                    ..self.texture.as_image_copy()
                },
                &bytes,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(map.size),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width: map.size, height: map.size, depth_or_array_layers: 1 },
            );
            self.sizes[k] = map.size;
        }
    }

    /// A map may be smaller than the texture that holds it: scales its coordinates to its corner.
    fn scale(&self, uv_from_world: glam::Mat4, k: usize) -> glam::Mat4 {
        let part = self.sizes[k] as f32 / self.texture.width() as f32;
        if part == 0.0 || part == 1.0 {
            return uv_from_world;
        }
        glam::Mat4::from_scale(glam::Vec3::new(part, part, 1.0)) * uv_from_world
    }
}
