//! The shadow method of one frame on the GPU: one map per light, looked up once per strand point and once per vertex of the body.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;

use glam::{Mat4, Vec3, Vec4};
use lovelock_gpu::{Commands, Gpu, wgpu};
use lovelock_shadow::{
    Bounds, GpuColumns, GpuList, GpuShadow, GpuShadowInput, GpuTargets, LightFrame, MapKind, SUM_WORDS,
    ShadowMethod, gpu_shadow,
};

use super::hair::HairBuffers;
use super::light_kernels::LightSet;
use crate::shadow_look::{ShadowLook, pack};
use crate::standing::{layer_of, placed_frame};
use crate::{FrameInput, KnownTransmittance, Light, MAX_LIGHTS, RenderError};

/// The shadows of all lights, kept from frame to frame.
pub(super) struct GpuShadowStage {
    /// Methods that were used, with their pipelines. Only the one in use has maps.
    methods: BTreeMap<ShadowMethod, Box<dyn GpuShadow>>,
    method: ShadowMethod,
    /// The axes of the direction of each light, and those of its maps.
    frames: Vec<[LightFrame; 2]>,
    /// Sum of the first light's bytes over the strands' points.
    sum: wgpu::Buffer,
    columns: Columns,
    lights: LightSet,
}

impl fmt::Debug for GpuShadowStage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuShadowStage").field("method", &self.method).finish_non_exhaustive()
    }
}

/// The vertices of the body, looked up like strand points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertices<'a> {
    /// Two `vec4f` per vertex; the first one starts with the position.
    pub positions: &'a wgpu::Buffer,
    pub count: u32,
    /// One word per vertex.
    pub hair: &'a wgpu::Buffer,
}

