//! The maps of any method on the GPU, for lights of any kind.
//!
//! A kernel projects the strands onto each plane of a light that stands somewhere; then the method builds its map of them. Methods have
//! kernels of their own for projected strands, compiled for the first such light.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Gpu, GpuError, GrowBuffer, Kernel, ShaderPart, ShaderSource, wgpu};

use super::cube::SIDES;
use super::{Face, PARALLEL, Perspective};
use crate::gpu::{Buffer, fits_device, wgsl};
use crate::{
    GpuColumns, GpuList, GpuProjected, GpuShadow, GpuShadowError, GpuShadowInput, GpuStrands, GpuTargets,
    ProjectedTargets, ShadowMethod, ShadowReport, ShadowSettings, SharedList,
};

const PROJECT: ShaderPart = wgsl!("perspective/gpu/", "project.wgsl");
/// The name of the pass in statistics.
const PROJECT_PASS: &str = "shadow/project";

/// Makes the kernels of a method, for the strands themselves or for projected ones.
pub(crate) type MakeGpuShadow = fn(ShadowMethod, &Gpu, bool) -> Result<Box<dyn GpuShadow>, GpuError>;

/// Twin of `ProjectUniform` in project.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct ProjectUniform {
    anchor: Vec3,
    count: u32,
    axis: Vec3,
    plane: f32,
    across: Vec3,
    nearest: f32,
    more: Vec3,
    slope: f32,
    offset: Vec3,
    radius: f32,
}

impl ProjectUniform {
    fn new(face: &Face, count: u32) -> Self {
        let [axis, across, more] = face.axes;
        let Face { anchor, offset, plane, nearest, radius, slope, .. } = *face;
        Self { anchor, count, axis, plane, across, nearest, more, slope, offset, radius }
    }
}

/// A method on the GPU, for lights of any kind.
#[derive(Debug)]
pub(crate) struct GpuLightMaps {
    method: ShadowMethod,
    make: MakeGpuShadow,
    parallel: Box<dyn GpuShadow>,
    standing: Option<Box<Standing>>,
    /// Whether the light of each slot stands somewhere.
    stands: Vec<bool>,
}

/// The maps of lights that stand somewhere: six slots per light, of which a light with one plane uses the first.
#[derive(Debug)]
struct Standing {
    maps: Box<dyn GpuShadow>,
    segments: Kernel,
    points: Kernel,
    /// The strands as the last plane sees them.
    projected: Buffer,
    /// The first point of each of their segments.
    starts: GrowBuffer<u32>,
    planes: Vec<Option<Perspective>>,
}

impl GpuLightMaps {
    /// Compiles the kernels of a method; its maps are empty.
    ///
    /// # Errors
    /// A shader that does not compile, by file and line.
    pub fn new(gpu: &Gpu, method: ShadowMethod, make: MakeGpuShadow) -> Result<Self, GpuError> {
        Ok(Self { method, make, parallel: make(method, gpu, false)?, standing: None, stands: Vec::new() })
    }

    /// The shaders that no method has, with their labels.
    pub fn shaders() -> Vec<(String, ShaderSource)> {
        vec![(PROJECT_PASS.to_owned(), source())]
    }

    /// The maps of a slot whose light stands somewhere.
    fn of_mut(&mut self, slot: usize) -> Option<&mut Standing> {
        let stands = self.stands.get(slot).copied().unwrap_or(false);
        self.standing.as_deref_mut().filter(|_| stands)
    }

    /// The same, to be read.
    fn of(&self, slot: usize) -> Option<&Standing> {
        let stands = self.stands.get(slot).copied().unwrap_or(false);
        self.standing.as_deref().filter(|_| stands)
    }

    /// Notes the kind of the light of a slot, and frees the maps of a kind that no light has.
    fn note(&mut self, gpu: &Gpu, slot: usize, maps: u32, stands: bool) {
        self.stands.resize(maps.max(1).max(slot as u32 + 1) as usize, stands);
        self.stands[slot] = stands;
        if self.stands.iter().all(|stands| !stands) {
            self.standing = None;
        }
        if stands && self.stands.iter().all(|stands| *stands) {
            self.parallel.forget(gpu);
        }
    }
}

fn source() -> ShaderSource {
    ShaderSource::new(&[PROJECT])
}

