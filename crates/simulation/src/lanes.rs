//! Rows of numbers, one per guide of a block.
//!
//! The hot loops are written for one guide, over `0..LANES`, on rows copied into locals. The compiler turns
//! each such loop into vector instructions of any width, and no lane depends on another.

use std::ops::{Deref, DerefMut};

use glam::{Mat3, Mat4, Quat, Vec3, Vec4};

/// Number of guides in a block.
pub(crate) const LANES: usize = 16;

/// One number per guide of a block, aligned for a single load by the widest registers.
#[repr(align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lane(pub(crate) [f32; LANES]);

impl Lane {
    /// The same number in every lane.
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// `self - a b`, lane by lane.
    #[inline(always)]
    pub(crate) fn minus_product(self, a: Self, b: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] -= a.0[k] * b.0[k];
        }
        out
    }

    /// `self + a`, lane by lane.
    #[inline(always)]
    pub(crate) fn plus(self, a: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] += a.0[k];
        }
        out
    }

    /// `self - a`, lane by lane.
    #[inline(always)]
    pub(crate) fn minus(self, a: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] -= a.0[k];
        }
        out
    }

    /// `self a`, lane by lane.
    #[inline(always)]
    pub(crate) fn times(self, a: Self) -> Self {
        let mut out = self;
        for k in 0..LANES {
            out.0[k] *= a.0[k];
        }
        out
    }
}

impl Deref for Lane {
    type Target = [f32; LANES];

    #[inline(always)]
    fn deref(&self) -> &[f32; LANES] {
        &self.0
    }
}

impl DerefMut for Lane {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f32; LANES] {
        &mut self.0
    }
}

/// One vector per guide of a block, component by component.
pub(crate) type Lane3 = [Lane; 3];

/// Zero in every lane.
pub(crate) const ZERO: Lane = Lane::splat(0.0);

/// The zero vector in every lane.
pub(crate) const ZERO3: Lane3 = [ZERO; 3];

/// Ends an iteration of a loop over independent rows. Without it the compiler may process several rows at
/// once, lane by lane, which needs a gather for every load.
#[inline(always)]
pub(crate) fn row_barrier() {
    std::hint::black_box(());
}

/// The same vector in every lane.
pub(crate) const fn splat3(v: Vec3) -> Lane3 {
    [Lane::splat(v.x), Lane::splat(v.y), Lane::splat(v.z)]
}

/// Transposes a square of rows and lanes.
#[inline(always)]
pub(crate) fn transposed(rows: &[Lane; LANES]) -> [Lane; LANES] {
    let mut out = [ZERO; LANES];
    for r in (0..LANES).step_by(4) {
        for k in (0..LANES).step_by(4) {
            let part = |n: usize| Vec4::from_slice(&rows[r + n][k..]);
            let square = Mat4::from_cols(part(0), part(1), part(2), part(3)).transpose();
            for n in 0..4 {
                square.col(n).write_to_slice(&mut out[k + n][r..]);
            }
        }
    }
    out
}

/// Reduces a row to one number: combines its halves by `of`, then the halves of the result, and so on.
#[inline(always)]
pub(crate) fn fold(row: Lane, of: impl Fn(f32, f32) -> f32) -> f32 {
    let (mut row, mut half) = (row, LANES / 2);
    while half > 0 {
        for k in 0..half {
            row[k] = of(row[k], row[k + half]);
        }
        half /= 2;
    }
    row[0]
}

/// The vector of lane `k`.
#[inline(always)]
pub(crate) fn at(row: &Lane3, k: usize) -> Vec3 {
    Vec3::new(row[0][k], row[1][k], row[2][k])
}

/// Writes the vector of lane `k`.
#[inline(always)]
pub(crate) fn put(row: &mut Lane3, k: usize, v: Vec3) {
    row[0][k] = v.x;
    row[1][k] = v.y;
    row[2][k] = v.z;
}

