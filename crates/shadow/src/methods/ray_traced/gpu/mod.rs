//! Rays on the GPU: the hierarchy is made there, because strands are known only there. Segments are sorted along a curve, and boxes are
//! joined level by level.
//!
//! The first light makes the hierarchy, and all others read it.

mod tree;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_gpu::{Commands, Gpu, GpuError, ShaderPart, ShaderSource, wgpu};

use self::tree::Tree;
use super::cpu::most_ribbons;
use super::hierarchy::places;
use super::samples::spread;
use super::{COLUMNS, RayTracedSettings, safe_width};
use crate::cpu::safe_extinction;
use crate::gpu::{GpuColumns, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup, wgsl};
use crate::world::{COLUMNS as COLUMN_QUERY, ColumnViews, ToLight, WorldLight};
use crate::{ShadowReport, ShadowSettings};

const FRAME: ShaderPart = wgsl!("methods/ray_traced/gpu/", "frame.wgsl");
const QUERY: [ShaderPart; 3] = [FRAME, wgsl!("methods/ray_traced/gpu/", "query.wgsl"), COLUMN_QUERY];

/// Twin of `TraceUniform` in frame.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct TraceUniform {
    anchor: Vec3,
    half_width: f32,
    low: Vec3,
    segments: u32,
    high: Vec3,
    places: u32,
    light: Vec3,
    radius: f32,
    first_axis: Vec3,
    edge: u32,
    second_axis: Vec3,
    each: f32,
    most: u32,
    spread: f32,
    unused: [u32; 2],
}

impl TraceUniform {
    fn new(input: &GpuShadowInput, settings: &RayTracedSettings) -> Self {
        let to_light = ToLight::of(&input.light.seen_from(input.anchor));
        let (light, radius) = to_light.source.unwrap_or((to_light.toward, -1.0));
        let (width, each) = (safe_width(input.strand_width), safe_extinction(input.extinction_scale));
        let is_some = input.extent.min.x <= input.extent.max.x;
        let (low, high) =
            if is_some { (input.extent.min, input.extent.max) } else { (Vec3::ZERO, Vec3::ZERO) };
        let segments = input.strands.segment_count;
        // Nothing blocks light: no ray need be traced.
        let is_lit = width == 0.0 || each == 0.0;
        Self {
            anchor: input.anchor,
            half_width: 0.5 * width,
            low,
            segments,
            high,
            places: if is_lit { 0 } else { places(u64::from(segments)) as u32 },
            light,
            radius,
            first_axis: input.light.y,
            edge: settings.rays.isqrt(),
            second_axis: input.light.z,
            each,
            most: most_ribbons(each),
            spread: spread(&input.light),
            unused: [0; 2],
        }
    }
}

/// [`ShadowMethod::RayTraced`](crate::ShadowMethod::RayTraced) on the GPU.
#[derive(Debug)]
pub(crate) struct GpuRayTraced {
    tree: Tree,
    lookup: PointLookup,
    lights: Vec<WorldLight>,
    /// What the hierarchy was made of.
    source: Option<Source>,
}

/// The hair of a hierarchy: lights with the same share it.
#[derive(Clone, Debug, PartialEq)]
struct Source {
    points: wgpu::Buffer,
    segments: wgpu::Buffer,
    /// Without the light and the rays.
    uniform: TraceUniform,
}

impl Source {
    fn new(input: &GpuShadowInput, uniform: TraceUniform) -> Self {
        let uniform = TraceUniform {
            light: Vec3::ZERO,
            radius: 0.0,
            spread: 0.0,
            first_axis: Vec3::ZERO,
            second_axis: Vec3::ZERO,
            edge: 0,
            ..uniform
        };
        Self { points: input.strands.points.clone(), segments: input.strands.segments.clone(), uniform }
    }
}

