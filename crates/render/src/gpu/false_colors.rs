//! False colours on the GPU: kernels that draw values of strand points in place of light.

use bytemuck::{Pod, Zeroable};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, Readback, ShaderSource, wgpu};

use crate::color_scale::ColorScale;
use crate::image::DeviceImage;

/// Twin of `FalseColors` in `false_colors.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct ScaleUniform {
    behind: f32,
    saturation: f32,
    relief: f32,
    pad: u32,
    table: [u32; 256],
}

/// The parts of the kernels.
#[derive(Debug)]
pub(super) struct FalseColorShaders {
    pub colors: ShaderSource,
    pub values: ShaderSource,
}

#[derive(Debug)]
struct Kernels {
    values: Kernel,
    paint: Kernel,
}

/// The kernels, compiled on first use, and the values of the points.
#[derive(Debug)]
pub(super) struct FalseColors {
    kernels: Option<Kernels>,
    values: GrowBuffer<f32>,
    staging: Vec<f32>,
    readback: Readback,
    head: Vec<u8>,
}

/// The buffers of a picture that [`FalseColors::paint`] reads.
pub(super) struct PaintInput<'a> {
    pub uniform: &'a wgpu::Buffer,
    /// Its pixels.
    pub pixels: &'a wgpu::Buffer,
    /// Its hair with values in place of light, and the area of that.
    pub hair: &'a wgpu::Buffer,
    pub area: [u32; 4],
}

impl FalseColors {
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            kernels: None,
            values: GrowBuffer::new(gpu, "values of points", wgpu::BufferUsages::STORAGE),
            staging: Vec::new(),
            readback: Readback::default(),
            head: Vec::new(),
        }
    }

    /// Compiles the kernels if necessary, and uploads one value per strand point. `missing` points behind them have none.
    ///
    /// # Errors
    /// A shader does not compile.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        shaders: &FalseColorShaders,
        values: &[f32],
        missing: usize,
    ) -> Result<(), GpuError> {
        if self.kernels.is_none() {
            self.kernels = Some(Kernels {
                values: Kernel::new(gpu, "given values of points", &shaders.values, "given_points")?,
                // Textures are used in turn.
                paint: Kernel::new(gpu, "false colours", &shaders.colors, "paint_values")?.keeping(12),
            });
        }
        // Shaders need not tell NaN from other numbers.
        let known = |&value: &f32| if value.is_finite() { value } else { f32::MAX };
        self.staging.clear();
        self.staging.extend(values.iter().map(known));
        self.staging.resize(values.len() + missing, f32::MAX);
        self.values.write(gpu, &self.staging);
        Ok(())
    }

    /// Encodes replacing the colours of the `shaded` points by their values in the range of `scale`.
    pub fn shade(&self, gpu: &Gpu, commands: &mut Commands, scale: &ColorScale, shaded: &wgpu::Buffer) {
        let points = self.values.len() as u64;
        let (Some(kernels), true) = (&self.kernels, points > 0) else { return };
        let [low, high] = scale.range;
        let range = commands.constants("range of values", &[low, (high - low).recip(), 0.0, 0.0]);
        // `arrayLength` of the values is the number of points.
        let values = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.values.raw(),
            offset: 0,
            size: std::num::NonZeroU64::new(4 * points),
        });
        let own = [(7, shaded.as_entire_binding()), (19, values), (20, range.as_entire_binding())];
        let group = kernels.values.bind(gpu, &own);
        commands.compute("draw/values", |pass| kernels.values.run(pass, &group, points));
    }

    /// Encodes painting the values of each pixel into `shown`.
    pub fn paint(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        scale: &ColorScale,
        input: &PaintInput,
        shown: &DeviceImage,
    ) {
        let Some(kernels) = &self.kernels else { return };
        let table = scale.colors.map(|[r, g, b]| u32::from_le_bytes([r, g, b, 255]));
        let ColorScale { behind, saturation, relief, .. } = *scale;
        let uniform = ScaleUniform { behind, saturation, relief, pad: 0, table };
        let scale = commands.constants("colours of values", &uniform);
        let area = commands.constants("hair area", &input.area);
        let own = [
            (0, input.uniform.as_entire_binding()),
            (8, input.hair.as_entire_binding()),
            (9, input.pixels.as_entire_binding()),
            (11, area.as_entire_binding()),
            (19, scale.as_entire_binding()),
            (20, wgpu::BindingResource::TextureView(shown.view())),
        ];
        let group = kernels.paint.bind(gpu, &own);
        let [width, height] = shown.size();
        commands.compute("draw/false-colours", |pass| {
            kernels.paint.run(pass, &group, u64::from(width) * u64::from(height));
        });
    }

    /// Encodes reading the first two words of a list back.
    pub fn copy_head(&mut self, gpu: &Gpu, commands: &mut Commands, list: &wgpu::Buffer) {
        self.readback.copy(gpu, commands.encoder(), &[(list, 8)]);
    }

    /// Waits for them.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read_head(&mut self, gpu: &Gpu) -> Result<[u32; 2], GpuError> {
        self.readback.read(gpu, &mut [&mut self.head])?;
        Ok(bytemuck::pod_read_unaligned(&self.head))
    }
}
