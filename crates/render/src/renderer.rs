//! One way to a picture, whatever draws it.

use std::sync::Arc;

use lovelock_gpu::Gpu;

use crate::{Backend, CpuRenderer, FrameInput, FrameStats, GpuRenderer, Picture, RenderError};

/// Draws pictures on the backend that was chosen, and keeps what it needs for the next one.
#[derive(Debug)]
pub struct Renderer {
    choice: Backend,
    gpu: Option<GpuRenderer>,
    cpu: Option<Box<CpuRenderer>>,
    /// Names of the graphics card and of the processor's way.
    adapters: [String; 2],
    /// Whether the last picture was drawn by the processor though there is a card.
    stood_in: bool,
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
        let adapters = [adapter, CpuRenderer::adapter()];
        Ok(Self { choice, gpu: Some(GpuRenderer::new(gpu)?), cpu: None, adapters, stood_in: false })
    }

    fn on_processor(choice: Backend) -> Self {
        let adapters = [String::new(), CpuRenderer::adapter()];
        Self { choice, gpu: None, cpu: Some(Box::default()), adapters, stood_in: false }
    }

    /// What was asked for.
    pub fn choice(&self) -> Backend {
        self.choice
    }

    /// What drew the last picture, and draws the next one by all that is known: the graphics card or the processor.
    pub fn backend(&self) -> Backend {
        if self.gpu.is_some() && !self.stood_in { Backend::Gpu } else { Backend::Cpu }
    }

    /// The name of what draws: the adapter, or the processor's way.
    pub fn adapter(&self) -> &str {
        &self.adapters[usize::from(self.backend() == Backend::Cpu)]
    }

    /// Whether the processor does the drawing, by itself or as a software adapter.
    pub fn is_software(&self) -> bool {
        self.stood_in || self.gpu.as_ref().is_none_or(|gpu| gpu.gpu().is_software())
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
        self.stood_in = self.choice == Backend::Auto && !input.picture.transparency.is_on_gpu();
        match &mut self.gpu {
            // Where the choice is ours, what the card does not draw is drawn by the processor.
            Some(gpu) if !self.stood_in => gpu.picture(input, width, height, picture),
            _ => self.cpu.get_or_insert_default().picture(input, width, height, picture),
        }
    }
}