impl GpuShadowStage {
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            methods: BTreeMap::new(),
            method: ShadowMethod::None,
            frames: Vec::new(),
            sum: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("sum of transmittances"),
                size: 4 * SUM_WORDS,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            columns: Columns::new(gpu, 1, MAX_LIGHTS),
            lights: LightSet::default(),
        }
    }

    /// Encodes building the maps of all lights and looking up all strand points, those of carried hair, and vertices.
    ///
    /// # Errors
    /// The maps exceed their memory limit, or a shader does not compile.
    pub fn run(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &FrameInput,
        hair: &mut HairBuffers,
        (carried, vertices): (Option<&HairBuffers>, Option<Vertices>),
    ) -> Result<(), RenderError> {
        let lights: Vec<Light> = Light::enabled(input.lights).collect();
        let method = if input.known.is_some() { ShadowMethod::Exact } else { input.shadow.method };
        if let Some(known) = input.known {
            let vertices = vertices.map_or(0, |vertices| vertices.count as usize);
            known.check(lights.len(), hair.drawn().point_count as usize, vertices)?;
        }
        if self.method != method
            && let Some(old) = self.methods.get_mut(&self.method)
        {
            old.forget(gpu);
        }
        self.method = method;
        let shadow = match self.methods.entry(method) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(gpu_shadow(method, gpu)?),
        };
        self.lights = LightSet::of(&lights);
        self.frames.truncate(lights.len());
        let look = ShadowLook::of(input);
        let anchor = look.anchor();
        if input.known.is_none() {
            commands.encoder().clear_buffer(&self.sum, 0, None);
        }
        let in_world = method.in_world();
        let extent = if in_world { hair.bounds(input, LightFrame::WORLD, anchor).0 } else { Bounds::EMPTY };
        for (slot, light) in lights.iter().enumerate() {
            // Transported instead of recomputed, so that the map does not roll while the light is dragged.
            let base = match self.frames.get(slot) {
                Some([base, _]) => base.transported(light.direction),
                None => LightFrame::new(light.direction),
            };
            let frame = placed_frame(base, light, anchor);
            self.frames.truncate(slot);
            self.frames.push([base, frame]);
            let (bounds, longest_strand) = hair.bounds(input, frame, anchor);
            let samples = frame.samples(anchor);
            let sample_bounds: Vec<_> = match &samples[..] {
                [_] => Vec::new(),
                // Rays sample the area themselves.
                _ if method.map_kind() == MapKind::Rays => Vec::new(),
                all => all.iter().map(|&light| hair.bounds(input, light, anchor).0).collect(),
            };
            let from = GpuShadowInput {
                strands: hair.strands(),
                bounds,
                extent,
                longest_strand,
                strand_width: look.strand_width,
                extinction_scale: look.extinction_scale,
                light: frame,
                anchor,
                maps: lights.len() as u32,
                sample_bounds: &sample_bounds,
                shared_list: None,
                projected: None,
            };
            shadow.build(slot, gpu, commands, &from, &look.settings)?;
            let strands = hair.drawn();
            let targets = GpuTargets {
                points: hair.asked(),
                stride: 1,
                count: strands.point_count,
                out: hair.transmittance(),
                sum: Some(&self.sum),
                byte: None,
                projected: None,
            };
            if input.known.is_none() {
                shadow.look_up(slot, gpu, commands, &targets);
            }
            if let Some(carried) = carried {
                let targets = GpuTargets {
                    points: carried.asked(),
                    stride: 1,
                    count: carried.drawn().point_count,
                    out: carried.transmittance(),
                    sum: None,
                    byte: None,
                    projected: None,
                };
                shadow.look_up(slot, gpu, commands, &targets);
            }
            let asked = input.known.is_none_or(|known| known.at_vertices.is_empty());
            if let Some(vertices) = vertices.filter(|_| asked) {
                let targets = GpuTargets {
                    points: vertices.positions,
                    stride: 2,
                    count: vertices.count,
                    out: vertices.hair,
                    sum: None,
                    byte: None,
                    projected: None,
                };
                shadow.look_up(slot, gpu, commands, &targets);
            }
        }
        if let Some(known) = &input.known {
            write_known(gpu, known, &self.sum, hair.transmittance(), vertices);
        }
        if lights.is_empty() {
            // Without lights there is nothing to shadow.
            self.columns.clear();
        }
        let most = (0..lights.len()).map(|slot| shadow.columns_size(slot)).max().unwrap_or(0);
        let sides = |slot: usize| (0..shadow.column_sides(slot)).map(move |side| (slot, side));
        let maps: Vec<_> = (0..lights.len()).flat_map(sides).collect();
        let layers = maps.iter().map(|(slot, side)| layer_of(*slot, *side) + 1).max().unwrap_or(0);
        self.columns.fit(gpu, most.max(1), layers);
        for (slot, side) in maps {
            let layer = layer_of(slot, side);
            let written = shadow.columns((slot, side), gpu, commands, &self.columns.layers[layer]);
            self.columns.written[layer] = written;
        }
        Ok(())
    }

    /// The lists of the maps of the last frame, which come first among its slots.
    pub fn lists(&self) -> impl Iterator<Item = GpuList<'_>> {
        let shadow = self.methods.get(&self.method);
        (0..self.lights.count).map_while(move |slot| shadow?.list(slot))
    }

    /// See [`GpuShadow::settle`]. Heads of a frame of another method are ignored.
    pub fn settle(
        &mut self,
        gpu: &Gpu,
        method: ShadowMethod,
        heads: &[[u32; 2]],
    ) -> Result<bool, RenderError> {
        if method != self.method {
            return Ok(false);
        }
        let settled = self.methods.get_mut(&self.method).map(|shadow| shadow.settle(gpu, heads));
        Ok(settled.transpose()?.unwrap_or(false))
    }

    /// The method of the last frame.
    pub fn method(&self) -> ShadowMethod {
        self.method
    }

    /// Encodes looking up the map of slot `slot` of the last frame.
    pub fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        if let Some(shadow) = self.methods.get_mut(&self.method) {
            shadow.look_up(slot, gpu, commands, targets);
        }
    }

    /// The number of lights of the last frame.
    pub fn lights(&self) -> usize {
        self.lights.count
    }

    /// The lights of the last frame.
    pub fn light_set(&self) -> LightSet {
        self.lights
    }

    /// The axes of the maps of light `k` of the last frame; those of light from above if it has none.
    pub fn frame(&self, k: usize) -> LightFrame {
        self.frames.get(k).map_or_else(LightFrame::default, |[_, frame]| *frame)
    }

    /// The maps of transmittance behind all hair of light `k`: one, or one per side of a cube around it.
    pub fn column_sides(&self, k: usize) -> usize {
        self.methods.get(&self.method).map_or(1, |shadow| shadow.column_sides(k))
    }

    /// Whether the last frame had a light.
    pub fn has_light(&self) -> bool {
        self.lights.count > 0
    }

    /// Memory of the maps, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let Some(shadow) = self.methods.get(&self.method) else { return 0 };
        let scratch = (0..self.lights.count).map(|slot| shadow.report(slot).scratch_bytes).max().unwrap_or(0);
        (0..self.lights.count).map(|slot| shadow.report(slot).memory_bytes).sum::<u64>() + scratch
    }

    /// Records of the maps that were read in a simpler way in the last frame whose counts have come back; see
    /// [`ShadowReport::fallbacks`](lovelock_shadow::ShadowReport::fallbacks).
    pub fn fallbacks(&self) -> u64 {
        let Some(shadow) = self.methods.get(&self.method) else { return 0 };
        (0..self.lights.count).map(|slot| shadow.report(slot).fallbacks).sum()
    }

    /// Words whose total is the sum of the first light's transmittance bytes over strand points.
    pub fn sum(&self) -> &wgpu::Buffer {
        &self.sum
    }

    /// All layers of transmittance behind the hair.
    pub fn columns_view(&self) -> &wgpu::TextureView {
        &self.columns.view
    }

    /// The transform from world space to the layer of a side of light `k`; far outside if it has none.
    pub fn columns_from_world(&self, k: usize, side: usize) -> Mat4 {
        self.columns.uv_from_world(layer_of(k, side))
    }
}

