//! The strands on the GPU: positions, and shading of points.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, wgpu};
use lovelock_groom::fine::{FineStrands, Portion};
use lovelock_groom::{HairShading, Hairstyle, StrandBounds};
use lovelock_shadow::{Bounds, GpuStrands, LightFrame, ShadowInput};
use rayon::prelude::*;

use super::fine::FineBuffers;
use super::frame_resources::FrameResources;
use super::interpolate::Interpolation;
use super::light_kernels::LightKernels;
use crate::shadow_look::ShadowLook;
use crate::strand_details::StrandDetails;
use crate::strand_portion::portion_of;
use crate::strand_values::at_points;
use crate::{FrameInput, HairPose};

/// Twin of `ShadedPoint` in the shaders; never read on the CPU.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct ShadedPoint([u32; 8]);

/// How the points of strands are shaded.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointShading<'a> {
    /// The kernels for the lights that are on.
    pub kernels: &'a LightKernels,
    pub model: HairShading,
    /// The tables of the fibres.
    pub tables: &'a wgpu::Buffer,
}

/// The width of a strand that is aimed at, pixels, on a GPU and on a software adapter.
const TARGET_PIXELS: [f32; 2] = [0.35, 0.7];
/// The most points of fine strands.
const MAX_POINTS: u64 = 1 << 22;

/// The buffers of the strands. Data of the hairstyle is uploaded when it changes. A frame uploads only guides, or its strands if they
/// are given.
#[derive(Debug)]
pub(super) struct HairBuffers {
    style: StrandDetails,
    list: FineStrands,
    fine: FineBuffers,
    /// The strands of the last frame.
    portion: Option<(Portion, usize)>,
    drawn: StrandDetails,
    drawn_segments: GrowBuffer<u32>,
    extent: Option<StrandBounds>,
    interpolation: Interpolation,
    points: GrowBuffer<[f32; 4]>,
    details: GrowBuffer<u32>,
    /// See `PointColours::words`.
    colors: GrowBuffer<u32>,
    segments: GrowBuffer<u32>,
    transmittance: GrowBuffer<u32>,
    shaded: GrowBuffer<ShadedPoint>,
    staging: Vec<[f32; 4]>,
}

