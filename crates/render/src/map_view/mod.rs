//! The shadow map of a light over an image: on a plane through the hair, or at points (Bertails, Ménier, Cani 2005, figure 1, shows such a
//! map).
//!
//! The map is that of the method's definition on the CPU, built from the stored strands, whatever draws the image. Values are computed at
//! each pixel of a plane, so that cells and texels are seen as a strand point reads them.

mod paint;

use glam::Vec3;
use lovelock_groom::{Strands, interpolate};
use lovelock_picture::{MapForm, MapValue, MapView};
use lovelock_shadow::{Bounds, CpuShadow, LightFrame, MapKind, ShadowInput, ShadowMethod, cpu_shadow};

use crate::shadow_look::ShadowLook;
use crate::standing::placed_frame;
use crate::{FrameInput, HairPose, Light, MAX_LIGHTS, Picture, RenderError};
use paint::Canvas;

/// Lengths of the depth of the hair over which density is measured, where a map has no cells along the light.
const DEPTH_PARTS: f32 = 128.0;
/// The least transmittance of which a density is known.
const DARKEST: f32 = 1e-6;
/// The least part of the density range at which a point is drawn.
const THINNEST: f32 = 0.01;

/// The map of the last image, kept from image to image.
#[derive(Default)]
pub(crate) struct MapStage {
    strands: Strands,
    /// The axes of the light's direction.
    base: Option<LightFrame>,
    shadow: Option<(ShadowMethod, Box<dyn CpuShadow + Send + Sync>)>,
}

impl std::fmt::Debug for MapStage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MapStage").field("base", &self.base).finish_non_exhaustive()
    }
}

impl MapStage {
    /// Draws the map over the image of `input`, if its settings ask for it.
    ///
    /// # Errors
    /// The map would exceed its memory limit.
    pub fn draw(&mut self, input: &FrameInput, picture: &mut Picture) -> Result<(), RenderError> {
        let view = &input.picture.map_view;
        let lights: Vec<Light> = Light::enabled(input.lights).take(MAX_LIGHTS).collect();
        let chosen = (view.light.max(1) as usize - 1).min(lights.len().saturating_sub(1));
        let Some(light) = lights.get(chosen).filter(|_| view.value != MapValue::None) else {
            // As the maps of the image, the axes do not outlast their light.
            self.base = None;
            return Ok(());
        };
        if let Some(field) = self.field(input, light)? {
            let mut canvas = Canvas::new(picture, input.camera);
            draw_field(&field, view, &mut canvas);
        }
        Ok(())
    }

    /// Builds the map of a light; `None` without hair.
    fn field(&mut self, input: &FrameInput, light: &Light) -> Result<Option<Field<'_>>, RenderError> {
        let strands = match input.hair {
            HairPose::Strands(strands) => strands,
            HairPose::Guides(guides) | HairPose::Resident(guides, _) => {
                interpolate(input.style, guides, &mut self.strands);
                &self.strands
            }
        };
        let look = ShadowLook::of(input);
        let method = look.settings.method;
        // Transported instead of recomputed, so that the map does not roll while the light is dragged.
        let base = self
            .base
            .map_or_else(|| LightFrame::new(light.direction), |base| base.transported(light.direction));
        self.base = Some(base);
        let frame = placed_frame(base, light, look.anchor());
        let from = ShadowInput {
            strands,
            strand_width: look.strand_width,
            extinction_scale: look.extinction_scale,
            light: frame,
            anchor: look.anchor(),
            maps: 1,
            projected: None,
        };
        let bounds = Bounds::of_strands(&from);
        if bounds.min.x > bounds.max.x {
            return Ok(None);
        }
        let same = self.shadow.as_ref().is_some_and(|(of, _)| *of == method);
        if !same {
            self.shadow = None;
        }
        let (_, shadow) = self.shadow.get_or_insert_with(|| (method, cpu_shadow(method)));
        shadow.build(&from, &look.settings)?;
        let cell = shadow.report().cell_size;
        let has_cells = method.map_kind() == MapKind::Cells;
        let depth = (bounds.max.x - bounds.min.x) / DEPTH_PARTS;
        Ok(Some(Field {
            shadow: &**shadow,
            light: frame,
            anchor: from.anchor,
            min: bounds.min,
            max: bounds.max,
            step: if has_cells { cell } else { depth }.max(1e-6),
        }))
    }
}

/// The map of a light within the extent of the hair.
pub(crate) struct Field<'a> {
    shadow: &'a (dyn CpuShadow + Send + Sync),
    light: LightFrame,
    /// Origin of the extent, world space.
    anchor: Vec3,
    /// The extent of the hair along the axes of the light, metres.
    min: Vec3,
    max: Vec3,
    /// Length along the light over which density is measured, metres.
    step: f32,
}

