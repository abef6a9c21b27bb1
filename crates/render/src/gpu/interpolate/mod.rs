//! Interpolation of strands from guides on the GPU: a frame uploads guides, not strands.
//!
//! The result agrees with [`lovelock_groom::interpolate`]. One kernel transports the moving frame of each wisp along its guides, one
//! thread per wisp; the other places the strands, one thread per point. Constant data is uploaded once per hairstyle.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat4, Vec4};
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, ShaderPart, ShaderSource, wgpu};
use lovelock_groom::{GuideFrame, Hairstyle, WispCurve};

use crate::ResidentGuides;
use crate::resident::Before;

const FRAMES: ShaderPart =
    ShaderPart { name: "crates/render/src/gpu/interpolate/frames.wgsl", text: include_str!("frames.wgsl") };
const STRANDS: ShaderPart =
    ShaderPart { name: "crates/render/src/gpu/interpolate/strands.wgsl", text: include_str!("strands.wgsl") };

const MIX: ShaderPart =
    ShaderPart { name: "crates/render/src/gpu/interpolate/mix.wgsl", text: include_str!("mix.wgsl") };

/// Twin of `Mix` in mix.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Mix {
    heads: [Mat4; 3],
    t: f32,
    points_per_guide: u32,
    guide_points: u32,
    unused: u32,
}

/// Twin of `Instant` in frames.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Instant {
    turn: [Vec4; 3],
    guide_points: u32,
    points_per_guide: u32,
    wisps: u32,
    strand_points: u32,
}

/// Twin of `Wisp` in frames.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Wisp {
    guides: [u32; 4],
    tangent: Vec4,
    normal: Vec4,
}

/// Twin of `Strand` in strands.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Strand {
    weights: [f32; 3],
    wisp: u32,
}

/// Twin of `CurvePoint` in frames.wgsl; never read on the CPU.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct CurvePoint([f32; 16]);

/// The composed shaders with their labels.
pub(in crate::gpu) fn shaders() -> Vec<(String, ShaderSource)> {
    vec![
        ("interpolate".to_owned(), ShaderSource::new(&[FRAMES, STRANDS])),
        ("mix guides".to_owned(), ShaderSource::new(&[MIX])),
    ]
}

/// The kernels, and the data of the current hairstyle.
#[derive(Debug)]
pub(in crate::gpu) struct Interpolation {
    carry_frames: Kernel,
    place_points: Kernel,
    mix_guides: Kernel,
    style: Option<Arc<Hairstyle>>,
    instant: wgpu::Buffer,
    guides: GrowBuffer<f32>,
    wisps: GrowBuffer<Wisp>,
    widest: GrowBuffer<f32>,
    curves: GrowBuffer<CurvePoint>,
    strands: GrowBuffer<Strand>,
    strand_of: GrowBuffer<u32>,
    places: GrowBuffer<Vec4>,
}

