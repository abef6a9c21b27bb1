//! Weightings of a field's joints, sixteen at a time: maps from the rest pose to head space, and back.
// `unsafe` is used by the macro, which calls functions that require CPU features after checking for them.
#![allow(unsafe_code)]

use glam::Affine3A;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use lovelock_motion::{FIELD_JOINTS, FieldWeights};

use super::affine::Affine;
use crate::lanes::{LANES, Lane, Lane3, ZERO, row_barrier, transposed};

/// Smallest volume of skin as a fraction of its rest volume. Flatter skin cannot be inverted and is left at
/// rest.
const LEAST_VOLUME: f32 = 1e-3;

/// Largest sum of the absolute numbers of a usable map, metres.
const LARGEST_MAP: f32 = 1e6;

/// Weightings of a field's joints, [`LANES`] in a row.
#[derive(Clone, Debug)]
pub(super) struct Weightings {
    rows: Vec<Row>,
    /// The weights of each row's joints, concatenated.
    weights: Vec<Lane>,
}

/// A row of weightings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Index of its first weight.
    first: usize,
    /// One bit per joint that any lane uses.
    joints: u32,
    /// The weights of the first joint, the head.
    head: Lane,
}

/// The joints of a field, each from the rest pose to head space.
#[derive(Clone, Debug)]
pub(crate) struct Joints {
    all: [Affine3A; FIELD_JOINTS],
    /// The same as plain numbers, zero where a joint is not finite, and one bit per joint that is not.
    numbers: [[f32; 12]; FIELD_JOINTS],
    lost: u32,
}

impl Joints {
    /// The first joint is the head, which stays at rest.
    pub(crate) fn new(mut all: [Affine3A; FIELD_JOINTS]) -> Self {
        all[0] = Affine3A::IDENTITY;
        let (mut numbers, mut lost) = ([[0.0; 12]; FIELD_JOINTS], 0);
        for (j, joint) in all.iter().enumerate() {
            // Zero times NaN would be NaN.
            if joint.is_finite() {
                numbers[j] = joint.to_cols_array();
            } else {
                lost |= 1 << j;
            }
        }
        Self { all, numbers, lost }
    }

    pub(crate) const fn all(&self) -> &[Affine3A; FIELD_JOINTS] {
        &self.all
    }
}

impl Default for Joints {
    fn default() -> Self {
        Self::new([Affine3A::IDENTITY; FIELD_JOINTS])
    }
}

impl Weightings {
    pub(super) fn new(all: &[FieldWeights]) -> Self {
        let (mut rows, mut weights) = (Vec::new(), Vec::new());
        for all in all.chunks(LANES) {
            let of = |j: usize| {
                let mut lane = ZERO;
                for (own, weights) in lane.0.iter_mut().zip(all) {
                    // Invalid weights count as zero.
                    *own = if weights[j] > 0.0 { weights[j] } else { 0.0 };
                }
                lane
            };
            let mut row = Row { first: weights.len(), joints: 0, head: of(0) };
            for j in 0..FIELD_JOINTS {
                let lane = of(j);
                if lane.iter().any(|&weight| weight > 0.0) {
                    row.joints |= 1 << j;
                    weights.push(lane);
                }
            }
            rows.push(row);
        }
        Self { rows, weights }
    }

    pub(super) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The inverse map, from head space to the rest pose, of each weighting; rows are padded. The first is
    /// the head's own and is exactly the identity.
    pub(super) fn inverse_maps(&self, width: Width, joints: &Joints, out: &mut Vec<Affine>) {
        out.resize(self.rows.len() * LANES, Affine::IDENTITY);
        invert_all(width, self, joints, out);
        // Exact to the last bit.
        out.first_mut().into_iter().for_each(|head| *head = Affine::IDENTITY);
    }

    /// The maps of a row from the rest pose to head space, three numbers per column; the identity where there
    /// is none, or where it cannot be inverted.
    #[inline(always)]
    pub(super) fn mixed(&self, row: &Row, joints: &Joints) -> [Lane; 12] {
        let (mut map, mut valid) = ([ZERO; 12], [true; LANES]);
        let (mut left, mut next) = (row.joints, row.first);
        while left != 0 {
            let j = left.trailing_zeros() as usize % FIELD_JOINTS;
            left &= left - 1;
            let weight = self.weights[next];
            next += 1;
            for (lane, number) in map.iter_mut().zip(&joints.numbers[j]) {
                *lane = lane.plus(weight.times(Lane::splat(*number)));
                row_barrier();
            }
            let lost = joints.lost >> j & 1 != 0;
            for k in 0..LANES {
                valid[k] &= !(lost & (weight[k] > 0.0));
            }
        }
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz, ..] = map;
        let (volume, mut size) = (dot(&[zx, zy, zz], &cross(&[xx, xy, xz], &[yx, yy, yz])), ZERO);
        for number in &map {
            for k in 0..LANES {
                size[k] += number[k].abs();
            }
            row_barrier();
        }
        let mut all = true;
        for k in 0..LANES {
            valid[k] &= (volume[k].abs() > LEAST_VOLUME) & (size[k] < LARGEST_MAP);
            all &= valid[k];
        }
        if !all {
            for (n, number) in map.iter_mut().enumerate() {
                let rest = if n % 4 == 0 && n < 9 { 1.0 } else { 0.0 };
                for k in 0..LANES {
                    number[k] = if valid[k] { number[k] } else { rest };
                }
            }
        }
        map
    }
}

simd_versions! {
    /// [`Weightings::inverse_maps`].
    fn invert_all(weightings: &Weightings, joints: &Joints, out: &mut [Affine]) -> () {
        for (row, out) in weightings.rows.iter().zip(out.as_chunks_mut().0) {
            invert(&weightings.mixed(row, joints), &row.head, out);
        }
    }
}

/// Writes the inverse maps of a row, with the head's weights.
#[inline(always)]
fn invert(map: &[Lane; 12], head: &Lane, out: &mut [Affine; LANES]) {
    let [xx, xy, xz, yx, yy, yz, zx, zy, zz, shift @ ..] = map;
    let (x, y, z) = ([*xx, *xy, *xz], [*yx, *yy, *yz], [*zx, *zy, *zz]);
    let rows = [cross(&y, &z), cross(&z, &x), cross(&x, &y)];
    let mut inv = dot(&z, &rows[2]);
    for k in 0..LANES {
        inv[k] = 1.0 / inv[k];
    }
    let rows = rows.map(|row| row.map(|number| number.times(inv)));
    let away = rows.map(|row| ZERO.minus(dot(&row, shift)));
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = rows;
    let columns = [xx, yx, zx, xy, yy, zy, xz, yz, zz, away[0], away[1], away[2]];
    let mut numbers = [ZERO; LANES];
    for (n, column) in columns.into_iter().enumerate() {
        numbers[n / 3 * 4 + n % 3] = column;
    }
    numbers[LANES - 1] = *head;
    let numbers = transposed(&numbers);
    for k in 0..LANES {
        out[k] = Affine::from(numbers[k]);
    }
}

#[inline(always)]
fn cross(a: &Lane3, b: &Lane3) -> Lane3 {
    [
        a[1].times(b[2]).minus_product(b[1], a[2]),
        a[2].times(b[0]).minus_product(b[2], a[0]),
        a[0].times(b[1]).minus_product(b[0], a[1]),
    ]
}

#[inline(always)]
fn dot(a: &Lane3, b: &Lane3) -> Lane {
    a[0].times(b[0]).plus(a[1].times(b[1])).plus(a[2].times(b[2]))
}
