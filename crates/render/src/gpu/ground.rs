//! The light on the ground at the corners of cells of pixels.

use lovelock_gpu::{Commands, Gpu, GrowBuffer, THREADS, wgpu};

use super::pipelines::Pipelines;

/// Pixels along each edge of a cell; twin of `CELL` in ground_light.wgsl.
const CELL: u32 = 4;

/// The corners of one picture.
#[derive(Debug)]
pub(super) struct Ground {
    corners: GrowBuffer<[f32; 4]>,
    groups: Option<[wgpu::BindGroup; 2]>,
    count: u32,
}

impl Ground {
    pub fn new(gpu: &Gpu) -> Self {
        let corners = GrowBuffer::new(&gpu.device, "light on the ground", wgpu::BufferUsages::STORAGE);
        Self { corners, groups: None, count: 0 }
    }

    /// Makes room for the corners of a picture.
    pub fn fit(&mut self, gpu: &Gpu, pipelines: &Pipelines, width: u32, height: u32) {
        let count = (width.div_ceil(CELL) + 1) * (height.div_ceil(CELL) + 1);
        if count == self.count {
            return;
        }
        self.count = count;
        self.corners.reserve(&gpu.device, count as usize);
        let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.corners.raw(),
            offset: 0,
            size: std::num::NonZeroU64::new(u64::from(count) * 16),
        });
        let group = |layout| {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("light on the ground"),
                layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: resource.clone() }],
            })
        };
        self.groups = Some([group(&pipelines.corners_layout), group(&pipelines.ground_layout)]);
    }

    /// Encodes asking for the light at the corners.
    pub fn run(&self, pipelines: &Pipelines, commands: &mut Commands, frame: &wgpu::BindGroup) {
        let Some([corners, _]) = &self.groups else { return };
        commands.compute("draw/ground", |pass| {
            pass.set_pipeline(&pipelines.ground_corners);
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(1, corners, &[]);
            pass.dispatch_workgroups(self.count.div_ceil(THREADS), 1, 1);
        });
    }

    /// Draws the background.
    pub fn draw(&self, pipelines: &Pipelines, pass: &mut wgpu::RenderPass, frame: &wgpu::BindGroup) {
        let Some([_, ground]) = &self.groups else { return };
        pass.set_pipeline(&pipelines.backdrop);
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, ground, &[]);
        pass.draw(0..3, 0..1);
    }
}
