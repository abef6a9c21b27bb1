//! Maps with a record per light texel on the GPU.
//!
//! Compute kernels rasterise strands with integer atomics, one thread per segment, so that results do not depend on the order of
//! threads. Each pass over the segments is lines.wgsl with its own `put`; each pass over the texels is `each_texel.wgsl` with its
//! own `texel_pass`. A method is a list of passes and a query.

pub(crate) mod curve;
mod kernels;
pub(crate) mod list;
#[cfg(test)]
mod tests;

use std::fmt::Debug;
use std::marker::PhantomData;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lovelock_gpu::{Commands, Constant, Gpu, GpuError, Kernel, ShaderPart, ShaderSource, read_buffer, wgpu};

use self::kernels::KernelSets;
use self::list::{List, Share};
use super::gaussian::line_deviation;
use super::{LineProfile, MapScale, TexelFilter, TexelFrame, TexelMethod};
use crate::cpu::safe_extinction;
use crate::gpu::{
    Buffer, EXP, GpuColumns, GpuList, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup,
    RAY, fits_device, projected_constant, wgsl,
};
use crate::methods::texels::map::depth_per_texel;
use crate::{ShadowError, ShadowReport, ShadowSettings};

/// The placement of texels.
pub(crate) const FRAME: ShaderPart = wgsl!("methods/texels/gpu/", "frame.wgsl");
/// The buffers that passes write.
pub(crate) const BUILD: ShaderPart = wgsl!("methods/texels/gpu/", "build.wgsl");
/// Lines one texel wide.
pub(crate) const THIN_STEP: ShaderPart = wgsl!("methods/texels/gpu/", "thin_step.wgsl");
const FILTERED_STEP: ShaderPart = wgsl!("methods/texels/gpu/", "filtered_step.wgsl");
/// Calls `put` for every fragment.
pub(crate) const LINES: ShaderPart = wgsl!("methods/texels/gpu/", "lines.wgsl");
/// Calls `texel_pass` for every texel.
pub(crate) const EACH_TEXEL: ShaderPart = wgsl!("methods/texels/gpu/", "each_texel.wgsl");
/// Reads the texels around a point by `depth_before`.
pub(crate) const LOOKUP: ShaderPart = wgsl!("methods/texels/gpu/", "lookup.wgsl");
/// The depth range of each texel, the first pass of several methods.
pub(crate) const RANGE: ShaderPart = wgsl!("methods/texels/gpu/", "range.wgsl");
/// Reads the result of [`RANGE`].
pub(crate) const RANGE_READ: ShaderPart = wgsl!("methods/texels/gpu/", "range_read.wgsl");
/// Sine and cosine; see [`super::turn`].
pub(crate) const TURN: ShaderPart = wgsl!("methods/texels/gpu/", "turn.wgsl");
/// What methods share whose record is one function; see [`super::whole`].
pub(crate) const WHOLE: ShaderPart = wgsl!("methods/texels/gpu/", "whole.wgsl");
/// How such records are built of the result of [`RANGE`].
pub(crate) const WHOLE_BUILD: [ShaderPart; 2] =
    [RANGE_READ, wgsl!("methods/texels/gpu/", "whole_build.wgsl")];
/// Counts records in [`ShadowReport::fallbacks`], behind the records of all texels.
pub(crate) const FALLBACKS: ShaderPart = wgsl!("methods/texels/gpu/", "fallbacks.wgsl");
/// Words of scratch memory per texel that [`RANGE`] uses, at the start of the buffer.
pub(crate) const RANGE_WORDS: u64 = 4;

/// Words of the head that comes back with a frame, as those of a list; see [`GpuList`].
const HEAD_WORDS: u64 = 4;

/// The most layers of deep opacity maps.
const MAX_LAYERS: usize = 16;

