//! Shaders, kernels and pipelines, created once per device.

use lovelock_gpu::{Gpu, GpuError, ShaderPart, ShaderSource, wgpu};
use lovelock_shadow::cube;

use super::clusters;
use super::false_colors::FalseColorShaders;
use super::layers::LayerShaders;
use super::light_kernels::{LightShaders, LightVariants};
use super::present::Present;
use super::screen::ScreenKernels;
use super::targets::{COLOR_FORMAT, DEPTH_FORMAT, NORMAL_FORMAT, SAMPLES};

macro_rules! part {
    ($name:literal) => {
        lovelock_gpu::ShaderPart {
            name: concat!("crates/render/src/gpu/shaders/", $name),
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/gpu/shaders/", $name)),
        }
    };
}
pub(super) use part as shader_part;

pub(super) const FRAME: ShaderPart = part!("frame.wgsl");
const TWO_HIGHLIGHTS: ShaderPart = part!("two_highlights.wgsl");
const KAJIYA_KAY: ShaderPart = part!("kajiya_kay.wgsl");
const FIBRE: ShaderPart = part!("fibre.wgsl");
const STRAND_POINTS: ShaderPart = part!("strand_points.wgsl");
const SURFACE: ShaderPart = part!("surface.wgsl");
const SURFACE_GROUPS: ShaderPart = part!("samples.wgsl");
const SURFACE_SAMPLES: ShaderPart = part!("surface_samples.wgsl");
const MATERIAL_SAMPLES: ShaderPart = part!("material_samples.wgsl");
const MATERIAL_SHADING: ShaderPart = part!("material_shading.wgsl");
const SURFACE_SHADING: ShaderPart = part!("surface_shading.wgsl");
const DEPTH: ShaderPart = part!("depth.wgsl");
const GROUND_LIGHT: ShaderPart = part!("ground_light.wgsl");
const GROUND: ShaderPart = part!("ground.wgsl");
const BACKDROP: ShaderPart = part!("backdrop.wgsl");
const TONE_MAP: ShaderPart = part!("tone_map.wgsl");
const PICTURE: ShaderPart = part!("picture.wgsl");
const LAYERS: ShaderPart = part!("layers.wgsl");
const VALUE_POINTS: ShaderPart = part!("value_points.wgsl");
const FALSE_COLORS: ShaderPart = part!("false_colors.wgsl");
const PRESENT: ShaderPart = part!("present.wgsl");
const SHRINK: ShaderPart = part!("shrink.wgsl");
const SKIN_SHADOW: ShaderPart = part!("skin_shadow.wgsl");

