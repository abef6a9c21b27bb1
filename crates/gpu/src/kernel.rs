//! Compute kernels: a pipeline and the bindings that it uses.

use std::collections::BTreeSet;

use crate::{Gpu, GpuError, ShaderSource, shader};

/// Threads per workgroup of every kernel with a one-dimensional range of threads.
pub const THREADS: u32 = 64;

/// The most workgroups along one axis of a dispatch that WebGPU allows.
const MOST_GROUPS: u32 = 65_535;

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
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    used: BTreeSet<u32>,
}

impl Kernel {
    /// Compiles `entry` of a composed shader.
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

    /// Binds resources by their binding numbers. Those that the kernel does not use are ignored.
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

    /// Dispatches at least `threads` threads; the kernel must return early in the surplus ones. The number of a thread is
    /// `id.x + id.y * groups.x * 64`.
    pub fn run(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, threads: u64) {
        let groups = u32::try_from(threads.div_ceil(u64::from(THREADS))).unwrap_or(u32::MAX);
        if groups > 0 {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            // The fewest rows that are possible, all of one length, leave the fewest surplus threads.
            let rows = groups.div_ceil(MOST_GROUPS);
            pass.dispatch_workgroups(groups.div_ceil(rows), rows, 1);
        }
    }
}
