//! The simulator and the body: the field of head and shoulders, and which part of the hair at rest penetrates
//! the body.

use glam::Vec3;
use rayon::prelude::*;

use super::Simulation;
use crate::colliders::contact::{FIELD, LAYER_HEIGHT};
use crate::colliders::field::{MovingField, PlaneRow};
use crate::lanes::{LANES, at};
use crate::{BodyPart, InsidePoint, SimulationSettings, StepInput};

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
                    let reach = SimulationSettings::default().skin_margin + LAYER_HEIGHT;
                    self.field = Some(MovingField::new(placed.field, placed.pose.lift, reach));
                    self.blocks.iter_mut().for_each(|block| block.skin.fill(PlaneRow::NO_SKIN));
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
        let field = self.field.as_ref();
        self.blocks.par_iter_mut().for_each(|block| {
            block.field_distance.clear();
            if let Some(field) = field {
                block.field_distance.extend(block.rest.position.iter().map(|row| field.rest_distance(row)));
            }
        });
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
