//! The field of head and shoulders in one step: points near it are taken back to rest and measured there.
//!
//! All of it happens in head space, where the skull never moves: a point over it is at rest where it is now.
//! What the other joints move has a map from head space now to rest for each weighting that occurs, at the
//! start and at the end of the step; in between, maps are mixed, and the head itself turns exactly.
// Loops over lanes hold no branches: a lazy operator is one, and made the field 7 % slower.
#![allow(clippy::needless_bitwise_bool)]

mod affine;
mod cells;
mod deposit;
mod measure;
mod occupancy;
mod planes;
mod rows;
mod search;
mod skins;
#[cfg(test)]
mod tests;
mod weightings;

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::simd::Width;
use lovelock_motion::{BodyField, FIELD_JOINTS, FieldPose};

use crate::lanes::{Lane, Lane3, at};
use crate::motion::HeadPose;
use affine::Affine;
use occupancy::Occupancy;
pub(crate) use planes::{FieldRow, PlaneRow};
pub(crate) use search::Search;
pub(crate) use weightings::Joints;
use weightings::Weightings;

/// A point taken back to rest is near enough when it moves less than this in a round, metres: after a step of
/// Newton's what is left is of second order.
const SETTLED: f32 = 1e-3;

/// Most rounds of taking a point back.
const ROUNDS: usize = 6;

/// A way back that ends further from the first guess than this leads to another part of the skin, spacings of
/// nodes.
const STRAYED: f32 = 3.0;

/// A way back that begins closer than this to a place that another has found leads there too, spacings of
/// nodes.
const CLOSE: f32 = 1.0;

/// Nothing is deeper than this in skin of which only a guess is known, metres.
const UNSURE: f32 = 0.002;

/// What seems deeper than this has rather been taken back to the wrong part of the skin, metres.
const DEEP: f32 = 0.02;

/// Where the skin is folded more than this it has no way back: the least determinant of how it unfolds.
const UNFOLDED: f32 = 0.05;

/// A field with its motion in the present step.
#[derive(Clone, Debug)]
pub(crate) struct MovingField {
    field: Arc<BodyField>,
    lift: f32,
    weightings: Weightings,
    /// Where the joints are at the start and at the end of the step, and from there the ways of all
    /// weightings back to rest.
    joints_before: Joints,
    joints: Joints,
    before: Vec<Affine>,
    now: Vec<Affine>,
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
        let weightings = Weightings::new(field.slots());
        let (joints, mut now) = (Joints::default(), Vec::new());
        weightings.ways_back(Width::widest(), &joints, &mut now);
        Self {
            lift,
            weightings,
            joints_before: joints.clone(),
            joints,
            before: now.clone(),
            now,
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
        std::mem::swap(&mut self.joints_before, &mut self.joints);
        self.dt_secs = dt_secs;
        self.joints = self.joints_at(head, pose);
        self.weightings.ways_back(Width::widest(), &self.joints, &mut self.now);
        let ends = [&self.joints_before, &self.joints];
        self.occupancy.update(Width::widest(), self.lift.max(0.0) + reach + planes::NEAR, ends, spare);
    }

    /// Starts anew at `pose`.
    pub(crate) fn reset(&mut self, head: &HeadPose, pose: &FieldPose) {
        self.joints = self.joints_at(head, pose);
        self.weightings.ways_back(Width::widest(), &self.joints, &mut self.now);
        self.before.clone_from(&self.now);
        self.joints_before.clone_from(&self.joints);
        self.occupancy.forget();
    }

    /// How many weightings it has, at least the head's: other fields have others.
    pub(crate) fn weightings(&self) -> u32 {
        self.field.slots().len().max(1) as u32
    }

    /// Where the joints are against the head: all of the motion that the next step begins with.
    pub(crate) const fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Puts the joints where [`MovingField::joints`] had them.
    pub(crate) fn set_joints(&mut self, joints: Joints) {
        self.occupancy.forget();
        self.joints = joints;
        self.weightings.ways_back(Width::widest(), &self.joints, &mut self.now);
    }

    /// Where `pose` has the joints against the head.
    fn joints_at(&self, head: &HeadPose, pose: &FieldPose) -> Joints {
        let head_from_world = head.affine().inverse();
        let rest_from_head = Affine3A::from_translation(self.field.rest_from_head());
        let mut joints = [Affine3A::IDENTITY; FIELD_JOINTS];
        for (joint, world_from_rest) in joints.iter_mut().zip(&pose.world_from_rest).skip(1) {
            *joint = head_from_world * *world_from_rest * rest_from_head;
        }
        Joints::new(joints)
    }
}

/// For each node whether it and the seven after it are the head's.
fn head_alone(field: &BodyField) -> Vec<bool> {
    let (lattice, slots) = (field.node_lattice(), field.slot_of_node());
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let offsets = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    (0..slots.len()).map(|i| offsets.iter().all(|o| slots.get(i + o).is_none_or(|&slot| slot == 0))).collect()
}
