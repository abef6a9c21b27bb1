//! The hair that a frame shows: where it is, and whether strands are drawn beside clusters.

use lovelock_gpu::{Commands, Gpu};
use lovelock_groom::HairShading;

use super::GpuRenderer;
use crate::gpu::carried::CarriedBuffers;
use crate::gpu::clusters::DrawnClusters;
use crate::gpu::eye::{Area, EyeInput, HairOutput, WIDEST_PLAIN};
use crate::gpu::frame_resources::FrameResources;
use crate::gpu::hair::{HairBuffers, PointShading};
use crate::gpu::targets::Targets;
use crate::uniform::FrameUniform;
use crate::{FrameInput, RenderError, Transparency};

/// See [`EyeInput`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SeenHair {
    pub area: Area,
    pub reach: f32,
    pub streaked: bool,
    /// Whether strands are drawn, beside clusters or alone.
    pub has_strands: bool,
    /// The least distance of the ribs of clusters along the view, metres.
    pub nearest_rib: f32,
    pub transparency: Transparency,
}

impl SeenHair {
    /// The strands alone, also where only clusters are drawn: see [`GpuRenderer::shade_hidden_strands`].
    pub fn of_strands(self) -> Self {
        Self { has_strands: true, ..self }
    }
}

/// The input of the passes over the hair.
pub(super) fn eye_input<'a>(
    seen: &SeenHair,
    (hair, carried): (&'a HairBuffers, &'a CarriedBuffers),
    clusters: Option<DrawnClusters<'a>>,
    targets: &'a Targets,
    uniform: &FrameUniform,
    drawn: HairOutput,
) -> EyeInput<'a> {
    let strands = hair.drawn();
    let (segments, segment_count) = carried.segments().unwrap_or((strands.segments, strands.segment_count));
    EyeInput {
        area: seen.area,
        reach: seen.reach,
        streaked: seen.streaked,
        shaded: hair.shaded(),
        segments,
        segment_count: if seen.has_strands { segment_count } else { 0 },
        depth: &targets.depth,
        opacity: uniform.opacity,
        drawn,
        clusters,
    }
}

impl GpuRenderer {
    /// The area that may contain hair, and the largest width of a strand.
    pub(super) fn seen_hair(
        &mut self,
        input: &FrameInput,
        uniform: &FrameUniform,
        size: [u32; 2],
    ) -> SeenHair {
        let (bounds, _) = self.hair.bounds(input, Area::axes(input.camera), input.camera.eye);
        let strand_width = uniform.strand_width;
        let reach_at = |least: f32| 0.5 * strand_width * uniform.pixels_per_metre / bounds.min.x.max(least);
        let area = Area::of(input.camera, size, (bounds.min, bounds.max), strand_width);
        let (area_of_carried, carried_reach) = self.carried.area(input, size, uniform.pixels_per_metre);
        let share = self.clusters.share();
        let transparency = input.picture.transparency;
        let ribs = self.clusters.bounds(input, Area::axes(input.camera), input.camera.eye);
        let area_of_ribs =
            ribs.map_or(Area::default(), |ribs| Area::of(input.camera, size, (ribs.min, ribs.max), 0.0));
        SeenHair {
            area: area.with(area_of_ribs).with(area_of_carried),
            reach: reach_at(0.05).max(carried_reach),
            // Nothing nearer than this is drawn.
            streaked: reach_at(0.02).max(carried_reach) > WIDEST_PLAIN,
            has_strands: share < 1.0,
            nearest_rib: ribs.map_or(0.0, |ribs| ribs.min.x),
            // Segments and layers have no order of their own.
            transparency: match transparency {
                Transparency::Sorted if share > 0.0 && share < 1.0 => Transparency::Exact,
                _ => transparency,
            },
        }
    }

    /// Encodes projecting the strands of the last frame if only clusters were drawn: then they have only cast shadows.
    pub(super) fn shade_hidden_strands(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
    ) -> Result<(), RenderError> {
        if self.seen.has_strands {
            return Ok(());
        }
        let frame = FrameResources {
            uniform: &self.uniform,
            body_depth: self.surface.depth(),
            columns: self.shadow.columns_view(),
            linear: &self.linear,
            compare: &self.compare,
            ambient: self.light.cells(),
        };
        let lit = self.pipelines.lit.of(gpu, self.shadow.light_set())?;
        // Values replace their light.
        let shading =
            PointShading { kernels: lit, model: HairShading::TwoHighlights, tables: self.light.tables() };
        self.hair.shade(gpu, "draw/points", shading, commands, &frame)?;
        Ok(())
    }
}