impl HairBuffers {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            style: StrandDetails::default(),
            list: FineStrands::default(),
            fine: FineBuffers::new(gpu)?,
            portion: None,
            drawn: StrandDetails::default(),
            drawn_segments: GrowBuffer::new(gpu, "segments of fine strands", storage),
            extent: None,
            interpolation: Interpolation::new(gpu)?,
            points: GrowBuffer::new(gpu, "strand points", storage),
            details: GrowBuffer::new(gpu, "strand details", storage),
            colors: GrowBuffer::new(gpu, "strand colours", storage),
            segments: GrowBuffer::new(gpu, "segments", storage),
            transmittance: GrowBuffer::new(gpu, "transmittance", storage),
            shaded: GrowBuffer::new(gpu, "shaded points", storage),
            staging: Vec::new(),
        })
    }

    /// Uploads the strands of one frame of an image `height` pixels high.
    ///
    /// # Errors
    /// The hairstyle needs a larger buffer than the device supports.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &FrameInput,
        height: u32,
    ) -> Result<(), GpuError> {
        self.write_stored(gpu, commands, input)?;
        self.list.follow(input.style, 0);
        let points = self.list.points_per_strand;
        let most = (gpu.most_storage_bytes() / size_of::<ShadedPoint>() as u64).min(MAX_POINTS);
        let target = TARGET_PIXELS[usize::from(gpu.is_software())];
        self.portion = portion_of(input, height, target, (points, most)).map(|portion| (portion, points));
        let Some((portion, _)) = self.portion else {
            if self.drawn.follow(input.style) {
                self.write_details(gpu);
            }
            return Ok(());
        };
        let longer = self.list.follow(input.style, portion.drawn);
        if self.drawn.follow_fine(input.style, &self.list, longer) {
            self.write_details(gpu);
            self.drawn_segments.write(gpu, &self.drawn.segments);
            self.fine.follow(gpu, input.style, &self.list);
        }
        let all = portion.drawn * points;
        self.transmittance.reserve(gpu, all);
        self.shaded.reserve(gpu, all);
        let reach = ShadowLook::of(input).reach;
        self.fine.run(gpu, commands, (portion.drawn, points), reach, self.points.raw());
        Ok(())
    }

    fn write_details(&mut self, gpu: &Gpu) {
        self.details.write(gpu, &self.drawn.words);
        if let Some(colours) = self.drawn.colours() {
            self.colors.write(gpu, &colours.words());
        }
    }

    /// Uploads or interpolates the stored strands.
    fn write_stored(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &FrameInput,
    ) -> Result<(), GpuError> {
        let points = input.style.strands.points();
        let needed = points as u64 * size_of::<ShadedPoint>() as u64;
        if needed > gpu.most_storage_bytes() {
            return Err(GpuError::Input(format!(
                "{points} strand points need a buffer of {needed} bytes, and {} takes at most {}: draw fewer strands, or \
                 on the CPU",
                gpu.info.name,
                gpu.most_storage_bytes()
            )));
        }
        if self.style.follow(input.style) {
            self.segments.write(gpu, &self.style.segments);
            self.extent = None;
        }
        self.points.reserve(gpu, points);
        self.transmittance.reserve(gpu, points);
        self.shaded.reserve(gpu, points);
        match input.hair {
            HairPose::Guides(guides) => {
                let guides = (guides, None);
                self.interpolation.run(gpu, commands, input.style, guides, self.points.raw())?;
            }
            HairPose::Resident(guides, there) => {
                let guides = (guides, Some(there));
                self.interpolation.run(gpu, commands, input.style, guides, self.points.raw())?;
            }
            HairPose::Strands(strands) => {
                strands
                    .x
                    .par_iter()
                    .zip(&strands.y)
                    .zip(&strands.z)
                    .map(|((&x, &y), &z)| [x, y, z, 0.0])
                    .collect_into_vec(&mut self.staging);
                // Strands and hairstyle should have the same size.
                self.staging.resize(points, [f32::NAN; 4]);
                self.points.write(gpu, &self.staging);
            }
        }
        Ok(())
    }

    /// Bounds of the strands along the axes of a light, relative to `anchor`, and the length of the longest strand. Both are upper
    /// bounds, not much larger than necessary.
    pub fn bounds(&mut self, input: &FrameInput, light: LightFrame, anchor: Vec3) -> (Bounds, f32) {
        let extent = self.extent.get_or_insert_with(|| StrandBounds::new(input.style));
        let bounds = match input.hair {
            HairPose::Strands(strands) => {
                let (strand_width, extinction_scale) = (0.0, 0.0);
                Bounds::of_strands(&ShadowInput {
                    strands,
                    strand_width,
                    extinction_scale,
                    light,
                    anchor,
                    maps: 1,
                    projected: None,
                })
            }
            HairPose::Guides(guides) | HairPose::Resident(guides, _) => {
                let found = extent.along(guides, [light.x, light.y, light.z], anchor);
                found.map_or(Bounds::EMPTY, |(min, max)| Bounds { min, max, ignored: 0 })
            }
        };
        (bounds, extent.longest_strand())
    }

    /// The part of the fine strands that is drawn, with the points of each; `None` for stored strands.
    pub fn portion(&self) -> Option<(Portion, usize)> {
        self.portion
    }

    /// One number per drawn point of `style`, that of the last frame, from one per stored strand.
    pub fn at_points(&self, style: &Hairstyle, of_strands: &[f32]) -> Vec<f32> {
        let fine = self.portion.map(|(portion, points)| {
            (&self.list.strands[..portion.drawn.min(self.list.strands.len())], points)
        });
        at_points(&style.strands, fine, of_strands)
    }

    /// The strands that are drawn.
    pub fn drawn(&self) -> GpuStrands<'_> {
        let Some((portion, points)) = self.portion else { return self.strands() };
        GpuStrands {
            points: self.fine.points(),
            point_count: (portion.drawn * points) as u32,
            segments: self.drawn_segments.raw(),
            segment_count: (portion.drawn * (points - 1)) as u32,
        }
    }

    /// The first points of the segments of [`HairBuffers::drawn`], in order, and some more.
    pub fn segment_list(&self) -> &Arc<Vec<u32>> {
        &self.drawn.segments
    }

    /// Makes room for shaded points behind those of the drawn strands. Returns the offset of their place, bytes.
    pub fn make_room(&mut self, gpu: &Gpu, points: usize) -> u64 {
        let own = self.drawn().point_count as usize;
        self.shaded.reserve(gpu, own + points);
        (own * size_of::<ShadedPoint>()) as u64
    }

    /// Bytes of the shaded points of the drawn strands.
    pub fn shaded_bytes(&self) -> u64 {
        u64::from(self.drawn().point_count) * size_of::<ShadedPoint>() as u64
    }

    /// The places at which the shadows of the drawn points are looked up.
    pub fn asked(&self) -> &wgpu::Buffer {
        if self.portion.is_some() { self.fine.asked() } else { self.points.raw() }
    }

    /// The stored strands, which cast shadows, as input of shadow methods.
    pub fn strands(&self) -> GpuStrands<'_> {
        GpuStrands {
            points: self.points.raw(),
            point_count: self.points.len() as u32,
            segments: self.segments.raw(),
            segment_count: self.segments.len() as u32,
        }
    }

    /// Memory in use, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let own = [&self.details, &self.colors, &self.segments, &self.transmittance]
            .map(|buffer| buffer.raw().size());
        let own = own.iter().sum::<u64>() + self.points.raw().size() + self.shaded.raw().size();
        own + self.drawn_segments.raw().size() + self.fine.bytes() + self.interpolation.bytes()
    }

    /// Four transmittances per point, written by shadow methods.
    pub fn transmittance(&self) -> &wgpu::Buffer {
        self.transmittance.raw()
    }

    /// Shaded points.
    pub fn shaded(&self) -> &wgpu::Buffer {
        self.shaded.raw()
    }

    /// Replaces the colours of shaded points by the transmittance of the first light.
    pub fn shade_values(&self, gpu: &Gpu, kernel: &Kernel, commands: &mut Commands, frame: &FrameResources) {
        self.run_over_points(gpu, kernel, "draw/values", commands, frame, []);
    }

    /// Projects and shades every point, in the pass `name`.
    ///
    /// # Errors
    /// The driver cannot compile a kernel.
    pub fn shade(
        &self,
        gpu: &Gpu,
        name: &'static str,
        shading: PointShading,
        commands: &mut Commands,
        frame: &FrameResources,
    ) -> Result<(), GpuError> {
        let kernel = shading.kernels.shade_points(gpu, shading.model, self.is_colored())?;
        self.light(gpu, kernel, name, shading, commands, (frame, []));
        Ok(())
    }

    /// Whether strands have colours of their own.
    pub fn is_colored(&self) -> bool {
        self.drawn.colours().is_some()
    }

    /// Runs a kernel that lights every point, with `more` bindings.
    pub fn light<'a, const N: usize>(
        &'a self,
        gpu: &Gpu,
        kernel: &Kernel,
        name: &'static str,
        shading: PointShading<'a>,
        commands: &mut Commands,
        (frame, more): (&FrameResources<'a>, [(u32, wgpu::BindingResource<'a>); N]),
    ) {
        let own = [(8, shading.tables.as_entire_binding()), (23, self.colors.raw().as_entire_binding())];
        self.run_over_points(gpu, kernel, name, commands, frame, own.into_iter().chain(more));
    }

    /// Runs a kernel of strand points over every point, with `more` bindings.
    pub fn run_over_points<'a>(
        &'a self,
        gpu: &Gpu,
        kernel: &Kernel,
        name: &'static str,
        commands: &mut Commands,
        frame: &FrameResources<'a>,
        more: impl IntoIterator<Item = (u32, wgpu::BindingResource<'a>)>,
    ) {
        let drawn = self.drawn();
        let points = u64::from(drawn.point_count);
        if points == 0 {
            return;
        }
        let own = [
            (4, drawn.points.as_entire_binding()),
            (5, self.details.raw().as_entire_binding()),
            (6, self.transmittance.raw().as_entire_binding()),
            (7, self.shaded.raw().as_entire_binding()),
        ];
        let mut all = frame.with(own);
        all.extend(more);
        let group = kernel.bind(gpu, &all);
        commands.compute(name, |pass| kernel.run(pass, &group, points));
    }
}
