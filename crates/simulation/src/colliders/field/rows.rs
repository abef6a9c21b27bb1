//! Rows of points in the field at rest: the nodes around them, and their distance to the skin. Over skin that
//! moves with the head a point is at its rest position already.

use glam::Vec3;
use lovelock_base::simd::whole_part;
use lovelock_motion::FieldLattice;

use super::MovingField;
use super::planes::NONE;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, choose, greater, inv_sqrt, lesser, put};
use crate::trilinear::{gradient, weights};

/// Skin that moves with the head, around a row of points.
#[derive(Clone, Debug)]
pub(super) struct HeadSkinRow {
    /// Whether the head alone moves the skin there; if not, the other values have no meaning.
    pub(super) alone: [bool; LANES],
    /// Distance, metres; [`NONE`] beyond reach.
    pub(super) distance: Lane,
    pub(super) normal: Lane3,
    /// Lower bound of the distance, metres; [`NONE`] outside the field.
    pub(super) nearest: Lane,
}

/// Rest distances of a row, and their gradients.
pub(super) struct RestDistances {
    /// Whether the lane was asked for and is in the field; if not, the other values have no meaning.
    pub(super) there: [bool; LANES],
    pub(super) value: Lane,
    pub(super) slope: Lane3,
}

impl MovingField {
    /// Measures the `asked` lanes of a row in head space against skin that moves with the head. Skin further
    /// away than `reach` is ignored.
    #[inline(always)]
    pub(super) fn measure_head_skin(&self, row: &Lane3, asked: &[bool; LANES], reach: f32) -> HeadSkinRow {
        let mut out =
            HeadSkinRow { alone: [false; LANES], distance: ZERO, normal: ZERO3, nearest: Lane::splat(NONE) };
        let nodes = Places::new(self.field.node_lattice(), self.inv_node, row);
        for k in 0..LANES {
            // A point outside has no node.
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

    /// Whether the head alone moves the skin at `p`, if `p` is a rest position, and whether `p` is in the
    /// field.
    #[inline(always)]
    pub(super) fn is_moved_by_head_alone(&self, p: Vec3) -> (bool, bool) {
        let lattice = self.field.node_lattice();
        let (q, last) = ((p - lattice.low) * self.inv_node, (lattice.size - 1).as_vec3());
        // NaN is outside.
        let inside = q.cmpge(Vec3::ZERO).all() && q.cmplt(last).all();
        (inside && self.head_alone[lattice.index(q.as_uvec3())], inside)
    }

    /// Measures the `asked` lanes of a row of rest positions.
    #[inline(always)]
    pub(super) fn at_rest(&self, row: &Lane3, asked: &[bool; LANES]) -> RestDistances {
        let lattice = self.field.distance_lattice();
        let places = Places::new(lattice, self.inv_spacing, row);
        let (all, mut corners) = (self.field.distances(), [ZERO; 8]);
        let (up, behind) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
        let mut out = RestDistances { there: [false; LANES], value: ZERO, slope: ZERO3 };
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

/// The direction of a gradient, and its length.
#[inline(always)]
pub(super) fn normal_of(slope: Vec3) -> (Vec3, f32) {
    let squared = slope.length_squared();
    let inv = inv_sqrt(squared);
    let steepness = squared * inv;
    (choose(steepness <= 1e-6, Vec3::Y, slope * inv), steepness)
}

/// Positions of a row of points in a lattice.
pub(super) struct Places {
    /// Index of the first of the eight lattice points around each; [`u32::MAX`] outside the lattice.
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
            // Written so that NaN is outside.
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
