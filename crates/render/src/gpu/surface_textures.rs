//! The materials of the body on the GPU: its textures, and the triangles of each material.

mod draw;
mod pipelines;
mod upload;

use std::ops::Range;
use std::sync::Arc;

use lovelock_gpu::{Gpu, GpuError, GrowBuffer, wgpu};
use lovelock_motion::{Alpha, Body};
use lovelock_picture::BodyLook;

use crate::surface_material::SurfaceMaterial;
use crate::textures::{BodyTextures, coordinate, share};
use draw::{MaterialDraw, group};
use pipelines::MaterialPipelines;
use upload::Uploaded;

/// The triangles of one material, as a range of indices.
#[derive(Clone, Debug)]
struct Part {
    indices: Range<u32>,
    is_double_sided: bool,
    group: wgpu::BindGroup,
}

/// The textures of a body and its triangles by material.
#[derive(Debug)]
pub(super) struct SurfaceTextures {
    pipelines: MaterialPipelines,
    body: Option<Arc<Body>>,
    textures: Option<Arc<BodyTextures>>,
    look: BodyLook,
    uploaded: Uploaded,
    /// Both sets of coordinates, opacity and occlusion of each vertex.
    vertices: GrowBuffer<[f32; 8]>,
    records: GrowBuffer<SurfaceMaterial>,
    /// Opaque materials first.
    parts: Vec<Part>,
    opaque: usize,
}

impl SurfaceTextures {
    /// Compiles the pipelines.
    ///
    /// # Errors
    /// A shader that does not compile.
    pub fn new(gpu: &Gpu, uniform_layout: &wgpu::BindGroupLayout) -> Result<Self, GpuError> {
        Ok(Self {
            pipelines: MaterialPipelines::new(gpu, uniform_layout)?,
            body: None,
            textures: None,
            look: BodyLook::default(),
            uploaded: Uploaded::new(gpu),
            vertices: GrowBuffer::new(gpu, "coordinates of textures", wgpu::BufferUsages::VERTEX),
            records: GrowBuffer::new(gpu, "materials", wgpu::BufferUsages::STORAGE),
            parts: Vec::new(),
            opaque: 0,
        })
    }

    /// Uploads what has changed. `indices` gets the triangles of the body sorted by material if it is another body.
    pub fn follow(&mut self, gpu: &Gpu, body: &Arc<Body>, look: &BodyLook, indices: &mut GrowBuffer<u32>) {
        let same_body = self.body.as_ref().is_some_and(|old| Arc::ptr_eq(old, body));
        if same_body && self.look == *look {
            return;
        }
        let Some(textures) = BodyTextures::of(body) else { return };
        let same_textures = self.textures.as_ref().is_some_and(|old| Arc::ptr_eq(old, &textures));
        if !same_textures {
            self.uploaded.write(gpu, &textures);
        }
        let records: Vec<_> = textures.materials.iter().map(|m| SurfaceMaterial::new(m, look)).collect();
        self.records.write(gpu, &records);
        let (sorted, ranges) = by_material(body, &textures);
        if !same_body {
            indices.write(gpu, sorted.as_flattened());
            self.vertices.write(gpu, &vertices_of(body));
        }
        let is_opaque = |material: usize| textures.materials[material].alpha == Alpha::Opaque;
        self.opaque = ranges.iter().filter(|(material, _)| is_opaque(*material)).count();
        self.parts = ranges
            .into_iter()
            .map(|(material, indices)| {
                let draw = MaterialDraw::new(&textures, material, &records[material]);
                let layout = &self.pipelines.layout;
                Part {
                    indices,
                    is_double_sided: textures.materials[material].is_double_sided,
                    group: group(gpu, layout, &draw, (&textures.of[material], &self.uploaded)),
                }
            })
            .collect();
        (self.body, self.textures, self.look) = (Some(Arc::clone(body)), Some(textures), *look);
    }

    /// Forgets the body, whose indices are no longer those of this.
    pub fn forget(&mut self) {
        (self.body, self.textures) = (None, None);
        self.parts.clear();
    }

    /// Whether any material has holes.
    pub fn has_holes(&self) -> bool {
        self.opaque < self.parts.len()
    }

    /// The indices of all opaque materials.
    pub fn opaque_indices(&self) -> Range<u32> {
        0..self.parts[..self.opaque].last().map_or(0, |part| part.indices.end)
    }

    pub fn bindings(&self) -> &wgpu::Buffer {
        self.records.raw()
    }

    /// Draws the triangles with holes into a depth map, after the others; vertex buffer 0 and the indices are set.
    pub fn draw_depth_of_holes(&self, pass: &mut wgpu::RenderPass) {
        pass.set_pipeline(&self.pipelines.depth);
        pass.set_vertex_buffer(1, self.vertices.raw().slice(..));
        for part in &self.parts[self.opaque..] {
            pass.set_bind_group(1, &part.group, &[]);
            pass.draw_indexed(part.indices.clone(), 0, 0..1);
        }
    }

    /// Draws all triangles; bind group 0, the vertex buffers 0 to 2 and the indices are set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_vertex_buffer(3, self.vertices.raw().slice(..));
        for (k, part) in self.parts.iter().enumerate() {
            let of = &self.pipelines.surface[usize::from(k >= self.opaque)];
            pass.set_pipeline(&of[usize::from(!part.is_double_sided)]);
            pass.set_bind_group(1, &part.group, &[]);
            pass.draw_indexed(part.indices.clone(), 0, 0..1);
        }
    }
}

/// The material of each part, and its indices.
type MaterialParts = Vec<(usize, Range<u32>)>;

/// The triangles of a body sorted by material, opaque ones first, and the indices of each material.
fn by_material(body: &Body, textures: &BodyTextures) -> (Vec<[u32; 3]>, MaterialParts) {
    let triangles = &body.mesh.triangles;
    let mut order: Vec<(bool, usize, u32)> = (0..triangles.len())
        .map(|i| {
            let material = textures.material_of(body, i);
            (textures.materials[material].alpha != Alpha::Opaque, material, i as u32)
        })
        .collect();
    order.sort_unstable();
    let sorted = order.iter().map(|&(_, _, i)| triangles[i as usize]).collect();
    let mut ranges: Vec<(usize, Range<u32>)> = Vec::new();
    for (i, &(_, material, _)) in order.iter().enumerate() {
        let end = 3 * (i as u32 + 1);
        match ranges.last_mut() {
            Some((last, range)) if *last == material => range.end = end,
            _ => ranges.push((material, end - 3..end)),
        }
    }
    (sorted, ranges)
}

fn vertices_of(body: &Body) -> Vec<[f32; 8]> {
    let mesh = &body.mesh;
    let [first, second] = &mesh.coordinates;
    (0..mesh.positions.len())
        .map(|i| {
            let (a, b) = (coordinate(first, i), coordinate(second, i));
            [a.x, a.y, b.x, b.y, share(&mesh.opacity, i), share(&mesh.occlusion, i), 0.0, 0.0]
        })
        .collect()
}

/// The shaders, for tests.
pub(super) use pipelines::shaders;
