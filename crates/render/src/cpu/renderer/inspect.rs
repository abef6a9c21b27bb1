//! Transmittance of the last picture.

use glam::Vec3;

use super::CpuRenderer;
use crate::{RayStructure, RenderError};

impl CpuRenderer {
    /// See [`Renderer::transmittance`](crate::Renderer::transmittance).
    ///
    /// # Errors
    /// As there.
    pub fn transmittance(&self, light: usize) -> Result<Vec<f32>, RenderError> {
        self.shadow.transmittance(light).map(<[f32]>::to_vec)
    }

    /// See [`Renderer::transmittance_at`](crate::Renderer::transmittance_at).
    ///
    /// # Errors
    /// As there.
    pub fn transmittance_at(&self, light: usize, points: &[Vec3]) -> Result<Vec<f32>, RenderError> {
        self.shadow.transmittance_at(light, points)
    }

    /// The number of strand points of the last picture whose light was computed, and of all. Light waits until it is known which points show
    /// where segments are blended in order; in other modes it is computed for all.
    pub fn lit_points(&self) -> [usize; 2] {
        self.placed.lit_points()
    }

    /// What the map of a light of the last picture holds along the light through `p` (world space, metres).
    ///
    /// # Errors
    /// As [`Renderer::transmittance`](crate::Renderer::transmittance).
    pub fn along_ray(&self, light: usize, p: Vec3) -> Result<RayStructure, RenderError> {
        self.shadow.along_ray(light, p)
    }
}
