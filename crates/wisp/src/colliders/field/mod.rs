//! The field of head and shoulders in one step: points near it are taken back to rest and measured there.
//!
//! All of it happens in head space, where the skull never moves: a point over it is at rest where it is now. What
//! the other joints move has a map from head space now to rest for each weighting that occurs, at the start and at
//! the end of the step; in between, maps are mixed, and the head itself turns exactly.

mod occupancy;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{Affine3A, Mat3A, UVec3, Vec3};
use lovelock_motion::{BodyField, FieldLattice, FieldPose};

use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, put};
use crate::motion::HeadPose;
use crate::solver::Substep;
use occupancy::{Candidates, Occupancy};

/// Radius of the sphere that stands for the surface where hair touches it, metres: nearly a plane.
const FLAT: f32 = 1.0;

/// A point taken back to rest is near enough when it moves less than this in a round, metres.
const SETTLED: f32 = 3e-4;

/// Most rounds of taking a point back.
const ROUNDS: usize = 6;

/// A way back that ends further from the first guess than this leads to another part of the skin, spacings of nodes.
const STRAYED: f32 = 3.0;

/// Nothing is deeper than this in skin of which only a guess is known, metres.
const UNSURE: f32 = 0.002;

/// What seems deeper than this has rather been taken back to the wrong part of the skin, metres.
const DEEP: f32 = 0.02;

/// Where the skin is folded more than this it has no way back: the least determinant of how it unfolds.
const UNFOLDED: f32 = 0.05;

/// The way back to rest of one weighting: a matrix by columns, a shift, and the head's share of the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
struct Back([f32; 16]);

impl Back {
    const IDENTITY: Self =
        Self([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);

    fn new(m: &Affine3A, head: f32) -> Self {
        let mut out = [0.0; 16];
        out[..12].copy_from_slice(&m.to_cols_array());
        out[12] = head;
        Self(out)
    }

    #[inline(always)]
    fn add(&mut self, other: &Self, weight: f32) {
        for (sum, value) in self.0.iter_mut().zip(&other.0) {
            *sum += weight * value;
        }
    }

    #[inline(always)]
    fn apply(&self, p: Vec3) -> Vec3 {
        let m = &self.0;
        Vec3::new(
            m[0] * p.x + m[3] * p.y + m[6] * p.z + m[9],
            m[1] * p.x + m[4] * p.y + m[7] * p.z + m[10],
            m[2] * p.x + m[5] * p.y + m[8] * p.z + m[11],
        )
    }

    /// The transpose of the matrix times a vector: gradients at rest become gradients now.
    #[inline(always)]
    fn turn_forth(&self, v: Vec3) -> Vec3 {
        let m = &self.0;
        Vec3::new(
            m[0] * v.x + m[1] * v.y + m[2] * v.z,
            m[3] * v.x + m[4] * v.y + m[5] * v.z,
            m[6] * v.x + m[7] * v.y + m[8] * v.z,
        )
    }
}

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

/// What one point learns of the field, in head space.
#[derive(Clone, Copy, Debug)]
struct Touch {
    distance: f32,
    normal: Vec3,
    /// The head's share of the skin there.
    head: f32,
    /// Velocity of the skin against the head, metres per second.
    drift: Vec3,
}

/// What a row of points learns of the field, in working space; lanes far from it have [`f32::MAX`] for a distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub(crate) distance: Lane,
    pub(crate) normal: Lane3,
    pub(crate) head: Lane,
    /// Velocity of the skin, metres per second.
    pub(crate) velocity: Lane3,
}

impl FieldRow {
    /// The sphere that stands for the surface near lane `k`, a point of which is at `p`.
    #[inline(always)]
    pub(crate) fn sphere(&self, k: usize, p: Vec3) -> (Vec3, f32) {
        (p - at(&self.normal, k) * (self.distance[k] + FLAT), FLAT)
    }
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
            occupancy: Occupancy::new(field, lift.max(0.0) + reach),
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

    /// Distance at rest of every lane of a row in head space; [`f32::MAX`] where the field ends.
    pub(crate) fn rest_distance(&self, row: &Lane3) -> Lane {
        // As `try_from` measures it: else hair would be pushed where it lies at rest.
        std::array::from_fn(|k| {
            self.field
                .sample(at(row, k))
                .map_or(f32::MAX, |(d, slope)| d / slope.length().clamp(0.5, 2.0) - self.lift)
        })
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
        self.occupancy.update(self.lift.max(0.0) + reach, [&self.forth_before, &self.forth], spare);
    }

    /// Starts anew at `pose`.
    pub(crate) fn reset(&mut self, head: &HeadPose, pose: &FieldPose) {
        self.learn(head, pose);
        self.before.copy_from_slice(&self.now);
        self.forth_before.copy_from_slice(&self.forth);
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
        for (slot, weights) in self.field.slots().iter().enumerate().skip(1) {
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
            self.forth[slot] = map;
            self.now[slot] = Back::new(&back, weights[0]);
        }
    }