/// The smaller number; the first if one is NaN. Compiles to one instruction, unlike `f32::min`.
#[inline(always)]
pub(crate) fn lesser(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// The greater number; the first if one is NaN.
#[inline(always)]
pub(crate) fn greater(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// Inverse square root of a number from 0 to the largest, to two units in the last place; finite for 0.
///
/// An estimate from the exponent, a Newton step with adjusted constants, and a step of third order. CPUs
/// pipeline sums and products but not roots and quotients, so this is several times faster, and unlike their
/// own estimates it gives the same bits everywhere.
#[inline(always)]
pub(crate) fn inv_sqrt(x: f32) -> f32 {
    let x = lesser(x, f32::MAX);
    // NaN may have a sign.
    let guess = f32::from_bits(0x5f1f_fff9_u32.wrapping_sub(x.to_bits() >> 1));
    let near = guess * (1.681_914_1 - 0.703_952_25 * x * guess * guess);
    let off = 1.0 - x * near * near;
    near + near * off * (0.5 + 0.375 * off)
}

/// The first vector if `first` is true, otherwise the second, without a branch.
#[inline(always)]
pub(crate) fn choose(first: bool, a: Vec3, b: Vec3) -> Vec3 {
    let pick = |a: f32, b: f32| if first { a } else { b };
    Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z))
}

/// The unit vector along `v`, and the length of `v`; a vector too short to have a direction gives `fallback`.
#[inline(always)]
pub(crate) fn direction_or(v: Vec3, fallback: Vec3) -> (Vec3, f32) {
    let squared = v.length_squared();
    let scale = inv_sqrt(squared);
    let ok = squared > 1e-24;
    (choose(ok, v * scale, fallback), squared * scale)
}

/// A rotation as a unit quaternion of plain numbers. `glam::Quat` is itself a vector register and would
/// prevent the compiler from vectorising over lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    v: Vec3,
    w: f32,
}

impl Turn {
    pub(crate) fn new(q: Quat) -> Self {
        Self { v: Vec3::new(q.x, q.y, q.z), w: q.w }
    }

    /// The quaternion: x, y, z, w.
    pub(crate) fn numbers(self) -> [f32; 4] {
        [self.v.x, self.v.y, self.v.z, self.w]
    }

    /// Rotates `a` (by q a q*).
    #[inline(always)]
    pub(crate) fn apply(self, a: Vec3) -> Vec3 {
        let t = 2.0 * self.v.cross(a);
        a + self.w * t + self.v.cross(t)
    }

    /// This rotation followed by the smallest rotation that carries the unit vector `from` to the unit vector
    /// `to`.
    #[inline(always)]
    pub(crate) fn then_smallest(self, from: Vec3, to: Vec3) -> Self {
        // The half-vector form. Opposite vectors have no smallest rotation and get one close to half a turn.
        let (v, w) = (from.cross(to), greater(1.0 + from.dot(to), 1e-4));
        let turned_w = w * self.w - v.dot(self.v);
        let turned_v = w * self.v + self.w * v + v.cross(self.v);
        let scale = inv_sqrt(turned_w * turned_w + turned_v.length_squared());
        Self { v: turned_v * scale, w: turned_w * scale }
    }

    /// As [`Turn::then_smallest`], exact for opposite vectors too: about some axis square to them.
    pub(crate) fn then_exact(self, from: Vec3, to: Vec3) -> Self {
        if from.dot(to) > -0.99 {
            return self.then_smallest(from, to);
        }
        let axis = from.any_orthonormal_vector();
        let half = Self { v: self.w * axis + axis.cross(self.v), w: -axis.dot(self.v) };
        half.then_smallest(-from, to)
    }
}

/// A row of rotations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turns {
    v: Lane3,
    w: Lane,
}

impl Turns {
    pub(crate) fn splat(turn: Turn) -> Self {
        Self { v: splat3(turn.v), w: Lane::splat(turn.w) }
    }

    #[inline(always)]
    pub(crate) fn at(&self, k: usize) -> Turn {
        Turn { v: at(&self.v, k), w: self.w[k] }
    }

    #[inline(always)]
    pub(crate) fn put(&mut self, k: usize, turn: Turn) {
        put(&mut self.v, k, turn.v);
        self.w[k] = turn.w;
    }
}

/// A rigid or affine map of plain numbers, for loops over lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Map {
    pub(crate) turn: Mat3,
    pub(crate) shift: Vec3,
}

impl Map {
    pub(crate) const IDENTITY: Self = Self { turn: Mat3::IDENTITY, shift: Vec3::ZERO };

