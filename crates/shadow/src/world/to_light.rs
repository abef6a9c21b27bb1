//! The ways from points to a light.

use glam::Vec3;

use crate::LightFrame;

/// The ways from points to a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToLight {
    /// Toward a directional light, unit length.
    pub toward: Vec3,
    /// Where the light stands, world space, and its radius, metres; `None` for a directional light.
    pub source: Option<(Vec3, f32)>,
}

impl ToLight {
    pub fn of(light: &LightFrame) -> Self {
        Self { toward: -light.x, source: light.source.map(|source| (source.position, source.safe_radius())) }
    }

    /// The unit vector from a point to the light, and the distance to its surface, metres: infinite for a directional light. `None`
    /// within the lamp, and where one of them is not finite.
    #[inline]
    pub fn from(&self, p: Vec3) -> Option<(Vec3, f32)> {
        let Some((position, radius)) = self.source else {
            return p.is_finite().then_some((self.toward, f32::INFINITY));
        };
        let way = position - p;
        let distance = way.length();
        (distance > radius && distance.is_finite()).then(|| (way / distance, distance - radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LightSource;

    #[test]
    fn ways_end_at_the_surface_of_the_lamp() {
        let frame = LightFrame::new(Vec3::new(0.0, -2.0, 0.0));
        assert_eq!(ToLight::of(&frame).from(Vec3::ONE), Some((Vec3::Y, f32::INFINITY)));
        let source = LightSource { position: Vec3::new(0.0, 3.0, 0.0), radius: 0.5 };
        let lamp = ToLight::of(&frame.standing(source, Vec3::ZERO));
        assert_eq!(lamp.from(Vec3::Y), Some((Vec3::Y, 1.5)));
        for nowhere in [Vec3::new(0.1, 2.8, 0.0), Vec3::NAN, Vec3::splat(1e30)] {
            assert_eq!(lamp.from(nowhere), None, "{nowhere}");
        }
        assert_eq!(ToLight::of(&frame).from(Vec3::NAN), None);
    }
}