    /// What a row of points in working space learns at the end of substep `s` of `count`; nothing further away than
    /// `reach` is of interest, nor are lanes that are not `wanted`. `None` where all lanes are far.
    #[inline(always)]
    pub(crate) fn row(
        &self,
        row: &Lane3,
        substep: &Substep,
        t: f32,
        reach: f32,
        wanted: &[bool; LANES],
    ) -> Option<FieldRow> {
        let Map { turn, shift } = substep.head;
        let mut local = ZERO3;
        for k in 0..LANES {
            let p = at(row, k) - shift;
            put(&mut local, k, Vec3::new(turn.x_axis.dot(p), turn.y_axis.dot(p), turn.z_axis.dot(p)));
        }
        let mut out = FieldRow { distance: [f32::MAX; LANES], normal: ZERO3, head: ZERO, velocity: ZERO3 };
        let mut any = false;
        for k in 0..LANES {
            if !wanted[k] {
                continue;
            }
            let p = at(&local, k);
            let Some(near) = self.occupancy.at(p) else { continue };
            let Some(touch) = self.touch(p, near, t, reach) else { continue };
            any = true;
            out.distance[k] = touch.distance;
            out.head[k] = touch.head;
            put(&mut out.normal, k, substep.head.rotate(touch.normal));
            put(&mut out.velocity, k, substep.rigid_velocity(at(row, k)) + substep.head.rotate(touch.drift));
        }
        any.then_some(out)
    }

    /// The nearer of the skin that goes with the head and the skin that the other joints move.
    #[inline(always)]
    fn touch(&self, p: Vec3, near: Candidates, t: f32, reach: f32) -> Option<Touch> {
        let head = if near.head { self.try_from(p, p, 0, t, reach) } else { None };
        let Some(slot) = near.slot else { return head };
        let guess = mixed(&self.before[slot], &self.now[slot], t).apply(p);
        match (head, self.try_from(p, guess, slot, t, reach)) {
            (Some(a), Some(b)) => Some(if b.distance < a.distance { b } else { a }),
            (a, b) => a.or(b),
        }
    }

    /// Takes `p` back to rest from a first guess of where that is, and measures there.
    ///
    /// Wanted is `X = V(X)`, where `V` mixes what the weightings of the eight nodes around `X` make of `p`. Newton's
    /// iteration, `(1 - V') dX = V - X`, goes where a plain one would swing to and fro: around a raised arm. Where the
    /// skin is so folded that it finds nothing near by, the weighting `slot` of the guess alone says where the point is.
    #[inline(always)]
    fn try_from(&self, p: Vec3, guess: Vec3, slot: usize, t: f32, reach: f32) -> Option<Touch> {
        let nodes = self.field.node_lattice();
        let mut rest = guess;
        let mut settled = false;
        let (mut slots, mut fraction, mut stretch) = ([0_u16; 8], Vec3::ZERO, Mat3A::IDENTITY);
        for _ in 0..ROUNDS {
            let (corners, within) = around(nodes, self.inv_node, rest)?;
            if self.head_alone[corners[0]] {
                let there = rest == p;
                (rest, slots, stretch, settled) = (p, [0; 8], Mat3A::IDENTITY, true);
                if there {
                    break;
                }
                // Only if that is where it is.
                let (corners, _) = around(nodes, self.inv_node, p)?;
                settled = self.head_alone[corners[0]];
                break;
            }
            let all = self.field.slot_of_node();
            for (slot, &c) in slots.iter_mut().zip(&corners) {
                *slot = all[c];
            }
            fraction = within;
            stretch = Mat3A::IDENTITY;
            let first = usize::from(slots[0]);
            let next = if slots == [slots[0]; 8] {
                if first == 0 { p } else { mixed(&self.before[first], &self.now[first], t).apply(p) }
            } else {
                let mut back = [Vec3::ZERO; 8];
                for (v, &slot) in back.iter_mut().zip(&slots) {
                    let (a, b) =
                        (self.before[usize::from(slot)].apply(p), self.now[usize::from(slot)].apply(p));
                    *v = a + (b - a) * t;
                }
                let mut value = Vec3::ZERO;
                for (v, weight) in back.iter().zip(weights(fraction)) {
                    value += *v * weight;
                }
                let along = [0, 1, 2].map(|axis| gradient(&back.map(|v| v[axis]), fraction) * self.inv_node);
                // Rows of V' are the gradients of its components.
                let slope = Mat3A::from_cols(along[0].into(), along[1].into(), along[2].into()).transpose();
                let left = Mat3A::IDENTITY - slope;
                // Where the skin is folded over itself there is no way back that keeps its sides apart.
                if left.determinant() < UNFOLDED {
                    value
                } else {
                    stretch = left.inverse();
                    let step = Vec3::from(stretch * glam::Vec3A::from(value - rest));
                    rest + step.clamp_length_max(nodes.spacing)
                }
            };
            let moved = (next - rest).length_squared();
            rest = next;
            if moved < SETTLED * SETTLED {
                settled = true;
                break;
            }
        }
        let strayed = (rest - guess).length_squared() > (STRAYED * nodes.spacing).powi(2);
        let sure = settled && !strayed;
        if !sure {
            if slot == 0 {
                return None;
            }
            (rest, slots, stretch) = (guess, [slot as u16; 8], Mat3A::IDENTITY);
        }
        let lattice = self.field.distance_lattice();
        let (corners, within) = around(lattice, self.inv_spacing, rest)?;
        let (all, weight, mut d, mut value) = (self.field.distances(), weights(within), [0.0; 8], 0.0);
        for i in 0..8 {
            d[i] = all[corners[i]];
            value += d[i] * weight[i];
        }
        // A stretched skin is further away than it was at rest, by half at most.
        if value - self.lift > 2.0 * reach {
            return None;
        }
        let at_rest = gradient(&d, within) * self.inv_spacing;
        if slots == [0; 8] {
            let steepness = at_rest.length_squared().sqrt();
            let distance = value / steepness.clamp(0.5, 2.0) - self.lift;
            let normal = if steepness > 1e-6 { at_rest * (1.0 / steepness) } else { Vec3::Y };
            return (distance < reach).then_some(Touch { distance, normal, head: 1.0, drift: Vec3::ZERO });
        }
        let (mut start, mut end) = (Back([0.0; 16]), Back([0.0; 16]));
        for (&slot, weight) in slots.iter().zip(weights(fraction)) {
            start.add(&self.before[usize::from(slot)], weight);
            end.add(&self.now[usize::from(slot)], weight);
        }
        let back = mixed(&start, &end, t);
        // The chain rule: dX = (1 - V')^-1 B dx.
        let slope = back.turn_forth(Vec3::from(stretch.transpose() * glam::Vec3A::from(at_rest)));
        let steepness = slope.length_squared().sqrt();
        let normal = if steepness > 1e-6 { slope * (1.0 / steepness) } else { Vec3::Y };
        let distance = value / steepness.clamp(0.5, 2.0) - self.lift;
        // A guess may push, but not far; nor may skin that is stretched or pressed beyond what skin can be, or that
        // hair has never been so deep in.
        let sound = sure && (0.5..2.0).contains(&steepness) && distance > -DEEP;
        let distance = if sound { distance } else { distance.max(-UNSURE) };
        let drift = back.turn_forth(start.apply(p) - end.apply(p)) * (1.0 / self.dt_secs);
        (distance < reach).then_some(Touch { distance, normal, head: back.0[12], drift })
    }
}

