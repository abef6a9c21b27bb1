//! Planar ray tracing of a sector (Xu et al., "SATF", section 5.1, equation 5).
//!
//! View and light lie in the plane of the sector. Nothing is lost by that for hair along the sector's axis: a ray at the
//! angle ψ to the strands meets `N w / area · sin ψ` of optical depth per metre, and its path within the plane is its length
//! times sin ψ. So the optical depth of the planar path is that of the ray, for any ψ.

use glam::Vec2;

use crate::layout::{ANGLES, TEXELS};
use crate::sector::{Sector, WIDTH, direction};

/// Reflectance without any light on the strand's side. Symbol: `k_a`.
pub const AMBIENT: f32 = 0.2;
/// Strength of the matt part. Symbol: `k_d`.
pub const DIFFUSE: f32 = 0.6;
/// Strength of the highlight, whose exponent is 16. Symbol: `k_s`.
pub const SPECULAR: f32 = 0.2;
/// The longest path through a sector, in widths of it: rays at a grazing angle are turned until theirs is as long.
pub const LONGEST_PATH: f32 = 4.0;
/// Steps on a path of length 1: half the distance of grid points.
const STEPS: f32 = 16.0;
/// A ray of this opacity is not followed further. The rest changes no byte of a record.
const OPAQUE: f32 = 0.999;
/// Gradients below this times the mean density have no direction: such points have only the ambient reflectance.
const LEAST_GRADIENT: f32 = 1e-3;

/// What the rays through a sector meet for one azimuth of view, for each texel of the outer arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Rays {
    /// Opacity. Symbol: `Â`.
    pub opacity: [f32; TEXELS],
    /// Reflectance times opacity for each azimuth of light. Symbol: `R`.
    pub reflected: [[f32; TEXELS]; ANGLES],
}

/// Traces the rays toward azimuth number `view` for all azimuths of light.
///
/// Azimuths are counted from the outward normal, positive toward +s. A ray seen from outside starts at the outer edge, and
/// one seen from inside ends there; its texel is where it meets the outer edge, in either case.
pub fn trace(sector: &Sector, view: usize) -> Rays {
    let field = sector.field();
    let least = LEAST_GRADIENT * sector.optical_depth();
    let toward_eye = direction(view);
    let light_s: [f32; ANGLES] = std::array::from_fn(|k| direction(k).x);
    let light_t: [f32; ANGLES] = std::array::from_fn(|k| direction(k).y);
    let mut rays = Rays { opacity: [0.0; TEXELS], reflected: [[0.0; TEXELS]; ANGLES] };
    for texel in 0..TEXELS {
        let path = Path::new((texel as f32 + 0.5) / TEXELS as f32, toward_eye);
        let mut opacity = 0.0_f32;
        let mut reflected = [0.0; ANGLES];
        for step in 0..path.steps {
            let local = field.at(path.at(step));
            let weight = (1.0 - (-local.density * path.step).exp()) * (1.0 - opacity);
            let steepness = local.gradient.length();
            if steepness > least {
                // Density falls toward the outside of a strand.
                let normal = -local.gradient / steepness;
                let eye = 2.0 * normal.dot(toward_eye) * normal - toward_eye;
                for k in 0..ANGLES {
                    let diffuse = (normal.x * light_s[k] + normal.y * light_t[k]).max(0.0);
                    let mirror = (eye.x * light_s[k] + eye.y * light_t[k]).max(0.0);
                    let squared = mirror * mirror;
                    let fourth = squared * squared;
                    let eighth = fourth * fourth;
                    reflected[k] += weight * (AMBIENT + DIFFUSE * diffuse + SPECULAR * eighth * eighth);
                }
            } else {
                for sum in &mut reflected {
                    *sum += weight * AMBIENT;
                }
            }
            opacity += weight;
            if opacity > OPAQUE {
                break;
            }
        }
        rays.opacity[texel] = opacity;
        for (all, value) in rays.reflected.iter_mut().zip(reflected) {
            all[texel] = value;
        }
    }
    rays
}

/// The optical depth from the edge at `u` of the outer arc to the other edge, toward the azimuth `theta` in radians.
pub fn optical_depth(sector: &Sector, theta: f32, u: f32) -> f32 {
    let field = sector.field();
    let path = Path::new(u, Vec2::new(theta.sin(), theta.cos()));
    (0..path.steps).map(|step| field.at(path.at(step)).density * path.step).sum()
}

/// Equal steps through a sector, from the side of the eye.
struct Path {
    start: Vec2,
    /// One step in s and t.
    advance: Vec2,
    /// Length of a step.
    step: f32,
    steps: usize,
}

impl Path {
    fn new(u: f32, toward_eye: Vec2) -> Self {
        let least = 1.0 / (LONGEST_PATH * WIDTH);
        let steep = toward_eye.y.abs() >= least;
        let cos =
            if steep { toward_eye.y } else { least.copysign(if toward_eye.y < -1e-6 { -1.0 } else { 1.0 }) };
        let sin = if steep { toward_eye.x } else { (1.0 - least * least).sqrt().copysign(toward_eye.x) };
        let length = 1.0 / cos.abs();
        let steps = (length * STEPS - 1e-3).ceil().max(1.0);
        let along = Vec2::new(-sin / WIDTH, -cos) * length;
        let outer = Vec2::new(u, 1.0);
        let start = if cos > 0.0 { outer } else { outer - along };
        Self { start, advance: along / steps, step: length / steps, steps: steps as usize }
    }

    fn at(&self, step: usize) -> Vec2 {
        self.start + self.advance * (step as f32 + 0.5)
    }
}
