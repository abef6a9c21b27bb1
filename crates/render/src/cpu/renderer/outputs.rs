//! What a picture is drawn to.

use super::{CpuRenderer, Target};
use crate::{ColorScale, FrameInput, FrameStats, Layers, Picture, RenderError};

impl CpuRenderer {
    /// Renders `input` at `width` by `height` pixels.
    ///
    /// # Errors
    /// The size is out of range, or the shadow needs too much memory.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::Picture(picture))
    }

    /// Renders the layers of `input` at `width` by `height` pixels, with or without the background.
    ///
    /// # Errors
    /// As [`CpuRenderer::picture`].
    pub fn layers(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::Layers(layers, over_background, true))
    }

    /// As [`CpuRenderer::layers`] without depth and transmittance, which stay as they are.
    ///
    /// # Errors
    /// As [`CpuRenderer::picture`].
    pub fn light(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::Layers(layers, over_background, false))
    }

    /// As [`CpuRenderer::picture`], with hair in the colours of `scale` by one value per stored strand; fine strands have what lies between
    /// their parents. A value that is not finite is missing: it hides what is behind it but has no colour.
    ///
    /// # Errors
    /// As [`CpuRenderer::picture`].
    pub fn strand_colors(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        (of_strands, scale): (&[f32], &ColorScale),
        picture: &mut Picture,
    ) -> Result<FrameStats, RenderError> {
        self.draw_to(input, width, height, Target::FalseColors(picture, of_strands, scale))
    }
}
