//! The depth maps of the body.

use rayon::prelude::*;

use super::{CpuRenderer, DEPTH_TEXELS};
use crate::cpu::body_depth::{Casters, DepthMap, Holes};
use crate::cpu::kept::Unchanged;
use crate::cpu::placed::surface_of;
use crate::cpu::surface::materials::Cutouts;
use crate::light_view::{bounding_sphere, light_views};
use crate::uniform::LightMaps;
use crate::{FrameInput, Light};

impl CpuRenderer {
    /// Draws the depth maps of the body for all lights, as far as they are not unchanged.
    pub(super) fn draw_depth(&mut self, input: &FrameInput, unchanged: Unchanged) -> Vec<LightMaps> {
        let (vertices, triangles) = surface_of(input);
        self.placed.surface.follow_materials(input.body.map(|(body, _)| body), &input.picture.body_look);
        let closed = self.placed.is_closed(input);
        let cutouts = self.placed.surface.materials.as_ref().zip(input.body);
        let cutouts = cutouts.map(|(materials, (body, _))| Cutouts { materials, body });
        let holed = cutouts.as_ref().filter(|cutouts| cutouts.any());
        let holes = holed.map(|cutouts| cutouts as &dyn Holes);
        let sphere = bounding_sphere(vertices);
        let lights: Vec<_> = Light::enabled(input.lights).collect();
        self.depth.resize_with(lights.len(), Vec::new);
        // Light passes through holes to faces that look away from it.
        let (width, closed) = (self.placed.width, closed && holes.is_none());
        let (shadow, before) = (&self.shadow, &self.maps);
        lights
            .par_iter()
            .zip(&mut self.depth)
            .enumerate()
            .map(|(k, (light, depth))| {
                if unchanged.surface
                    && unchanged.lights[k]
                    && let Some(views) = before.get(k)
                {
                    return *views;
                }
                let views = light_views(light, &shadow.frame(k), sphere, DEPTH_TEXELS);
                depth.resize_with(views.body_views().len(), DepthMap::default);
                depth.par_iter_mut().zip(views.body_views()).for_each(|(depth, from_world)| {
                    if views.standing.is_standing() {
                        // From within a closed body, triangles that face away are nearest.
                        let casters = Casters { vertices, triangles, closed: false, holes };
                        depth.draw_perspective(width, *from_world, &casters);
                    } else {
                        depth.draw(width, *from_world, &Casters { vertices, triangles, closed, holes });
                    }
                });
                views
            })
            .collect()
    }
}
