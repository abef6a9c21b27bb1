//! The axes of a light's maps, and where a light stands.

use glam::{Quat, Vec3};

use crate::LightArea;

/// The place from which light spreads in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSource {
    /// World space, metres.
    pub position: Vec3,
    /// Radius of what shines, metres; at least [`LightSource::LEAST_RADIUS`] is used. Hair within it casts no shadow.
    pub radius: f32,
}

impl LightSource {
    /// The smallest radius in use, metres.
    pub const LEAST_RADIUS: f32 = 1e-3;

    /// The radius in its usable range.
    pub(crate) fn safe_radius(&self) -> f32 {
        if self.radius > Self::LEAST_RADIUS { self.radius.min(1e3) } else { Self::LEAST_RADIUS }
    }
}

/// Right-handed orthonormal axes along a light, in world space (`y × z = x`).
///
/// Create the first frame with [`LightFrame::new`] and follow a moving light with [`LightFrame::transported`]: axes computed
/// from each direction alone jump somewhere on the sphere, and the whole map jumps with them. A light that stands somewhere has
/// the axes of [`LightFrame::standing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFrame {
    /// Direction in which the light travels, unit length (the paper's *L*, also ω); of a light that stands somewhere, from it
    /// to the hair.
    pub x: Vec3,
    /// First axis across the light.
    pub y: Vec3,
    /// Second axis across the light.
    pub z: Vec3,
    /// Where the light stands; `None` for a directional light, which is infinitely far away.
    pub source: Option<LightSource>,
    /// The area from which light comes.
    pub area: LightArea,
}

impl LightFrame {
    /// The axes of the world.
    pub const WORLD: Self = Self { x: Vec3::X, y: Vec3::Y, z: Vec3::Z, source: None, area: LightArea::HARD };

    /// Axes for light that travels along `direction` (of any length; a zero vector becomes straight down).
    ///
    /// Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    pub fn new(direction: Vec3) -> Self {
        let x = direction.normalize_or(Vec3::NEG_Y);
        let sign = 1.0_f32.copysign(x.z);
        let a = -1.0 / (sign + x.z);
        let b = x.x * x.y * a;
        let y = Vec3::new(1.0 + sign * x.x * x.x * a, sign * b, -sign * x.x);
        let z = Vec3::new(b, sign + x.y * x.y * a, -x.y);
        Self { x, y, z, source: None, area: LightArea::HARD }
    }

    /// The axes of a light at `source`: these axes rotated by the smallest rotation so that the first one points at `anchor`.
    ///
    /// They depend on nothing but the arguments, so that an image of a light that stands still does not depend on how many were
    /// drawn before it. They roll only where the light travels opposite to the first of these axes.
    pub fn standing(&self, source: LightSource, anchor: Vec3) -> Self {
        Self { source: Some(source), ..self.transported(anchor - source.position) }
    }

    /// These axes rotated to another direction by the smallest rotation, which adds no roll: a small change of the light rotates
    /// the map by a small angle. A zero vector changes nothing.
    pub fn transported(&self, direction: Vec3) -> Self {
        let x = direction.normalize_or(self.x);
        if x == self.x {
            // Exactly the same axes, so that an image does not depend on how many were drawn before it.
            return *self;
        }
        let y = Quat::from_rotation_arc(self.x, x) * self.y;
        // Orthonormalise, because rounding errors would accumulate over a long drag.
        match (y - y.dot(x) * x).try_normalize() {
            Some(y) => Self { x, y, z: x.cross(y), ..*self },
            None => Self { source: self.source, area: self.area, ..Self::new(x) },
        }
    }

    /// The direction in which the light travels at `p`, unit length.
    pub fn way_at(&self, p: Vec3) -> Vec3 {
        self.source.map_or(self.x, |source| (p - source.position).normalize_or(self.x))
    }

    /// The same light in coordinates whose origin is `anchor`.
    pub(crate) fn seen_from(&self, anchor: Vec3) -> Self {
        let moved = |source: LightSource| LightSource { position: source.position - anchor, ..source };
        Self { source: self.source.map(moved), ..*self }
    }

    /// Transforms a vector from world space into the axes of the light.
    pub fn light_from_world(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// Transforms a vector from the axes of the light into world space.
    pub fn world_from_light(&self, v: Vec3) -> Vec3 {
        v.x * self.x + v.y * self.y + v.z * self.z
    }
}

