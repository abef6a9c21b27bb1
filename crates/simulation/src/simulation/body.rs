//! The simulator and the body: the field of head and shoulders, and what of the hair at rest is inside.

use glam::Vec3;
use rayon::prelude::*;

use super::Simulation;
use crate::colliders::contact::{FIELD, LAYER_HEIGHT};
use crate::colliders::field::{MovingField, PlaneRow};
use crate::lanes::{LANES, at};
use crate::{BodyPart, InsidePoint, SimulationSettings, StepInput};

impl Simulation {
    /// Takes up the field of `input` where it is another one than before; whether it was.
    pub(super) fn meet_field(&mut self, input: &StepInput) -> bool {
        match input.field {
            None => {
                let had = self.field.take().is_some();
                if had {
                    self.learn_field_distances();
                }
                false
            }
            Some(placed) => {
                let known = self.field.as_ref().is_some_and(|f| f.is(placed.field, placed.pose.lift));
                if !known {
                    let reach = SimulationSettings::default().skin_margin + LAYER_HEIGHT;
                    self.field = Some(MovingField::new(placed.field, placed.pose.lift, reach));
                    self.blocks.iter_mut().for_each(|block| block.skin.fill(PlaneRow::NO_SKIN));
                    self.learn_field_distances();
                }
                !known
            }
        }
    }

    /// Puts the field where it is now, without motion.
    pub(super) fn reset_field(&mut self, input: &StepInput) {
        if let (Some(field), Some(placed)) = (&mut self.field, input.field) {
            field.reset(&self.head, placed.pose);
        }
    }

    /// Measures how far every point at rest is from the field at rest.
    pub(super) fn learn_field_distances(&mut self) {
        let field = self.field.as_ref();
        self.blocks.par_iter_mut().for_each(|block| {
            block.field_distance.clear();
            if let Some(field) = field {
                block.field_distance.extend(block.rest.position.iter().map(|row| field.rest_distance(row)));
            }
        });
    }

    /// Whether tests against the body that cannot find a contact are left out, as they are at first. The motion is
    /// the same, bit for bit; this is to measure what is gained.
    pub fn spare_contacts(&mut self, spare: bool) {
        self.spare = spare;
    }

    /// Where a point of a guide is now, world space, metres; the guide's tip where it has fewer points. `None` where there is no
    /// such guide.
    pub fn guide_point(&self, guide: u32, point: u32) -> Option<Vec3> {
        let &(block, lane) = self.slots.get(guide as usize)?;
        let rows = &self.blocks.get(block as usize)?.position;
        let row = rows.get((point as usize).min(rows.len().checked_sub(1)?))?;
        Some(at(row, lane as usize) + self.head.place)
    }

    /// The point of the hairstyle at rest that is deepest inside the body, among those that the scalp does not carry;
    /// `None` where all are outside. Known from the first [`Simulation::reset`] on.
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
