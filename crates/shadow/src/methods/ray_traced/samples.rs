//! The rays of a point: even samples of the square on which they start and of the disc on which they end.

use glam::{Vec2, Vec3};

use crate::LightFrame;
use crate::world::ToLight;

/// Hits nearer than this are those of the strand that the point belongs to, metres: at least, and as a part of the distance from the
/// anchor, because positions far from it are rounded.
const NEAREST: [f32; 2] = [1e-6, 4e-7];

/// A ray, and how far it goes: to the surface of the lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ray {
    pub from: Vec3,
    /// Unit length.
    pub along: Vec3,
    pub length: f32,
}

impl Ray {
    /// Hits nearer than this are those of the strand that the point belongs to, metres.
    pub fn nearest(&self) -> f32 {
        (NEAREST[1] * self.from.length()).max(NEAREST[0])
    }
}

/// The rays to a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays {
    to_light: ToLight,
    /// Axes across a directional light.
    across: [Vec3; 2],
    /// Rays along each edge of the square.
    pub edge: u32,
    /// Edge of the square, metres.
    pub width: f32,
    /// See [`spread`].
    spread: f32,
}

/// The radius of the disc on which rays end: metres, or that of a directional light one metre away. 0 for hard shadows.
pub(super) fn spread(light: &LightFrame) -> f32 {
    if light.area.samples <= 1 {
        return 0.0;
    }
    light.source.map_or_else(|| light.area.tangent(), |source| source.safe_radius())
}

impl Rays {
    /// The rays to the light, `count` of each point, for strands of a width.
    pub fn new(light: &LightFrame, count: u32, width: f32) -> Self {
        // The settings allow powers of four only.
        let edge = count.max(1).isqrt();
        Self { to_light: ToLight::of(light), across: [light.y, light.z], edge, width, spread: spread(light) }
    }

    /// The ray from a point to the middle of the light; `None` within the lamp.
    pub fn middle(&self, p: Vec3) -> Option<Ray> {
        let (along, length) = self.to_light.from(p)?;
        Some(Ray { from: p, along, length })
    }

    /// The mean of `light` over the rays of a point; 1 within the lamp and for points that are not finite.
    pub fn mean(&self, p: Vec3, light: impl Fn(&Ray) -> f32) -> f32 {
        let Some((toward, _)) = self.to_light.from(p) else { return 1.0 };
        let [first, second] = if self.to_light.source.is_some() { basis(toward) } else { self.across };
        let across = |v: Vec2| v.x * first + v.y * second;
        let mut sum = 0.0;
        for i in 0..self.edge {
            for j in 0..self.edge {
                let [start, end] = self.places(i, j);
                let from = p + self.width * across(start);
                let Some((position, radius)) = self.to_light.source else {
                    let along = (toward + self.spread * across(end)).normalize_or(toward);
                    sum += light(&Ray { from, along, length: f32::INFINITY });
                    continue;
                };
                sum += lamp(from, position + self.spread * across(end), (position, radius))
                    .map_or(1.0, |ray| light(&ray));
            }
        }
        sum / (self.edge * self.edge) as f32
    }

    /// The places of a ray: on a square around the origin whose edge is 1, and on the unit disc. Both are divided evenly, in different
    /// orders, so that neighbours on the square end far apart. They are the same for every point: few rays show a soft edge several
    /// times, and a single one goes to the middle of the lamp.
    fn places(&self, i: u32, j: u32) -> [Vec2; 2] {
        let part = |i: u32| (i as f32 + 0.5) / self.edge as f32;
        let start = Vec2::new(part(i) - 0.5, part(j) - 0.5);
        // A bijection of the cells: its determinant is 1.
        let (k, l) = ((i + j) % self.edge, (i + 2 * j) % self.edge);
        [start, disc(Vec2::new(2.0 * part(k) - 1.0, 2.0 * part(l) - 1.0))]
    }
}

