//! The view of a light onto the body.

use glam::{Mat4, Vec3};
use lovelock_shadow::LightFrame;

use crate::Light;
use crate::standing::StandingUniform;
use crate::uniform::LightMaps;

/// The views of a sphere from a light whose maps have the axes `frame`, in maps of `texels` along each edge.
pub(crate) fn light_views(
    light: &Light,
    frame: &LightFrame,
    (center, radius): (Vec3, f32),
    texels: u32,
) -> LightMaps {
    let view = light_view(light.direction, center, radius, texels);
    if !light.stands() {
        return view;
    }
    LightMaps { standing: StandingUniform::new(light, frame, (center, radius), texels), ..view }
}

/// The orthographic view of a sphere from a light that travels along `direction`, and the size of its texels.
fn light_view(direction: Vec3, center: Vec3, radius: f32, texels: u32) -> LightMaps {
    let radius = radius.max(0.01);
    let up = if direction.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
    let view = glam::camera::rh::view::look_at_mat4(center - direction * radius, center, up);
    let project =
        glam::camera::rh::proj::directx::orthographic(-radius, radius, -radius, radius, 0.0, 2.0 * radius);
    LightMaps {
        shadow_from_world: project * view,
        columns_from_world: Mat4::IDENTITY,
        metres_per_texel: 2.0 * radius / texels as f32,
        standing: StandingUniform::default(),
    }
}

/// A sphere around all points: the centre of their bounding box and half of its diagonal.
pub(crate) fn bounding_sphere(points: &[Vec3]) -> (Vec3, f32) {
    let (low, high) = points
        .iter()
        .filter(|p| p.is_finite())
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    if low.x > high.x {
        return (Vec3::ZERO, 1.0);
    }
    ((low + high) * 0.5, (high - low).length() * 0.5 * 1.02)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_sees_its_sphere_and_depth_grows_along_the_light() {
        let direction = Vec3::new(0.3, -0.8, 0.5).normalize_or_zero();
        let center = Vec3::new(0.2, 0.9, -0.1);
        let maps = light_view(direction, center, 1.2, 1024);
        let at = |p: Vec3| maps.shadow_from_world.project_point3(p);
        assert!(at(center).truncate().length() < 1e-5);
        assert!((at(center).z - 0.5).abs() < 1e-5);
        assert!(at(center + direction).z > at(center).z);
        assert!((at(center - direction * 1.2).z).abs() < 1e-5);
    }

    #[test]
    fn a_sphere_of_nothing_is_finite() {
        assert_eq!(bounding_sphere(&[]), (Vec3::ZERO, 1.0));
        assert_eq!(bounding_sphere(&[Vec3::NAN]), (Vec3::ZERO, 1.0));
    }
}
