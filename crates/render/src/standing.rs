//! What both backends compute of lights that stand somewhere: the axes of their maps, and their views of the body.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3, Vec4};
use lovelock_shadow::cube::{SIDES, side_of, turned};
use lovelock_shadow::{LightArea, LightFrame, LightSource};

use crate::{Light, LightKind, MAX_LIGHTS};

/// The largest tangent of half the angle that one view of the body takes in: 60 degrees. Lights that see more have six.
const WIDEST_VIEW: f32 = 1.732_050_8;
/// The smallest one.
const NARROWEST_VIEW: f32 = 1e-3;

/// The axes of the shadow maps of a light around hair at `anchor`, and where the light stands. `base` are those of its direction.
pub(crate) fn placed_frame(base: LightFrame, light: &Light, anchor: Vec3) -> LightFrame {
    let area = LightArea { angle: light.angular_radius, samples: light.shadow_samples };
    let base = LightFrame { area, ..base };
    if !light.stands() {
        return base;
    }
    let source = LightSource { position: light.position, radius: light.radius };
    base.standing(source, anchor)
}

/// The axes of the shadow maps of a light around hair at `anchor` (world space, metres), and where the light stands.
pub fn light_frame(light: &Light, anchor: Vec3) -> LightFrame {
    placed_frame(LightFrame::new(light.direction), light, anchor)
}

/// A light that stands somewhere, and its maps. Twin of `StandingUniform` in `frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct StandingUniform {
    /// World space.
    pub position: Vec3,
    /// 0 for a directional light.
    pub radius: f32,
    /// Unit axes, by which a side of a cube is told: see [`side_of`].
    pub axes: [Vec4; 3],
    /// The middle of a spot's cone, and [`Light::cone`]: 0 and 1 for a point light.
    pub cone_axis: Vec3,
    pub cone_scale: f32,
    pub cone_offset: f32,
    /// Tangent of a texel of the body's depth map.
    pub texel: f32,
    /// Views of the body: 1 or 6.
    pub body_sides: u32,
    /// Maps of transmittance behind all hair: 0, 1 or 6.
    pub column_sides: u32,
    /// To the clip space of the body's depth maps.
    pub shadow_from_world: [Mat4; SIDES],
    /// To the textures of transmittance behind all hair, divided by the fourth coordinate; the third one is the fraction of the
    /// texture's edge that a map uses.
    pub columns_from_world: [Mat4; SIDES],
}

impl StandingUniform {
    /// A light with the axes of its shadow maps and its views of a body within a sphere, in maps of `texels` along each edge.
    pub fn new(light: &Light, frame: &LightFrame, (center, radius): (Vec3, f32), texels: u32) -> Self {
        let axes = [frame.x, frame.y, frame.z];
        let away = center - light.position;
        let far = 1.01 * (away.length() + radius);
        let before = 0.5 * light.radius.max(1e-3);
        let far = far.max(1.0);
        let mut shadow_from_world = [Mat4::ZERO; SIDES];
        let (tangent, body_sides) = if let Some((axis, tangent)) = one_view(light, away, radius) {
            // Depth has few digits far from a near end that is near the light.
            let near = before.max(0.99 * (axis.dot(away) - radius));
            shadow_from_world[0] = view(light.position, looking(axis), tangent, [near, far]);
            (tangent, 1)
        } else {
            for (side, matrix) in shadow_from_world.iter_mut().enumerate() {
                *matrix = view(light.position, turned(axes, side), 1.0, [before, far]);
            }
            (1.0, SIDES as u32)
        };
        let mut standing = Self {
            position: light.position,
            radius: light.radius.max(1e-3),
            axes: axes.map(|axis| axis.extend(0.0)),
            texel: 2.0 * tangent / texels as f32,
            body_sides,
            column_sides: 0,
            shadow_from_world,
            columns_from_world: [Mat4::ZERO; SIDES],
            ..Self::default()
        };
        standing.shape_cone(light);
        standing
    }

    /// Takes over the cone of a light, which no map of the body depends on within its outer angle.
    pub fn shape_cone(&mut self, light: &Light) {
        self.cone_axis = light.direction.normalize_or(Vec3::NEG_Y);
        [self.cone_scale, self.cone_offset] =
            if light.kind == LightKind::Spot { light.cone() } else { [0.0, 1.0] };
    }

    /// The view of the body in which `q`, a way from the light in the world, is.
    pub fn body_side(&self, q: Vec3) -> usize {
        if self.body_sides == 1 {
            0
        } else {
            side_of(Vec3::from(self.axes.map(|axis| axis.truncate().dot(q))))
        }
    }

    /// Whether the light stands somewhere.
    pub fn is_standing(&self) -> bool {
        self.radius > 0.0
    }
}

/// The axis and the tangent of half the angle of a view in which all of the body is that the light reaches; `None` if that is too
/// wide. The body is in a sphere at `away`.
fn one_view(light: &Light, away: Vec3, radius: f32) -> Option<(Vec3, f32)> {
    let distance = away.length();
    let sphere = (distance > radius).then(|| radius / (distance * distance - radius * radius).sqrt());
    let sphere = sphere.map(|tangent| (away / distance, tangent));
    let half = 0.5 * light.outer_angle;
    let is_spot = light.kind == LightKind::Spot && half < 1.5;
    let cone = is_spot.then(|| (light.direction.normalize_or(Vec3::NEG_Y), half.tan()));
    let narrowest = [sphere, cone].into_iter().flatten().min_by(|(_, a), (_, b)| a.total_cmp(b));
    // A little more, because a texel at the edge is read with its neighbours.
    let wider = narrowest.map(|(axis, tangent)| (axis, (1.02 * tangent).max(NARROWEST_VIEW)));
    wider.filter(|(_, tangent)| *tangent <= WIDEST_VIEW)
}

