//! The light that stands out.

use glam::{DVec3, Quat, Vec3};

use super::picture::{Reduced, luminance};

/// The part of the sphere whose brightest texels are looked at.
const BRIGHTEST: f64 = 0.01;

/// Half the opening of the cone around the brightest texel, as a cosine, 30 degrees: a second lamp must not draw the
/// direction to the dark between the two.
const CONE_COS: f64 = 0.866_025_403_784_438_6;

/// The brightest part stands out from this multiple of the mean luminance. A uniform half of the sphere has 2.
const STANDS_OUT: f64 = 2.5;

/// The light that stands out from its surroundings, to be taken as a key light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strongest {
    /// Unit vector toward the light.
    pub direction: Vec3,
    /// Irradiance on a surface that faces it, from what is above the mean luminance of the surroundings.
    pub irradiance: Vec3,
}

impl Strongest {
    /// The colour of the light, with its largest component 1.
    pub fn colour(&self) -> Vec3 {
        self.irradiance / self.irradiance.max_element()
    }

    /// The light turned by `radians` about +Y.
    pub fn turned(&self, radians: f32) -> Self {
        let turn = Quat::from_rotation_y(radians);
        Self { direction: (turn * self.direction).normalize_or(self.direction), ..*self }
    }

    /// The centroid of the brightest hundredth of the sphere, within a cone around the brightest texel.
    pub(super) fn find(picture: &Reduced) -> Option<Self> {
        let light: Vec<f64> = picture.texels.iter().map(|&texel| luminance(texel)).collect();
        let mut order: Vec<usize> = (0..light.len()).collect();
        // Equal texels stay in their order, so equal pictures have equal lights.
        order.sort_by(|&a, &b| light[b].total_cmp(&light[a]));

        let solid = |at: usize| picture.solid_angle(at / picture.width);
        let sphere: f64 = 4.0 * std::f64::consts::PI;
        let mean = light.iter().enumerate().map(|(at, l)| l * solid(at)).sum::<f64>() / sphere;
        let (mut taken, mut bright, mut count) = (0.0, 0.0, 0);
        for &at in &order {
            if taken >= BRIGHTEST * sphere {
                break;
            }
            taken += solid(at);
            bright += light[at] * solid(at);
            count += 1;
        }
        // Also refuses a black picture.
        if bright <= STANDS_OUT * mean * taken {
            return None;
        }

        let peak = picture.direction(*order.first()?);
        let (mut centre, mut irradiance) = (DVec3::ZERO, DVec3::ZERO);
        for &at in &order[..count] {
            let direction = picture.direction(at);
            let above = light[at] - mean;
            if above > 0.0 && direction.dot(peak) >= CONE_COS {
                centre += direction * (above * solid(at));
                irradiance += picture.texels[at] * (above / light[at] * solid(at));
            }
        }
        let direction = centre.as_vec3().try_normalize().unwrap_or(peak.as_vec3());
        Some(Self { direction, irradiance: irradiance.as_vec3() })
    }
}
