//! The field of head and shoulders in one step: points near it are taken back to rest and measured there.
//!
//! All of it happens in head space, where the skull never moves: a point over it is at rest where it is now. What
//! the other joints move has a map from head space now to rest for each weighting that occurs, at the start and at
//! the end of the step; in between, maps are mixed, and the head itself turns exactly.
// Loops over lanes hold no branches: a lazy operator is one, and made the field 7 % slower.
#![allow(clippy::needless_bitwise_bool)]

mod back;
mod occupancy;
mod planes;
mod rows;
mod skins;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Vec3};
use lovelock_motion::{BodyField, FieldPose};
use rayon::prelude::*;

use crate::lanes::{Lane, Lane3, at};
use crate::motion::HeadPose;
use back::Back;
use occupancy::Occupancy;
pub(crate) use planes::{FieldRow, PlaneRow};

/// A point taken back to rest is near enough when it moves less than this in a round, metres: after a step of Newton's what is
/// left is of second order.
const SETTLED: f32 = 1e-3;

/// Most rounds of taking a point back.
const ROUNDS: usize = 6;

/// A way back that ends further from the first guess than this leads to another part of the skin, spacings of nodes.
const STRAYED: f32 = 3.0;

/// A way back that begins closer than this to a place that another has found leads there too, spacings of nodes.
const CLOSE: f32 = 1.0;

/// Nothing is deeper than this in skin of which only a guess is known, metres.
const UNSURE: f32 = 0.002;

/// What seems deeper than this has rather been taken back to the wrong part of the skin, metres.
const DEEP: f32 = 0.02;

/// Where the skin is folded more than this it has no way back: the least determinant of how it unfolds.
const UNFOLDED: f32 = 0.05;

/// Weightings that a task works out at least.
const SLOTS_A_TASK: usize = 512;

/// A field with its motion in the present step.
#[derive(Clone, Debug)]
pub(crate) struct MovingField {
    field: Arc<BodyField>,
    lift: f32,
    /// For each slot, at the start and at the end of the step; the first is the head's and never changes.
    before: Vec<Back>,
    now: Vec<Back>,
    /// The other way, from rest to head space.
    forth_before: Vec<Affine3A>,
    forth: Vec<Affine3A>,
    occupancy: Occupancy,
    /// For each cell of nodes, by its first: whether all eight are the head's.
    head_alone: Vec<bool>,
    inv_spacing: f32,
    inv_node: f32,
    dt_secs: f32,
}

impl MovingField {
    /// A field at rest around the head. `reach` is the distance within which hair may touch it, metres.
    pub(crate) fn new(field: &Arc<BodyField>, lift: f32, reach: f32) -> Self {
        let slots = field.slots().len();
        Self {
            lift,
            before: vec![Back::IDENTITY; slots],
            now: vec![Back::IDENTITY; slots],
            forth_before: vec![Affine3A::IDENTITY; slots],
            forth: vec![Affine3A::IDENTITY; slots],
            occupancy: Occupancy::new(field, lift.max(0.0) + reach + planes::NEAR),
            head_alone: head_alone(field),
            inv_spacing: 1.0 / field.distance_lattice().spacing,
            inv_node: 1.0 / field.node_lattice().spacing,
            dt_secs: 1.0,
            field: Arc::clone(field),
        }
    }

    /// Whether this is the field that is wanted.
    pub(crate) fn is(&self, field: &Arc<BodyField>, lift: f32) -> bool {
        Arc::ptr_eq(&self.field, field) && self.lift == lift
    }

    /// Where the head is at rest, in the world of the rest pose.
    pub(crate) fn head_at_rest(&self) -> Vec3 {
        self.field.rest_from_head()
    }

    /// Distance at rest of every lane of a row in head space; [`f32::MAX`] where the field ends.
    pub(crate) fn rest_distance(&self, row: &Lane3) -> Lane {
        // As [`MovingField::heads`] measures it: else hair would be pushed where it lies at rest.
        Lane(std::array::from_fn(|k| {
            self.field
                .sample(at(row, k))
                .map_or(f32::MAX, |(d, slope)| d / slope.length().clamp(0.5, 2.0) - self.lift)
        }))
    }

    /// Goes on from where the last step ended to `pose`.
    pub(crate) fn advance(
        &mut self,
        head: &HeadPose,
        pose: &FieldPose,
        reach: f32,
        dt_secs: f32,
        spare: bool,
    ) {
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.forth_before, &mut self.forth);
        self.dt_secs = dt_secs;
        self.learn(head, pose);
        self.occupancy.update(
            self.lift.max(0.0) + reach + planes::NEAR,
            [&self.forth_before, &self.forth],
            spare,
        );
    }

    /// Starts anew at `pose`.
    pub(crate) fn reset(&mut self, head: &HeadPose, pose: &FieldPose) {
        self.learn(head, pose);
        self.before.copy_from_slice(&self.now);
        self.forth_before.copy_from_slice(&self.forth);
        self.occupancy.forget();
    }

    /// Where the parts of the skin are against the head: all of the motion that the next step begins with.
    pub(crate) fn places(&self) -> &[Affine3A] {
        &self.forth
    }

    /// Puts the parts where [`MovingField::places`] had them; whether they are as many and can be there.
    pub(crate) fn set_places(&mut self, places: &[Affine3A]) -> bool {
        let backs = || places.iter().map(Affine3A::inverse);
        if places.len() != self.forth.len() || !backs().all(|back| back.is_finite()) {
            return false;
        }
        self.forth.copy_from_slice(places);
        self.occupancy.forget();
        let slots = self.field.slots().iter().zip(backs()).zip(&mut self.now);
        for ((weights, back), now) in slots.skip(1) {
            *now = Back::new(&back, weights[0]);
        }
        true
    }

    /// Works out `now` and `forth`.
    fn learn(&mut self, head: &HeadPose, pose: &FieldPose) {
        let head_from_world = head.affine().inverse();
        let rest_from_head = Affine3A::from_translation(self.field.rest_from_head());
        let mut joints = [Affine3A::IDENTITY; lovelock_motion::FIELD_JOINTS];
        for (joint, world_from_rest) in joints.iter_mut().zip(&pose.world_from_rest).skip(1) {
            *joint = head_from_world * *world_from_rest * rest_from_head;
        }
        let slots = self.field.slots().par_iter().zip(&mut self.forth).zip(&mut self.now);
        slots.skip(1).with_min_len(SLOTS_A_TASK).for_each(|((weights, forth), now)| {
            let mut map = Affine3A { matrix3: Mat3A::ZERO, translation: glam::Vec3A::ZERO };
            for (&weight, joint) in weights.iter().zip(&joints) {
                if weight > 0.0 {
                    map.matrix3 += joint.matrix3 * weight;
                    map.translation += joint.translation * weight;
                }
            }
            let back = map.inverse();
            // A skin folded flat has no way back; it is left at rest.
            let sound = map.is_finite() && back.is_finite() && back.matrix3.determinant().abs() < 1e3;
            let (map, back) = if sound { (map, back) } else { (Affine3A::IDENTITY, Affine3A::IDENTITY) };
            *forth = map;
            *now = Back::new(&back, weights[0]);
        });
    }
}

/// For each node whether it and the seven after it are the head's.
fn head_alone(field: &BodyField) -> Vec<bool> {
    let (lattice, slots) = (field.node_lattice(), field.slot_of_node());
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let offsets = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    (0..slots.len()).map(|i| offsets.iter().all(|o| slots.get(i + o).is_none_or(|&slot| slot == 0))).collect()
}
