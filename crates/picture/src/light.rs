//! Lights.

use glam::Vec3;
use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};
use serde::{Deserialize, Serialize};

/// The most lights of a picture: transmittance is stored per light and strand point.
pub const MAX_LIGHTS: usize = 4;

/// The smallest radius of a light that stands somewhere, metres.
const LEAST_RADIUS: f32 = 1e-3;

/// Where light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightKind {
    /// From infinitely far away: the same direction and brightness everywhere.
    #[default]
    Directional,
    /// From a place, within a cone.
    Spot,
    /// From a place, in all directions.
    Point,
}

impl Choices for LightKind {
    const ALL: &'static [Self] = &[Self::Directional, Self::Spot, Self::Point];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Directional => ("directional", "Directional"),
            Self::Spot => ("spot", "Spot"),
            Self::Point => ("point", "Point"),
        }
    }
}

/// A light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Light {
    /// What the interface calls it.
    pub name: String,
    /// Whether it is on.
    pub enabled: bool,
    /// Where it comes from.
    pub kind: LightKind,
    /// The way the light travels, world space; any length but zero. Of a spot, the middle of its cone.
    pub direction: Vec3,
    /// Where a spot or a point light stands, world space, metres.
    pub position: Vec3,
    /// Full angle of a spot's cone at which its light begins to fall off, radians; at most `outer_angle`.
    pub inner_angle: f32,
    /// Full angle of a spot's cone beyond which there is no light, radians.
    pub outer_angle: f32,
    /// Radius of what shines in a spot or a point light, metres. Nearer than this it does not become brighter, and hair casts no shadow.
    pub radius: f32,
    /// Angle between the middle and the edge of a directional light, radians, if shadows are soft.
    pub angular_radius: f32,
    /// Samples of the light's area, for each of which hair has a shadow map: 1 for hard shadows.
    pub shadow_samples: u32,
    /// Colour, linear sRGB, of about unit brightness.
    pub color: Vec3,
    /// Brightness; of a spot or a point light at a distance of one metre.
    pub intensity: f32,
    /// Fraction of it that makes highlights: 1 for a lamp, 0 for a large soft source.
    pub specular: f32,
    /// Blur of the edges of the body's shadow in this light, metres; of a directional light. That of the first light that is on also
    /// softens the shadows of hair on hair and on skin.
    pub softness: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: "Key".to_owned(),
            enabled: true,
            kind: LightKind::default(),
            direction: Vec3::new(-0.5, -0.7, -0.5),
            position: Vec3::new(0.8, 2.75, 0.8),
            inner_angle: 0.5,
            outer_angle: 0.7,
            radius: 0.1,
            angular_radius: 0.05,
            shadow_samples: 1,
            color: Vec3::ONE,
            intensity: 3.0,
            specular: 1.0,
            softness: 0.01,
        }
    }
}

impl Light {
    /// The three lights of the default scene: a soft warm key from above and the side, a cool weak fill from
    /// the other side, and a rim light from behind that shows the silhouette.
    pub fn default_rig() -> Vec<Self> {
        vec![
            Self {
                name: "Key".to_owned(),
                direction: Vec3::new(-0.62, -0.62, -0.48),
                color: Vec3::new(1.0, 0.94, 0.86),
                intensity: 3.2,
                softness: 0.012,
                ..Self::default()
            },
            Self {
                name: "Rim".to_owned(),
                direction: Vec3::new(0.55, -0.45, 0.70),
                color: Vec3::new(0.86, 0.93, 1.0),
                intensity: 2.2,
                specular: 0.8,
                softness: 0.012,
                ..Self::default()
            },
            Self {
                name: "Fill".to_owned(),
                direction: Vec3::new(0.70, -0.35, -0.62),
                color: Vec3::new(0.72, 0.82, 1.0),
                intensity: 1.2,
                specular: 0.4,
                softness: 0.012,
                ..Self::default()
            },
        ]
    }

    /// How far before a shadow's edge the hair or the body is that casts it, metres.
    pub const BLOCKER_METRES: f32 = 0.1;
    /// The largest blur of a shadow's edge, metres.
    pub const MAX_SOFTNESS: f32 = 0.1;

    /// Whether the light stands somewhere, as a spot or a point light does.
    pub fn stands(&self) -> bool {
        self.kind != LightKind::Directional
    }

    /// Stands the light at `distance` metres from `target`, on the side from which it comes.
    pub fn stand_before(&mut self, target: Vec3, distance: f32) {
        self.position = target - distance * self.direction.normalize_or(Vec3::NEG_Y);
    }

