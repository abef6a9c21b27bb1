//! The pipelines that draw a body with materials.

use lovelock_gpu::{Gpu, GpuError, ShaderPart, ShaderSource, wgpu};
use lovelock_shadow::cube;

use super::draw;
use crate::gpu::pipelines::{
    CULLS, FIXED_VERTEX_BYTES, FRAME, MOVING_VERTEX_BYTES, depth_state, shader_part as part,
};
use crate::gpu::targets::{COLOR_FORMAT, NORMAL_FORMAT, SAMPLES};

const MATERIAL_DRAW: ShaderPart = part!("material_draw.wgsl");
const MATERIAL_SURFACE: ShaderPart = part!("material_surface.wgsl");
const MATERIAL_DEPTH: ShaderPart = part!("material_depth.wgsl");

/// Bytes of one vertex: both sets of coordinates, opacity, occlusion, two unused.
const COORDINATES_BYTES: u64 = 32;

/// The shaders with their labels.
pub(in crate::gpu) fn shaders() -> [(String, ShaderSource); 2] {
    [
        ("surface with materials", &[cube::SHADER, FRAME, MATERIAL_DRAW, MATERIAL_SURFACE][..]),
        ("depth with holes", &[MATERIAL_DRAW, MATERIAL_DEPTH]),
    ]
    .map(|(label, parts)| (label.to_owned(), ShaderSource::new(parts)))
}

/// The pipelines, and the layout of the bind group of a material.
#[derive(Debug)]
pub(super) struct MaterialPipelines {
    pub layout: wgpu::BindGroupLayout,
    /// Without and with holes; of each, all faces, and front faces only.
    pub surface: [[wgpu::RenderPipeline; 2]; 2],
    /// The body seen from a light, where it has holes.
    pub depth: wgpu::RenderPipeline,
}

impl MaterialPipelines {
    /// Compiles them.
    ///
    /// # Errors
    /// A shader that does not compile, or the driver refuses a pipeline.
    pub fn new(gpu: &Gpu, uniform_layout: &wgpu::BindGroupLayout) -> Result<Self, GpuError> {
        let layout = draw::layout(gpu);
        let both = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("body with materials"),
            bind_group_layouts: &[Some(uniform_layout), Some(&layout)],
            immediate_size: 0,
        });
        let [surface, depth] = shaders();
        let (surface, depth) = (gpu.shader(&surface.0, &surface.1)?, gpu.shader(&depth.0, &depth.1)?);
        gpu.checked(|| Self {
            surface: ["sample_surface", "sample_with_holes"]
                .map(|entry| CULLS.map(|cull| surface_pipeline(gpu, &both, &surface, (entry, cull)))),
            depth: depth_pipeline(gpu, &both, &depth),
            layout,
        })
    }
}

#[expect(clippy::unnecessary_wraps, reason = "as wgpu wants it")]
fn buffer(array_stride: u64, attributes: &[wgpu::VertexAttribute]) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
}

fn surface_pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    (entry, cull_mode): (&str, Option<wgpu::Face>),
) -> wgpu::RenderPipeline {
    let target =
        |format| Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL });
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surface with materials"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("surface"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                buffer(MOVING_VERTEX_BYTES, &wgpu::vertex_attr_array![0 => Float32x4, 2 => Float32x3]),
                buffer(FIXED_VERTEX_BYTES, &wgpu::vertex_attr_array![3 => Float32x4]),
                buffer(4, &wgpu::vertex_attr_array![1 => Uint32]),
                buffer(COORDINATES_BYTES, &wgpu::vertex_attr_array![4 => Float32x4, 5 => Float32x2]),
            ],
        },
        primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
        depth_stencil: Some(depth_state(wgpu::CompareFunction::Greater)),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[
                target(NORMAL_FORMAT),
                target(COLOR_FORMAT),
                target(NORMAL_FORMAT),
                target(NORMAL_FORMAT),
            ],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn depth_pipeline(
    gpu: &Gpu,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
) -> wgpu::RenderPipeline {
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("depth with holes"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("depth_with_holes"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                buffer(MOVING_VERTEX_BYTES, &wgpu::vertex_attr_array![0 => Float32x3]),
                buffer(COORDINATES_BYTES, &wgpu::vertex_attr_array![4 => Float32x4, 5 => Float32x2]),
            ],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(depth_state(wgpu::CompareFunction::Less)),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("keep_opaque"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}
