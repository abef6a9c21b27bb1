//! A user's method on the GPU: the passes of its current version, as `TexelShadow` runs those of the program's own methods.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use lovelock_gpu::{Commands, Gpu, GpuError, Kernel, read_buffer, wgpu};

use super::UserMethod;
use super::definition::Definition;
use crate::gpu::{
    Buffer, GpuColumns, GpuList, GpuShadow, GpuShadowError, GpuShadowInput, GpuTargets, PointLookup,
    fits_device, projected_constant,
};
use crate::methods::texels::gpu::{Needs, TexelUniform, filter_constant};
use crate::methods::texels::{LineProfile, MAP_MEMORY_LIMIT_BYTES, TexelFilter, TexelFrame};
use crate::{ShadowError, ShadowMethod, ShadowReport, ShadowSettings};

/// The maps of a user's method.
#[derive(Debug)]
pub(super) struct UserShadow {
    method: UserMethod,
    /// Whether strands are projected.
    projected: bool,
    kernels: Option<Arc<Kernels>>,
    /// See turns.wgsl. It stands where other methods have the head of a list, so that a frame brings it back.
    fault: wgpu::Buffer,
    scratch: Buffer,
    maps: Vec<Map>,
}

/// The kernels of one version and one filter. They keep bind groups by the frames of a handle of a device.
#[derive(Debug)]
struct Kernels {
    /// The number of the handle.
    handle: u64,
    projected: bool,
    definition: &'static Definition,
    filter: TexelFilter,
    passes: Vec<Kernel>,
    lookup: PointLookup,
}

/// All kernels in use. A soft light has many maps, which may be built at the same time: one of them compiles for all.
static IN_USE: Mutex<Vec<Weak<Kernels>>> = Mutex::new(Vec::new());

/// The map of one light.
#[derive(Debug)]
struct Map {
    uniform: wgpu::Buffer,
    words: Buffer,
    /// Words that the last build used.
    used: u64,
    frame: Option<TexelFrame>,
    report: ShadowReport,
}

fn buffer(gpu: &Gpu, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    gpu.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}

impl Map {
    /// An empty map: everything is lit.
    fn new(gpu: &Gpu) -> Self {
        Self {
            uniform: buffer(gpu, "texels", size_of::<TexelUniform>() as u64, wgpu::BufferUsages::UNIFORM),
            words: Buffer::new(gpu, "shadow map"),
            used: 0,
            frame: None,
            report: ShadowReport::default(),
        }
    }

    /// The bindings of a query.
    fn resources<'a>(&'a self, fault: &'a wgpu::Buffer) -> Vec<(u32, wgpu::BindingResource<'a>)> {
        vec![
            (0, self.uniform.as_entire_binding()),
            (3, self.words.raw().as_entire_binding()),
            (6, fault.as_entire_binding()),
        ]
    }
}

impl Kernels {
    fn new(
        gpu: &Gpu,
        definition: &'static Definition,
        filter: TexelFilter,
        projected: bool,
    ) -> Result<Self, GpuError> {
        let constants = [filter_constant(filter), projected_constant(projected)];
        let pass = |pass: &super::definition::UserPass| {
            Kernel::specialised(gpu, pass.name, &pass.source, pass.entry, &constants)
        };
        let passes = definition.passes.iter().map(pass).collect::<Result<_, _>>()?;
        let lookup = PointLookup::new(gpu, &definition.query, true, &constants)?;
        Ok(Self { handle: gpu.number(), projected, definition, filter, passes, lookup })
    }

    /// Those in use, or new ones.
    fn shared(
        gpu: &Gpu,
        definition: &'static Definition,
        filter: TexelFilter,
        projected: bool,
    ) -> Result<Arc<Self>, GpuError> {
        // Held while kernels are compiled, so that others wait for them.
        let mut in_use = IN_USE.lock().unwrap_or_else(PoisonError::into_inner);
        in_use.retain(|kernels| kernels.strong_count() > 0);
        let found = in_use.iter().filter_map(Weak::upgrade).find(|kernels| {
            std::ptr::eq(kernels.definition, definition)
                && (kernels.filter, kernels.projected) == (filter, projected)
                && kernels.handle == gpu.number()
        });
        if let Some(kernels) = found {
            return Ok(kernels);
        }
        let kernels = Arc::new(Self::new(gpu, definition, filter, projected)?);
        in_use.push(Arc::downgrade(&kernels));
        Ok(kernels)
    }
}

impl UserShadow {
    /// For the strands themselves, or for projected ones. Kernels are compiled by the first build.
    ///
    /// # Errors
    /// None now: its type is that of the other methods.
    pub(super) fn boxed(
        method: ShadowMethod,
        gpu: &Gpu,
        projected: bool,
    ) -> Result<Box<dyn GpuShadow>, GpuError> {
        let ShadowMethod::User(method) = method else {
            return Err(GpuError::Input(format!("{method} is no method of a user")));
        };
        Ok(Box::new(Self {
            method,
            projected,
            kernels: None,
            fault: buffer(gpu, "fault", 16, wgpu::BufferUsages::STORAGE),
            scratch: Buffer::new(gpu, "shadow scratch"),
            maps: Vec::new(),
        }))
    }

    fn error(&self, problem: String) -> GpuShadowError {
        ShadowError::User { method: self.method, problem }.into()
    }

