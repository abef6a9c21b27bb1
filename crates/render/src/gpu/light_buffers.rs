//! What the CPU computes of light, on the GPU: the tables of fibres, and the grid of light from all directions.

use half::f16;
use lovelock_gpu::{Commands, Gpu, GrowBuffer, wgpu};
use rayon::prelude::*;

use crate::ambient::CELLS;
use crate::scene_light::SceneLight;

/// The buffers; see [`SceneLight`].
#[derive(Debug)]
pub(super) struct LightBuffers {
    light: SceneLight,
    tables: GrowBuffer<f32>,
    /// Cells as four half floats.
    staged: GrowBuffer<[u16; 4]>,
    staging: Vec<[u16; 4]>,
    cells: wgpu::Texture,
    view: wgpu::TextureView,
}

const SIZE: wgpu::Extent3d =
    wgpu::Extent3d { width: CELLS as u32, height: CELLS as u32, depth_or_array_layers: CELLS as u32 };

impl LightBuffers {
    pub fn new(gpu: &Gpu) -> Self {
        let cells = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("ambient light"),
            size: SIZE,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            light: SceneLight::default(),
            tables: GrowBuffer::new(gpu, "tables of fibres", wgpu::BufferUsages::STORAGE),
            staged: GrowBuffer::new(gpu, "ambient light", wgpu::BufferUsages::empty()),
            staging: Vec::new(),
            view: cells.create_view(&wgpu::TextureViewDescriptor::default()),
            cells,
        }
    }

    /// Computes and uploads the light of a frame.
    pub fn write(&mut self, gpu: &Gpu, commands: &mut Commands, input: &crate::FrameInput) {
        let changed = self.light.follow(input);
        let tables = &self.light.tables;
        if changed || self.tables.is_empty() {
            let all = [tables.direct.values(), tables.forward.values(), tables.many.values()].concat();
            self.tables.write(gpu, &all);
        }
        let cells = &self.light.grid.cells;
        cells
            .par_iter()
            .map(|cell| cell.map(|x| f16::from_f32(x.min(f16::MAX.to_f32())).to_bits()))
            .collect_into_vec(&mut self.staging);
        self.staged.write(gpu, &self.staging);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * SIZE.width),
            rows_per_image: Some(SIZE.height),
        };
        commands.encoder().copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer: self.staged.raw(), layout },
            self.cells.as_image_copy(),
            SIZE,
        );
    }

    /// The light of the last frame.
    pub fn light(&self) -> &SceneLight {
        &self.light
    }

    /// The tables of the fibres: see fibre.wgsl.
    pub fn tables(&self) -> &wgpu::Buffer {
        self.tables.raw()
    }

    /// The grid of light from all directions.
    pub fn cells(&self) -> &wgpu::TextureView {
        &self.view
    }
}
