//! One way to a picture, whatever draws it.

use std::sync::Arc;

use glam::Vec3;
use lovelock_gpu::Gpu;

use crate::{
    Backend, CpuRenderer, FrameInput, FrameStats, GpuRenderer, Layers, Picture, RayStructure, RenderError,
};

/// Draws pictures on the backend that was chosen, and keeps what it needs for the next one.
#[derive(Debug)]
pub struct Renderer {
    choice: Backend,
    gpu: Option<GpuRenderer>,
    cpu: Option<Box<CpuRenderer>>,
    /// Name of what draws.
    adapter: String,
}

impl Renderer {
    /// Opens what draws. [`Backend::Auto`] takes the graphics card where there is a real one.
    ///
    /// # Errors
    /// No adapter for [`Backend::Gpu`], or one that cannot be used.
    pub fn open(choice: Backend) -> Result<Self, RenderError> {
        match choice {
            Backend::Cpu => Ok(Self::on_processor(choice)),
            Backend::Gpu => Self::on(Gpu::open()?, choice),
            // What emulates a graphics card on the processor is slower than using the processor; and a card that cannot
            // be used is none.
            Backend::Auto => match Gpu::open() {
                Ok(gpu) if !gpu.is_software() => Ok(Self::on(gpu, choice).unwrap_or_else(|error| {
                    tracing::warn!(%error, "the graphics card cannot be used");
                    Self::on_processor(choice)
                })),
                _ => Ok(Self::on_processor(choice)),
            },
        }
    }

    /// Draws on a device that is open.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn on_device(gpu: Arc<Gpu>) -> Result<Self, RenderError> {
        Self::on(gpu, Backend::Gpu)
    }

    fn on(gpu: Arc<Gpu>, choice: Backend) -> Result<Self, RenderError> {
        let adapter = gpu.info.name.clone();
        Ok(Self { choice, gpu: Some(GpuRenderer::new(gpu)?), cpu: None, adapter })
    }

    fn on_processor(choice: Backend) -> Self {
        Self { choice, gpu: None, cpu: Some(Box::default()), adapter: CpuRenderer::adapter() }
    }

    /// What was asked for.
    pub fn choice(&self) -> Backend {
        self.choice
    }

    /// What draws: the graphics card or the processor.
    pub fn backend(&self) -> Backend {
        if self.gpu.is_some() { Backend::Gpu } else { Backend::Cpu }
    }

    /// The name of what draws: the adapter, or the processor's way.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Whether the processor does the drawing, by itself or as a software adapter.
    pub fn is_software(&self) -> bool {
        self.gpu.as_ref().is_none_or(|gpu| gpu.gpu().is_software())
    }

    /// The device that it draws on; none on the processor.
    pub fn gpu(&self) -> Option<&Arc<Gpu>> {
        self.gpu.as_ref().map(GpuRenderer::gpu)
    }

    /// Draws `input` at `width` by `height` pixels.
    ///
    /// # Errors
    /// A size out of range, a shadow that needs too much memory, or a device that is lost.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.picture(input, width, height, picture),
            None => self.cpu.get_or_insert_default().picture(input, width, height, picture),
        }
    }

    /// Draws the layers of a picture of `input`: what an exchange with a compositor, a transparent background or a shutter that is
    /// open for a while needs. Costs about twice a picture. `over_background` draws the background and the ground behind hair and
    /// body; without, there is nothing behind them, and no shadow on the ground.
    ///
    /// # Errors
    /// As [`Renderer::picture`].
    pub fn layers(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.layers(input, width, height, over_background, layers),
            None => self.cpu.get_or_insert_default().layers(input, width, height, over_background, layers),
        }
    }

    /// Transmittance that the last picture used at every strand point, 0 to 1, in the order of the points: of light `light`,
    /// counted from 0 among those that are switched on. In steps of 1/255 on a graphics card, which keeps no more.
    ///
    /// # Errors
    /// No such light, no picture since the renderer was opened or the last one failed, or a device that is lost.
    pub fn transmittance(&mut self, light: usize) -> Result<Vec<f32>, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.transmittance(light),
            None => self.cpu.get_or_insert_default().transmittance(light),
        }
    }

    /// Asks the map of a light of the last picture at any points, world space, metres: transmittance, 0 to 1, in the
    /// precision and for the lights of [`Renderer::transmittance`]. A point that is not finite gets 1.
    ///
    /// # Errors
    /// As [`Renderer::transmittance`], or more points than the device takes at once.
    pub fn transmittance_at(&mut self, light: usize, points: &[Vec3]) -> Result<Vec<f32>, RenderError> {
        match &mut self.gpu {
            Some(gpu) => gpu.transmittance_at(light, points),
            None => self.cpu.get_or_insert_default().transmittance_at(light, points),
        }
    }

    /// What the map of a light of the last picture keeps along the light through `p`, world space, metres. `None` on a graphics
    /// card, whose maps stay there: build the method's [`CpuShadow`](lovelock_shadow::CpuShadow), its definition, to look into
    /// it.
    ///
    /// # Errors
    /// On the processor as [`Renderer::transmittance`].
    pub fn along_ray(&mut self, light: usize, p: Vec3) -> Result<Option<RayStructure>, RenderError> {
        match &self.gpu {
            Some(_) => Ok(None),
            None => self.cpu.get_or_insert_default().along_ray(light, p).map(Some),
        }
    }
}