/// For each node whether it and the seven after it are the head's.
fn head_alone(field: &BodyField) -> Vec<bool> {
    let (lattice, slots) = (field.node_lattice(), field.slot_of_node());
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let offsets = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    (0..slots.len()).map(|i| offsets.iter().all(|o| slots.get(i + o).is_none_or(|&slot| slot == 0))).collect()
}

#[inline(always)]
fn mixed(a: &Back, b: &Back, t: f32) -> Back {
    let mut out = Back([0.0; 16]);
    for i in 0..16 {
        out.0[i] = a.0[i] + (b.0[i] - a.0[i]) * t;
    }
    out
}

/// The eight points of a lattice around a place, x fastest, and where between them it is.
#[inline(always)]
fn around(lattice: &FieldLattice, inv_spacing: f32, p: Vec3) -> Option<([usize; 8], Vec3)> {
    let q = (p - lattice.low) * inv_spacing;
    let last = lattice.size - 1;
    // Written so that what is not a number is outside.
    let inside = q.x >= 0.0
        && q.y >= 0.0
        && q.z >= 0.0
        && q.x < last.x as f32
        && q.y < last.y as f32
        && q.z < last.z as f32;
    if !inside {
        return None;
    }
    let cell = UVec3::new(q.x as u32, q.y as u32, q.z as u32);
    let first = lattice.index(cell);
    let (row, layer) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
    let mut corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1];
    for corner in &mut corners {
        *corner += first;
    }
    Some((corners, q - cell.as_vec3()))
}

/// Trilinear weights of the points that [`around`] gives.
#[inline(always)]
fn weights(f: Vec3) -> [f32; 8] {
    let g = Vec3::ONE - f;
    let (a, b, c, d) = (g.y * g.z, f.y * g.z, g.y * f.z, f.y * f.z);
    [g.x * a, f.x * a, g.x * b, f.x * b, g.x * c, f.x * c, g.x * d, f.x * d]
}

/// Gradient of the trilinear interpolant of eight values, per cell.
#[inline(always)]
fn gradient(v: &[f32; 8], f: Vec3) -> Vec3 {
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let square = |a: f32, b: f32, c: f32, d: f32, s: f32, t: f32| mix(mix(a, b, s), mix(c, d, s), t);
    Vec3::new(
        square(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6], f.y, f.z),
        square(v[2] - v[0], v[3] - v[1], v[6] - v[4], v[7] - v[5], f.x, f.z),
        square(v[4] - v[0], v[5] - v[1], v[6] - v[2], v[7] - v[3], f.x, f.y),
    )
}