    /// The way in which the light travels at `p`: from its place, or its direction as it is.
    pub fn way_to(&self, p: Vec3) -> Vec3 {
        if self.stands() { (p - self.position).normalize_or(self.direction) } else { self.direction }
    }

    /// The share of the brightness that arrives at `p` if nothing is between: 1 of a directional light.
    ///
    /// It falls with the square of the distance, which counts as at least the radius, and from the inner to the outer angle of a
    /// spot's cone by the cosine, smoothly.
    pub fn share_at(&self, p: Vec3) -> f32 {
        if !self.stands() {
            return 1.0;
        }
        let away = p - self.position;
        let distance = away.length();
        let near = distance.max(self.radius.max(LEAST_RADIUS));
        let share = 1.0 / (near * near);
        if self.kind == LightKind::Point {
            return share;
        }
        let [scale, offset] = self.cone();
        let along = away.dot(self.direction.normalize_or(Vec3::NEG_Y)) / distance.max(1e-12);
        let t = (along * scale + offset).clamp(0.0, 1.0);
        share * (t * t * (3.0 - 2.0 * t))
    }

    /// Factor and summand that make the cosine of the angle to the middle of a spot's cone 0 at its outer angle and 1 at its inner one.
    pub fn cone(&self) -> [f32; 2] {
        let cosine = |angle: f32| (0.5 * angle).cos();
        let outer = cosine(self.outer_angle);
        let scale = 1.0 / (cosine(self.inner_angle.min(self.outer_angle)) - outer).max(1e-6);
        [scale, -outer * scale]
    }

    /// Blur of the edges of shadows, metres, `distance` metres from the light: that of its radius, seen past something
    /// [`Light::BLOCKER_METRES`] before the edge.
    pub fn softness_at(&self, distance: f32) -> f32 {
        if !self.stands() {
            let penumbra =
                if self.has_soft_shadows() { Self::BLOCKER_METRES * self.angular_radius.tan() } else { 0.0 };
            return self.softness.max(penumbra);
        }
        let near = distance.max(self.radius.max(LEAST_RADIUS));
        (self.radius * Self::BLOCKER_METRES / near).clamp(0.0, Self::MAX_SOFTNESS)
    }

    /// Whether the shadows of hair are those of the light's area, and not of its middle.
    pub fn has_soft_shadows(&self) -> bool {
        self.shadow_samples > 1
    }

    /// The light with every value in its range and a direction of length 1.
    pub fn normalized(&self) -> Self {
        let light = self.clamped();
        Self { direction: light.direction.normalize_or(Vec3::NEG_Y), ..light }
    }

    /// The lights that are drawn: those that are enabled, at most [`MAX_LIGHTS`], normalized.
    pub fn enabled(lights: &[Self]) -> impl Iterator<Item = Self> {
        lights.iter().filter(|light| light.enabled).take(MAX_LIGHTS).map(Self::normalized)
    }
}