/// Uploads given transmittance, and the sum of its bytes, in place of what the map would return.
fn write_known(
    gpu: &Gpu,
    known: &KnownTransmittance,
    sum: &wgpu::Buffer,
    at_points: &wgpu::Buffer,
    vertices: Option<Vertices>,
) {
    let mut packed = Vec::new();
    let mut upload = |lists: &[Vec<f32>], to: &wgpu::Buffer| {
        let lists: Vec<&[f32]> = lists.iter().map(Vec::as_slice).collect();
        pack(&lists, lists.first().map_or(0, |list| list.len()), &mut packed);
        gpu.upload(to, 0, &packed);
        packed.iter().map(|word| word & 0xff).fold(0, u32::saturating_add)
    };
    let mut sums = [0_u32; SUM_WORDS as usize];
    sums[0] = upload(known.at_points, at_points);
    gpu.upload(sum, 0, &sums);
    if let Some(vertices) = vertices
        && !known.at_vertices.is_empty()
    {
        upload(known.at_vertices, vertices.hair);
    }
}

/// The transmittance behind all hair, one layer per light and side, for surfaces far behind it.
#[derive(Debug)]
struct Columns {
    size: u32,
    view: wgpu::TextureView,
    layers: Vec<wgpu::TextureView>,
    written: Vec<Option<GpuColumns>>,
}

impl Columns {
    fn new(gpu: &Gpu, size: u32, layers: usize) -> Self {
        let texture = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("hair columns"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        let views = (0..layers as u32).map(|layer| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: layer,
                array_layer_count: Some(1),
                ..Default::default()
            })
        });
        Self {
            size,
            layers: views.collect(),
            view: texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            written: vec![None; layers],
        }
    }

    /// Makes room for layers of `size` by `size` texels, with a margin so that swaying hair does not need a new texture.
    fn fit(&mut self, gpu: &Gpu, size: u32, layers: usize) {
        let layers = layers.max(MAX_LIGHTS);
        if size > self.size || layers > self.layers.len() {
            *self = Self::new(gpu, size.next_multiple_of(64).max(self.size), layers);
        }
        self.clear();
    }

    fn clear(&mut self) {
        self.written.fill(None);
    }

    fn uv_from_world(&self, k: usize) -> Mat4 {
        const OUTSIDE: Mat4 = Mat4::from_cols_array(&[
            0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 1.0, 1.0,
        ]);
        let Some(columns) = self.written.get(k).copied().flatten() else { return OUTSIDE };
        // A map may be smaller than the texture: its coordinates are scaled to its corner, and the third coordinate is the edge of that
        // corner.
        let part = columns.size as f32 / self.size as f32;
        let scaled = Mat4::from_scale(Vec3::new(part, part, 1.0)) * columns.uv_from_world;
        let rows = scaled.transpose();
        Mat4::from_cols(rows.x_axis, rows.y_axis, Vec4::W * part, rows.w_axis).transpose()
    }
}