/// Twin of `TexelUniform` in frame.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TexelUniform {
    anchor: Vec3,
    optical_depth: f32,
    column: Vec3,
    first_column: f32,
    row: Vec3,
    first_row: f32,
    depth: Vec3,
    first_depth: f32,
    edge: u32,
    segments: u32,
    count: u32,
    parts: u32,
    seeds: u32,
    merged: u32,
    prefiltered: u32,
    line_deviation: f32,
    plane: f32,
    start: f32,
    slope: f32,
    most: f32,
    tolerance: f32,
    bias: f32,
    overestimation: f32,
    unused: u32,
    starts: [f32; MAX_LAYERS],
    per_depth: [f32; MAX_LAYERS],
}

/// What the threads of a pass iterate over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    /// Every segment: the part defines `put`.
    Segments,
    /// Every segment, with the profile of [`TexelMethod::profile`]: the part defines `put`.
    FilteredSegments,
    /// Every texel: the part defines `texel_pass`.
    Texels,
    /// Every texel, by cooperating workgroups: the part defines the entry point `each_group`.
    Groups,
}

/// One pass of a method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    /// Its name in statistics, `shadow/…`.
    pub name: &'static str,
    pub over: Over,
    pub parts: &'static [ShaderPart],
}

impl Pass {
    fn source(&self) -> ShaderSource {
        let last = match self.over {
            Over::Segments => &[THIN_STEP, RAY, LINES][..],
            Over::FilteredSegments => &[FILTERED_STEP, RAY, LINES],
            Over::Texels => &[EACH_TEXEL],
            Over::Groups => &[],
        };
        let parts: Vec<_> = [EXP, FRAME, BUILD].iter().chain(self.parts).chain(last).copied().collect();
        ShaderSource::new(&parts)
    }

    fn kernel(&self, gpu: &Gpu, constants: &[Constant]) -> Result<Kernel, GpuError> {
        let entry = match self.over {
            Over::Segments | Over::FilteredSegments => "draw",
            Over::Texels => "each_texel",
            Over::Groups => "each_group",
        };
        Kernel::specialised(gpu, self.name, &self.source(), entry, constants)
    }
}

/// The 32-bit words that a method needs per texel, and the settings that its shaders read.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Words of the map per texel.
    pub map_words: u64,
    /// Words of scratch memory per texel.
    pub scratch_words: u64,
    /// Slices, layers or clusters of a texel.
    pub parts: u32,
    /// See `TexelUniform` in frame.wgsl.
    pub seeds: u32,
    /// See `seeds`.
    pub merged: u32,
    /// See `seeds`.
    pub slope: f32,
    /// See `seeds`.
    pub most: f32,
    /// See `seeds`.
    pub tolerance: f32,
    /// See `seeds`.
    pub bias: f32,
    /// See `seeds`.
    pub overestimation: f32,
    /// See `seeds`.
    pub starts: [f32; MAX_LAYERS],
    /// See `seeds`.
    pub per_depth: [f32; MAX_LAYERS],
}

/// The GPU's part of a method with a record per texel.
pub(crate) trait GpuTexelMethod: TexelMethod {
    /// All passes. [`GpuTexelMethod::schedule`] refers to them by index.
    const PASSES: &'static [Pass];
    /// The part that defines `depth_before`.
    const QUERY: &'static [ShaderPart];
    /// Whether its passes put fragments into a [`List`] at binding 5.
    const LISTS: bool = false;
    /// Whether [`FALLBACKS`] is a part of its passes.
    const COUNTS_FALLBACKS: bool = false;
    /// Whether only the build needs the list.
    const LIST_IS_SCRATCH: bool = false;

    fn needs(&self) -> Needs;

    /// The method's own constants of its shaders: settings with few values, because kernels are compiled for each combination.
    fn constants(&self) -> Vec<Constant> {
        Vec::new()
    }

    /// The passes to run, as indices into [`GpuTexelMethod::PASSES`]; a pass may run more than once.
    fn schedule(&self) -> Vec<usize> {
        (0..Self::PASSES.len()).collect()
    }
}

/// The value of `FILTER` in shaders.
pub(crate) fn filter_constant(filter: TexelFilter) -> Constant {
    let filter = match filter {
        TexelFilter::Nearest => 0,
        TexelFilter::Bilinear => 1,
        TexelFilter::Jitter => 2,
    };
    ("FILTER", f64::from(filter))
}

