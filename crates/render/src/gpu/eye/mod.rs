//! Rasterisation and blending of hair by compute kernels, for every transparency mode.
//!
//! A thread iterates over the pixels of a segment and accumulates fragments with integer atomics, so that results do not depend on
//! the order of threads. Each pass over fragments is `fragments.wgsl` with its own `take`, each pass over pixels is
//! `each_pixel.wgsl` with its own `pixel_pass`. A picture that does not fit a buffer of the device is rendered in bands of rows.

mod area;
mod modes;
mod passes;

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, wgpu};

use super::clusters::{ClusterVariant, DrawnClusters};
pub(super) use area::Area;
pub(super) use modes::HairOutput;
use modes::{Mode, Over};
use passes::behind_source;
pub(super) use passes::shaders;

macro_rules! part {
    ($name:literal) => {
        lovelock_gpu::ShaderPart {
            name: concat!("crates/render/src/gpu/eye/", $name),
            text: include_str!($name),
        }
    };
}
use part;

/// Half the width in pixels up to which no strand is streaked; a little less than in fragments.wgsl, to allow for rounding.
pub(super) const WIDEST_PLAIN: f32 = 0.79;

/// Words per fragment in a list.
const FRAGMENT_WORDS: u64 = 3;

/// Twin of `EyeUniform` in frame.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct EyeUniform {
    corner: [u32; 2],
    size: [u32; 2],
    segments: u32,
    room: u32,
    opacity: f32,
    first: u32,
    lanes: u32,
    unused: [u32; 3],
}

/// The input of the passes.
pub(super) struct EyeInput<'a> {
    /// The area of the picture that may contain hair.
    pub area: Area,
    /// Shaded points; see `ShadedPoint`.
    pub shaded: &'a wgpu::Buffer,
    /// First point of each segment.
    pub segments: &'a wgpu::Buffer,
    pub segment_count: u32,
    /// Depths of the body, four samples per pixel.
    pub depth: &'a wgpu::TextureView,
    /// Half of the widest strand, pixels.
    pub reach: f32,
    /// Whether a strand may be wide enough to be streaked.
    pub streaked: bool,
    /// Opacity of a strand where it covers a pixel completely.
    pub opacity: f32,
    pub drawn: HairOutput,
    /// Hair that is drawn as clusters, beside the segments or in their place.
    pub clusters: Option<DrawnClusters<'a>>,
}

/// The most pixels per thread: half of what software adapters allow.
const MAX_PIXELS_A_THREAD: f32 = 32_768.0;
/// The most threads per segment.
const MAX_LANES: u32 = 64;

impl EyeInput<'_> {
    /// Threads per segment, so that none iterates over too many pixels: from the largest possible length and width.
    fn lanes(&self) -> u32 {
        let (columns, rows) = (self.area.columns as f32, self.area.rows as f32);
        let most = (2.0 * self.reach + 4.0) * (columns.hypot(rows) + 2.0 * self.reach);
        let most = if most < columns * rows { most } else { columns * rows };
        ((most / MAX_PIXELS_A_THREAD).ceil() as u32).clamp(1, MAX_LANES)
    }
}

/// The kernels of all modes that were used, and the buffers of the pixels.
#[derive(Debug)]
pub(super) struct Eye {
    behind_kernel: Kernel,
    /// By whether strands are streaked.
    modes: Vec<((HairOutput, bool), Vec<Kernel>)>,
    /// The passes over the fragments of clusters, in order.
    cluster_modes: Vec<((HairOutput, ClusterVariant), Vec<Kernel>)>,
    depths: Option<AreaDepths>,
    map: GrowBuffer<u32>,
    list: GrowBuffer<u32>,
    total: wgpu::Buffer,
    layer: GrowBuffer<[u32; 2]>,
    /// The capacity of the list in fragments, and the least number of bands, for modes with lists.
    room: u64,
    least_bands: u32,
    /// Whether the last frame had lists.
    lists: Option<Lists>,
}

/// The depths of the body in the samples of each pixel of an area, for areas up to a certain size.
#[derive(Debug)]
struct AreaDepths {
    view: wgpu::TextureView,
    columns: u32,
    rows: u32,
}

/// The list of a frame, and how it was divided into bands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lists {
    /// The fragments that fit.
    pub room: u64,
    bands: u32,
    /// Rows of the area.
    rows: u32,
}

