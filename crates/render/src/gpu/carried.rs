//! Hair that the skin carries, on the GPU: shaded as strands of its own look into the place behind the points of the hairstyle.

use std::sync::{Arc, Weak};

use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, wgpu};
use lovelock_groom::Hairstyle;
use lovelock_shadow::{Bounds, ShadowInput};

use super::eye::Area;
use super::frame_resources::FrameResources;
use super::hair::{HairBuffers, PointShading};
use crate::uniform::FrameUniform;
use crate::{CarriedHair, FrameInput};

/// The carried hair of the last frame, if it had any.
#[derive(Debug)]
pub(super) struct CarriedBuffers {
    hair: Option<HairBuffers>,
    uniform: wgpu::Buffer,
    /// The segments of the hairstyle that are drawn, and those of the carried hair behind them.
    segments: GrowBuffer<u32>,
    joined: Option<Joined>,
    /// Where its shaded points are behind those of the hairstyle, bytes.
    offset: u64,
    strand_width: f32,
}

/// What the segments were joined from.
#[derive(Debug)]
struct Joined {
    of_hair: Weak<Vec<u32>>,
    hair_segments: u32,
    style: Weak<Hairstyle>,
    first_point: u32,
}

impl CarriedBuffers {
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            hair: None,
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame of carried hair"),
                size: size_of::<FrameUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            segments: GrowBuffer::new(gpu, "segments with carried hair", wgpu::BufferUsages::STORAGE),
            joined: None,
            offset: 0,
            strand_width: 0.0,
        }
    }

    /// Uploads the strands of `input`, that of the carried hair, for an image of this height, after those of the hairstyle. Without one,
    /// forgets those of the last frame.
    ///
    /// # Errors
    /// It needs a larger buffer than the device supports, or a shader does not compile.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        (input, height): (Option<&FrameInput>, u32),
        of_hair: &mut HairBuffers,
    ) -> Result<(), GpuError> {
        let Some(input) = input else {
            (self.hair, self.joined) = (None, None);
            return Ok(());
        };
        let mut own = match self.hair.take() {
            Some(kept) => kept,
            None => HairBuffers::new(gpu)?,
        };
        own.write(gpu, commands, input, height)?;
        self.offset = of_hair.make_room(gpu, own.drawn().point_count as usize);
        self.join(gpu, input, (of_hair, &own));
        self.hair = Some(own);
        Ok(())
    }

    /// Puts the segments of both into one buffer, if they have changed.
    fn join(&mut self, gpu: &Gpu, input: &FrameInput, (of_hair, own): (&HairBuffers, &HairBuffers)) {
        let strands = of_hair.drawn();
        let is_known = self.joined.as_ref().is_some_and(|joined| {
            joined.hair_segments == strands.segment_count
                && joined.first_point == strands.point_count
                && std::ptr::eq(joined.of_hair.as_ptr(), Arc::as_ptr(of_hair.segment_list()))
                && std::ptr::eq(joined.style.as_ptr(), Arc::as_ptr(input.style))
        });
        if is_known {
            return;
        }
        let hair_bytes = 4 * u64::from(strands.segment_count);
        let behind: Vec<u32> = own.segment_list().iter().map(|first| first + strands.point_count).collect();
        self.segments.reserve(gpu, strands.segment_count as usize + behind.len());
        // Not by a command, which a frame that fails would drop.
        gpu.upload(self.segments.raw(), 0, &of_hair.segment_list()[..strands.segment_count as usize]);
        gpu.upload(self.segments.raw(), hair_bytes, &behind);
        self.joined = Some(Joined {
            of_hair: Arc::downgrade(of_hair.segment_list()),
            hair_segments: strands.segment_count,
            style: Arc::downgrade(input.style),
            first_point: strands.point_count,
        });
    }

    /// Uploads the uniform with which it is shaded.
    pub fn write_uniform(&mut self, gpu: &Gpu, uniform: &FrameUniform) {
        gpu.upload(&self.uniform, 0, &[*uniform]);
        self.strand_width = uniform.strand_width;
    }

    /// Its buffers, if there is any.
    pub fn hair(&self) -> Option<&HairBuffers> {
        self.hair.as_ref()
    }

    /// The number of its points.
    pub fn points(&self) -> usize {
        self.hair.as_ref().map_or(0, |hair| hair.drawn().point_count as usize)
    }

    /// The segments of the hairstyle and of this hair with their number, if there is any.
    pub fn segments(&self) -> Option<(&wgpu::Buffer, u32)> {
        self.hair.as_ref().map(|_| (self.segments.raw(), self.segments.len() as u32))
    }

    /// Projects and shades every point, into the place behind the points of the hairstyle.
    ///
    /// # Errors
    /// The driver cannot compile a kernel.
    pub fn shade(
        &self,
        gpu: &Gpu,
        shading: PointShading,
        commands: &mut Commands,
        frame: &FrameResources,
        of_hair: &HairBuffers,
    ) -> Result<(), GpuError> {
        let Some(hair) = &self.hair else { return Ok(()) };
        let frame = FrameResources { uniform: &self.uniform, ..*frame };
        hair.shade(gpu, "draw/points", shading, commands, &frame)?;
        self.append(commands, hair, of_hair);
        Ok(())
    }

    /// As [`HairBuffers::shade_values`], behind the points of the hairstyle.
    pub fn shade_values(
        &self,
        gpu: &Gpu,
        kernel: &Kernel,
        commands: &mut Commands,
        frame: &FrameResources,
        of_hair: &HairBuffers,
    ) {
        let Some(hair) = &self.hair else { return };
        let frame = FrameResources { uniform: &self.uniform, ..*frame };
        hair.shade_values(gpu, kernel, commands, &frame);
        self.append(commands, hair, of_hair);
    }

    fn append(&self, commands: &mut Commands, hair: &HairBuffers, of_hair: &HairBuffers) {
        let bytes = Some(hair.shaded_bytes());
        commands.encoder().copy_buffer_to_buffer(hair.shaded(), 0, of_hair.shaded(), self.offset, bytes);
    }

    /// The area of an image of `input` that may contain it, and half of the largest width of a strand, pixels.
    pub fn area(&self, input: &FrameInput, size: [u32; 2], pixels_per_metre: f32) -> (Area, f32) {
        let (Some(_), Some(CarriedHair { strands, .. })) = (&self.hair, input.carried) else {
            return (Area::default(), 0.0);
        };
        let (light, anchor) = (Area::axes(input.camera), input.camera.eye);
        let bounds = Bounds::of_strands(&ShadowInput {
            strands,
            strand_width: 0.0,
            extinction_scale: 0.0,
            light,
            anchor,
            maps: 1,
            projected: None,
        });
        let area = Area::of(input.camera, size, (bounds.min, bounds.max), self.strand_width);
        // Nothing nearer than this is drawn.
        (area, 0.5 * self.strand_width * pixels_per_metre / bounds.min.x.max(0.02))
    }

    /// GPU memory in use, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.hair.as_ref().map_or(0, |hair| hair.memory_bytes() + self.segments.raw().size())
    }
}