/// Words of the map of `M` per texel.
pub(crate) fn map_words<M: GpuTexelMethod>(settings: &ShadowSettings) -> u64 {
    M::new(settings).needs().map_words
}

/// A method with a record per texel on the GPU.
#[derive(Debug)]
pub(crate) struct TexelShadow<M: GpuTexelMethod> {
    kernels: KernelSets,
    /// Whether strands are projected.
    projected: bool,
    scratch: Buffer,
    maps: Vec<Map>,
    _method: PhantomData<M>,
}

/// The map of one light.
#[derive(Debug)]
struct Map {
    uniform: wgpu::Buffer,
    words: Buffer,
    list: Option<List>,
    /// The slot of the map whose list this one uses.
    list_of: usize,
    /// Words that the last build used.
    used: u64,
    frame: Option<TexelFrame>,
    report: ShadowReport,
}

impl<M: GpuTexelMethod> TexelShadow<M> {
    /// For the strands themselves, or for projected ones.
    pub(crate) fn new(gpu: &Gpu, projected: bool) -> Result<Self, GpuError> {
        Ok(Self {
            kernels: KernelSets::new(
                gpu,
                M::PASSES,
                &Self::query(),
                Self::constants(&M::new(&ShadowSettings::default()), projected),
            )?,
            projected,
            scratch: Buffer::new(gpu, "shadow scratch"),
            maps: Vec::new(),
            _method: PhantomData,
        })
    }

    /// Every composed shader with its label.
    pub(crate) fn shaders() -> Vec<(String, ShaderSource)> {
        let passes = M::PASSES.iter().map(|pass| (pass.name.to_owned(), pass.source()));
        passes.chain(PointLookup::shaders(&Self::query(), true)).collect()
    }

    /// The constants of all shaders.
    fn constants(method: &M, projected: bool) -> Vec<Constant> {
        let own = [filter_constant(method.filter()), projected_constant(projected)];
        own.into_iter().chain(method.constants()).collect()
    }

    fn query() -> Vec<ShaderPart> {
        [FRAME, LOOKUP].iter().chain(M::QUERY).copied().collect()
    }

    fn map(&mut self, gpu: &Gpu, slot: usize) -> &mut Map {
        while self.maps.len() <= slot {
            self.maps.push(Map::new(gpu, self.maps.len(), M::LISTS));
        }
        &mut self.maps[slot]
    }

    /// The bindings of a query.
    fn resources<'a>(&'a self, map: &'a Map) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        let list = self.maps.get(map.list_of).and_then(|map| map.list.as_ref());
        let list = list.map(|list| (5, list.raw().as_entire_binding()));
        let own = [(0, map.uniform.as_entire_binding()), (3, map.words.raw().as_entire_binding())];
        own.into_iter().chain(list).collect()
    }
}