impl Default for LightFrame {
    /// Light from straight above.
    fn default() -> Self {
        Self::new(Vec3::NEG_Y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_orthonormal(frame: &LightFrame) {
        // A few units in the last place of 1.
        let close = |a: f32, b: f32| (a - b).abs() < 2e-6;
        assert!(close(frame.x.length(), 1.0) && close(frame.y.length(), 1.0) && close(frame.z.length(), 1.0));
        assert!(close(frame.x.dot(frame.y), 0.0) && close(frame.y.dot(frame.z), 0.0));
        assert!((frame.y.cross(frame.z) - frame.x).length() < 4e-6, "left-handed: {frame:?}");
    }

    fn directions() -> impl Iterator<Item = Vec3> {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let spiral = (0..500).map(|i| {
            let (z, a) = (1.0 - (i as f32 + 0.5) / 250.0, i as f32 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            3.0 * Vec3::new(r * a.cos(), r * a.sin(), z)
        });
        axes.into_iter().chain(spiral)
    }

    #[test]
    fn a_light_that_does_not_turn_keeps_its_axes_exactly() {
        for direction in
            [Vec3::new(-0.6, -0.6, -0.5), Vec3::new(0.2, -0.5, 0.7)].map(|v| v.normalize_or(Vec3::X))
        {
            let frame = LightFrame::new(direction);
            assert_eq!(frame.transported(direction), frame);
            assert_ne!(frame.transported(direction + Vec3::X * 1e-3), frame, "control");
        }
    }

    #[test]
    fn axes_are_orthonormal_for_every_direction() {
        for direction in directions() {
            let frame = LightFrame::new(direction);
            assert_orthonormal(&frame);
            assert!((frame.x - direction.normalize_or_zero()).length() < 1e-6);
        }
        assert_eq!(LightFrame::new(Vec3::ZERO).x, Vec3::NEG_Y);
        assert_eq!(LightFrame::new(Vec3::NAN).x, Vec3::NEG_Y);
    }

    #[test]
    fn transport_is_steady_where_a_fresh_basis_jumps() {
        // A drag through the seam of the branchless basis (z changes sign).
        let at = |t: f32| Vec3::new(0.6, -0.8, t).normalize_or_zero();
        let (before, after) = (at(1e-4), at(-1e-4));
        let fresh = LightFrame::new(before).y.distance(LightFrame::new(after).y);
        assert!(fresh > 0.5, "the control must jump: {fresh}");
        let frame = LightFrame::new(before);
        assert!(frame.transported(after).y.distance(frame.y) < 1e-3);
    }

    #[test]
    fn long_drags_and_reversals_stay_orthonormal() {
        let mut frame = LightFrame::default();
        for direction in directions() {
            frame = frame.transported(direction);
            assert_orthonormal(&frame);
            let reversed = frame.transported(-direction);
            assert_orthonormal(&reversed);
        }
        assert_eq!(frame.transported(Vec3::ZERO).x, frame.x);
    }

    #[test]
    fn a_light_that_stands_somewhere_looks_at_the_hair() {
        let base = LightFrame::new(Vec3::NEG_Y);
        let source = LightSource { position: Vec3::new(2.0, 3.0, -1.0), radius: 0.05 };
        let anchor = Vec3::new(0.0, 1.6, 0.1);
        let frame = base.standing(source, anchor);
        assert_orthonormal(&frame);
        assert!((frame.x - (anchor - source.position).normalize_or_zero()).length() < 1e-6);
        assert_eq!(frame, base.standing(source, anchor));
        assert_eq!(base.standing(source, source.position), LightFrame { source: Some(source), ..base });
        assert_eq!((base.source, frame.source), (None, Some(source)));
    }

    #[test]
    fn light_space_round_trip() {
        let frame = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
        let v = Vec3::new(0.1, 0.2, -0.3);
        assert!((frame.world_from_light(frame.light_from_world(v)) - v).length() < 1e-6);
        assert!((frame.light_from_world(frame.x) - Vec3::X).length() < 1e-6);
    }
}
