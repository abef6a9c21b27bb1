//! Finished images in textures for a window.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, ShaderSource, wgpu};
use lovelock_shadow::GpuList;

use crate::image::DeviceImage;

/// The most lists of a frame: that of the image and one for each light.
pub(super) const MAX_LISTS: usize = 1 + crate::MAX_LIGHTS;
/// Bytes of the head of a list.
pub(super) const HEAD_BYTES: u64 = 16;

/// Twin of `Present` in present.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct PresentUniform {
    size: [u32; 2],
    lists: u32,
    has_before: u32,
    room: [u32; 8],
}

/// The kernel, and the heads of the lists of the frame.
#[derive(Debug)]
pub(super) struct Present {
    kernel: Kernel,
    heads: wgpu::Buffer,
    /// Stands for an image before the first one.
    nothing: wgpu::TextureView,
}

impl Present {
    pub fn new(gpu: &Gpu, source: &ShaderSource) -> Result<Self, GpuError> {
        let nothing = gpu.create_texture(&wgpu::TextureDescriptor {
            label: Some("no image"),
            size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        Ok(Self {
            nothing: nothing.create_view(&wgpu::TextureViewDescriptor::default()),
            // Textures are used in turn, and each is bound with the one before it.
            kernel: Kernel::new(gpu, "present", source, "show")?.keeping(12),
            heads: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("heads of lists"),
                size: HEAD_BYTES * MAX_LISTS as u64,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
        })
    }

    /// The heads of the lists of the last frame, [`HEAD_BYTES`] each: that of the image first.
    pub fn heads(&self) -> &wgpu::Buffer {
        &self.heads
    }

    /// Encodes collecting the heads of the lists of a frame.
    pub fn collect(&self, encoder: &mut wgpu::CommandEncoder, lists: &[Option<GpuList>]) {
        encoder.clear_buffer(&self.heads, 0, None);
        for (at, list) in (0..MAX_LISTS as u64).zip(lists) {
            if let Some(list) = list {
                encoder.copy_buffer_to_buffer(list.buffer, list.at, &self.heads, HEAD_BYTES * at, HEAD_BYTES);
            }
        }
    }

    /// Encodes copying `pixels` into `shown`, or `before` if a list was too short.
    pub fn show(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        pixels: &wgpu::Buffer,
        (shown, before): (&DeviceImage, Option<&DeviceImage>),
        lists: &[Option<GpuList>],
    ) {
        let size = shown.size();
        let before = before.filter(|before| before.size() == size);
        let mut uniform = PresentUniform {
            size,
            lists: lists.len().min(MAX_LISTS) as u32,
            has_before: u32::from(before.is_some()),
            room: [u32::MAX; 8],
        };
        for (room, list) in uniform.room.iter_mut().zip(lists) {
            *room = list.map_or(u32::MAX, |list| u32::try_from(list.room).unwrap_or(u32::MAX));
        }
        let constants = commands.constants("present", &uniform);
        let group = self.kernel.bind(
            gpu,
            &[
                (0, constants.as_entire_binding()),
                (1, pixels.as_entire_binding()),
                (2, self.heads.as_entire_binding()),
                (3, wgpu::BindingResource::TextureView(before.map_or(&self.nothing, DeviceImage::view))),
                (4, wgpu::BindingResource::TextureView(shown.view())),
            ],
        );
        let [width, height] = size;
        commands.compute("draw/present", |pass| {
            self.kernel.run(pass, &group, u64::from(width) * u64::from(height));
        });
    }
}
