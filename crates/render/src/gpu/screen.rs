//! The finished pixels of one picture: hair over the body over the background.

use lovelock_gpu::{Commands, Gpu, GrowBuffer, Kernel, constants, wgpu};

use super::eye::Area;
use super::frame_resources::FrameResources;
use super::light_kernels::{LISTS, LightKernels};
use super::targets::Targets;

/// Threads that share the pixels that are lit one by one: enough to fill a card, and few enough that those without a pixel cost
/// little where kernels run on the processor.
const LIT_THREADS: [u64; 2] = [1 << 18, 1 << 15];

/// What the last kernels put together.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenInput<'a> {
    /// The body as the eye sees it.
    pub targets: &'a Targets,
    /// The light on the ground.
    pub corners: &'a wgpu::Buffer,
    /// The part of the picture that may have hair, and the hair of each of its pixels.
    pub area: Area,
    pub hair: &'a wgpu::Buffer,
}

/// The pixels, and which of them are lit one by one.
#[derive(Debug)]
pub(super) struct Screen {
    pixels: GrowBuffer<u32>,
    /// [`LISTS`] lists, one behind the other, each with room for all pixels.
    lit: GrowBuffer<u32>,
    lit_count: wgpu::Buffer,
    lit_threads: u64,
}

impl Screen {
    pub fn new(gpu: &Gpu) -> Self {
        let device = &gpu.device;
        let usage = wgpu::BufferUsages::STORAGE;
        Self {
            pixels: GrowBuffer::new(device, "screen", usage),
            lit: GrowBuffer::new(device, "lit pixels", usage),
            lit_count: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("number of lit pixels"),
                size: 4 * LISTS as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            lit_threads: LIT_THREADS[usize::from(gpu.is_software())],
        }
    }

    /// Makes room for a picture.
    pub fn fit(&mut self, gpu: &Gpu, width: u32, height: u32) {
        let pixels = width as usize * height as usize;
        self.pixels.reserve(&gpu.device, pixels);
        self.lit.reserve(&gpu.device, LISTS * pixels);
    }

    /// Red, green, blue and alpha of each pixel, row after row.
    pub fn pixels(&self) -> &wgpu::Buffer {
        self.pixels.raw()
    }

    pub fn memory_bytes(&self) -> u64 {
        self.pixels.raw().size() + self.lit.raw().size()
    }

    /// Encodes making them.
    pub fn run(
        &self,
        gpu: &Gpu,
        picture: &Kernel,
        kernels: &LightKernels,
        commands: &mut Commands,
        frame: &FrameResources,
        input: &ScreenInput,
    ) {
        let ScreenInput { targets, area, .. } = *input;
        let hair_area = constants(gpu, "hair area", &[area.left, area.top, area.columns, area.rows]);
        let own = frame.with([
            (4, wgpu::BindingResource::TextureView(&targets.normals)),
            (5, wgpu::BindingResource::TextureView(&targets.colors)),
            (6, wgpu::BindingResource::TextureView(&targets.depth)),
            (7, input.corners.as_entire_binding()),
            (8, input.hair.as_entire_binding()),
            (9, self.pixels.raw().as_entire_binding()),
            (11, hair_area.as_entire_binding()),
            (12, self.lit.raw().as_entire_binding()),
            (13, self.lit_count.as_entire_binding()),
        ]);
        commands.encoder().clear_buffer(&self.lit_count, 0, None);
        let pixels = self.pixels.len() as u64;
        let group = picture.bind(gpu, &own);
        commands.compute("draw/picture", |pass| picture.run(pass, &group, pixels));
        let groups = kernels.picture_lit.each_ref().map(|kernel| kernel.bind(gpu, &own));
        commands.compute("draw/lit", |pass| {
            for (kernel, group) in kernels.picture_lit.iter().zip(&groups) {
                kernel.run(pass, group, pixels.min(self.lit_threads));
            }
        });
    }
}
