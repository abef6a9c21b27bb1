//! The layers of a picture.

use std::sync::Arc;

use lovelock_gpu::PassTimer;

use super::{GpuRenderer, eye_input};
use crate::gpu::eye::{HairOutput, too_large};
use crate::gpu::frame_resources::FrameResources;
use crate::gpu::layers::{LayerBuffers, LayerVariant};
use crate::gpu::screen::material_bindings;
use crate::{FrameInput, FrameStats, Layers, Picture, RenderError};

impl GpuRenderer {
    /// See [`Renderer::layers`](crate::Renderer::layers). Renders the picture first, then the layers from its buffers. Statistics are
    /// those of both.
    ///
    /// # Errors
    /// As there, or the layers do not fit a buffer of the device.
    pub fn layers(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        self.draw_layers(input, [width, height], (over_background, true), layers)
    }

    /// See [`Renderer::light`](crate::Renderer::light).
    ///
    /// # Errors
    /// As [`GpuRenderer::layers`].
    pub fn light(
        &mut self,
        input: &FrameInput,
        width: u32,
        height: u32,
        over_background: bool,
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        self.draw_layers(input, [width, height], (over_background, false), layers)
    }

    fn draw_layers(
        &mut self,
        input: &FrameInput,
        [width, height]: [u32; 2],
        (over_background, with_values): (bool, bool),
        layers: &mut Layers,
    ) -> Result<FrameStats, RenderError> {
        let gpu = Arc::clone(&self.gpu);
        let pixels = u64::from(width) * u64::from(height);
        let needed = LayerBuffers::needed(pixels);
        if needed > gpu.most_storage_bytes() {
            return Err(too_large(&gpu, needed).into());
        }
        let mut picture = Picture { rgba: std::mem::take(&mut self.spare), ..Picture::default() };
        let drawn = self.picture(input, width, height, &mut picture);
        self.spare = picture.rgba;
        let mut stats = drawn?;

        let uniform = self.last;
        let has_materials = self.surface.materials().is_some();
        let kind = LayerVariant { lights: self.shadow.light_set(), over_background, has_materials };
        // Depth and transmittance of clusters are those of the strands that cast their shadow.
        let seen = self.seen.of_strands();
        self.layers.fit(&gpu, &self.pipelines.layers, pixels, kind)?;
        let mut timer = PassTimer::new(&gpu)?;
        let mut commands = timer.begin(&gpu, "layers");
        if with_values {
            self.shade_hidden_strands(&gpu, &mut commands)?;
        }
        let (Some(kernels), Some(targets)) = (self.layers.kernels(kind), &self.targets) else {
            return Err(RenderError::NoPicture);
        };
        let frame = FrameResources {
            uniform: &self.uniform,
            body_depth: self.surface.depth(),
            columns: self.shadow.columns_view(),
            linear: &self.linear,
            compare: &self.compare,
            ambient: self.light.cells(),
        };
        let area = [seen.area.left, seen.area.top, seen.area.columns, seen.area.rows];
        let hair_area = commands.constants("hair area", &area);
        // The bind group is created each time, because the buffers may have been replaced.
        macro_rules! bound {
            () => {{
                let (corners, hair) = (self.ground.corners(), self.eye.layer());
                let mut all = self.screen.bindings_of_last(&frame, targets, corners, hair, &hair_area);
                all.extend(self.layers.bindings());
                all.extend(material_bindings(targets, self.surface.materials()));
                all
            }};
        }
        let all = bound!();
        let background = kernels.background.bind(&gpu, &all);
        let lit = kernels.lit.each_ref().map(|kernel| kernel.bind(&gpu, &all));
        drop(all);
        commands.compute("draw/layer-light", |pass| {
            kernels.background.run(pass, &background, pixels);
            for (list, (kernel, group)) in kernels.lit.iter().zip(&lit).enumerate() {
                self.screen.run_list(pass, kernel, group, list);
            }
        });

        if with_values {
            self.hair.shade_values(&gpu, &kernels.values, &mut commands, &frame);
            self.carried.shade_values(&gpu, &kernels.values, &mut commands, &frame, &self.hair);
        }
        let blended = HairOutput::Blended(input.picture.transparency);
        for (drawn, kernel, threads) in [
            (blended, &kernels.transmittance, seen.area.pixels()),
            (HairOutput::NearestDepth, &kernels.depth, pixels),
        ]
        .into_iter()
        .filter(|_| with_values)
        {
            let eye = eye_input(&seen, (&self.hair, &self.carried), None, targets, &uniform, drawn);
            self.eye.draw(&gpu, &mut commands, &eye)?;
            let group = kernel.bind(&gpu, &bound!());
            commands.compute("draw/layers", |pass| kernel.run(pass, &group, threads));
        }
        self.layers.copy(&gpu, &mut commands, pixels);
        commands.submit();
        self.layers.read(&gpu, [width, height], with_values, layers)?;
        layers.behind = self.behind.clone().filter(|_| over_background);
        gpu.check()?;
        stats.passes.extend(timer.times(&gpu));
        Ok(stats)
    }
}
