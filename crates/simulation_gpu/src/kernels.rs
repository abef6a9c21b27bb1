//! The kernels of a step.

use std::sync::Arc;

use lovelock_gpu::{Gpu, GpuError, Kernel, ShaderPart, ShaderSource};
use lovelock_simulation::device::constants;

macro_rules! part {
    ($file:literal) => {
        ShaderPart {
            name: concat!("simulation_gpu/src/shaders/", $file),
            text: include_str!(concat!("shaders/", $file)),
        }
    };
}

const STEP: [ShaderPart; 2] = [part!("step.wgsl"), part!("math.wgsl")];
const FIELD: [ShaderPart; 3] = [part!("field.wgsl"), part!("skin.wgsl"), part!("planes.wgsl")];
const BENDING: ShaderPart = part!("bending.wgsl");
const ROPES: ShaderPart = part!("ropes.wgsl");

fn composed(parts: &[ShaderPart]) -> ShaderSource {
    ShaderSource::new(&[&STEP[..], parts].concat())
}

/// The shaders by name.
pub fn shaders() -> Vec<(&'static str, ShaderSource)> {
    let contacts = [&FIELD[..], &[BENDING, part!("shape.wgsl"), part!("place.wgsl")]].concat();
    vec![
        ("grid", composed(&[part!("grid.wgsl")])),
        ("prepare", composed(&[ROPES, part!("wind.wgsl"), part!("prepare.wgsl")])),
        ("locks", composed(&[ROPES, part!("locks.wgsl")])),
        ("bending", composed(&[BENDING])),
        ("chain", composed(&[BENDING, part!("chain.wgsl")])),
        ("lengths", composed(&[BENDING, part!("lengths.wgsl")])),
        ("field", composed(&FIELD)),
        ("contacts", composed(&contacts)),
        ("publish", ShaderSource::new(&[part!("publish.wgsl")])),
    ]
}

/// The compiled kernels of a device; several [`GuideDevice`](crate::GuideDevice)s may share them.
#[derive(Debug)]
pub struct GuideKernels {
    pub(crate) gpu: Arc<Gpu>,
    pub(crate) clear_grid: Kernel,
    pub(crate) deposit: Kernel,
    pub(crate) gather: Kernel,
    pub(crate) sample_grid: Kernel,
    pub(crate) prepare: Kernel,
    pub(crate) forget_planes: Kernel,
    pub(crate) factorise: Kernel,
    pub(crate) response: Kernel,
    pub(crate) forces: Kernel,
    pub(crate) bend: Kernel,
    pub(crate) hold_together: Kernel,
    pub(crate) lengths: Kernel,
    pub(crate) prefetch: Kernel,
    pub(crate) place_points: Kernel,
    pub(crate) publish: Kernel,
}

impl GuideKernels {
    /// Compiles the kernels for the device of `gpu`.
    ///
    /// # Errors
    /// A shader does not compile, or the driver rejects it.
    pub fn new(gpu: &Arc<Gpu>) -> Result<Self, GpuError> {
        let (sources, constants) = (shaders(), constants());
        let source = |name: &str| {
            let found = sources.iter().find(|(known, _)| *known == name);
            found.map(|(_, source)| source).ok_or_else(|| GpuError::Shader(format!("no shader {name}")))
        };
        let kernel = |name: &str, entry: &'static str| {
            Kernel::specialised(gpu, entry, source(name)?, entry, &constants)
        };
        Ok(Self {
            gpu: Arc::clone(gpu),
            clear_grid: kernel("grid", "clear_grid")?,
            deposit: kernel("grid", "deposit")?,
            gather: kernel("grid", "gather")?,
            sample_grid: kernel("grid", "sample_grid")?,
            prepare: kernel("prepare", "prepare")?,
            forget_planes: kernel("field", "forget_planes")?,
            factorise: kernel("bending", "factorise")?,
            response: kernel("bending", "response")?,
            forces: kernel("locks", "forces")?,
            bend: kernel("chain", "bend")?,
            hold_together: kernel("locks", "hold_together")?,
            lengths: kernel("lengths", "lengths")?,
            prefetch: kernel("field", "prefetch")?,
            place_points: kernel("contacts", "place_points")?,
            // Its output is one of several buffers in turn.
            publish: kernel("publish", "publish")?.keeping(8),
        })
    }

    /// The device that runs them.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }
}

#[cfg(test)]
mod tests {
    use lovelock_gpu::{check_shader, check_translations};

    use super::*;

    #[test]
    fn every_shader_is_valid_and_has_translations_for_direct3d_and_metal() {
        for (name, source) in shaders() {
            check_shader(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
            check_translations(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }

    #[test]
    fn every_constant_of_the_shaders_has_a_value_and_every_value_a_use() {
        let known: Vec<&str> = constants().iter().map(|(name, _)| *name).collect();
        let mut used = Vec::new();
        for (name, source) in shaders() {
            let module = check_shader(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
            used.extend(module.overrides.iter().filter_map(|(_, constant)| constant.name.clone()));
        }
        for name in &used {
            assert!(known.contains(&name.as_str()), "{name} has no value");
        }
        for name in known {
            assert!(used.iter().any(|used| used == name), "{name} has no use");
        }
    }
}