impl Interpolation {
    /// Compiles the kernels; there is no hairstyle yet.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let source = ShaderSource::new(&[FRAMES, STRANDS]);
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(Self {
            // Guides on the device are in several buffers in turn.
            carry_frames: Kernel::new(gpu, "carry frames", &source, "carry_frames")?.keeping(8),
            place_points: Kernel::new(gpu, "place points", &source, "place_points")?.keeping(8),
            mix_guides: Kernel::new(gpu, "mix guides", &ShaderSource::new(&[MIX]), "mix_guides")?.keeping(8),
            style: None,
            instant: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("instant of guides"),
                size: size_of::<Instant>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            guides: GrowBuffer::new(gpu, "guides", storage),
            wisps: GrowBuffer::new(gpu, "wisps", storage),
            widest: GrowBuffer::new(gpu, "widest radii of wisps", storage),
            curves: GrowBuffer::new(gpu, "curves of wisps", storage),
            strands: GrowBuffer::new(gpu, "strands", storage),
            strand_of: GrowBuffer::new(gpu, "strand of point", storage),
            places: GrowBuffer::new(gpu, "places along guides", storage),
        })
    }

    /// Encodes writing every strand point of `style` (world space, metres) into `points`: an `array<vec4f>` whose last components become
    /// 0. Guides that `gpu` has are taken from there. Others are written to the queue immediately, so there may be one frame per
    /// submission.
    ///
    /// Encodes nothing for a hairstyle without strands.
    ///
    /// # Errors
    /// The guides do not match the hairstyle; the hairstyle is inconsistent or needs a larger buffer than the device supports; or
    /// `points` is too small.
    pub fn run(
        &mut self,
        gpu: &Gpu,
        commands: &mut Commands,
        style: &Arc<Hairstyle>,
        (frame, there): (&GuideFrame, Option<&ResidentGuides>),
        points: &wgpu::Buffer,
    ) -> Result<(), GpuError> {
        let count = style.strands.points();
        if count == 0 {
            return Ok(());
        }
        self.follow(gpu, style)?;
        check_guides(style, frame)?;
        let needed = count as u64 * size_of::<Vec4>() as u64;
        if points.size() < needed {
            return Err(GpuError::Input(format!(
                "the buffer of the strands has {} bytes; they need {needed}",
                points.size()
            )));
        }

        let guides = &frame.guides;
        let there = there.filter(|there| there.is_on(gpu, guides.x.len()));
        match there {
            None => {
                let bytes_of_axis = size_of_val(guides.x.as_slice()) as u64;
                self.guides.reserve(gpu, 3 * guides.x.len());
                for (offset, axis) in (0..).zip([&guides.x, &guides.y, &guides.z]) {
                    gpu.upload(self.guides.raw(), offset * bytes_of_axis, axis);
                }
            }
            Some(ResidentGuides { before: None, .. }) => {}
            Some(ResidentGuides { now, before: Some(before) }) => {
                self.guides.reserve(gpu, 3 * guides.x.len());
                self.mix(gpu, commands, frame, (before, now.raw()));
            }
        }
        let of_step = there.filter(|there| there.before.is_none());
        let guide_points = of_step.map_or(self.guides.raw(), |there| there.now.raw());
        let turn = frame.world_from_head.matrix3;
        let instant = Instant {
            turn: [turn.x_axis, turn.y_axis, turn.z_axis].map(|column| column.extend(0.0)),
            // Each fits, because its buffer fits a binding.
            guide_points: guides.x.len() as u32,
            points_per_guide: guides.points_per_guide as u32,
            wisps: style.wisps.len() as u32,
            strand_points: count as u32,
        };
        gpu.upload(&self.instant, 0, &[instant]);

        let resources = [
            (0, self.instant.as_entire_binding()),
            (1, guide_points.as_entire_binding()),
            (2, self.wisps.raw().as_entire_binding()),
            (3, self.curves.raw().as_entire_binding()),
            (4, self.strands.raw().as_entire_binding()),
            (5, self.strand_of.raw().as_entire_binding()),
            (6, self.places.raw().as_entire_binding()),
            (7, points.as_entire_binding()),
            (8, self.widest.raw().as_entire_binding()),
        ];
        let carry = self.carry_frames.bind(gpu, &resources);
        let place = self.place_points.bind(gpu, &resources);
        commands.compute("interpolate", |pass| {
            self.carry_frames.run(pass, &carry, style.wisps.len() as u64);
            self.place_points.run(pass, &place, count as u64);
        });
        Ok(())
    }

    /// Encodes writing the guides between two steps.
    fn mix(
        &self,
        gpu: &Gpu,
        commands: &mut Commands,
        frame: &GuideFrame,
        (before, now): (&Before, &wgpu::Buffer),
    ) {
        let [from, to] = before.heads;
        let mix = Mix {
            heads: [from, to, frame.world_from_head].map(rigid),
            t: before.t,
            points_per_guide: frame.guides.points_per_guide as u32,
            guide_points: frame.guides.x.len() as u32,
            unused: 0,
        };
        let uniform = commands.constants("mix", &mix);
        let resources = [
            (0, uniform.as_entire_binding()),
            (1, before.guides.raw().as_entire_binding()),
            (2, now.as_entire_binding()),
            (3, self.guides.raw().as_entire_binding()),
        ];
        let bound = self.mix_guides.bind(gpu, &resources);
        commands.compute("interpolate", |pass| {
            self.mix_guides.run(pass, &bound, frame.guides.count() as u64);
        });
    }

    /// GPU memory in use, bytes.
    pub fn bytes(&self) -> u64 {
        let buffers = [
            self.guides.raw(),
            self.wisps.raw(),
            self.widest.raw(),
            self.curves.raw(),
            self.strands.raw(),
            self.strand_of.raw(),
            self.places.raw(),
        ];
        self.instant.size() + buffers.iter().map(|buffer| buffer.size()).sum::<u64>()
    }

    /// Uploads the data of the hairstyle if it has changed.
    fn follow(&mut self, gpu: &Gpu, style: &Arc<Hairstyle>) -> Result<(), GpuError> {
        if self.style.as_ref().is_some_and(|old| Arc::ptr_eq(old, style)) {
            return Ok(());
        }
        style.check().map_err(|error| GpuError::Input(format!("the hairstyle: {error}")))?;
        let set = &style.strands;
        let curve_points = style.wisps.len() * style.guides.points_per_guide;
        fits(gpu, "guides", 3 * style.guides.x.len(), size_of::<f32>())?;
        fits(gpu, "wisps", style.wisps.len(), size_of::<Wisp>())?;
        fits(gpu, "curves of the wisps", curve_points, size_of::<CurvePoint>())?;
        fits(gpu, "strands", set.count(), size_of::<Strand>())?;
        fits(gpu, "strand points", set.points(), size_of::<Vec4>())?;

        let wisps: Vec<_> = style.wisps.iter().map(|wisp| root_of(style, wisp)).collect();
        let strands = set.weights.iter().zip(&set.wisp);
        let strands: Vec<_> = strands.map(|(&weights, &wisp)| Strand { weights, wisp }).collect();
        let strand_of: Vec<u32> = (0..)
            .zip(set.first_point.windows(2))
            .flat_map(|(strand, ends)| (ends[0]..ends[1]).map(move |_| strand))
            .collect();
        let links = (style.guides.points_per_guide - 1) as f32;
        let places: Vec<_> = (0..set.points())
            .map(|i| {
                // Clamped to the guides, and 0 for NaN: shaders may differ on NaN.
                let along = set.guide_param[i].max(0.0).min(links);
                Vec4::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i], along)
            })
            .collect();
        self.style = None;
        if style.widest.is_empty() {
            self.widest.write(gpu, &vec![f32::MAX; style.guides.x.len()]);
        } else {
            self.widest.write(gpu, &style.widest);
        }
        self.wisps.write(gpu, &wisps);
        self.curves.reserve(gpu, curve_points);
        self.strands.write(gpu, &strands);
        self.strand_of.write(gpu, &strand_of);
        self.places.write(gpu, &places);
        self.style = Some(Arc::clone(style));
        Ok(())
    }
}

