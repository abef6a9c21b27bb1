//! The body on the GPU: its buffers, and its depth maps for all lights.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, wgpu};
use lovelock_motion::Body;
use rayon::prelude::*;

use super::pipelines::Pipelines;
use super::shadow::Vertices;
use super::surface_textures::SurfaceTextures;
use super::targets::DEPTH_FORMAT;
use crate::closed::{Closedness, encloses};
use crate::skin::ScalpPaint;
use crate::textures::BodyTextures;
use crate::{FrameInput, MAX_LIGHTS};

/// Vertex attributes that change every frame: position and normal. Shadow methods read them as two `vec4f`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct VertexPose {
    position: [f32; 4],
    normal: [f32; 4],
}

/// Colour, and 1 where hair grows.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct VertexColor([f32; 4]);

/// The body's buffers and depth maps.
#[derive(Debug)]
pub(super) struct SurfaceBuffers {
    body: Option<Arc<Body>>,
    closed: Closedness,
    is_closed: bool,
    /// Whether the body is closed and the eye outside.
    seen_from_without: bool,
    moving: GrowBuffer<VertexPose>,
    hair: GrowBuffer<u32>,
    fixed: GrowBuffer<VertexColor>,
    indices: GrowBuffer<u32>,
    staging: Vec<VertexPose>,
    /// The materials of the body, once there was a body with some, and whether this one has.
    textures: Option<SurfaceTextures>,
    has_materials: bool,
    depth: DepthMaps,
    /// Texels along the edge of a depth map.
    pub texels: u32,
}

