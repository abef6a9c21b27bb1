//! The light on the ground at the corners of cells of pixels.

use lovelock_gpu::{Commands, Gpu, GrowBuffer, wgpu};

use super::frame_resources::FrameResources;
use super::light_kernels::LightKernels;

/// Pixels along each edge of a cell; twin of `CELL` in `ground_light.wgsl`.
pub(super) const CELL: u32 = 4;

/// The corners of one picture.
#[derive(Debug)]
pub(super) struct Ground(GrowBuffer<u32>);

/// Cells of a picture.
pub(super) fn cells(width: u32, height: u32) -> usize {
    width.div_ceil(CELL) as usize * height.div_ceil(CELL) as usize
}

impl Ground {
    pub fn new(gpu: &Gpu) -> Self {
        Self(GrowBuffer::new(gpu, "light on the ground", wgpu::BufferUsages::STORAGE))
    }

    /// Resizes the buffer for the corners of a picture.
    pub fn fit(&mut self, gpu: &Gpu, width: u32, height: u32) {
        let count = (width.div_ceil(CELL) + 1) * (height.div_ceil(CELL) + 1);
        self.0.reserve(gpu, count as usize);
    }

    pub fn corners(&self) -> &wgpu::Buffer {
        self.0.raw()
    }

    /// Encodes computing the light at the corners.
    pub fn run(&self, gpu: &Gpu, kernels: &LightKernels, commands: &mut Commands, frame: &FrameResources) {
        let group = kernels.ground.bind(gpu, &frame.with([(4, self.0.raw().as_entire_binding())]));
        commands.compute("draw/ground", |pass| kernels.ground.run(pass, &group, self.0.len() as u64));
    }
}
