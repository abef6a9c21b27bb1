//! The simulator and the body: the field of head and shoulders, and which part of the hair at rest penetrates
//! the body.

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::Simulation;
use crate::colliders::contact::{FIELD, LAYER_HEIGHT};
use crate::colliders::field::{MovingField, PlaneRow};
use crate::colliders::shape::Shape;
use crate::colliders::transformed;
use crate::device::Stamp;
use crate::lanes::{LANES, ZERO3, at, splat3};
use crate::{BodyPart, InsidePoint, SimulationSettings, StepInput};

/// Distance up to which the moving body is measured, metres.
fn reach() -> f32 {
    SimulationSettings::default().skin_margin + LAYER_HEIGHT
}

/// The body with which hair collides, at the end of the last step.
pub struct BodyNow<'a> {
    field: Option<&'a MovingField>,
    /// In head space.
    shapes: Vec<Shape>,
}

impl BodyNow<'_> {
    /// Signed distance in metres from a point of head space to the body, and the normal there. `at_rest` is that of the body at rest, which
    /// moves with the head where the head alone moves the skin. Skin further away than a few centimetres is not measured; the distance of
    /// such points is at least that.
    pub fn distance(&self, p: Vec3, at_rest: (f32, Vec3)) -> (f32, Vec3) {
        let reach = reach();
        let mut nearest = at_rest;
        if let Some(field) = self.field {
            // Other skin may come near a place where only the head has skin at rest.
            let skin = field.skin_near(p, reach);
            nearest = match skin {
                Some(skin) if !field.is_at_rest(p) || skin.0 < at_rest.0 => skin,
                None if !field.is_at_rest(p) => (at_rest.0.max(reach), at_rest.1),
                _ => at_rest,
            };
        }
        for shape in &self.shapes {
            let found = shape.nearest(&splat3(p), &ZERO3);
            if found.distance[0] < nearest.0 {
                nearest = (found.distance[0], (p - at(&found.centre, 0)).normalize_or(nearest.1));
            }
        }
        nearest
    }
}

impl Simulation {
    /// Switches to the field of `input` if it differs from the current one; returns whether the new input has
    /// a field that differs.
    pub(super) fn update_field(&mut self, input: &StepInput) -> bool {
        match input.field {
            None => {
                let had = self.field.take().is_some();
                if had {
                    self.measure_field_distances();
                }
                false
            }
            Some(placed) => {
                let known = self.field.as_ref().is_some_and(|f| f.is(placed.field, placed.pose.lift));
                if !known {
                    self.field = Some(MovingField::new(placed.field, placed.pose.lift, reach()));
                    self.blocks.iter_mut().for_each(|block| block.skin.fill(PlaneRow::NO_SKIN));
                    self.stamps.state = Stamp::new();
                    self.measure_field_distances();
                }
                !known
            }
        }
    }

    /// Places the field at its current pose, without motion.
    pub(super) fn reset_field(&mut self, input: &StepInput) {
        if let (Some(field), Some(placed)) = (&mut self.field, input.field) {
            field.reset(&self.head, placed.pose);
        }
    }

    /// Measures the rest distance of every point to the field.
    pub(super) fn measure_field_distances(&mut self) {
        self.stamps.distances = Stamp::new();
        let field = self.field.as_ref();
        self.blocks.par_iter_mut().for_each(|block| {
            block.field_distance.clear();
            if let Some(field) = field {
                block.field_distance.extend(block.rest.position.iter().map(|row| field.rest_distance(row)));
            }
        });
    }

    /// The body at the end of the last step.
    pub fn body_now(&mut self) -> BodyNow<'_> {
        if let Some(field) = &mut self.field {
            field.find_body(reach());
        }
        let head_from_world: Affine3A = self.head.affine().inverse();
        let shapes =
            self.colliders.iter().filter_map(|c| Shape::new(&transformed(&c.shape, &head_from_world)));
        BodyNow { shapes: shapes.collect(), field: self.field.as_ref() }
    }

    /// Sets whether contact tests that cannot find a contact are skipped (the default). The motion is the
    /// same, bit for bit; switching it off serves to measure the gain.
    pub fn set_contact_culling(&mut self, culling: bool) {
        self.culling = culling;
    }

    /// Current position of a point of a guide, world space, metres; the tip if the guide has fewer points.
    /// `None` if there is no such guide.
    pub fn guide_point(&self, guide: u32, point: u32) -> Option<Vec3> {
        let &(block, lane) = self.slots.get(guide as usize)?;
        let rows = &self.blocks.get(block as usize)?.position;
        let row = rows.get((point as usize).min(rows.len().checked_sub(1)?))?;
        Some(at(row, lane as usize) + self.head.place)
    }

    /// The point of the hairstyle at rest with the deepest penetration into the body, among the points that
    /// the scalp does not carry; `None` if all are outside. Known after the first [`Simulation::reset`].
    pub fn rest_inside(&self) -> Option<InsidePoint> {
        let mut deepest: Option<InsidePoint> = None;
        let first_free = super::first_free(self.clamped_links, self.style.guides.points_per_guide);
        for block in &self.blocks {
            let points = block.points();
            let shapes = block.rest_distance.chunks_exact(points).zip(0_u32..);
            let field = block.field_distance.chunks_exact(points).map(|rows| (rows, FIELD));
            for (rows, collider) in shapes.chain(field) {
                for (point, row) in rows.iter().enumerate().skip(first_free) {
                    for k in 0..LANES.min(block.used) {
                        let depth_m = -row[k];
                        if depth_m > deepest.map_or(0.0, |d| d.depth_m) {
                            let (guide, within) = (block.guides[k], BodyPart::of(collider));
                            deepest = Some(InsidePoint { guide, point: point as u32, depth_m, within });
                        }
                    }
                }
            }
        }
        deepest
    }
}