impl SurfaceBuffers {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        // A texel is about one millimetre for a standing figure on a GPU, two on a software adapter.
        let texels = if gpu.is_software() { 1024 } else { 2048 };
        let vertex = wgpu::BufferUsages::VERTEX;
        Self {
            body: None,
            closed: Closedness::default(),
            is_closed: false,
            seen_from_without: false,
            moving: GrowBuffer::new(gpu, "body surface", vertex | wgpu::BufferUsages::STORAGE),
            hair: GrowBuffer::new(gpu, "hair on the body", vertex | wgpu::BufferUsages::STORAGE),
            fixed: GrowBuffer::new(gpu, "body colours", vertex),
            indices: GrowBuffer::new(gpu, "body triangles", wgpu::BufferUsages::INDEX),
            staging: Vec::new(),
            textures: None,
            has_materials: false,
            depth: DepthMaps::new(gpu, pipelines, texels, MAX_LIGHTS),
            texels,
        }
    }

    /// The depth maps of all lights, as a texture array.
    pub fn depth(&self) -> &wgpu::TextureView {
        &self.depth.view
    }

    /// Makes room for so many depth maps.
    pub fn fit_depth(&mut self, gpu: &Gpu, pipelines: &Pipelines, layers: usize) {
        let layers = layers.max(MAX_LIGHTS);
        if layers > self.depth.layers.len() || layers * 2 < self.depth.layers.len() {
            self.depth = DepthMaps::new(gpu, pipelines, self.texels, layers);
        }
    }

    /// The materials of the body, if it has any.
    pub fn materials(&self) -> Option<&wgpu::Buffer> {
        self.drawn_textures().map(SurfaceTextures::bindings)
    }

    /// Uploads one frame.
    ///
    /// # Errors
    /// The pipelines of the first body with materials do not compile.
    pub fn write(&mut self, gpu: &Gpu, pipelines: &Pipelines, input: &FrameInput) -> Result<(), GpuError> {
        let eye = input.camera.eye;
        let Some((body, skin)) = input.body else {
            (self.body, self.has_materials) = (None, false);
            self.textures.iter_mut().for_each(SurfaceTextures::forget);
            self.indices.reserve(gpu, 0);
            self.moving.reserve(gpu, 0);
            return Ok(());
        };
        self.has_materials = BodyTextures::are_in(body);
        if !self.body.as_ref().is_some_and(|old| Arc::ptr_eq(old, body)) {
            let mesh = &body.mesh;
            let mut paint = ScalpPaint::default();
            paint.follow(body);
            let fixed: Vec<_> = (0..mesh.positions.len())
                .map(|i| {
                    let color = mesh.colors.get(i).copied().unwrap_or(Vec3::splat(0.5));
                    VertexColor([color.x, color.y, color.z, paint.values.get(i).copied().unwrap_or(0.0)])
                })
                .collect();
            self.fixed.write(gpu, &fixed);
            if !self.has_materials {
                self.indices.write(gpu, mesh.triangles.as_flattened());
                self.textures.iter_mut().for_each(SurfaceTextures::forget);
            }
            self.body = Some(Arc::clone(body));
        }
        if self.has_materials {
            let drawn = match &mut self.textures {
                Some(drawn) => drawn,
                none => none.insert(SurfaceTextures::new(gpu, &pipelines.uniform_layout)?),
            };
            drawn.follow(gpu, body, &input.picture.body_look, &mut self.indices);
        }
        self.is_closed = self.closed.of(body);
        self.seen_from_without = self.is_closed && !encloses(eye, &skin.positions, &body.mesh.triangles);
        skin.positions
            .par_iter()
            .zip(&skin.normals)
            .map(|(p, n)| VertexPose { position: [p.x, p.y, p.z, 1.0], normal: [n.x, n.y, n.z, 0.0] })
            .collect_into_vec(&mut self.staging);
        self.moving.write(gpu, &self.staging);
        self.hair.reserve(gpu, self.staging.len());
        Ok(())
    }

    fn drawn_textures(&self) -> Option<&SurfaceTextures> {
        self.textures.as_ref().filter(|_| self.has_materials)
    }

    /// The vertices for shadow methods; `None` without a body.
    pub fn vertices(&self) -> Option<Vertices<'_>> {
        (!self.moving.is_empty()).then(|| Vertices {
            positions: self.moving.raw(),
            count: self.moving.len() as u32,
            hair: self.hair.raw(),
        })
    }

    /// Draws the depth of the body into a layer. Triangles that face away from the light are left out if they are `behind` others.
    pub fn draw_depth(
        &self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        commands: &mut Commands,
        (layer, shadow_from_world): (usize, Mat4),
        behind: bool,
    ) {
        let (buffer, group) = &self.depth.uniforms[layer];
        gpu.upload(buffer, 0, &[shadow_from_world]);
        let descriptor = wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth.layers[layer],
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        };
        commands.render("draw/body-depth", &descriptor, |pass| {
            if self.indices.is_empty() {
                return;
            }
            let textures = self.drawn_textures();
            let holed = textures.filter(|textures| textures.has_holes());
            // Light passes through holes to faces that look away from it.
            let culled = self.is_closed && behind && holed.is_none();
            pass.set_pipeline(&pipelines.depth[usize::from(culled)]);
            pass.set_bind_group(0, group, &[]);
            pass.set_vertex_buffer(0, self.moving.raw().slice(..));
            pass.set_index_buffer(self.indices.raw().slice(..), wgpu::IndexFormat::Uint32);
            let opaque = holed.map_or(0..self.indices.len() as u32, SurfaceTextures::opaque_indices);
            pass.draw_indexed(opaque, 0, 0..1);
            if let Some(holed) = holed {
                holed.draw_depth_of_holes(pass);
            }
        });
    }

    /// Draws the body. `uniform` is that of the frame.
    pub fn draw(&self, pipelines: &Pipelines, pass: &mut wgpu::RenderPass, uniform: &wgpu::BindGroup) {
        if self.indices.is_empty() {
            return;
        }
        if !self.has_materials {
            pass.set_pipeline(&pipelines.surface[usize::from(self.seen_from_without)]);
        }
        pass.set_bind_group(0, uniform, &[]);
        pass.set_vertex_buffer(0, self.moving.raw().slice(..));
        pass.set_vertex_buffer(1, self.fixed.raw().slice(..));
        pass.set_vertex_buffer(2, self.hair.raw().slice(..));
        pass.set_index_buffer(self.indices.raw().slice(..), wgpu::IndexFormat::Uint32);
        match self.drawn_textures() {
            Some(textures) => textures.draw(pass),
            None => pass.draw_indexed(0..self.indices.len() as u32, 0, 0..1),
        }
    }
}

/// The depth maps of the body: layers of a texture, each with the uniform of its pass.
#[derive(Debug)]
struct DepthMaps {
    view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    uniforms: Vec<(wgpu::Buffer, wgpu::BindGroup)>,
}

impl DepthMaps {
    fn new(gpu: &Gpu, pipelines: &Pipelines, texels: u32, count: usize) -> Self {
        let device = &gpu.device;
        let texture = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("body depth"),
            size: wgpu::Extent3d { width: texels, height: texels, depth_or_array_layers: count as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let layers = (0..count as u32)
            .map(|layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer: layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let uniforms = (0..count)
            .map(|_| {
                let buffer = gpu.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("depth pass"),
                    size: 64,
                    usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("depth pass"),
                    layout: &pipelines.uniform_layout,
                    entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
                });
                (buffer, group)
            })
            .collect();
        Self { view, layers, uniforms }
    }
}