impl Eye {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            behind_kernel: Kernel::new(gpu, "behind", &behind_source(), "each_pixel")?,
            modes: Vec::new(),
            cluster_modes: Vec::new(),
            depths: None,
            map: GrowBuffer::new(gpu, "eye maps", storage),
            list: GrowBuffer::new(gpu, "fragments", storage),
            total: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("fragments in all"),
                size: 16,
                usage: storage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            layer: GrowBuffer::new(gpu, "hair layer", storage),
            room: 1 << 16,
            least_bands: 1,
            lists: None,
        })
    }

    /// The hair of each pixel of the area: `layer` in frame.wgsl.
    pub fn layer(&self) -> &wgpu::Buffer {
        self.layer.raw()
    }

    /// Memory in use, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let buffers = [self.map.raw(), self.list.raw(), self.layer.raw()];
        let depths =
            self.depths.as_ref().map_or(0, |held| 16 * u64::from(held.columns) * u64::from(held.rows));
        buffers.iter().map(|buffer| buffer.size()).sum::<u64>() + depths
    }

    /// Encodes rendering the hair into [`Eye::layer`].
    ///
    /// # Errors
    /// A shader does not compile, or a row of the picture does not fit a buffer of the device.
    pub fn draw(&mut self, gpu: &Gpu, commands: &mut Commands, input: &EyeInput) -> Result<(), GpuError> {
        let mode = Mode::of(input.drawn);
        let Area { left, top, columns, rows: all_rows } = input.area;
        let variant = (input.drawn, input.streaked);
        if !self.modes.iter().any(|(known, _)| *known == variant) {
            let kernels = mode.passes.iter().map(|pass| pass.kernel(gpu, input.streaked));
            self.modes.push((variant, kernels.collect::<Result<_, _>>()?));
        }
        if let Some(clusters) = &input.clusters {
            let variant = (input.drawn, clusters.variant);
            if !self.cluster_modes.iter().any(|(known, _)| *known == variant) {
                let passes = mode.passes.iter().filter(|pass| pass.over == Over::Fragments);
                let kernels = passes.map(|pass| pass.cluster_kernel(gpu, clusters.variant));
                self.cluster_modes.push((variant, kernels.collect::<Result<_, _>>()?));
            }
        }
        self.lists = None;
        if input.area.is_empty() {
            return Ok(());
        }
        if input.area.pixels() * 8 > gpu.most_storage_bytes() {
            return Err(too_large(gpu, input.area.pixels() * 8));
        }
        self.layer.reserve(gpu, input.area.pixels() as usize);
        let row_bytes = u64::from(columns) * u64::from(mode.words) * 4;
        let most_rows = gpu.most_storage_bytes() / row_bytes.max(1);
        if most_rows == 0 {
            return Err(too_large(gpu, row_bytes));
        }
        let mut bands = u64::from(all_rows).div_ceil(most_rows) as u32;
        if mode.lists {
            self.room = self.room.min(list_limit(gpu));
            self.list.reserve(gpu, (self.room * FRAGMENT_WORDS) as usize);
            bands = bands.max(self.least_bands).min(all_rows);
            self.lists = Some(Lists { room: self.room, bands, rows: all_rows });
        }
        let rows = all_rows.div_ceil(bands);
        self.depths.take_if(|held| held.columns < columns || held.rows < rows);
        self.depths.get_or_insert_with(|| AreaDepths::new(gpu, columns, rows));
        self.map.reserve(gpu, (u64::from(rows) * row_bytes / 4) as usize);
        commands.encoder().clear_buffer(&self.total, 0, None);
        for first in (0..all_rows).step_by(rows as usize) {
            let rows = rows.min(all_rows - first);
            let band = Area { left, top: top + first, columns, rows };
            self.draw_area(gpu, commands, input, mode, band, first * columns);
        }
        Ok(())
    }

    /// Renders one area of the picture. `first` is the index of its first pixel in the layer.
    fn draw_area(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &EyeInput,
        mode: &Mode,
        area: Area,
        first: u32,
    ) {
        let pixels = area.pixels();
        let uniform = EyeUniform {
            corner: [area.left, area.top],
            size: [area.columns, area.rows],
            segments: input.segment_count,
            room: self.room as u32,
            opacity: input.opacity,
            first,
            lanes: input.lanes(),
            unused: [0; 3],
        };
        let Some(depths) = &self.depths else { return };
        let buffer = commands.constants("eye", &uniform);
        let mut resources = vec![
            (0, buffer.as_entire_binding()),
            (1, input.shaded.as_entire_binding()),
            (2, input.segments.as_entire_binding()),
            (3, wgpu::BindingResource::TextureView(&depths.view)),
            (4, self.map.raw().as_entire_binding()),
            (5, self.list.raw().as_entire_binding()),
            (6, self.total.as_entire_binding()),
            (7, self.layer.raw().as_entire_binding()),
            (8, wgpu::BindingResource::TextureView(input.depth)),
            (9, wgpu::BindingResource::TextureView(&depths.view)),
        ];
        resources.extend(input.clusters.iter().flat_map(DrawnClusters::bindings));
        let encoder = commands.encoder();
        encoder.clear_buffer(self.map.raw(), 0, Some((pixels * u64::from(mode.words) * 4).max(4)));
        if mode.lists {
            // Each band reuses the list; the total of the frame is that of the largest band.
            encoder.clear_buffer(&self.total, 0, Some(4));
        }
        let group = self.behind_kernel.bind(gpu, &resources);
        commands.compute("draw/behind", |pass| self.behind_kernel.run(pass, &group, pixels));
        let variant = (input.drawn, input.streaked);
        let kernels = self.modes.iter().find(|(known, _)| *known == variant);
        let Some((_, kernels)) = kernels else { return };
        let of_clusters = input.clusters.as_ref().and_then(|clusters| {
            let variant = (input.drawn, clusters.variant);
            let (_, kernels) = self.cluster_modes.iter().find(|(known, _)| *known == variant)?;
            Some((kernels.iter(), clusters.threads))
        });
        let (mut of_clusters, cluster_threads) = of_clusters.unwrap_or_default();
        let segment_threads = u64::from(input.segment_count) * u64::from(input.lanes());
        for (pass, kernel) in mode.passes.iter().zip(kernels) {
            let over_fragments = pass.over == Over::Fragments;
            let threads = if over_fragments { segment_threads } else { pixels };
            if threads > 0 {
                let group = kernel.bind(gpu, &resources);
                commands.compute(pass.name, |pass| kernel.run(pass, &group, threads));
            }
            if over_fragments && let Some(kernel) = of_clusters.next() {
                let group = kernel.bind(gpu, &resources);
                commands.compute(pass.name, |pass| kernel.run(pass, &group, cluster_threads));
            }
        }
    }

    /// The list of fragments of the last frame, if its mode has one: a buffer whose second word is the number of fragments of its
    /// largest band, and the number of fragments that fit.
    pub fn list(&self) -> Option<(&wgpu::Buffer, u64)> {
        self.lists.map(|_| (&self.total, self.room))
    }

    /// The list of the last frame, if its mode has one.
    pub fn lists(&self) -> Option<Lists> {
        self.lists
    }

    /// Takes the first two words of [`Eye::list`] of a finished frame, whose [`Eye::lists`] were `then`. If they were too short, those of
    /// later frames are longer, the result is `true`, and the frame must be rendered again.
    ///
    /// # Errors
    /// One row of the picture needs a longer list than the device supports.
    pub fn settle(&mut self, gpu: &Gpu, totals: [u32; 2], then: Option<Lists>) -> Result<bool, GpuError> {
        let Some(Lists { room, bands, rows }) = then else { return Ok(false) };
        let wanted = u64::from(totals[1]);
        if wanted <= room {
            // Once lists have shrunk after a close view, half as many bands are tried.
            if self.least_bands > 1 && wanted < self.room / 4 {
                self.least_bands /= 2;
            }
            return Ok(false);
        }
        let limit = list_limit(gpu);
        if wanted <= limit {
            // A quarter more, so that moving hair does not need a larger list in the next frame.
            self.room = (wanted + wanted / 4).min(limit).max(self.room.min(limit));
            return Ok(true);
        }
        if bands >= rows {
            return Err(too_large(gpu, wanted * 4 * FRAGMENT_WORDS));
        }
        // Fewer bands have proportionally more fragments each.
        let more = (u64::from(bands) * wanted / limit + 1).max(2 * u64::from(bands));
        self.room = limit;
        self.least_bands = self.least_bands.max(more.min(u64::from(rows)) as u32);
        Ok(true)
    }
}