    #[inline(always)]
    pub(crate) fn apply(&self, p: Vec3) -> Vec3 {
        self.turn.x_axis * p.x + self.turn.y_axis * p.y + self.turn.z_axis * p.z + self.shift
    }

    #[inline(always)]
    pub(crate) fn rotate(&self, v: Vec3) -> Vec3 {
        self.turn.x_axis * v.x + self.turn.y_axis * v.y + self.turn.z_axis * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_rotation_carries_one_direction_to_the_other_and_keeps_their_axis() {
        let (from, to) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 1.0, 0.0));
        let turn = Turn::new(Quat::IDENTITY).then_smallest(from, to);
        // Unit vectors in f32: a few roundings of 6e-8.
        assert!((turn.apply(from) - to).length() < 1e-6);
        let axis = from.cross(to);
        assert!((turn.apply(axis) - axis).length() < 1e-6);
        assert!((turn.apply(to) - to).length() > 0.1, "the identity would pass the assertions above");
    }

    #[test]
    fn transposing_swaps_rows_and_lanes() {
        let rows: [Lane; LANES] =
            std::array::from_fn(|r| Lane(std::array::from_fn(|k| (LANES * r + k) as f32)));
        let lanes = transposed(&rows);
        for (k, lane) in lanes.iter().enumerate() {
            assert_eq!(lane.0, std::array::from_fn(|r| (LANES * r + k) as f32), "lane {k}");
        }
    }

    #[test]
    fn inv_sqrt_is_right_to_two_units_in_the_last_place() {
        let mut worst = 0.0_f64;
        for i in 0..200_000 {
            // All exponents from 1e-24 to 1e24, and values in between.
            let x = 10.0_f32.powf(-24.0 + 48.0 * i as f32 / 200_000.0);
            worst = worst.max((f64::from(inv_sqrt(x)) * f64::from(x).sqrt() - 1.0).abs());
        }
        assert!(worst < 2.0 * f64::from(f32::EPSILON), "{worst:e}");
        assert!(worst > 0.25 * f64::from(f32::EPSILON), "nothing is that exact");
        assert!(inv_sqrt(0.0).is_finite());
        assert!((0.0..1e-18).contains(&inv_sqrt(f32::INFINITY)), "infinity counts as the largest number");
        assert!(inv_sqrt(-f32::NAN).is_nan(), "NaN does not panic");
    }

    #[test]
    fn rotations_compose_in_order() {
        let q = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
        let (a, to) = (Vec3::new(0.0, 0.6, -0.8), Vec3::new(1.0, 0.0, 0.0));
        let both = Turn::new(q).then_smallest(q * a, to);
        assert!((both.apply(a) - to).length() < 1e-6);
    }

    #[test]
    fn opposite_directions_give_a_finite_rotation() {
        let turn = Turn::new(Quat::IDENTITY).then_smallest(Vec3::X, Vec3::NEG_X);
        assert!(turn.apply(Vec3::new(1.0, 2.0, 3.0)).is_finite());
    }

    #[test]
    fn opposite_directions_are_carried_exactly() {
        let q = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
        for off in [0.0, 1e-6, 1e-4, 1e-3, 0.05] {
            let from = q * Vec3::new(0.0, 0.6, -0.8);
            let to = (-from + off * from.any_orthonormal_vector()).normalize_or(from);
            let turn = Turn::new(q).then_exact(from, to);
            assert!((turn.apply(Vec3::new(0.0, 0.6, -0.8)) - to).length() < 1e-6, "{off}");
        }
        let smallest = Turn::new(Quat::IDENTITY).then_smallest(Vec3::X, Vec3::NEG_X);
        assert!(
            (smallest.apply(Vec3::X) - Vec3::NEG_X).length() > 1.0,
            "control: the quick one is not exact"
        );
    }

    #[test]
    fn a_vector_without_a_direction_takes_the_fallback() {
        assert_eq!(direction_or(Vec3::ZERO, Vec3::Y), (Vec3::Y, 0.0));
        let (d, length) = direction_or(Vec3::new(0.0, 0.0, 5.0), Vec3::Y);
        assert_eq!((d, length), (Vec3::Z, 5.0));
    }
}