/// The shaders of these kernels and pipelines.
pub(super) fn own_shaders() -> [(&'static str, ShaderSource); 12] {
    let [clusters, surface, rib_light, published] = clusters::RIB_PARTS;
    let without = [SURFACE_SHADING, SURFACE_SAMPLES];
    let with_materials = [MATERIAL_SHADING, MATERIAL_SAMPLES];
    let strands = [cube::SHADER, FRAME, TWO_HIGHLIGHTS, KAJIYA_KAY, FIBRE, STRAND_POINTS];
    [
        ("strand points", strands.to_vec()),
        ("ground", vec![cube::SHADER, FRAME, GROUND_LIGHT, GROUND]),
        ("picture", picture_parts(without, &[])),
        ("surface", vec![cube::SHADER, FRAME, SURFACE]),
        ("depth", vec![DEPTH]),
        ("layers", picture_parts(without, &[LAYERS])),
        ("false colours", picture_parts(without, &[LAYERS, FALSE_COLORS])),
        ("values of points", [&strands[..], &[VALUE_POINTS]].concat()),
        ("present", vec![PRESENT]),
        ("light on ribs", [&strands[..], &[clusters, surface, rib_light, published]].concat()),
        ("picture with materials", picture_parts(with_materials, &[])),
        ("layers with materials", picture_parts(with_materials, &[LAYERS])),
    ]
    .map(|(label, parts)| (label, ShaderSource::new(&parts)))
}

/// A shader that shades the samples of the body, then what is drawn from them.
fn picture_parts(surface: [ShaderPart; 2], more: &[ShaderPart]) -> Vec<ShaderPart> {
    let [shading, of_samples] = surface;
    let picture =
        [cube::SHADER, FRAME, shading, SURFACE_GROUPS, of_samples, GROUND_LIGHT, BACKDROP, TONE_MAP, PICTURE];
    [&picture[..], more].concat()
}

/// The shader of [`Shrinker`](super::Shrinker).
pub(super) fn shrink_source() -> ShaderSource {
    ShaderSource::new(&[SHRINK])
}

/// The shader of [`SkinShadow`](super::skin_shadow::SkinShadow).
pub(super) fn skin_shadow_source() -> ShaderSource {
    ShaderSource::new(&[SKIN_SHADOW])
}

/// The kernels and pipelines, and the bind group layouts of the pipelines.
#[derive(Debug)]
pub(super) struct Pipelines {
    /// The kernels that evaluate lights.
    pub lit: LightVariants,
    pub screen: ScreenKernels,
    pub present: Present,
    /// The parts of the kernels for layers, which are compiled on demand.
    pub layers: LayerShaders,
    /// Those for false colours, likewise.
    pub false_colors: FalseColorShaders,
    /// The shader of the light on clusters, likewise.
    pub rib_light: ShaderSource,
    /// A uniform for the vertices.
    pub uniform_layout: wgpu::BindGroupLayout,
    /// The body seen from the camera: all faces, and front faces only if it is closed.
    pub surface: [wgpu::RenderPipeline; 2],
    /// The body seen from a light.
    pub depth: [wgpu::RenderPipeline; 2],
}

/// Bytes of one vertex of the body that change every frame: position and normal, four numbers each.
pub(super) const MOVING_VERTEX_BYTES: u64 = 32;
/// Bytes of one vertex of the body that stay: colour and scalp.
pub(super) const FIXED_VERTEX_BYTES: u64 = 16;

/// Without culling, and with culling of back faces.
pub(super) const CULLS: [Option<wgpu::Face>; 2] = [None, Some(wgpu::Face::Back)];

impl Pipelines {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let device = &gpu.device;
        let [
            points,
            ground,
            picture,
            surface,
            depth,
            layers,
            colors,
            values,
            present,
            rib_light,
            picture_of_materials,
            layers_of_materials,
        ] = own_shaders();
        let uniform_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("uniform"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("body"),
            bind_group_layouts: &[Some(&uniform_layout)],
            immediate_size: 0,
        });
        let (surface, depth) = (gpu.shader(surface.0, &surface.1)?, gpu.shader(depth.0, &depth.1)?);
        Ok(Self {
            screen: ScreenKernels::new(gpu, &picture.1)?,
            present: Present::new(gpu, &present.1)?,
            layers: LayerShaders { layers: [layers.1, layers_of_materials.1], values: values.1.clone() },
            false_colors: FalseColorShaders { colors: colors.1, values: values.1 },
            lit: LightVariants::new(LightShaders {
                points: points.1,
                ground: ground.1,
                picture: picture.1,
                materials: picture_of_materials.1,
            }),
            rib_light: rib_light.1,
            surface: CULLS.map(|cull| surface_pipeline(device, &layout, &surface, cull)),
            depth: CULLS.map(|cull| depth_pipeline(device, &layout, &depth, cull)),
            uniform_layout,
        })
    }
}

fn surface_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    cull_mode: Option<wgpu::Face>,
) -> wgpu::RenderPipeline {
    let buffer = |array_stride, attributes| {
        Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
    };
    let target =
        |format| Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surface"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("surface"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[
                buffer(MOVING_VERTEX_BYTES, &wgpu::vertex_attr_array![0 => Float32x4, 2 => Float32x3]),
                buffer(FIXED_VERTEX_BYTES, &wgpu::vertex_attr_array![3 => Float32x4]),
                buffer(4, &wgpu::vertex_attr_array![1 => Uint32]),
            ],
        },
        primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
        depth_stencil: Some(depth_state(wgpu::CompareFunction::Greater)),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("sample_surface"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[target(NORMAL_FORMAT), target(COLOR_FORMAT)],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn depth_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    cull_mode: Option<wgpu::Face>,
) -> wgpu::RenderPipeline {
    let position = wgpu::VertexBufferLayout {
        array_stride: MOVING_VERTEX_BYTES,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3],
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("depth"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("depth_only"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(position)],
        },
        primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
        depth_stencil: Some(depth_state(wgpu::CompareFunction::Less)),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}

pub(super) fn depth_state(compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}