/// The ray from a point to one of the lamp's, until it enters the lamp; `None` within it.
fn lamp(from: Vec3, to: Vec3, (position, radius): (Vec3, f32)) -> Option<Ray> {
    let way = to - from;
    let distance = way.length();
    let along = way / distance;
    let middle = position - from;
    let b = middle.dot(along);
    let outside = middle.dot(middle) - radius * radius;
    // False for NaN.
    if !(outside > 0.0 && distance > 0.0 && distance.is_finite()) {
        return None;
    }
    let length = b - (b * b - outside).max(0.0).sqrt();
    Some(Ray { from, along, length })
}

/// From a square to a disc, both around the origin: areas stay in proportion (Shirley, Chiu 1997).
fn disc(v: Vec2) -> Vec2 {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    if v == Vec2::ZERO {
        return v;
    }
    let (radius, angle) = if v.x.abs() > v.y.abs() {
        (v.x, FRAC_PI_4 * (v.y / v.x))
    } else {
        (v.y, FRAC_PI_2 - FRAC_PI_4 * (v.x / v.y))
    };
    radius * Vec2::new(angle.cos(), angle.sin())
}

/// Two axes across a unit vector. Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
fn basis(x: Vec3) -> [Vec3; 2] {
    let sign = if x.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + x.z);
    let b = x.x * x.y * a;
    [Vec3::new(1.0 + sign * x.x * x.x * a, sign * b, -sign * x.x), Vec3::new(b, sign + x.y * x.y * a, -x.y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LightArea, LightSource};

    #[test]
    fn rays_cover_the_square_and_the_disc_evenly() {
        let light = LightFrame::new(Vec3::NEG_Y);
        for count in [1, 4, 16, 64, 256] {
            let rays = Rays::new(&light, count, 1e-3);
            let places: Vec<_> = (0..rays.edge)
                .flat_map(|i| (0..rays.edge).map(move |j| (i, j)))
                .map(|(i, j)| rays.places(i, j))
                .collect();
            assert_eq!(places.len(), count as usize);
            for side in 0..2 {
                let sum: Vec2 = places.iter().map(|of| of[side]).sum();
                assert!((sum / count as f32).length() < 1e-6, "{count}: {sum}");
            }
            assert!(
                places.iter().all(|[square, disc]| square.abs().max_element() < 0.5 && disc.length() < 1.0)
            );
            // Half of the disc's area lies within 1/√2.
            let inner = places.iter().filter(|[_, disc]| disc.length() < 0.5_f32.sqrt()).count();
            assert!(count < 64 || (inner as f32 / count as f32 - 0.5).abs() < 0.1, "{count}: {inner}");
            for (at, [_, disc]) in places.iter().enumerate() {
                assert!(places[..at].iter().all(|[_, other]| other.distance(*disc) > 1e-3), "each once");
            }
        }
    }

    #[test]
    fn a_single_ray_goes_to_the_middle() {
        let rays = Rays::new(&LightFrame::new(Vec3::NEG_Y), 1, 1e-3);
        assert_eq!(rays.places(0, 0), [Vec2::ZERO; 2]);
    }

    #[test]
    fn rays_end_at_the_lamp_and_start_around_the_point() {
        let source = LightSource { position: Vec3::new(0.2, 2.0, 0.1), radius: 0.3 };
        let hard = LightFrame::new(Vec3::NEG_Y).standing(source, Vec3::ZERO);
        let light = LightFrame { area: LightArea { angle: 0.0, samples: 16 }, ..hard };
        assert_eq!((spread(&hard), spread(&light)), (0.0, 0.3));
        let rays = Rays::new(&light, 16, 0.01);
        let p = Vec3::new(0.1, 0.5, -0.2);
        let mean = rays.mean(p, |ray| {
            assert!((ray.along.length() - 1.0).abs() < 1e-6);
            let end = ray.from + ray.length * ray.along;
            assert!((end.distance(source.position) - source.radius).abs() < 1e-5, "{end}");
            assert!(ray.from.distance(p) < 0.01 && ray.from.distance(p) > 0.0);
            0.25
        });
        assert_eq!(mean, 0.25);
        // Within the lamp everything is lit, and what is not finite is, too.
        for lit in [source.position, source.position + 0.29 * Vec3::X, Vec3::NAN, Vec3::splat(f32::INFINITY)]
        {
            assert_eq!(rays.mean(lit, |_| 0.0), 1.0, "{lit}");
        }
    }
}
