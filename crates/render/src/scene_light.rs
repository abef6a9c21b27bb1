//! What both backends compute of light on the CPU before they draw a frame.

use std::sync::LazyLock;

use lovelock_appearance::fibre::{Fibre, FibreTables};

use crate::FrameInput;
use crate::ambient::{AmbientGrid, Surroundings};

/// Tables of the fibres, and light from all directions; kept from frame to frame.
#[derive(Debug)]
pub(crate) struct SceneLight {
    pub tables: FibreTables,
    pub surroundings: Surroundings,
    pub grid: AmbientGrid,
}

impl Default for SceneLight {
    fn default() -> Self {
        Self {
            tables: FibreTables::bake(&Fibre::default()),
            surroundings: Surroundings::default(),
            grid: AmbientGrid::default(),
        }
    }
}

/// Without any light, for drawings in which colours do not matter.
pub(crate) static NO_LIGHT: LazyLock<SceneLight> = LazyLock::new(SceneLight::default);

impl SceneLight {
    /// Follows the settings and the hair of `input`. Returns whether the azimuthal tables have changed.
    pub fn follow(&mut self, input: &FrameInput) -> bool {
        let shape = |tables: &FibreTables| (tables.fibre.roughness_around, tables.fibre.index);
        let before = shape(&self.tables);
        self.tables.update(&input.look.fibre());
        self.surroundings = Surroundings::new(input);
        self.grid.build(input, &self.surroundings, &self.tables);
        before != shape(&self.tables)
    }
}