impl GpuRayTraced {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            tree: Tree::new(gpu)?,
            lookup: PointLookup::new(gpu, &QUERY, true, &[])?,
            lights: Vec::new(),
            source: None,
        })
    }

    /// Every composed shader with its label.
    pub(crate) fn shaders() -> Vec<(String, ShaderSource)> {
        Tree::shaders().into_iter().chain(PointLookup::shaders(&QUERY, true)).collect()
    }

    /// The bindings of a query.
    fn resources<'a>(&'a self, light: &'a WorldLight) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        let [ends, nodes] = self.tree.resources();
        vec![(0, light.uniform.as_entire_binding()), ends, nodes]
    }
}

impl GpuShadow for GpuRayTraced {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let settings = settings.ray_traced.clamped();
        let uniform = TraceUniform::new(input, &settings);
        let source = Source::new(input, uniform);
        self.lights.truncate(input.slots());
        let needed_bytes = Tree::needed_bytes(input.strands.segment_count);
        // The hair of the first light is new in each frame.
        if slot == 0 || self.source.as_ref() != Some(&source) {
            let room = self.tree.make_room(gpu, input.strands.segment_count, settings.memory_limit_bytes);
            if let Err(error) = room {
                self.forget(gpu);
                self.lights.resize_with(slot + 1, || WorldLight::new::<TraceUniform>(gpu));
                return Err(error.into());
            }
            let buffer = commands.constants("traced rays", &uniform);
            if uniform.places > 0 {
                self.tree.build(gpu, commands, &buffer, (input, uniform.places));
            }
            self.source = Some(source);
        }
        while self.lights.len() <= slot {
            self.lights.push(WorldLight::new::<TraceUniform>(gpu));
        }
        let light = &mut self.lights[slot];
        gpu.upload(&light.uniform, 0, &[uniform]);
        let reach = 2.0 * uniform.half_width + 1e-4;
        light.columns = ColumnViews::new(&input.light, input.anchor, (COLUMNS, reach), &input.bounds);
        light.report = ShadowReport {
            // Lights share the hierarchy.
            memory_bytes: if slot == 0 { self.tree.memory_bytes() } else { 0 },
            scratch_bytes: self.tree.scratch_bytes(),
            cell_size: 2.0 * uniform.half_width,
            points_ignored: input.extent.ignored,
            needed_bytes,
            ..ShadowReport::default()
        };
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let Some(light) = self.lights.get(slot) else { return };
        self.lookup.run(gpu, commands, slot, &self.resources(light), targets);
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.lights.get(slot).map_or(0, |light| light.columns.size())
    }

    fn column_sides(&self, slot: usize) -> usize {
        self.lights.get(slot).map_or(1, |light| light.columns.0.len().max(1))
    }

    fn columns(
        &mut self,
        (slot, side): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let light = self.lights.get(slot)?;
        light.write_columns(side, (&self.lookup, self.resources(light)), (gpu, commands), into)
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.lights.clear();
        self.source = None;
        self.tree.free(gpu);
    }

    fn report(&self, slot: usize) -> ShadowReport {
        self.lights.get(slot).map_or_else(ShadowReport::default, |light| light.report)
    }

    fn map_words(&self, _slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(source) = &self.source else { return Ok(Vec::new()) };
        self.tree.words(gpu, source.uniform.places)
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use lovelock_gpu::layout_in_shader;

    #[test]
    fn the_uniform_has_the_layout_of_every_shader() {
        let expected = [
            offset_of!(TraceUniform, anchor),
            offset_of!(TraceUniform, half_width),
            offset_of!(TraceUniform, low),
            offset_of!(TraceUniform, segments),
            offset_of!(TraceUniform, high),
            offset_of!(TraceUniform, places),
            offset_of!(TraceUniform, light),
            offset_of!(TraceUniform, radius),
            offset_of!(TraceUniform, first_axis),
            offset_of!(TraceUniform, edge),
            offset_of!(TraceUniform, second_axis),
            offset_of!(TraceUniform, each),
            offset_of!(TraceUniform, most),
            offset_of!(TraceUniform, spread),
            size_of::<TraceUniform>(),
        ];
        for (label, source) in GpuRayTraced::shaders().iter().filter(|(label, _)| label != "shadow/sort") {
            if source.text().contains("TraceUniform") {
                assert_eq!(layout_in_shader(source, "TraceUniform"), expected, "{label}");
            }
        }
    }
}