impl Settings for Light {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(field!(Self, enabled), "Enabled", "Switches the light on."),
        Setting::choice::<LightKind>(
            field!(Self, kind),
            "Light from",
            "Where the light comes from: everywhere from one direction, from a place within a cone, or from a place in all directions.",
        ),
        Setting::direction_or_zero(
            field!(Self, direction),
            "Light direction",
            "Direction in which the light travels.",
        ),
        Setting::vector(
            field!(Self, position),
            [-1000.0, 1000.0],
            "Light position",
            ["Position x", "Position y", "Position z"],
            "Place of the light in the world. It can also be dragged in the image.",
        )
        .soft([-4.0, 4.0])
        .unit(Unit::METRES),
        Setting::number(
            field!(Self, inner_angle),
            [0.0, std::f64::consts::PI],
            "Inner angle",
            "Full angle of the cone within which a spot has all of its brightness.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, outer_angle),
            [0.0, std::f64::consts::PI],
            "Outer angle",
            "Full angle of the cone beyond which a spot gives no light.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, radius),
            [0.001, 1.0],
            "Light radius",
            "Radius of the lamp. A larger one softens the edges of shadows; hair within it casts none.",
        )
        .unit(Unit::METRES_AS_CM)
        .logarithmic(),
        Setting::count(
            field!(Self, shadow_samples),
            [1, 64],
            "Shadow samples",
            "Points of the lamp from which hair casts shadows: 1 for hard edges, more for soft ones. Each has a map of its own, with its \
             time and memory; 16 are smooth.",
        )
        .offered(&[1, 2, 4, 8, 16, 32, 64]),
        Setting::number(
            field!(Self, angular_radius),
            [0.0, 0.5],
            "Angular radius",
            "How large a directional light looks from the hair, with more than one shadow sample: the sun has 0.27 degrees, a large lamp \
             10. A larger one softens shadows more.",
        )
        .unit(Unit::RADIANS),
        Setting::number(
            field!(Self, intensity),
            [0.0, 1000.0],
            "Intensity",
            "Brightness of the light; of a spot or a point light at a distance of one metre.",
        )
        .soft([0.0, 20.0]),
        Setting::color(field!(Self, color), "Colour", "Colour of the light."),
        Setting::number(
            field!(Self, specular),
            [0.0, 1.0],
            "Highlights",
            "How strongly the light makes highlights: high for a lamp, low for a large soft source.",
        )
        .unit(Unit::FRACTION),
        Setting::number(
            field!(Self, softness),
            [0.0, 0.1],
            "Softness",
            "Blur of the edges of the body's shadow in this light. Shadows of hair, on hair and on skin, \
             are as soft in every light as in the first one that is on.",
        )
        .unit(Unit::METRES_AS_MM),
    ];

    fn reconcile(&mut self) {
        // A vector without a direction points down, as in `normalized`.
        if self.direction.try_normalize().is_none() {
            self.direction = Vec3::NEG_Y;
        }
        self.inner_angle = self.inner_angle.min(self.outer_angle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot() -> Light {
        Light {
            kind: LightKind::Spot,
            direction: Vec3::NEG_Y,
            position: Vec3::new(0.0, 3.0, 0.0),
            ..Light::default()
        }
    }

    #[test]
    fn brightness_falls_with_the_square_of_the_distance_down_to_the_radius() {
        let point = Light { kind: LightKind::Point, radius: 0.05, ..spot() };
        let at = |distance: f32| point.share_at(point.position + distance * Vec3::X);
        assert!(
            (at(1.0) - 1.0).abs() < 1e-6 && (at(2.0) - 0.25).abs() < 1e-6 && (at(0.1) - 100.0).abs() < 1e-3
        );
        for inside in [0.05, 0.01, 0.0] {
            assert!((at(inside) - 400.0).abs() < 1e-2, "{inside}");
        }
        let directional = Light { kind: LightKind::Directional, ..point };
        assert_eq!(directional.share_at(Vec3::ZERO), 1.0, "control");
    }

    #[test]
    fn a_cone_has_all_light_inside_and_none_outside() {
        let spot = Light { inner_angle: 0.6, outer_angle: 1.0, ..spot() };
        let at = |angle: f32| spot.share_at(spot.position + Vec3::new(angle.sin(), -angle.cos(), 0.0));
        for (angle, share) in [(0.0, 1.0), (0.29, 1.0), (0.51, 0.0), (1.5, 0.0), (3.1, 0.0)] {
            assert!((at(angle) - share).abs() < 1e-5, "{angle}: {}", at(angle));
        }
        assert!(at(0.4) > 0.2 && at(0.4) < 0.8 && at(0.35) > at(0.45), "a soft edge");
    }

    #[test]
    fn cones_of_nothing_and_of_a_half_space_and_hard_edges_are_finite() {
        let half = Light { inner_angle: 3.2, outer_angle: 3.2, ..spot() }.normalized();
        assert!((half.outer_angle - std::f32::consts::PI).abs() < 1e-6);
        assert_eq!(half.share_at(half.position - Vec3::Y), 1.0);
        assert_eq!(half.share_at(half.position + Vec3::Y), 0.0);
        let narrow = Light { inner_angle: 0.0, outer_angle: 0.01, ..spot() }.normalized();
        assert!(narrow.share_at(narrow.position - Vec3::Y) > 0.97);
        let nothing = Light { inner_angle: 0.4, outer_angle: 0.0, ..spot() }.normalized();
        assert_eq!(nothing.inner_angle, 0.0);
        assert_eq!(nothing.share_at(nothing.position + Vec3::new(0.1, -1.0, 0.0)), 0.0);
        for p in [nothing.position, Vec3::splat(1e30), Vec3::ZERO] {
            assert!(nothing.share_at(p).is_finite() && half.share_at(p).is_finite(), "{p}");
        }
    }

    #[test]
    fn what_a_light_lacks_in_a_file_is_what_it_had() {
        let light = Light::default_rig().swap_remove(0);
        assert_eq!((light.kind, light.stands()), (LightKind::Directional, false));
        assert_eq!(light.softness_at(0.2), light.softness);
    }

    #[test]
    fn edges_are_softer_near_a_large_lamp() {
        let light = Light { radius: 0.2, ..spot() };
        assert!((light.softness_at(2.0) - 0.01).abs() < 1e-6);
        assert!(
            light.softness_at(1.0) > light.softness_at(2.0) && light.softness_at(0.0) <= Light::MAX_SOFTNESS
        );
    }
}