impl Map {
    /// An empty map: everything is lit.
    fn new(gpu: &Gpu, slot: usize, lists: bool) -> Self {
        Self {
            uniform: gpu.create_buffer(&wgpu::BufferDescriptor {
                label: Some("texels"),
                size: size_of::<TexelUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            words: Buffer::new(gpu, "shadow map"),
            list: lists.then(|| List::new(gpu)),
            list_of: slot,
            used: 0,
            frame: None,
            report: ShadowReport::default(),
        }
    }
}

impl Map {
    /// Writes the memory of the map and of its builds into the report.
    fn count_memory(&mut self, scratch: u64, has_list: bool, list_is_scratch: bool) {
        let list = self.list.as_ref().filter(|_| has_list).map_or(0, List::memory_bytes);
        let (kept, of_build) = if list_is_scratch { (0, list) } else { (list, 0) };
        self.report.memory_bytes = self.words.bytes() + kept;
        self.report.scratch_bytes = scratch + of_build;
    }
}

impl TexelUniform {
    pub(crate) fn new(
        frame: &TexelFrame,
        input: &GpuShadowInput,
        profile: LineProfile,
        needs: &Needs,
    ) -> Self {
        let axes = frame.axes();
        let (prefiltered, line_deviation) = match profile {
            LineProfile::Thin => (0, 0.0),
            LineProfile::TwoTexels => (1, 0.0),
            LineProfile::Gaussian(width) => (2, line_deviation(width, input.strand_width, frame)),
        };
        Self {
            anchor: axes.anchor,
            optical_depth: depth_per_texel(input.extinction_scale, input.strand_width, frame),
            column: axes.column,
            first_column: axes.offset.x,
            row: axes.row,
            first_row: axes.offset.y,
            depth: axes.depth,
            first_depth: axes.offset.z,
            edge: frame.resolution,
            segments: input.strands.segment_count,
            count: frame.resolution * frame.resolution,
            parts: needs.parts,
            seeds: needs.seeds,
            merged: needs.merged,
            prefiltered,
            line_deviation,
            plane: input.projected.map_or(0.0, |projected| projected.plane),
            start: input.projected.map_or(0.0, |projected| projected.start),
            slope: needs.slope,
            most: needs.most,
            tolerance: needs.tolerance,
            bias: needs.bias,
            overestimation: needs.overestimation,
            unused: 0,
            starts: needs.starts,
            per_depth: needs.per_depth,
        }
    }
}

impl<M: GpuTexelMethod + Debug> GpuShadow for TexelShadow<M> {
    fn build(
        &mut self,
        slot: usize,
        gpu: &Gpu,
        commands: &mut Commands,
        input: &GpuShadowInput,
        settings: &ShadowSettings,
    ) -> Result<(), GpuShadowError> {
        // Frees the maps of lights that were removed.
        self.maps.truncate(input.slots());
        let method = M::new(settings);
        let frame = TexelFrame::place(
            (input.light, input.anchor),
            input.strand_width,
            method.resolution(),
            &input.bounds,
        );
        let scale = MapScale {
            frame: &frame,
            extinction_scale: safe_extinction(input.extinction_scale),
            depth_per_texel: depth_per_texel(input.extinction_scale, input.strand_width, &frame),
        };
        let method = method.within(&scale);
        let needs = method.needs();
        let texels = u64::from(frame.resolution).pow(2);
        let used = texels * needs.map_words;
        let map_words = used + if M::COUNTS_FALLBACKS { HEAD_WORDS } else { 0 };
        let scratch_words = texels * needs.scratch_words;
        let needed_bytes = 4 * (map_words + scratch_words);
        let limit_bytes = method.memory_limit_bytes() / u64::from(input.maps.max(1));
        let fits = if needed_bytes > limit_bytes {
            let maps = input.maps.max(1);
            Err(ShadowError::TooLarge { method: M::METHOD, needed_bytes, limit_bytes, maps })
        } else {
            fits_device(gpu, M::METHOD, 4 * map_words.max(scratch_words))
        };
        if let Err(error) = fits {
            *self.map(gpu, slot) = Map::new(gpu, slot, M::LISTS);
            return Err(error.into());
        }
        self.kernels.choose(gpu, M::PASSES, &Self::query(), Self::constants(&method, self.projected))?;

        self.scratch.fit(gpu, scratch_words);
        let scratch = self.scratch.bytes();
        let segments = input.strands.segment_count;
        let uniform = TexelUniform::new(&frame, input, method.profile(), &needs);
        let list_of = input.shared_list.map_or(slot, |list| list.of);
        let map = self.map(gpu, slot);
        map.list_of = list_of;
        map.words.fit(gpu, map_words);
        map.used = used;
        map.frame = Some(frame);
        map.report = ShadowReport {
            memory_bytes: map.words.bytes(),
            cells_total: texels,
            cell_size: frame.texel_size,
            needed_bytes,
            // Until this build's count comes back.
            fallbacks: map.report.fallbacks,
            ..ShadowReport::default()
        };
        gpu.upload(&map.uniform, 0, &[uniform]);
        let encoder = commands.encoder();
        // A map that continues the list of another one adds its fragments to it.
        if let Some(list) = map.list.as_mut().filter(|_| list_of == slot) {
            let maps = input.maps.max(1);
            let times = u64::from(input.shared_list.map_or(1, |list| list.maps));
            let [limit_bytes, other_bytes] =
                [limit_bytes, needed_bytes].map(|bytes| bytes.saturating_mul(times));
            let share = Share { method: M::METHOD, limit_bytes, other_bytes, maps };
            list.begin(gpu, encoder, share, segments);
        }
        map.count_memory(scratch, list_of == slot, M::LIST_IS_SCRATCH);

        let map = &self.maps[slot];
        encoder.clear_buffer(map.words.raw(), 0, Some((4 * map_words).max(4)));
        encoder.clear_buffer(self.scratch.raw(), 0, Some((4 * scratch_words).max(4)));
        let mut resources = self.resources(map);
        resources.extend([
            (1, input.strands.points.as_entire_binding()),
            (2, input.strands.segments.as_entire_binding()),
            (4, self.scratch.raw().as_entire_binding()),
        ]);
        for at in method.schedule() {
            let (pass, kernel) = (&M::PASSES[at], &self.kernels.chosen().passes[at]);
            let group = kernel.bind(gpu, &resources);
            let threads = match pass.over {
                Over::Segments | Over::FilteredSegments => u64::from(segments),
                Over::Texels | Over::Groups => texels,
            };
            commands.compute(pass.name, |pass| kernel.run(pass, &group, threads));
        }
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        let Some(map) = self.maps.get(slot) else { return };
        self.kernels.chosen().lookup.run(gpu, commands, slot, &self.resources(map), targets);
    }

    fn columns_size(&self, slot: usize) -> u32 {
        self.maps.get(slot).and_then(|map| map.frame).map_or(0, |frame| frame.resolution)
    }

    fn columns(
        &mut self,
        (slot, _): (usize, usize),
        gpu: &Gpu,
        commands: &mut Commands,
        into: &wgpu::TextureView,
    ) -> Option<GpuColumns> {
        let map = self.maps.get(slot)?;
        let frame = map.frame?;
        let resources = self.resources(map);
        self.kernels.chosen().lookup.write_columns(gpu, commands, &resources, frame.resolution, into);
        Some(GpuColumns { size: frame.resolution, uv_from_world: frame.uv_from_world() })
    }

    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        let map = self.maps.get(slot)?;
        if M::COUNTS_FALLBACKS {
            let built = map.frame.is_some();
            return built.then(|| GpuList { buffer: map.words.raw(), at: 4 * map.used, room: u64::MAX });
        }
        let list = map.list.as_ref()?;
        Some(GpuList { buffer: list.raw(), at: 0, room: list.room() })
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        let mut again = false;
        let scratch = self.scratch.bytes();
        for (slot, (map, &head)) in self.maps.iter_mut().zip(heads).enumerate() {
            if M::COUNTS_FALLBACKS {
                map.report.fallbacks = GpuList::fragments(head);
            }
            let Some(list) = map.list.as_mut().filter(|_| map.list_of == slot) else { continue };
            match list.settle(gpu, head) {
                Ok(None) => {}
                Ok(Some((needed_bytes, short))) => {
                    again |= short;
                    map.report.needed_bytes = needed_bytes;
                    map.report.samples = list.found();
                    map.count_memory(scratch, true, M::LIST_IS_SCRATCH);
                }
                Err(error) => {
                    *map = Map::new(gpu, slot, M::LISTS);
                    return Err(error.into());
                }
            }
        }
        Ok(again)
    }

    fn forget(&mut self, gpu: &Gpu) {
        self.maps.clear();
        self.scratch = Buffer::new(gpu, "shadow scratch");
    }

    fn report(&self, slot: usize) -> ShadowReport {
        self.maps.get(slot).map_or_else(ShadowReport::default, |map| map.report)
    }

    fn map_words(&self, slot: usize, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let Some(map) = self.maps.get(slot) else { return Ok(Vec::new()) };
        let mut words = vec![0; map.used as usize];
        read_buffer(gpu, map.words.raw(), &mut words)?;
        if let Some(list) = map.list.as_ref().filter(|_| !M::LIST_IS_SCRATCH) {
            words.extend(list.words(gpu)?);
        }
        Ok(words)
    }
}