/// A transform of the head without scale.
fn rigid(head: Affine3A) -> Mat4 {
    let turn = glam::Quat::from_mat3a(&head.matrix3).normalize();
    Mat4::from_rotation_translation(turn, head.translation.into())
}

/// The guides of a wisp and its frame at the root, in the rest pose.
fn root_of(style: &Hairstyle, wisp: &lovelock_groom::Wisp) -> Wisp {
    let [normal, _, tangent] = WispCurve::root_frame(&style.guides, wisp);
    let [a, b, c] = wisp.guides;
    Wisp { guides: [a, b, c, 0], tangent: tangent.extend(0.0), normal: normal.extend(0.0) }
}

/// Returns an error for guides that the hairstyle does not have.
fn check_guides(style: &Hairstyle, frame: &GuideFrame) -> Result<(), GpuError> {
    let (wanted, found) = (&style.guides, &frame.guides);
    let lengths = [&found.x, &found.y, &found.z].map(Vec::len);
    if found.points_per_guide == wanted.points_per_guide && lengths == [wanted.x.len(); 3] {
        return Ok(());
    }
    Err(GpuError::Input(format!(
        "found {} guides of {} points, but the hairstyle has {} guides of {} points",
        found.count(),
        found.points_per_guide,
        wanted.count(),
        wanted.points_per_guide
    )))
}

/// Returns an error for data that does not fit one binding.
fn fits(gpu: &Gpu, what: &str, count: usize, bytes_each: usize) -> Result<(), GpuError> {
    let (needed, limit) = (count as u64 * bytes_each as u64, gpu.most_storage_bytes());
    if needed > limit || u32::try_from(count).is_err() {
        return Err(GpuError::Input(format!(
            "the {what} of this hairstyle need {needed} bytes in one buffer; the device gives {limit}"
        )));
    }
    Ok(())
}