impl Standing {
    fn new(gpu: &Gpu, method: ShadowMethod, make: MakeGpuShadow) -> Result<Self, GpuError> {
        let kernel = |entry| Kernel::new(gpu, PROJECT_PASS, &source(), entry);
        Ok(Self {
            maps: make(method, gpu, true)?,
            segments: kernel("project_segments")?,
            points: kernel("project_points")?,
            projected: Buffer::new(gpu, "projected strands"),
            starts: GrowBuffer::new(gpu, "projected segments", wgpu::BufferUsages::STORAGE),
            planes: Vec::new(),
        })
    }

    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        (input, perspective): (&GpuShadowInput, Perspective),
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let only_points = settings.counts_points();
        let GpuStrands { point_count, segment_count, .. } = input.strands;
        let (count, points) =
            if only_points { (point_count, point_count) } else { (segment_count, 2 * segment_count) };
        fits_device(gpu, settings.method, 16 * u64::from(points))?;
        self.projected.fit(gpu, 4 * u64::from(points));
        if self.starts.len() != segment_count as usize {
            let starts: Vec<u32> = (0..segment_count).map(|segment| 2 * segment).collect();
            self.starts.write(gpu, &starts);
        }
        self.planes.resize(input.maps.max(1).max(slot as u32 + 1) as usize, None);
        self.planes[slot] = None;
        let faces = perspective.faces().len() as u32;
        // As before: the list of a light with six planes has the share of one.
        let lists = input.shared_list.map_or(1, |list| list.maps);
        let settings = &if faces > 1 { settings.for_sides() } else { *settings };
        let mut list_of = input.shared_list.and_then(|list| self.planes(list.of).next()).map(|(_, at, _)| at);
        for (side, face) in perspective.faces().iter().enumerate() {
            let Some(face) = face else { continue };
            let at = SIDES * slot + side;
            let uniform = commands.constants("projection", &ProjectUniform::new(face, count));
            let kernel = if only_points { &self.points } else { &self.segments };
            let resources = [
                (0, uniform.as_entire_binding()),
                (1, input.strands.points.as_entire_binding()),
                (2, input.strands.segments.as_entire_binding()),
                (3, self.projected.raw().as_entire_binding()),
            ];
            let group = kernel.bind(gpu, &resources);
            commands.compute(PROJECT_PASS, |pass| kernel.run(pass, &group, u64::from(count)));
            let projected = GpuProjected {
                plane: face.plane,
                start: face.offset.length(),
                slots: SIDES as u32 * input.maps.max(1),
            };
            let from = GpuShadowInput {
                strands: GpuStrands {
                    points: self.projected.raw(),
                    point_count: points,
                    segments: self.starts.raw(),
                    segment_count,
                },
                bounds: face.bounds,
                light: PARALLEL,
                anchor: Vec3::ZERO,
                maps: input.maps.max(1).saturating_mul(faces),
                shared_list: Some(SharedList { of: *list_of.get_or_insert(at), maps: lists }),
                projected: Some(projected),
                ..*input
            };
            self.maps.build(at, gpu, commands, &from, settings)?;
        }
        self.planes[slot] = Some(perspective);
        Ok(())
    }

    /// The planes of a slot that see hair, with their slots.
    fn planes(&self, slot: usize) -> impl Iterator<Item = (usize, usize, &Face)> {
        let perspective = self.planes.get(slot).and_then(Option::as_ref);
        let faces = perspective.map_or(&[][..], Perspective::faces).iter().enumerate();
        faces.filter_map(move |(side, face)| Some((side, SIDES * slot + side, face.as_ref()?)))
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let Some(Some(perspective)) = self.planes.get(slot) else { return };
        let (axes, anchor, offset) = (perspective.axes, perspective.anchor, perspective.offset);
        let sides = perspective.faces().len() as u32;
        let without = perspective.faces().iter().enumerate().filter(|(_, face)| face.is_none());
        let mut lit = without.fold(0, |bits, (side, _)| bits | 1_u32 << side);
        let planes: Vec<_> = self.planes(slot).map(|(side, at, face)| (side, at, face.plane)).collect();
        for (side, at, plane) in planes {
            let projected = ProjectedTargets {
                anchor,
                axes,
                offset,
                plane,
                sides,
                side: side as u32,
                lit,
                slot: targets.byte.unwrap_or(slot as u32),
            };
            self.maps.look_up(at, gpu, commands, &GpuTargets { projected: Some(&projected), ..*targets });
            // Points of planes without hair are written once.
            lit = 0;
        }
    }
}

