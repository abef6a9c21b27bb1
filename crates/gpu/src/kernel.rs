//! Compute kernels: a pipeline with what it binds.

use std::collections::BTreeSet;

use crate::{Gpu, GpuError, ShaderSource, shader};

/// Threads of a workgroup in every kernel whose threads are numbered in one row.
pub const THREADS: u32 = 64;

/// Workgroups along one axis of a dispatch: WebGPU's limit.
const MOST_GROUPS: u32 = 65_535;

/// The name and the value of an `override` of a shader.
///
/// What every thread would find to be the same is better known when a kernel is compiled: where kernels run on the processor,
/// both sides of a branch are carried out, and the driver only leaves out what can never be reached.
pub type Constant = (&'static str, f64);

/// A compute pipeline whose resources are all in group 0.
///
/// Its layout comes from the shader. Composed shaders declare more than one entry point uses; what it does not use is not
/// bound.
#[derive(Debug)]
pub struct Kernel {
    label: &'static str,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    used: BTreeSet<u32>,
}

impl Kernel {
    /// Compiles `entry` of a composed shader.
    ///
    /// # Errors
    /// The file and line that do not compile, and why; or what the driver says.
    pub fn new(gpu: &Gpu, label: &'static str, source: &ShaderSource, entry: &str) -> Result<Self, GpuError> {
        Self::specialised(gpu, label, source, entry, &[])
    }

    /// As [`Kernel::new`], for these values of the shader's `override`s; names that it does not declare are left out.
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
            Self { label, pipeline, layout, used }
        })
    }

    /// Binds resources by their numbers. Those that the kernel does not use are left out.
    pub fn bind(&self, gpu: &Gpu, resources: &[(u32, wgpu::BindingResource)]) -> wgpu::BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .filter(|(binding, _)| self.used.contains(binding))
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        })
    }

    /// Runs it on so many threads or a few more, which the kernel must leave out itself: thread numbers are
    /// `id.x + id.y * groups.x * 64`.
    pub fn run(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, threads: u64) {
        let groups = u32::try_from(threads.div_ceil(u64::from(THREADS))).unwrap_or(u32::MAX);
        if groups > 0 {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            // As square as needed: a row that is full leaves as few threads over as one that is not.
            let rows = groups.div_ceil(MOST_GROUPS);
            pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
        }
    }
}