    /// Compiles the current version if the kernels are those of another one. If the device refuses it, the version before it is used.
    fn compile(&mut self, gpu: &Gpu, filter: TexelFilter) -> Result<&'static Definition, GpuShadowError> {
        loop {
            let definition = self.method.definition().map_err(|problem| self.error(problem))?;
            let is_current = |kernels: &Arc<Kernels>| {
                kernels.definition.version == definition.version && kernels.filter == filter
            };
            if self.kernels.as_ref().is_some_and(is_current) {
                return Ok(definition);
            }
            match Kernels::shared(gpu, definition, filter, self.projected) {
                Ok(kernels) => {
                    self.kernels = Some(kernels);
                    // A new one, because frames in flight still write the one before.
                    self.fault = buffer(gpu, "fault", 16, wgpu::BufferUsages::STORAGE);
                    return Ok(definition);
                }
                Err(GpuError::Shader(why)) => {
                    let problem = format!(
                        "{}: the graphics device refuses it: {}",
                        self.method.folder().display(),
                        one_line(&why)
                    );
                    if !self.method.refuse(definition.version, &problem) {
                        return Err(self.error(problem));
                    }
                }
                Err(other) => return Err(other.into()),
            }
        }
    }

    fn map(&mut self, gpu: &Gpu, slot: usize) -> &mut Map {
        while self.maps.len() <= slot {
            self.maps.push(Map::new(gpu));
        }
        &mut self.maps[slot]
    }
}

/// The first sentence of a driver's answer.
fn one_line(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines.join(" ").chars().take(400).collect()
}

impl GpuShadow for UserShadow {
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
        let own = settings.of_any_user(self.method).clamped();
        let definition = self.compile(gpu, own.filter)?;
        let frame =
            TexelFrame::place((input.light, input.anchor), input.strand_width, own.resolution, &input.bounds);
        let values = definition.values(&own);
        let words = |words: &super::description::Words| words.with(|at| f64::from(values[at]));
        let (per_record, per_scratch) = (words(&definition.record).max(1), words(&definition.scratch));
        let texels = u64::from(frame.resolution).pow(2);
        let (map_words, scratch_words) = (texels * per_record, texels * per_scratch);
        let needed_bytes = 4 * (map_words + scratch_words);
        let maps = input.maps.max(1);
        let limit_bytes = MAP_MEMORY_LIMIT_BYTES / u64::from(maps);
        let method = ShadowMethod::User(self.method);
        let fits = if needed_bytes > limit_bytes {
            Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps })
        } else {
            fits_device(gpu, method, 4 * map_words.max(scratch_words))
        };
        if let Err(error) = fits {
            *self.map(gpu, slot) = Map::new(gpu);
            return Err(error.into());
        }
        let mut starts = [0.0; 16];
        starts[..values.len()].copy_from_slice(&values);
        let needs = Needs {
            map_words: per_record,
            scratch_words: per_scratch,
            parts: per_record as u32,
            merged: per_scratch as u32,
            seeds: definition.version << 8,
            starts,
            ..Needs::default()
        };
        let uniform = TexelUniform::new(&frame, input, LineProfile::Thin, &needs);
        self.scratch.fit(gpu, scratch_words);
        let scratch_bytes = self.scratch.bytes();
        let map = self.map(gpu, slot);
        map.words.fit(gpu, map_words);
        map.used = map_words;
        map.frame = Some(frame);
        map.report = ShadowReport {
            memory_bytes: map.words.bytes(),
            scratch_bytes,
            cells_total: texels,
            cell_size: frame.texel_size,
            needed_bytes,
            ..ShadowReport::default()
        };
        gpu.upload(&map.uniform, 0, &[uniform]);

        let (map, Some(kernels)) = (&self.maps[slot], &self.kernels) else { return Ok(()) };
        let encoder = commands.encoder();
        encoder.clear_buffer(map.words.raw(), 0, Some((4 * map_words).max(4)));
        encoder.clear_buffer(self.scratch.raw(), 0, Some((4 * scratch_words).max(4)));
        let mut resources = map.resources(&self.fault);
        resources.extend([
            (1, input.strands.points.as_entire_binding()),
            (2, input.strands.segments.as_entire_binding()),
            (4, self.scratch.raw().as_entire_binding()),
        ]);
        for (pass, kernel) in definition.passes.iter().zip(&kernels.passes) {
            let group = kernel.bind(gpu, &resources);
            let threads = if pass.over_fragments { u64::from(input.strands.segment_count) } else { texels };
            commands.compute(pass.name, |pass| kernel.run(pass, &group, threads));
        }
        Ok(())
    }

    fn look_up(&mut self, slot: usize, gpu: &Gpu, commands: &mut Commands, targets: &GpuTargets) {
        if let (Some(map), Some(kernels)) = (self.maps.get(slot), &self.kernels) {
            kernels.lookup.run(gpu, commands, slot, &map.resources(&self.fault), targets);
        }
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
        let lookup = &self.kernels.as_ref()?.lookup;
        lookup.write_columns(gpu, commands, &map.resources(&self.fault), frame.resolution, into);
        Some(GpuColumns { size: frame.resolution, uv_from_world: frame.uv_from_world() })
    }

    /// No list, but the word of the fault in its place: with room for nothing, so that a frame with a fault is not shown.
    fn list(&self, slot: usize) -> Option<GpuList<'_>> {
        self.maps.get(slot).map(|_| GpuList { buffer: &self.fault, at: 0, room: 0 })
    }

    fn settle(&mut self, gpu: &Gpu, heads: &[[u32; 2]]) -> Result<bool, GpuShadowError> {
        let Some(definition) = self.kernels.as_ref().map(|kernels| kernels.definition) else {
            return Ok(false);
        };
        let Some(problem) = heads.iter().find_map(|head| definition.fault(head[0])) else { return Ok(false) };
        if self.method.refuse(definition.version, &problem) {
            return Ok(true);
        }
        self.forget(gpu);
        Err(self.error(problem))
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
        Ok(words)
    }
}