impl GpuShadow for GpuLightMaps {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        let perspective = Perspective::new(&input.light, input.anchor, &input.bounds, settings.face_margin());
        self.note(gpu, slot, input.maps, perspective.is_some());
        let Some(perspective) = perspective else {
            return self.parallel.build(slot, gpu, commands, input, settings);
        };
        let standing = match &mut self.standing {
            Some(standing) => standing,
            none => none.insert(Box::new(Standing::new(gpu, self.method, self.make)?)),
        };
        standing.build(slot, gpu, commands, (input, perspective), settings)
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        match self.of_mut(slot) {
            Some(standing) => standing.look_up(slot, gpu, commands, targets),
            None => self.parallel.look_up(slot, gpu, commands, targets),
        }
    }

    fn columns_size(&self, slot: usize) -> u32 {
        match self.of(slot) {
            Some(standing) => {
                standing.planes(slot).map(|(_, at, _)| standing.maps.columns_size(at)).max().unwrap_or(0)
            }
            None => self.parallel.columns_size(slot),
        }
    }

    fn column_sides(&self, slot: usize) -> usize {
        let planes = |standing: &Standing| standing.planes.get(slot)?.as_ref().map(|p| p.faces().len());
        self.of(slot).map_or(1, |standing| planes(standing).unwrap_or(1))
    }

    fn columns(
        &mut self,
        (slot, side): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let Some(standing) = self.of_mut(slot) else {
            return self.parallel.columns((slot, side), gpu, commands, into);
        };
        let (_, at, face) = standing.planes(slot).find(|(at, _, _)| *at == side)?;
        let face = *face;
        let columns = standing.maps.columns((at, 0), gpu, commands, into)?;
        Some(GpuColumns { uv_from_world: face.uv_from_world(columns.uv_from_world), ..columns })
    }

    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        let Some(standing) = self.of(slot) else { return self.parallel.list(slot) };
        // All planes of a light share the list of the first one.
        let (_, at, _) = standing.planes(slot).next()?;
        standing.maps.list(at)
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        let of_parallel: Vec<_> =
            (0..heads.len()).map(|slot| if self.of(slot).is_some() { [0; 2] } else { heads[slot] }).collect();
        let mut again = self.parallel.settle(gpu, &of_parallel)?;
        if let Some(standing) = self.standing.as_deref_mut() {
            let mut of_planes = vec![[0; 2]; SIDES * heads.len()];
            for (slot, head) in heads.iter().enumerate() {
                if let Some((_, at, _)) = standing.planes(slot).next() {
                    of_planes[at] = *head;
                }
            }
            again |= standing.maps.settle(gpu, &of_planes)?;
        }
        Ok(again)
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.parallel.forget(gpu);
        self.standing = None;
        self.stands.clear();
    }

    fn report(&self, slot: usize) -> ShadowReport {
        let Some(standing) = self.of(slot) else { return self.parallel.report(slot) };
        let own = standing.projected.bytes() + 4 * standing.starts.len() as u64;
        let reports = standing.planes(slot).map(|(_, at, _)| standing.maps.report(at));
        let sum = reports.fold(ShadowReport::default(), ShadowReport::joined);
        ShadowReport { scratch_bytes: sum.scratch_bytes + own, ..sum }
    }

    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(standing) = self.of(slot) else { return self.parallel.map_words(slot, gpu) };
        let words = standing.planes(slot).map(|(_, at, _)| standing.maps.map_words(at, gpu));
        Ok(words.collect::<Result<Vec<_>, _>>()?.concat())
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use crate::perspective::MAX_WIDENING;
    use lovelock_gpu::layout_in_shader;

    #[test]
    fn the_uniform_has_the_layout_of_the_shader() {
        let expected = [
            offset_of!(ProjectUniform, anchor),
            offset_of!(ProjectUniform, count),
            offset_of!(ProjectUniform, axis),
            offset_of!(ProjectUniform, plane),
            offset_of!(ProjectUniform, across),
            offset_of!(ProjectUniform, nearest),
            offset_of!(ProjectUniform, more),
            offset_of!(ProjectUniform, slope),
            offset_of!(ProjectUniform, offset),
            offset_of!(ProjectUniform, radius),
            size_of::<ProjectUniform>(),
        ];
        assert_eq!(layout_in_shader(&source(), "ProjectUniform"), expected);
    }

    #[test]
    fn the_widest_strand_is_that_of_the_cpu() {
        let line = format!("const MAX_WIDENING: f32 = {MAX_WIDENING:.1};");
        assert!(crate::gpu::RAY.text.contains(&line), "{line}");
    }
}