impl Field<'_> {
    /// From the axes of the light to world space.
    fn world_from_map(&self, p: Vec3) -> Vec3 {
        self.anchor + self.light.world_from_light(p)
    }

    /// Transmittance at points of world space.
    pub fn transmittance(&self, points: &[Vec3]) -> Vec<f32> {
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let mut out = vec![1.0; points.len()];
        self.shadow.transmittance_at(&x, &y, &z, &mut out);
        out
    }

    /// What hair absorbs per metre at points of world space: the fall of the logarithm of transmittance along the light.
    pub fn density(&self, points: &[Vec3]) -> Vec<f32> {
        let moved = |by: f32| points.iter().map(|p| *p + by * self.light.way_at(*p)).collect::<Vec<_>>();
        let [before, behind] = [-0.5, 0.5].map(|steps| self.transmittance(&moved(steps * self.step)));
        let fall = |(before, behind): (&f32, &f32)| {
            ((before.max(DARKEST) / behind.max(DARKEST)).ln() / self.step).max(0.0)
        };
        before.iter().zip(&behind).map(fall).collect()
    }

    /// The eight corners of the extent, in the order of the bits of their index.
    fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|corner| {
            let at = |axis: usize| if corner >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            self.world_from_map(Vec3::new(at(0), at(1), at(2)))
        })
    }
}

/// The place of values in the colours, 0 to 1: light is 1 and shadow 0, thin hair 0 and dense hair 1.
fn places(field: &Field, view: &MapView, points: &[Vec3]) -> Vec<f32> {
    match view.value {
        MapValue::None => vec![0.0; points.len()],
        MapValue::Transmittance => field.transmittance(points),
        MapValue::Density => {
            let range = view.density_range.max(1e-3);
            field.density(points).into_iter().map(|density| (density / range).min(1.0)).collect()
        }
    }
}

fn draw_field(field: &Field, view: &MapView, canvas: &mut Canvas) {
    let corners = field.corners();
    // The edges of a box join corners that differ in one bit.
    for corner in 0..8 {
        for axis in 0..3 {
            if corner >> axis & 1 == 0 {
                canvas.line(corners[corner], corners[corner | 1 << axis]);
            }
        }
    }
    let axis = match view.form {
        MapForm::AcrossLight => 0,
        MapForm::AlongLightY => 1,
        MapForm::AlongLightZ => 2,
        MapForm::Points => return draw_points(field, view, canvas),
    };
    let at = field.min[axis] + (field.max[axis] - field.min[axis]) * view.slice.clamp(0.0, 1.0);
    let slice = canvas.pixels_on_plane(
        |p| field.light.light_from_world(p - field.anchor),
        axis,
        at,
        [field.min, field.max],
    );
    let points: Vec<Vec3> = slice.iter().map(|(_, p)| field.world_from_map(*p)).collect();
    let places = places(field, view, &points);
    for ((pixel, _), place) in slice.into_iter().zip(places) {
        canvas.put(pixel, view.value, place, view.opacity);
    }
    // The edges of the plane.
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let corner = |i: usize| {
        let mut p = Vec3::splat(at);
        for (bit, axis) in others.into_iter().enumerate() {
            p[axis] = if i >> bit & 1 == 0 { field.min[axis] } else { field.max[axis] };
        }
        field.world_from_map(p)
    };
    for [a, b] in [[0, 1], [1, 3], [3, 2], [2, 0]] {
        canvas.line(corner(a), corner(b));
    }
}

/// Draws the map at points where there is hair, from far to near.
fn draw_points(field: &Field, view: &MapView, canvas: &mut Canvas) {
    let extent = field.max - field.min;
    let step = (extent.max_element() / view.points.max(1) as f32).max(1e-6);
    let counts = (extent / step).ceil().max(Vec3::ONE).as_uvec3();
    let mut points = Vec::new();
    for i in 0..counts.x {
        for j in 0..counts.y {
            for k in 0..counts.z {
                let p = field.min + step * (Vec3::new(i as f32, j as f32, k as f32) + 0.5);
                points.push(field.world_from_map(p));
            }
        }
    }
    let range = view.density_range.max(1e-3);
    let dense = field.density(&points).into_iter().map(|density| density > THINNEST * range);
    let points: Vec<Vec3> = points.iter().zip(dense).filter(|(_, dense)| *dense).map(|(p, _)| *p).collect();
    let mut shown: Vec<(Vec3, f32)> = points.iter().copied().zip(places(field, view, &points)).collect();
    let eye = canvas.eye();
    shown.sort_by(|(a, _), (b, _)| b.distance_squared(eye).total_cmp(&a.distance_squared(eye)));
    for (p, place) in shown {
        canvas.disc(p, 0.4 * step, view.value, place, view.opacity);
    }
}

#[cfg(test)]
mod tests;
