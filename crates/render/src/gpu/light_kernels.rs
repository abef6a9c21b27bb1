//! The kernels that evaluate lights, compiled for the number of lights.

use lovelock_gpu::{Constant, Gpu, GpuError, Kernel, ShaderSource};

use crate::MAX_LIGHTS;

/// The lists of pixels that are drawn one by one; twin of `BODY` and the constants below it in picture.wgsl.
pub(super) const LISTS: usize = 4;

/// The kernels for one number of lights.
#[derive(Debug)]
pub(super) struct LightKernels {
    /// By whether hair scatters as fibres do.
    pub shade_points: [Kernel; 2],
    pub ground: Kernel,
    /// The kernels that draw the pixels of each list.
    pub picture_lit: [Kernel; LISTS],
}

/// The parts of these kernels.
#[derive(Debug)]
pub(super) struct LightShaders {
    pub points: ShaderSource,
    pub ground: ShaderSource,
    pub picture: ShaderSource,
}

/// The kernels for each number of lights that has been used.
#[derive(Debug)]
pub(super) struct LightVariants {
    shaders: LightShaders,
    made: [Option<LightKernels>; MAX_LIGHTS + 1],
}

impl LightShaders {
    fn compile(&self, gpu: &Gpu, lights: usize) -> Result<LightKernels, GpuError> {
        let count = ("LIGHTS", lights as f64);
        let kernel = |label, source, entry, constants: &[Constant]| {
            Kernel::specialised(gpu, label, source, entry, constants)
        };
        let lit = |list: f64| kernel("picture lit", &self.picture, "picture_lit", &[count, ("LIST", list)]);
        let shade_points =
            |fibre: f64| kernel("strand points", &self.points, "shade_points", &[count, ("FIBRE", fibre)]);
        Ok(LightKernels {
            shade_points: [shade_points(0.0)?, shade_points(1.0)?],
            ground: kernel("ground", &self.ground, "ground_corners", &[count])?,
            picture_lit: [lit(0.0)?, lit(1.0)?, lit(2.0)?, lit(3.0)?],
        })
    }
}

impl LightVariants {
    pub fn new(shaders: LightShaders) -> Self {
        Self { shaders, made: [const { None }; MAX_LIGHTS + 1] }
    }

    /// The kernels for a number of lights.
    ///
    /// # Errors
    /// The driver cannot compile them.
    pub fn of(&mut self, gpu: &Gpu, lights: usize) -> Result<&LightKernels, GpuError> {
        let lights = lights.min(MAX_LIGHTS);
        let made = &mut self.made[lights];
        if made.is_none() {
            *made = Some(self.shaders.compile(gpu, lights)?);
        }
        made.as_ref().ok_or_else(|| GpuError::Refused("no kernels for the lights".to_owned()))
    }
}
