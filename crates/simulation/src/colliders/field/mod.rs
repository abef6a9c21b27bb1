//! The field of head and shoulders during one step: points near it are mapped back to the rest pose and
//! measured there.
//!
//! Everything is computed in head space, where the skull never moves: a point above it is at its rest
//! position already. For skin moved by other joints there is a map from current head space to the rest pose
//! for each weighting that occurs, at the start and at the end of the step. In between, the maps are
//! interpolated, and the head itself rotates exactly.
// Loops over lanes contain no branches. A lazy operator is a branch and made the field 7 % slower.
#![allow(clippy::needless_bitwise_bool)]

mod affine;
mod cells;
mod deposit;
mod device;
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
use lovelock_base::simd::Width;
use lovelock_motion::{BodyField, FIELD_JOINTS, FieldPose};

use crate::contents::Stamp;
use crate::lanes::{Lane, Lane3, at, put, splat3};
use crate::motion::{HeadPose, substep};
use affine::Affine;
pub use device::FieldLattices;
use occupancy::Occupancy;
pub(crate) use planes::{FieldRow, PlaneRow};
pub(crate) use search::Search;
pub(crate) use weightings::Joints;
use weightings::Weightings;

/// The iteration stops when a point moves less than this, metres: after a Newton step the remaining error is
/// of second order.
const CONVERGED: f32 = 1e-3;

/// Largest number of iterations.
const ROUNDS: usize = 6;

/// A rest position further than this from the first guess belongs to another part of the skin; in node
/// spacings.
const FURTHEST_FROM_GUESS: f32 = 3.0;

/// Starting points closer than this to a rest position that has been found would lead there again; in node
/// spacings.
const SAME_START: f32 = 1.0;

/// Largest penetration into skin whose position is only a guess, metres.
const GUESSED_DEPTH: f32 = 0.002;

/// A larger penetration means that the point was mapped to the wrong part of the skin, metres.
const IMPLAUSIBLE_DEPTH: f32 = 0.02;

/// Smallest determinant of the Newton matrix; below it the skin is folded too much to be inverted.
const LEAST_DETERMINANT: f32 = 0.05;

/// The constants of the field by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 8] = [
    ("CONVERGED", CONVERGED as f64),
    ("ROUNDS", ROUNDS as f64),
    ("FURTHEST_FROM_GUESS", FURTHEST_FROM_GUESS as f64),
    ("SAME_START", SAME_START as f64),
    ("GUESSED_DEPTH", GUESSED_DEPTH as f64),
    ("IMPLAUSIBLE_DEPTH", IMPLAUSIBLE_DEPTH as f64),
    ("LEAST_DETERMINANT", LEAST_DETERMINANT as f64),
    ("NEAR", planes::NEAR as f64),
];

/// A field and its motion during the current step.
#[derive(Clone, Debug)]
pub struct MovingField {
    stamp: Stamp,
    field: Arc<BodyField>,
    lift: f32,
    weightings: Weightings,
    /// The joints at the start and at the end of the step, and the inverse maps of all weightings at both
    /// times.
    joints_before: Joints,
    joints: Joints,
    before: Vec<Affine>,
    now: Vec<Affine>,
    occupancy: Occupancy,
    /// For each cell of nodes, by its first node: whether all eight are moved by the head alone.
    head_alone: Vec<bool>,
    inv_spacing: f32,
    inv_node: f32,
    dt_secs: f32,
}