/// Axes of a view along `axis`: itself, upward and to the right in the picture.
fn looking(axis: Vec3) -> [Vec3; 3] {
    let up = if axis.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
    let right = axis.cross(up).normalize_or(Vec3::X);
    [axis, right.cross(axis), right]
}

/// The perspective view from `position` along the first of three unit axes; the others point upward and to the right in the picture.
/// Depth is 0 at the near and 1 at the far end, and the fourth coordinate is the distance along the axis.
fn view(position: Vec3, [forward, up, right]: [Vec3; 3], tangent: f32, [near, far]: [f32; 2]) -> Mat4 {
    let row = |axis: Vec3, scale: f32| (axis * scale).extend(-(axis * scale).dot(position));
    let scale = far / (far - near);
    let depth = row(forward, scale) - Vec4::W * (near * scale);
    Mat4::from_cols(row(right, 1.0 / tangent), row(up, 1.0 / tangent), depth, row(forward, 1.0)).transpose()
}

/// The layer of a side of light `light` in arrays of textures. Twin of `layer_of` in `frame.wgsl`.
pub(crate) fn layer_of(light: usize, side: usize) -> usize {
    if side == 0 { light } else { MAX_LIGHTS + (SIDES - 1) * light + side - 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(kind: LightKind, position: Vec3) -> Light {
        Light { kind, position, direction: Vec3::NEG_Y, ..Light::default() }
    }

    #[test]
    fn a_far_light_sees_the_body_in_one_view_and_a_near_one_in_six() {
        let sphere = (Vec3::new(0.0, 1.0, 0.0), 1.0);
        for (distance, sides) in [(5.0, 1), (1.2, 1), (1.1, 6), (0.5, 6), (0.0, 6)] {
            let light = lamp(LightKind::Point, sphere.0 + distance * Vec3::X);
            let frame = light_frame(&light, Vec3::new(0.0, 1.6, 0.0));
            let made = StandingUniform::new(&light, &frame, sphere, 1024);
            assert_eq!(made.body_sides, sides, "{distance}");
        }
        let spot = Light { outer_angle: 1.0, ..lamp(LightKind::Spot, sphere.0) };
        let made = StandingUniform::new(&spot, &light_frame(&spot, Vec3::ZERO), sphere, 1024);
        assert_eq!(made.body_sides, 1, "a narrow cone from within the body");
    }

    #[test]
    fn every_side_of_every_light_has_a_layer_of_its_own() {
        let all = (0..MAX_LIGHTS).flat_map(|light| (0..SIDES).map(move |side| layer_of(light, side)));
        let mut layers: Vec<_> = all.collect();
        layers.sort_unstable();
        assert_eq!(layers, (0..MAX_LIGHTS * SIDES).collect::<Vec<_>>());
        assert_eq!([0, 1, 2, 3].map(|light| layer_of(light, 0)), [0, 1, 2, 3]);
    }

    #[test]
    fn every_point_is_in_the_view_of_its_side() {
        let light = lamp(LightKind::Point, Vec3::new(0.1, 1.5, 0.2));
        let frame = light_frame(&light, Vec3::new(0.0, 1.6, 0.0));
        let made = StandingUniform::new(&light, &frame, (Vec3::Y, 1.0), 512);
        let mut seen = [0; SIDES];
        for i in 0..2000 {
            let (z, a) = (1.0 - (i as f32 + 0.5) / 1000.0, i as f32 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            let q = Vec3::new(r * a.cos(), r * a.sin(), z) * (0.3 + 1e-4 * i as f32);
            let side = made.body_side(q);
            let at = made.shadow_from_world[side] * (light.position + q).extend(1.0);
            let ndc = at / at.w;
            assert!(at.w > 0.0 && ndc.x.abs() < 1.0001 && ndc.y.abs() < 1.0001, "{q}: {ndc}");
            assert!((0.0..=1.0).contains(&ndc.z), "{q}: {ndc}");
            seen[side] += 1;
        }
        assert!(seen.iter().all(|count| *count > 250), "{seen:?}");
    }

    #[test]
    fn depth_rises_along_rays_and_views_are_not_mirrored() {
        let light = lamp(LightKind::Point, Vec3::new(3.0, 2.0, 1.0));
        let frame = light_frame(&light, Vec3::Y);
        let made = StandingUniform::new(&light, &frame, (Vec3::Y, 1.0), 512);
        let at = |p: Vec3| (made.shadow_from_world[0] * p.extend(1.0)).to_array();
        let z = |p: Vec3| at(p)[2] / at(p)[3];
        let way = (Vec3::Y - light.position).normalize_or_zero();
        assert!(z(Vec3::Y + 0.1 * way) > z(Vec3::Y) && z(Vec3::Y) > z(Vec3::Y - 0.1 * way));
        // A triangle that faces the light runs counter-clockwise.
        let [up, right] = [looking(way)[1], looking(way)[2]];
        let corner = |p: Vec3| Vec3::new(at(p)[0] / at(p)[3], at(p)[1] / at(p)[3], 0.0);
        let (a, b, c) = (corner(Vec3::Y), corner(Vec3::Y + 0.1 * right), corner(Vec3::Y + 0.1 * up));
        assert!((b - a).cross(c - a).z > 0.0);
    }
}
