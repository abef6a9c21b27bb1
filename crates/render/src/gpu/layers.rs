//! The layers of a picture on the GPU: kernels over the buffers of the last picture.

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, Readback, ShaderSource, wgpu};

use super::light_kernels::{LISTS, LightSet, shows_body};
use crate::Layers;

/// Bytes per pixel of the two buffers.
const LIGHT_BYTES: u64 = 16;
const DATA_BYTES: u64 = 8;

/// The parts of the kernels.
#[derive(Debug)]
pub(super) struct LayerShaders {
    /// Without and with materials of the body.
    pub layers: [ShaderSource; 2],
    pub values: ShaderSource,
}

/// What the kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LayerVariant {
    pub lights: LightSet,
    pub over_background: bool,
    /// Whether the body has materials.
    pub has_materials: bool,
}

/// The kernels of a [`LayerVariant`].
#[derive(Debug)]
pub(super) struct LayerKernels {
    pub background: Kernel,
    /// The kernels that draw the pixels of each list.
    pub lit: [Kernel; LISTS],
    pub values: Kernel,
    pub transmittance: Kernel,
    pub depth: Kernel,
}

impl LayerKernels {
    fn compile(
        gpu: &Gpu,
        shaders: &LayerShaders,
        LayerVariant { lights, over_background, has_materials }: LayerVariant,
    ) -> Result<Self, GpuError> {
        let over = ("OVER_BACKGROUND", f64::from(u8::from(over_background)));
        let [count, standing] = lights.constants();
        let kernel = |label, entry, list: f64| {
            let constants = [count, standing, ("LIST", list), over];
            Kernel::specialised(gpu, label, &shaders.layers[0], entry, &constants)
        };
        let lit = |list: usize| {
            let constants = [count, standing, ("LIST", list as f64), over];
            let source = &shaders.layers[usize::from(has_materials && shows_body(list))];
            Kernel::specialised(gpu, "layer lit", source, "layer_lit", &constants)
        };
        Ok(Self {
            background: kernel("layer background", "layer_background", 0.0)?,
            lit: [lit(0)?, lit(1)?, lit(2)?, lit(3)?],
            values: Kernel::new(gpu, "values of points", &shaders.values, "value_points")?,
            transmittance: kernel("layer transmittance", "layer_transmittance", 0.0)?,
            depth: kernel("layer depth", "layer_depth", 0.0)?,
        })
    }
}

/// The kernels that were used, and the buffers of the pixels.
#[derive(Debug)]
pub(super) struct LayerBuffers {
    kernels: Vec<(LayerVariant, LayerKernels)>,
    light: GrowBuffer<[f32; 4]>,
    data: GrowBuffer<[f32; 2]>,
    readback: Readback,
    bytes: [Vec<u8>; 2],
}

impl LayerBuffers {
    pub fn new(gpu: &Gpu) -> Self {
        let storage = wgpu::BufferUsages::STORAGE;
        Self {
            kernels: Vec::new(),
            light: GrowBuffer::new(gpu, "light layer", storage),
            data: GrowBuffer::new(gpu, "data layer", storage),
            readback: Readback::default(),
            bytes: [const { Vec::new() }; 2],
        }
    }

    /// Bytes of the largest buffer for an image of this many pixels.
    pub fn needed(pixels: u64) -> u64 {
        LIGHT_BYTES * pixels
    }

    /// Resizes the buffers for a picture, and compiles the kernels that it needs.
    ///
    /// # Errors
    /// A shader does not compile.
    pub fn fit(
        &mut self,
        gpu: &Gpu,
        shaders: &LayerShaders,
        pixels: u64,
        variant: LayerVariant,
    ) -> Result<(), GpuError> {
        self.light.reserve(gpu, pixels as usize);
        self.data.reserve(gpu, pixels as usize);
        if !self.kernels.iter().any(|(known, _)| *known == variant) {
            let kernels = LayerKernels::compile(gpu, shaders, variant)?;
            self.kernels.push((variant, kernels));
        }
        Ok(())
    }

    /// The kernels of a kind that [`LayerBuffers::fit`] has made.
    pub fn kernels(&self, variant: LayerVariant) -> Option<&LayerKernels> {
        self.kernels.iter().find(|(known, _)| *known == variant).map(|(_, kernels)| kernels)
    }

    /// The buffers by their bindings.
    pub fn bindings(&self) -> [(u32, wgpu::BindingResource<'_>); 2] {
        [(16, self.light.raw().as_entire_binding()), (17, self.data.raw().as_entire_binding())]
    }

    /// Encodes the readback.
    pub fn copy(&mut self, gpu: &Gpu, commands: &mut Commands, pixels: u64) {
        let wanted = [(self.light.raw(), LIGHT_BYTES * pixels), (self.data.raw(), DATA_BYTES * pixels)];
        self.readback.copy(gpu, commands.encoder(), &wanted);
    }

    /// Waits for the readback, and takes the light, and depth and transmittance `with_values`.
    ///
    /// # Errors
    /// The device is lost.
    pub fn read(
        &mut self,
        gpu: &Gpu,
        [width, height]: [u32; 2],
        with_values: bool,
        layers: &mut Layers,
    ) -> Result<(), GpuError> {
        let [light, data] = &mut self.bytes;
        self.readback.read(gpu, &mut [light, data])?;
        layers.resize(width, height);
        for (to, from) in layers.light.iter_mut().zip(light.as_chunks::<16>().0) {
            *to = bytemuck::pod_read_unaligned(from);
        }
        if !with_values {
            return Ok(());
        }
        let places = layers.depth.iter_mut().zip(&mut layers.transmittance);
        for ((depth, transmittance), from) in places.zip(data.as_chunks::<8>().0) {
            [*depth, *transmittance] = bytemuck::pod_read_unaligned(from);
        }
        Ok(())
    }
}
