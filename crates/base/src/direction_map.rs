//! Values over all directions from a middle, as a square image: painted masks.

use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{Vec2, Vec3};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A painted mask. It belongs to directions from the middle of the head and not to vertices, so it suits any head.
///
/// The directions are unfolded onto a square as an octahedron. Values are bytes, 255 for 1, row after row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DirectionMap(Arc<[u8]>);

impl Default for DirectionMap {
    fn default() -> Self {
        Self(Arc::new([]))
    }
}

impl DirectionMap {
    /// Texels along each side.
    pub const SIDE: usize = 128;
    const TEXELS: usize = Self::SIDE * Self::SIDE;

    /// Bytes of memory that this has and `other` does not share with it.
    pub fn bytes_beside(&self, other: Option<&Self>) -> u64 {
        if other.is_some_and(|other| Arc::ptr_eq(&self.0, &other.0)) { 0 } else { self.0.len() as u64 }
    }

    /// Whether nothing was painted.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|&value| value == 0)
    }

    /// The mask in a direction from the middle of the head, 0 to 1, interpolated between four texels.
    pub fn at(&self, direction: Vec3) -> f32 {
        if self.0.is_empty() {
            return 0.0;
        }
        let spot = unfold(direction) * Self::SIDE as f32 - Vec2::splat(0.5);
        let (low, part) = (spot.floor(), spot - spot.floor());
        let texel = |dx: i32, dy: i32| f32::from(self.0[texel_index(low.x as i32 + dx, low.y as i32 + dy)]);
        let row = |dy| texel(0, dy) * (1.0 - part.x) + texel(1, dy) * part.x;
        (row(0) * (1.0 - part.y) + row(1) * part.y) / 255.0
    }

    /// Paints: `paint` gets the direction of each texel, a unit vector, with its value, and returns the new value, 0 to 1.
    pub fn paint(&mut self, paint: impl Fn(Vec3, f32) -> f32) {
        let old = if self.0.is_empty() { vec![0; Self::TEXELS] } else { self.0.to_vec() };
        let new = old.into_iter().enumerate().map(|(i, value)| {
            let spot = Vec2::new((i % Self::SIDE) as f32 + 0.5, (i / Self::SIDE) as f32 + 0.5);
            let painted = paint(fold(spot / Self::SIDE as f32), f32::from(value) / 255.0);
            (painted.clamp(0.0, 1.0) * 255.0).round() as u8
        });
        self.0 = new.collect();
    }
}

/// The texel at a place that may lie one texel outside: the octahedron goes on there, mirrored about the middle of the side.
fn texel_index(x: i32, y: i32) -> usize {
    let side = DirectionMap::SIDE as i32;
    let (mut x, mut y) = (x, y);
    if !(0..side).contains(&x) {
        (x, y) = (x.clamp(0, side - 1), side - 1 - y);
    }
    if !(0..side).contains(&y) {
        (x, y) = (side - 1 - x, y.clamp(0, side - 1));
    }
    (y.clamp(0, side - 1) * side + x.clamp(0, side - 1)) as usize
}

/// The place of a direction in the unit square; the middle is up.
fn unfold(direction: Vec3) -> Vec2 {
    let sum = direction.x.abs() + direction.y.abs() + direction.z.abs();
    if sum <= 0.0 || !sum.is_finite() {
        return Vec2::splat(0.5);
    }
    let flat = Vec2::new(direction.x, direction.z) / sum;
    let folded = if direction.y < 0.0 { (Vec2::ONE - flat.yx().abs()) * sign(flat) } else { flat };
    folded * 0.5 + Vec2::splat(0.5)
}

/// The direction at a place of the unit square, a unit vector.
fn fold(place: Vec2) -> Vec3 {
    let flat = place * 2.0 - Vec2::ONE;
    let up = 1.0 - flat.x.abs() - flat.y.abs();
    let flat = if up < 0.0 { (Vec2::ONE - flat.yx().abs()) * sign(flat) } else { flat };
    Vec3::new(flat.x, up, flat.y).normalize_or(Vec3::Y)
}

/// 1 or -1 of each number; 1 of 0.
fn sign(v: Vec2) -> Vec2 {
    Vec2::new(if v.x < 0.0 { -1.0 } else { 1.0 }, if v.y < 0.0 { -1.0 } else { 1.0 })
}

use glam::Vec2Swizzles as _;

impl Serialize for DirectionMap {
    /// LZ4, then base 64: a painted mask is a few kilobytes of text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let packed = if self.0.is_empty() { Vec::new() } else { lz4_flex::compress(&self.0) };
        serializer.serialize_str(&STANDARD.encode(packed))
    }
}

impl<'de> Deserialize<'de> for DirectionMap {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        if text.is_empty() {
            return Ok(Self::default());
        }
        let packed =
            STANDARD.decode(&text).map_err(|error| D::Error::custom(format!("a painted mask: {error}")))?;
        let mut values = vec![0; Self::TEXELS];
        match lz4_flex::decompress_into(&packed, &mut values) {
            Ok(Self::TEXELS) => Ok(Self(values.into())),
            Ok(found) => {
                Err(D::Error::custom(format!("a painted mask of {found} texels; must be {}", Self::TEXELS)))
            }
            Err(error) => Err(D::Error::custom(format!("a painted mask: {error}"))),
        }
    }
}
