//! Rows of points in the field at rest: which nodes are around, and how far the skin is. Over the skin that goes with the
//! head a point is at rest wherever it is now.

use glam::Vec3;
use lovelock_groom::simd::whole_part;
use lovelock_motion::FieldLattice;

use super::MovingField;
use super::planes::NONE;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, choose, greater, inv_sqrt, lesser, put};
use crate::trilinear::{gradient, weights};

/// What a row of points learns of the skin that goes with the head.
#[derive(Clone, Debug)]
pub(super) struct Heads {
    /// Whether the head alone moves the skin there; where it does not, the rest says nothing.
    pub(super) alone: [bool; LANES],
    /// Distance, metres; [`NONE`] where it is too far to be of interest.
    pub(super) distance: Lane,
    pub(super) normal: Lane3,
    /// How far the skin is at least, metres; [`NONE`] where the field ends.
    pub(super) nearest: Lane,
}

/// Distances at rest of a row, and their gradients.
pub(super) struct AtRest {
    /// Whether it was asked for, and is in the field; elsewhere the rest says nothing.
    pub(super) there: [bool; LANES],
    pub(super) value: Lane,
    pub(super) slope: Lane3,
}

impl MovingField {
    /// Measures the lanes of a row in head space that `asked` names against the skin that goes with the head; nothing
    /// further than `reach` is of interest.
    #[inline(always)]
    pub(super) fn heads(&self, row: &Lane3, asked: &[bool; LANES], reach: f32) -> Heads {
        let mut out =
            Heads { alone: [false; LANES], distance: ZERO, normal: ZERO3, nearest: Lane::splat(NONE) };
        let nodes = Places::new(self.field.node_lattice(), self.inv_node, row);
        for k in 0..LANES {
            // A place that is not inside has no node.
            out.alone[k] = asked[k] && self.head_alone.get(nodes.first[k] as usize).is_some_and(|&own| own);
        }
        let at_rest = self.at_rest(row, &out.alone);
        for k in 0..LANES {
            let (value, there) = (at_rest.value[k], at_rest.there[k]);
            let (normal, steepness) = normal_of(at(&at_rest.slope, k));
            let distance = value / lesser(greater(steepness, 0.5), 2.0) - self.lift;
            put(&mut out.normal, k, normal);
            let far = value - self.lift > 2.0 * reach;
            let at_least = if far { 0.5 * value - self.lift } else { distance };
            out.distance[k] = if far | !there { NONE } else { distance };
            out.nearest[k] = if there { at_least } else { NONE };
        }
        out
    }

    /// Whether the head alone moves the skin at `p`, if it is where it is at rest; and whether that is in the field.
    #[inline(always)]
    pub(super) fn is_heads(&self, p: Vec3) -> (bool, bool) {
        let lattice = self.field.node_lattice();
        let (q, last) = ((p - lattice.low) * self.inv_node, (lattice.size - 1).as_vec3());
        // What is not a number is outside.
        let inside = q.cmpge(Vec3::ZERO).all() && q.cmplt(last).all();
        (inside && self.head_alone[lattice.index(q.as_uvec3())], inside)
    }

    /// Measures the lanes of a row of places at rest that `asked` names.
    #[inline(always)]
    pub(super) fn at_rest(&self, row: &Lane3, asked: &[bool; LANES]) -> AtRest {
        let lattice = self.field.distance_lattice();
        let places = Places::new(lattice, self.inv_spacing, row);
        let (all, mut corners) = (self.field.distances(), [ZERO; 8]);
        let (up, behind) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
        let mut out = AtRest { there: [false; LANES], value: ZERO, slope: ZERO3 };
        for k in 0..LANES {
            let first = places.first[k] as usize;
            if !asked[k] || first >= all.len() {
                continue;
            }
            out.there[k] = true;
            for (n, offset) in [0, up, behind, behind + up].into_iter().enumerate() {
                let pair = &all[first + offset..first + offset + 2];
                (corners[2 * n][k], corners[2 * n + 1][k]) = (pair[0], pair[1]);
            }
        }
        for k in 0..LANES {
            let (d, f) = (std::array::from_fn(|n| corners[n][k]), at(&places.fraction, k));
            let mut value = 0.0;
            for (d, weight) in d.iter().zip(weights(f)) {
                value += d * weight;
            }
            out.value[k] = value;
            put(&mut out.slope, k, gradient(&d, f) * self.inv_spacing);
        }
        out
    }
}

/// The direction of a gradient, and how steep it is.
#[inline(always)]
pub(super) fn normal_of(slope: Vec3) -> (Vec3, f32) {
    let squared = slope.length_squared();
    let inv = inv_sqrt(squared);
    let steepness = squared * inv;
    (choose(steepness <= 1e-6, Vec3::Y, slope * inv), steepness)
}

/// Where the points of a row are between the points of a lattice.
pub(super) struct Places {
    /// The first of the eight around each; [`u32::MAX`] where the lattice ends.
    pub(super) first: [u32; LANES],
    pub(super) fraction: Lane3,
}

impl Places {
    #[inline(always)]
    pub(super) fn new(lattice: &FieldLattice, inv_spacing: f32, row: &Lane3) -> Self {
        let mut out = Self { first: [u32::MAX; LANES], fraction: ZERO3 };
        let (size, last) = (lattice.size, (lattice.size - 1).as_vec3());
        for k in 0..LANES {
            let q = (at(row, k) - lattice.low) * inv_spacing;
            // Written so that what is not a number is outside.
            let within = |q: f32, last: f32| (q >= 0.0) & (q < last);
            let inside = within(q.x, last.x) & within(q.y, last.y) & within(q.z, last.z);
            let (x, y, z) = (whole_part(q.x) as u32, whole_part(q.y) as u32, whole_part(q.z) as u32);
            let first = (z.wrapping_mul(size.y).wrapping_add(y)).wrapping_mul(size.x).wrapping_add(x);
            out.first[k] = if inside { first } else { u32::MAX };
            put(&mut out.fraction, k, q - Vec3::new(x as f32, y as f32, z as f32));
        }
        out
    }
}
