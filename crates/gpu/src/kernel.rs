//! Compute kernels: a pipeline and the bindings that it uses.

use std::sync::{Mutex, PoisonError};

use crate::compiled::Compiled;
use crate::{Gpu, GpuError, ShaderSource};

/// Threads per workgroup of every kernel with a one-dimensional range of threads.
pub const THREADS: u32 = 64;

/// The most workgroups along one axis of a dispatch that WebGPU allows.
const MAX_GROUPS: u32 = 65_535;

/// The name and the value of an `override` of a shader.
///
/// Values that are the same for all threads are set when a kernel is compiled, because software adapters execute both sides of
/// a branch unless the compiler removes one.
pub type Constant = (&'static str, f64);

/// A compute pipeline whose resources are all in group 0.
///
/// Its layout comes from the shader. Composed shaders declare more bindings than one entry point uses; unused ones are not
/// bound.
#[derive(Debug)]
pub struct Kernel {
    label: &'static str,
    compiled: Compiled,
    groups: Mutex<BoundGroups>,
}

/// A bind group that was not used in this many frames is dropped: it keeps its buffers and textures alive.
const KEPT_FRAMES: u64 = 2;
/// The most bind groups that are kept.
const MAX_KEPT: usize = 64;

/// The bind groups of the last frames, with the resources that they bind.
#[derive(Debug)]
struct BoundGroups {
    kept: Vec<Bound>,
    frames: u64,
}

#[derive(Debug)]
struct Bound {
    resources: Vec<(u32, Resource)>,
    group: wgpu::BindGroup,
    /// The frame that used it last.
    last: u64,
}

/// A resource that can be compared.
#[derive(Clone, Debug, PartialEq)]
enum Resource {
    Buffer(wgpu::Buffer, u64, Option<wgpu::BufferSize>),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

impl Resource {
    /// `None` for the kinds that no kernel uses.
    fn of(resource: &wgpu::BindingResource) -> Option<Self> {
        match resource {
            wgpu::BindingResource::Buffer(part) => {
                Some(Self::Buffer(part.buffer.clone(), part.offset, part.size))
            }
            wgpu::BindingResource::TextureView(view) => Some(Self::View((*view).clone())),
            wgpu::BindingResource::Sampler(sampler) => Some(Self::Sampler((*sampler).clone())),
            _ => None,
        }
    }

    fn is(&self, resource: &wgpu::BindingResource) -> bool {
        match (self, resource) {
            (Self::Buffer(buffer, offset, size), wgpu::BindingResource::Buffer(part)) => {
                (buffer, *offset, *size) == (part.buffer, part.offset, part.size)
            }
            (Self::View(known), wgpu::BindingResource::TextureView(view)) => known == *view,
            (Self::Sampler(known), wgpu::BindingResource::Sampler(sampler)) => known == *sampler,
            _ => false,
        }
    }
}

impl Kernel {
    /// Compiles `entry` of a composed shader, unless a handle of the device has done so before.
    ///
    /// # Errors
    /// The file, the line and the reason where the shader does not compile; or the error of the driver.
    pub fn new(gpu: &Gpu, label: &'static str, source: &ShaderSource, entry: &str) -> Result<Self, GpuError> {
        Self::specialised(gpu, label, source, entry, &[])
    }

    /// As [`Kernel::new`], with values for the shader's `override`s. Names that the shader does not declare are ignored.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn specialised(
        gpu: &Gpu,
        label: &'static str,
        source: &ShaderSource,
        entry: &str,
        constants: &[Constant],
    ) -> Result<Self, GpuError> {
        let compiled = gpu.compiled.get(gpu, label, source, entry, constants)?;
        let groups = Mutex::new(BoundGroups { kept: Vec::new(), frames: KEPT_FRAMES });
        Ok(Self { label, compiled, groups })
    }

    /// Keeps bind groups for this many frames in place of two: for kernels whose resources are used in turn.
    #[must_use]
    pub fn keeping(self, frames: u64) -> Self {
        self.groups.lock().unwrap_or_else(PoisonError::into_inner).frames = frames;
        self
    }

    /// Binds resources by their binding numbers. Those that the kernel does not use are ignored. The bind group of an earlier frame is
    /// used again if its resources are the same.
    pub fn bind(&self, gpu: &Gpu, resources: &[(u32, wgpu::BindingResource)]) -> wgpu::BindGroup {
        let wanted = || resources.iter().filter(|(binding, _)| self.compiled.used.contains(binding));
        let mut groups = self.groups.lock().unwrap_or_else(PoisonError::into_inner);
        let (now, frames) = (gpu.frame(), groups.frames);
        groups.kept.retain(|bound| bound.last + frames >= now);
        let same = |bound: &Bound| {
            bound.resources.len() == wanted().count()
                && bound
                    .resources
                    .iter()
                    .zip(wanted())
                    .all(|((at, known), (binding, resource))| at == binding && known.is(resource))
        };
        if let Some(bound) = groups.kept.iter_mut().find(|bound| same(bound)) {
            bound.last = now;
            return bound.group.clone();
        }
        if groups.kept.len() >= MAX_KEPT {
            groups.kept.clear();
        }
        let entries: Vec<_> = wanted()
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
            .collect();
        gpu.counters.created();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.compiled.layout,
            entries: &entries,
        });
        let known = wanted().map(|(binding, resource)| Some((*binding, Resource::of(resource)?)));
        if let Some(resources) = known.collect() {
            groups.kept.push(Bound { resources, group: group.clone(), last: now });
        }
        group
    }

    /// Dispatches as many workgroups as three words of `groups` say, `offset` bytes after its start, which the device itself may have
    /// written.
    pub fn run_indirect(
        &self,
        pass: &mut wgpu::ComputePass,
        group: &wgpu::BindGroup,
        groups: &wgpu::Buffer,
        offset: u64,
    ) {
        pass.set_pipeline(&self.compiled.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups_indirect(groups, offset);
    }

    /// Dispatches at least `threads` threads; the kernel must return early in the surplus ones. The number of a thread is
    /// `id.x + id.y * groups.x * 64`.
    pub fn run(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, threads: u64) {
        let groups = u32::try_from(threads.div_ceil(u64::from(THREADS))).unwrap_or(u32::MAX);
        if groups > 0 {
            pass.set_pipeline(&self.compiled.pipeline);
            pass.set_bind_group(0, group, &[]);
            // The fewest rows that are possible, all of one length, leave the fewest surplus threads.
            let rows = groups.div_ceil(MAX_GROUPS);
            pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
        }
    }
}
