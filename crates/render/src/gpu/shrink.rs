//! Small copies of images on the device.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Gpu, Kernel, PassTimer, wgpu};

use super::pipelines::shrink_source;
use crate::RenderError;
use crate::image::{DeviceImage, DeviceImages};

/// Twin of `Shrink` in shrink.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct ShrinkUniform {
    corner: [f32; 2],
    size: [f32; 2],
}

/// Makes small copies of images on a device.
#[derive(Debug)]
pub struct Shrinker {
    gpu: Arc<Gpu>,
    kernel: Kernel,
    copies: DeviceImages,
}

impl Shrinker {
    /// For images of this device.
    ///
    /// # Errors
    /// The device cannot compile the shader, or is lost.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, RenderError> {
        let gpu = gpu.handle();
        let kernel = Kernel::new(&gpu, "shrink", &shrink_source(), "average")?;
        Ok(Self { kernel, copies: DeviceImages::new(&gpu), gpu })
    }

    /// The device of the images.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// A copy of the middle of `image` with the aspect ratio of `size`, in pixels. Does not wait for the device.
    pub fn shrink(&mut self, image: &DeviceImage, size: [u32; 2]) -> Arc<DeviceImage> {
        let copy = self.copies.free(size);
        let [width, height] = image.size().map(|side| side as f32);
        let aspect = size[0] as f32 / size[1].max(1) as f32;
        let shown = [(height * aspect).min(width), (width / aspect).min(height)];
        let uniform =
            ShrinkUniform { corner: [0.5 * (width - shown[0]), 0.5 * (height - shown[1])], size: shown };
        let mut timer = PassTimer::off();
        let mut commands = timer.begin(&self.gpu, "shrink");
        let constants = commands.constants("shrink", &uniform);
        let group = self.kernel.bind(
            &self.gpu,
            &[
                (0, constants.as_entire_binding()),
                (1, wgpu::BindingResource::TextureView(image.view())),
                (2, wgpu::BindingResource::TextureView(copy.view())),
            ],
        );
        commands.compute("shrink", |pass| {
            self.kernel.run(pass, &group, u64::from(size[0]) * u64::from(size[1]));
        });
        commands.submit();
        copy
    }
}