impl MovingField {
    /// A field at rest around the head. Hair may touch it within `reach`, metres.
    pub(crate) fn new(field: &Arc<BodyField>, lift: f32, reach: f32) -> Self {
        let weightings = Weightings::new(field.slots());
        let (joints, mut now) = (Joints::default(), Vec::new());
        weightings.inverse_maps(Width::widest(), &joints, &mut now);
        Self {
            stamp: Stamp::new(),
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

    /// Whether this is the given field with the given lift.
    pub(crate) fn is(&self, field: &Arc<BodyField>, lift: f32) -> bool {
        Arc::ptr_eq(&self.field, field) && self.lift == lift
    }

    /// Position of the head in the rest pose, world space.
    pub(crate) fn head_at_rest(&self) -> Vec3 {
        self.field.rest_from_head()
    }

    /// Rest distance of every lane of a row in head space; [`f32::MAX`] outside the field.
    pub(crate) fn rest_distance(&self, row: &Lane3) -> Lane {
        // Must agree with [`MovingField::measure_head_skin`], or hair would be pushed at its rest position.
        Lane(std::array::from_fn(|k| {
            self.field
                .sample(at(row, k))
                .map_or(f32::MAX, |(d, slope)| d / slope.length().clamp(0.5, 2.0) - self.lift)
        }))
    }

    /// Advances from the end of the last step to `pose`.
    pub(crate) fn advance(
        &mut self,
        head: &HeadPose,
        pose: &FieldPose,
        reach: f32,
        dt_secs: f32,
        culling: bool,
    ) {
        std::mem::swap(&mut self.before, &mut self.now);
        std::mem::swap(&mut self.joints_before, &mut self.joints);
        self.dt_secs = dt_secs;
        self.joints = self.joints_at(head, pose);
        self.weightings.inverse_maps(Width::widest(), &self.joints, &mut self.now);
        let ends = [&self.joints_before, &self.joints];
        self.occupancy.update(Width::widest(), self.lift.max(0.0) + reach + planes::NEAR, ends, culling);
    }

    /// Restarts at `pose`.
    pub(crate) fn reset(&mut self, head: &HeadPose, pose: &FieldPose) {
        self.joints = self.joints_at(head, pose);
        self.weightings.inverse_maps(Width::widest(), &self.joints, &mut self.now);
        self.before.clone_from(&self.now);
        self.joints_before.clone_from(&self.joints);
        self.occupancy.discard_end();
    }

    /// Number of weightings, at least 1 (the head's); distinguishes fields from each other.
    pub(crate) fn weightings(&self) -> u32 {
        self.field.slots().len().max(1) as u32
    }

    /// The joints relative to the head: the whole motion that the next step starts with.
    pub(crate) const fn joints(&self) -> &Joints {
        &self.joints
    }

    /// Finds the body at the end of the last step, for [`MovingField::skin_near`].
    pub(crate) fn find_body(&mut self, reach: f32) {
        let ends = [&self.joints, &self.joints];
        self.occupancy.update(Width::widest(), self.lift.max(0.0) + reach + planes::NEAR, ends, true);
    }

    /// Distance from the skin near a point of head space at the end of the last step, and its normal; `None` if there is none within
    /// `reach`. Needs [`MovingField::find_body`].
    pub(crate) fn skin_near(&self, p: Vec3, reach: f32) -> Option<(f32, Vec3)> {
        let identity = HeadPose::IDENTITY;
        let here = substep(&identity, &identity, Vec3::ZERO, self.dt_secs);
        let mut planes = PlaneRow::unknown(PlaneRow::NO_SKIN);
        // Nothing is searched for lanes that are not numbers.
        let mut alone = splat3(Vec3::NAN);
        put(&mut alone, 0, p);
        let row = self.row(&alone, &here, 1.0, reach, &mut planes)?;
        // Skin that is only guessed is at least that deep.
        let is_deep = row.guess[0] > 0.0 && row.distance[0] < 0.0;
        let distance = if is_deep { -IMPLAUSIBLE_DEPTH } else { row.distance[0] };
        (distance < reach).then(|| (distance, at(&row.normal, 0)))
    }

    /// Whether the head alone moves the skin at a point of head space: it is there as it is at rest.
    pub(crate) fn is_at_rest(&self, p: Vec3) -> bool {
        self.is_moved_by_head_alone(p).0
    }

    /// Restores the joints returned by [`MovingField::joints`].
    pub(crate) fn set_joints(&mut self, joints: Joints) {
        self.occupancy.discard_end();
        self.joints = joints;
        self.weightings.inverse_maps(Width::widest(), &self.joints, &mut self.now);
    }

    /// The joints of `pose` relative to the head.
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

/// For each node, whether it and the seven nodes after it are moved by the head alone.
fn head_alone(field: &BodyField) -> Vec<bool> {
    let (lattice, slots) = (field.node_lattice(), field.slot_of_node());
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let offsets = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    (0..slots.len()).map(|i| offsets.iter().all(|o| slots.get(i + o).is_none_or(|&slot| slot == 0))).collect()
}