/// The most fragments of a list: what fits a buffer of the device, and 1 GiB.
fn list_limit(gpu: &Gpu) -> u64 {
    gpu.most_storage_bytes().min(1 << 30) / (4 * FRAGMENT_WORDS)
}

impl AreaDepths {
    /// For areas up to this size and a little larger, so that hair that sways needs no other one.
    fn new(gpu: &Gpu, columns: u32, rows: u32) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let [columns, rows] = [columns, rows].map(|side| side.next_multiple_of(64).min(most));
        let texture = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("depths behind hair"),
            size: wgpu::Extent3d { width: columns, height: rows, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), columns, rows }
    }
}

/// The error for a picture that does not fit.
pub(super) fn too_large(gpu: &Gpu, needed: u64) -> GpuError {
    GpuError::Input(format!(
        "an image of this size needs a buffer of {needed} bytes, and {} takes at most {}: draw a smaller one, or draw on the CPU",
        gpu.info.name,
        gpu.most_storage_bytes()
    ))
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lovelock_gpu::layout_in_shader;

    use super::*;

    #[test]
    fn the_uniform_has_the_layout_of_the_shader() {
        let (_, source) = shaders().into_iter().nth(1).expect("a pass");
        assert_eq!(
            layout_in_shader(&source, "EyeUniform"),
            [
                offset_of!(EyeUniform, corner),
                offset_of!(EyeUniform, size),
                offset_of!(EyeUniform, segments),
                offset_of!(EyeUniform, room),
                offset_of!(EyeUniform, opacity),
                offset_of!(EyeUniform, first),
                offset_of!(EyeUniform, lanes),
                size_of::<EyeUniform>(),
            ]
        );
    }
}
