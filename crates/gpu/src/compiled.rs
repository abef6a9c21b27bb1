//! Compiled kernels of a device. Its handles share them, so a second renderer or pane waits for no compiler.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Mutex, PoisonError};

use xxhash_rust::xxh3::xxh3_128;

use crate::kernel::Constant;
use crate::{Gpu, GpuError, ShaderSource, shader};

/// The most that are kept: several times as many as the shadow methods and a renderer have. Versions of a shader that is being edited push
/// out what was not used for longest.
const MOST: usize = 512;

/// What a kernel is compiled from.
#[derive(Debug, Eq, PartialEq)]
struct Origin {
    /// The hash of the text.
    text: u128,
    entry: String,
    /// Names and bits of the values.
    constants: Vec<(&'static str, u64)>,
}

/// A compute pipeline, the layout of its bindings in group 0, and the numbers of those that it uses.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
    pub(crate) used: BTreeSet<u32>,
}

/// The kernels of a device, in the order of their last use.
#[derive(Debug, Default)]
pub(crate) struct CompiledKernels(Mutex<VecDeque<(Origin, Compiled)>>);

impl CompiledKernels {
    /// The kernel, from before or compiled now. The label is that of its first use.
    pub(crate) fn get(
        &self,
        gpu: &Gpu,
        label: &str,
        source: &ShaderSource,
        entry: &str,
        constants: &[Constant],
    ) -> Result<Compiled, GpuError> {
        // Passes of a method get the constants of all. One whose name a shader does not contain changes nothing there.
        let used = constants.iter().filter(|(name, _)| source.text().contains(name));
        let origin = Origin {
            text: xxh3_128(source.text().as_bytes()),
            entry: entry.to_owned(),
            constants: used.map(|(name, value)| (*name, value.to_bits())).collect(),
        };
        if let Some(known) = self.find(&origin) {
            return Ok(known);
        }
        // Others are not kept waiting meanwhile: two that compile the same both succeed.
        let compiled = compile(gpu, label, source, entry, constants)?;
        self.keep(origin, compiled.clone());
        Ok(compiled)
    }

    fn find(&self, origin: &Origin) -> Option<Compiled> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|(known, _)| known == origin)?;
        let found = kept.remove(at)?;
        let compiled = found.1.clone();
        kept.push_back(found);
        Some(compiled)
    }

    fn keep(&self, origin: Origin, compiled: Compiled) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(known, _)| *known != origin);
        if kept.len() >= MOST {
            kept.pop_front();
        }
        kept.push_back((origin, compiled));
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
    use super::*;
    use crate::ShaderPart;

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
        let get = |gpu: &Gpu, source: &ShaderSource, times| {
            gpu.compiled.get(gpu, "scale", source, "scale", &[("times", times)])
        };
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
        let kept = |gpu: &Gpu| gpu.compiled.0.lock().expect("no test has panicked").len();
        assert_eq!(kept(&gpu), 3);
        // A constant that the shader does not have makes no other kernel.
        let more = [("times", 2.0), ("absent", 1.0)];
        let same = gpu.compiled.get(&gpu, "scale", &source, "scale", &more).expect("it is known");
        assert_eq!((same.pipeline, kept(&gpu)), (first.pipeline.clone(), 3));
        // Many others push out what was not used for longest, which is not the first.
        for text in 0..MOST as u128 - 2 {
            let origin = Origin { text, entry: String::new(), constants: Vec::new() };
            gpu.compiled.keep(origin, first.clone());
        }
        assert_eq!(kept(&gpu), MOST);
        assert_eq!(get(&gpu, &source, 2.0).expect("it is known").pipeline, first.pipeline);
        assert_ne!(get(&gpu, &source, 3.0).expect("it compiles").pipeline, third.pipeline);
    }
}
