//! Shaders and pipelines, made once a device.

use lovelock_gpu::{Gpu, GpuError, ShaderPart, ShaderSource, wgpu};

use super::targets::{DEPTH_FORMAT, HDR_FORMAT, OUT_FORMAT, SAMPLES};
use crate::gpu::{eye, interpolate};

macro_rules! part {
    ($name:literal) => {
        ShaderPart {
            name: concat!("crates/render/src/gpu/shaders/", $name),
            text: include_str!(concat!("shaders/", $name)),
        }
    };
}

const FRAME: ShaderPart = part!("frame.wgsl");
const STRAND_SHADING: ShaderPart = part!("strand_shading.wgsl");
const STRAND_POINTS: ShaderPart = part!("strand_points.wgsl");
const SURFACE: ShaderPart = part!("surface.wgsl");
const DEPTH: ShaderPart = part!("depth.wgsl");
const BACKDROP: ShaderPart = part!("backdrop.wgsl");
const GROUND_LIGHT: ShaderPart = part!("ground_light.wgsl");
const GROUND: ShaderPart = part!("ground.wgsl");
const TONE_MAP: ShaderPart = part!("tone_map.wgsl");

/// The shaders of the pipelines that are made here.
fn own_shaders() -> [(&'static str, ShaderSource); 6] {
    [
        ("strand points", &[FRAME, STRAND_SHADING, STRAND_POINTS][..]),
        ("surface", &[FRAME, SURFACE]),
        ("depth", &[DEPTH]),
        ("ground", &[FRAME, GROUND_LIGHT, GROUND]),
        ("backdrop", &[FRAME, GROUND_LIGHT, BACKDROP]),
        ("tone map", &[FRAME, TONE_MAP]),
    ]
    .map(|(label, parts)| (label, ShaderSource::new(parts)))
}

/// Every composed shader with its label, so that a test can validate them without a device.
pub fn all_shaders() -> Vec<(String, ShaderSource)> {
    let own = own_shaders().into_iter().map(|(label, source)| (label.to_owned(), source));
    own.chain(eye::shaders()).chain(interpolate::shaders()).collect()
}

/// The pipelines and the layouts of their bind groups.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub frame_layout: wgpu::BindGroupLayout,
    pub points_layout: wgpu::BindGroupLayout,
    pub depth_layout: wgpu::BindGroupLayout,
    pub tone_layout: wgpu::BindGroupLayout,
    pub corners_layout: wgpu::BindGroupLayout,
    pub ground_layout: wgpu::BindGroupLayout,
    pub shade_points: wgpu::ComputePipeline,
    pub ground_corners: wgpu::ComputePipeline,
    pub surface: wgpu::RenderPipeline,
    pub depth: wgpu::RenderPipeline,
    pub backdrop: wgpu::RenderPipeline,
    pub tone_map: wgpu::RenderPipeline,
}

/// Bytes of one vertex of the body that change every frame: position and normal, four numbers each.
pub(super) const MOVING_VERTEX_BYTES: u64 = 32;
/// Bytes of one vertex of the body that stay: colour and scalp.
pub(super) const FIXED_VERTEX_BYTES: u64 = 16;

impl Pipelines {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let device = &gpu.device;
        let mut modules = Vec::new();
        for (label, source) in own_shaders() {
            modules.push(gpu.shader(label, &source)?);
        }
        let [points, surface, depth, ground, backdrop, tone]: [wgpu::ShaderModule; 6] =
            modules.try_into().map_err(|_| GpuError::Shader("the list of shaders changed".to_owned()))?;

        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let frame_layout = layout(
            device,
            "frame",
            &[
                (stages, uniform()),
                (stages, texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array)),
                (stages, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison)),
                (
                    stages,
                    texture(
                        wgpu::TextureSampleType::Float { filterable: true },
                        wgpu::TextureViewDimension::D2Array,
                    ),
                ),
                (stages, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        );
        let compute = wgpu::ShaderStages::COMPUTE;
        let points_layout = layout(
            device,
            "strand points",
            &[
                (compute, storage(true)),
                (compute, storage(true)),
                (compute, storage(true)),
                (compute, storage(false)),
            ],
        );
        let vertex = wgpu::ShaderStages::VERTEX;
        let depth_layout = layout(device, "depth", &[(vertex, uniform())]);
        let tone_layout = layout(
            device,
            "tone map",
            &[
                (
                    wgpu::ShaderStages::FRAGMENT,
                    texture(
                        wgpu::TextureSampleType::Float { filterable: false },
                        wgpu::TextureViewDimension::D2,
                    ),
                ),
                (wgpu::ShaderStages::FRAGMENT, storage(true)),
            ],
        );

