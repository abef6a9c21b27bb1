//! Compute kernels: a pipeline and the bindings that it uses.

use std::sync::{Mutex, PoisonError};

use crate::compiled::{Compiled, Origin};
use crate::{Gpu, GpuError, ShaderSource, shader};

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
        let origin = Origin::new(source.text(), entry, constants);
        let compiled = gpu.compiled.get(origin, || compile(gpu, label, source, entry, constants))?;
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

fn compile(
    gpu: &Gpu,
    label: &str,
    source: &ShaderSource,
    entry: &str,
    constants: &[Constant],
) -> Result<Compiled, GpuError> {
    let checked = shader::check(source)?;
    let used = checked.bindings_of(entry);
    let constants: Vec<_> =
        constants.iter().copied().filter(|(name, _)| checked.has_override(name)).collect();
    gpu.checked(|| {
        let module = gpu.module(label, source);
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: None,
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            cache: None,
        });
        let layout = pipeline.get_bind_group_layout(0);
        Compiled { pipeline, layout, used }
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::ShaderPart;
    use crate::compiled::MOST;

    const SCALE: ShaderPart = ShaderPart {
        name: "scale.wgsl",
        text: "override times: u32 = 2u;\n\
            @group(0) @binding(1) var<storage, read_write> a: array<u32>;\n\
            @compute @workgroup_size(64) fn scale(@builtin(global_invocation_id) id: vec3<u32>) { a[id.x] *= times; }\n",
    };

    #[test]
    fn handles_of_a_device_share_kernels_of_the_same_text_and_constants() {
        let gpu = match Gpu::open() {
            Ok(gpu) => gpu,
            Err(error) => return lovelock_testkit::skip_without_adapter(&error),
        };
        let source = ShaderSource::new(&[SCALE]);
        let with = |gpu: &Gpu, source: &ShaderSource, constants: &[Constant]| {
            Kernel::specialised(gpu, "scale", source, "scale", constants).map(|kernel| kernel.compiled)
        };
        let get = |gpu: &Gpu, source: &ShaderSource, times| with(gpu, source, &[("times", times)]);
        let first = get(&gpu, &source, 2.0).expect("it compiles");
        assert_eq!(first.used, BTreeSet::from([1]));
        assert_eq!(get(&gpu.handle(), &source, 2.0).expect("it is known").pipeline, first.pipeline);
        // Controls: another constant and another text are other kernels, and what does not compile is not kept.
        let third = get(&gpu, &source, 3.0).expect("it compiles");
        assert_ne!(third.pipeline, first.pipeline);
        let other = ShaderSource::new(&[SCALE, ShaderPart { name: "more.wgsl", text: "const MORE = 1;\n" }]);
        assert_ne!(get(&gpu, &other, 2.0).expect("it compiles").pipeline, first.pipeline);
        let broken = ShaderSource::new(&[ShaderPart { name: "broken.wgsl", text: "fn" }]);
        let error = get(&gpu, &broken, 2.0).expect_err("it does not compile");
        assert!(error.to_string().starts_with("broken.wgsl, line "), "{error}");
        let kept = |gpu: &Gpu| gpu.compiled.len();
        assert_eq!(kept(&gpu), 3);
        // A constant that the shader does not have makes no other kernel.
        let more = [("times", 2.0), ("absent", 1.0)];
        let same = with(&gpu, &source, &more).expect("it is known");
        assert_eq!((same.pipeline, kept(&gpu)), (first.pipeline.clone(), 3));
        // Many others push out what was not used for longest, which is not the first.
        for text in 0..MOST - 2 {
            gpu.compiled.keep(Origin::new(&text.to_string(), "", &[]), first.clone());
        }
        assert_eq!(kept(&gpu), MOST);
        assert_eq!(get(&gpu, &source, 2.0).expect("it is known").pipeline, first.pipeline);
        assert_ne!(get(&gpu, &source, 3.0).expect("it compiles").pipeline, third.pipeline);
    }
}
