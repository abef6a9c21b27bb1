//! The kernels that evaluate lights, compiled for their number and kinds.

use std::sync::{Arc, OnceLock};

use lovelock_gpu::{Constant, Gpu, GpuError, Kernel, ShaderSource};
use lovelock_groom::HairShading;

use crate::{Light, MAX_LIGHTS};

/// The lists of pixels that are drawn one by one; twin of `BODY` and the constants below it in picture.wgsl.
pub(super) const LISTS: usize = 4;

/// The values of [`HairShading`].
const SHADINGS: usize = 3;

/// The lights that kernels are compiled for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LightSet {
    /// Their number.
    pub count: usize,
    /// Whether any of them stands somewhere.
    pub standing: bool,
}

impl LightSet {
    /// The lights of an image.
    pub fn of(lights: &[Light]) -> Self {
        Self { count: lights.len().min(MAX_LIGHTS), standing: lights.iter().any(Light::stands) }
    }

    /// The values of the constants of shaders.
    pub fn constants(self) -> [Constant; 2] {
        [("LIGHTS", self.count as f64), ("STANDING", f64::from(u8::from(self.standing)))]
    }
}

/// The kernels for some lights.
#[derive(Debug)]
pub(super) struct LightKernels {
    shaders: Arc<LightShaders>,
    lights: LightSet,
    /// By shading and by whether strands have colours of their own. Rare ones are compiled for the first such hair.
    shade_points: [[OnceLock<Kernel>; 2]; SHADINGS],
    pub ground: Kernel,
    /// The kernels that draw the pixels of each list.
    picture_lit: [Kernel; LISTS],
    /// Those for the lists that show a body, if it has materials: compiled for the first such body.
    materials_lit: [OnceLock<Kernel>; LISTS],
}

/// The parts of these kernels.
#[derive(Debug)]
pub(super) struct LightShaders {
    pub points: ShaderSource,
    pub ground: ShaderSource,
    pub picture: ShaderSource,
    /// The picture of a body with materials.
    pub materials: ShaderSource,
}

/// The kernels for all lights that have been used.
#[derive(Debug)]
pub(super) struct LightVariants {
    shaders: Arc<LightShaders>,
    /// By the number of lights, and whether any stands somewhere.
    made: [[Option<LightKernels>; 2]; MAX_LIGHTS + 1],
}

impl LightShaders {
    fn shade_points(
        &self,
        gpu: &Gpu,
        lights: LightSet,
        shading: HairShading,
        colored: bool,
    ) -> Result<Kernel, GpuError> {
        let [count, standing] = lights.constants();
        let constants = [
            count,
            standing,
            ("SHADING", f64::from(shading as u8)),
            ("COLORED", f64::from(u8::from(colored))),
        ];
        Kernel::specialised(gpu, "strand points", &self.points, "shade_points", &constants)
    }

    fn compile(self: &Arc<Self>, gpu: &Gpu, lights: LightSet) -> Result<LightKernels, GpuError> {
        let [count, standing] = lights.constants();
        let kernel = |label, source, entry, constants: &[Constant]| {
            Kernel::specialised(gpu, label, source, entry, constants)
        };
        let lit = |list: f64| {
            kernel("picture lit", &self.picture, "picture_lit", &[count, standing, ("LIST", list)])
        };
        let usual = |shading: HairShading| {
            let kernel = self.shade_points(gpu, lights, shading, false)?;
            Ok::<_, GpuError>([OnceLock::from(kernel), OnceLock::new()])
        };
        Ok(LightKernels {
            shaders: Arc::clone(self),
            lights,
            shade_points: [
                usual(HairShading::Fibre)?,
                usual(HairShading::TwoHighlights)?,
                [const { OnceLock::new() }; 2],
            ],
            ground: kernel("ground", &self.ground, "ground_corners", &[count, standing])?,
            picture_lit: [lit(0.0)?, lit(1.0)?, lit(2.0)?, lit(3.0)?],
            materials_lit: [const { OnceLock::new() }; LISTS],
        })
    }
}

/// Whether a list shows the body: twin of `BODY` and `BODY_AND_GROUND` in picture.wgsl.
pub(super) fn shows_body(list: usize) -> bool {
    list.is_multiple_of(2)
}

impl LightKernels {
    /// The kernel that shades strand points. `colored` says that strands have colours of their own.
    ///
    /// # Errors
    /// The driver cannot compile it.
    pub fn shade_points(&self, gpu: &Gpu, shading: HairShading, colored: bool) -> Result<&Kernel, GpuError> {
        let made = &self.shade_points[shading as usize][usize::from(colored)];
        if let Some(kernel) = made.get() {
            return Ok(kernel);
        }
        let kernel = self.shaders.shade_points(gpu, self.lights, shading, colored)?;
        Ok(made.get_or_init(|| kernel))
    }

    /// The kernel that draws the pixels of a list, of a body with or without materials.
    ///
    /// # Errors
    /// The driver cannot compile it.
    pub fn picture_lit(&self, gpu: &Gpu, list: usize, has_materials: bool) -> Result<&Kernel, GpuError> {
        if !has_materials || !shows_body(list) {
            return Ok(&self.picture_lit[list]);
        }
        let made = &self.materials_lit[list];
        if let Some(kernel) = made.get() {
            return Ok(kernel);
        }
        let [count, standing] = self.lights.constants();
        let constants = [count, standing, ("LIST", list as f64)];
        let source = &self.shaders.materials;
        let kernel = Kernel::specialised(gpu, "picture lit", source, "picture_lit", &constants)?;
        Ok(made.get_or_init(|| kernel))
    }
}

impl LightVariants {
    pub fn new(shaders: LightShaders) -> Self {
        Self { shaders: Arc::new(shaders), made: [const { [const { None }; 2] }; MAX_LIGHTS + 1] }
    }

    /// The kernels for some lights.
    ///
    /// # Errors
    /// The driver cannot compile them.
    pub fn of(&mut self, gpu: &Gpu, lights: LightSet) -> Result<&LightKernels, GpuError> {
        let made = &mut self.made[lights.count.min(MAX_LIGHTS)][usize::from(lights.standing)];
        if made.is_none() {
            *made = Some(self.shaders.compile(gpu, lights)?);
        }
        made.as_ref().ok_or_else(|| GpuError::Refused("no kernels for the lights".to_owned()))
    }
}