        let corners_layout = layout(device, "ground corners", &[(compute, storage(false))]);
        let ground_layout = layout(device, "ground", &[(wgpu::ShaderStages::FRAGMENT, storage(true))]);

        let pipeline_layout = |label, groups: &[&wgpu::BindGroupLayout]| {
            let groups: Vec<_> = groups.iter().map(|&group| Some(group)).collect();
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &groups,
                immediate_size: 0,
            })
        };
        let compute_pipeline = |label, own: &wgpu::BindGroupLayout, module, entry| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout(label, &[&frame_layout, own])),
                module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        };
        let shade_points = compute_pipeline("strand points", &points_layout, &points, "shade_points");
        let ground_corners = compute_pipeline("ground", &corners_layout, &ground, "ground_corners");
        let moving = wgpu::VertexBufferLayout {
            array_stride: MOVING_VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 2 => Float32x3],
        };
        let fixed = wgpu::VertexBufferLayout {
            array_stride: FIXED_VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![3 => Float32x4],
        };
        let hair = wgpu::VertexBufferLayout {
            array_stride: 4,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![1 => Uint32],
        };
        let position_only = wgpu::VertexBufferLayout {
            array_stride: MOVING_VERTEX_BYTES,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3],
        };
        let frame_only = pipeline_layout("frame", &[&frame_layout]);
        let surface = raster(
            device,
            "surface",
            &frame_only,
            &surface,
            ["surface", "shade_surface"],
            &[moving, fixed, hair],
            Draw { depth: Some((wgpu::CompareFunction::Greater, true)), ..Draw::default() },
        );
        let backdrop = raster(
            device,
            "backdrop",
            &pipeline_layout("backdrop", &[&frame_layout, &ground_layout]),
            &backdrop,
            ["screen", "backdrop"],
            &[],
            Draw { depth: Some((wgpu::CompareFunction::Always, false)), ..Draw::default() },
        );
        let tone_map = raster(
            device,
            "tone map",
            &pipeline_layout("tone map", &[&frame_layout, &tone_layout]),
            &tone,
            ["screen", "tone_map"],
            &[],
            Draw { format: OUT_FORMAT, samples: 1, ..Draw::default() },
        );
        let depth = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("depth"),
            layout: Some(&pipeline_layout("depth", &[&depth_layout])),
            vertex: wgpu::VertexState {
                module: &depth,
                entry_point: Some("depth_only"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(position_only)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(depth_state(wgpu::CompareFunction::Less, true)),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        Ok(Self {
            frame_layout,
            points_layout,
            depth_layout,
            tone_layout,
            corners_layout,
            ground_layout,
            shade_points,
            ground_corners,
            surface,
            depth,
            backdrop,
            tone_map,
        })
    }
}

/// What differs between the raster pipelines.
#[derive(Clone, Copy)]
struct Draw {
    format: wgpu::TextureFormat,
    samples: u32,
    depth: Option<(wgpu::CompareFunction, bool)>,
}

impl Default for Draw {
    fn default() -> Self {
        Self { format: HDR_FORMAT, samples: SAMPLES, depth: None }
    }
}

fn depth_state(compare: wgpu::CompareFunction, write: bool) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

fn raster(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    buffers: &[wgpu::VertexBufferLayout],
    draw: Draw,
) -> wgpu::RenderPipeline {
    let buffers: Vec<_> = buffers.iter().cloned().map(Some).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &buffers,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: draw.depth.map(|(compare, write)| depth_state(compare, write)),
        multisample: wgpu::MultisampleState {
            count: draw.samples,
            alpha_to_coverage_enabled: false,
            ..Default::default()
        },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: draw.format,
                blend: None,
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn uniform() -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn storage(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}

fn layout(
    device: &wgpu::Device,
    label: &str,
    entries: &[(wgpu::ShaderStages, wgpu::BindingType)],
) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = entries
        .iter()
        .enumerate()
        .map(|(binding, &(visibility, ty))| wgpu::BindGroupLayoutEntry {
            binding: binding as u32,
            visibility,
            ty,
            count: None,
        })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}
