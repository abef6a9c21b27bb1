//! The kernels of a method, compiled with its settings as constants.

use lovelock_gpu::{Constant, Gpu, GpuError, Kernel, ShaderPart};

use super::Pass;
use crate::gpu::PointLookup;

/// The number of cached sets of kernels, so that switching a setting back and forth does not recompile.
const MAX_KEPT: usize = 8;

/// The kernels for certain values of the shaders' constants.
#[derive(Debug)]
pub(super) struct Kernels {
    constants: Vec<Constant>,
    pub passes: Vec<Kernel>,
    pub lookup: PointLookup,
}

/// The cached sets of kernels of a method, at least one. The first one is in use.
#[derive(Debug)]
pub(super) struct KernelSets(Vec<Kernels>);

impl Kernels {
    fn new(
        gpu: &Gpu,
        passes: &[Pass],
        query: &[ShaderPart],
        constants: Vec<Constant>,
    ) -> Result<Self, GpuError> {
        let lookup = PointLookup::new(gpu, query, true, &constants)?;
        let passes = passes.iter().map(|pass| pass.kernel(gpu, &constants)).collect::<Result<_, _>>()?;
        Ok(Self { constants, passes, lookup })
    }
}

impl KernelSets {
    /// Compiles the first set.
    pub fn new(
        gpu: &Gpu,
        passes: &[Pass],
        query: &[ShaderPart],
        constants: Vec<Constant>,
    ) -> Result<Self, GpuError> {
        Ok(Self(vec![Kernels::new(gpu, passes, query, constants)?]))
    }

    /// Selects the set for these constants. Compiles it if it is not cached.
    pub fn choose(
        &mut self,
        gpu: &Gpu,
        passes: &[Pass],
        query: &[ShaderPart],
        constants: Vec<Constant>,
    ) -> Result<(), GpuError> {
        if let Some(at) = self.0.iter().position(|set| set.constants == constants) {
            self.0[..=at].rotate_right(1);
            return Ok(());
        }
        let set = Kernels::new(gpu, passes, query, constants)?;
        self.0.truncate(MAX_KEPT - 1);
        self.0.insert(0, set);
        Ok(())
    }

    /// The set in use.
    pub fn chosen(&self) -> &Kernels {
        &self.0[0]
    }
}
