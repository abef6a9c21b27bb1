//! Eyeballs with a cornea, and their texture.

use glam::{Quat, Vec2, Vec3};
use image::{Rgb, RgbImage};
use lovelock_base::numbers::smoothstep;

use super::noise::noise;
use super::recipe::Look;
use super::surface::{Surface, Vertex};
use super::texture::encode;
use crate::assets::rig;

/// Rings from the front to the back, and columns around.
const RINGS: usize = 22;
const COLUMNS: usize = 36;
/// The angle from the front at which the ball ends, which is behind the lids, radians.
const LAST: f32 = 1.95;
/// The angle of the iris's edge, radians.
const IRIS: f32 = 0.455;
/// How far the cornea stands out, relative to the radius.
const CORNEA: f32 = 0.055;
/// How far the eyes turn at the full weight of a morph target: to the sides, and up and down, radians.
const TURN: [f32; 2] = [0.42, 0.35];

/// Both eyeballs as one surface. `eye` is the middle of the left one.
pub(super) fn surface(eye: Vec3, radius: f32) -> Surface {
    let mut out = Surface::default();
    for side in [1.0, -1.0] {
        let middle = eye * Vec3::new(side, 1.0, 1.0);
        let first = out.vertices.len() as u32;
        for ring in 0..=RINGS {
            // Rings are closer where the iris is.
            let polar = LAST * (ring as f32 / RINGS as f32).powf(1.25);
            let inside = (1.0 - (polar / (1.25 * IRIS)).powi(2)).max(0.0);
            let distance = radius * (1.0 + CORNEA * inside * inside);
            for column in 0..COLUMNS {
                let azimuth = std::f32::consts::TAU * column as f32 / COLUMNS as f32;
                let (s, c) = azimuth.sin_cos();
                let along = Vec3::new(polar.sin() * c, polar.sin() * s, polar.cos());
                let mut vertex = Vertex::at(middle + along * distance, along);
                vertex.weights[rig::HEAD] = 1.0;
                vertex.uv = Vec2::splat(0.5) + 0.5 * polar / LAST * Vec2::new(c, -s);
                let turned = |axis: Vec3, angle: f32| {
                    Quat::from_axis_angle(axis, angle) * (along * distance) - along * distance
                };
                // The order of `MORPHS`.
                vertex.moves[1] = turned(Vec3::Y, TURN[0]);
                vertex.moves[2] = turned(Vec3::Y, -TURN[0]);
                vertex.moves[3] = turned(Vec3::X, -TURN[1]);
                vertex.moves[4] = turned(Vec3::X, TURN[1]);
                out.vertices.push(vertex);
            }
        }
        let at = |ring: usize, column: usize| first + (ring * COLUMNS + column % COLUMNS) as u32;
        for ring in 0..RINGS {
            for column in 0..COLUMNS {
                let [a, b] = [at(ring, column), at(ring, column + 1)];
                let [c, d] = [at(ring + 1, column), at(ring + 1, column + 1)];
                out.triangles.push([a, c, d]);
                if ring > 0 {
                    out.triangles.push([a, d, b]);
                }
            }
        }
    }
    out.uv = out.triangles.iter().map(|t| t.map(|v| out.vertices[v as usize].uv)).collect();
    out.update_normals();
    out
}

/// The texture: pupil, iris with fibres and a dark rim, and a white that reddens toward the back.
pub(super) fn texture(look: &Look, size: u32) -> RgbImage {
    let white = Vec3::new(0.700, 0.650, 0.610);
    let red = Vec3::new(0.560, 0.270, 0.220);
    RgbImage::from_fn(size, size, |x, y| {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size as f32 * 2.0 - 1.0;
        let polar = at.length() * LAST;
        let around = at.normalize_or(Vec2::X);
        let r = polar / IRIS;
        // Fibres run from the pupil to the rim; the ring around the pupil is warmer.
        let fibre = noise(Vec3::new(around.x * 9.0, around.y * 9.0, r * 1.2))
            + 0.6 * noise(Vec3::new(around.x * 23.0, around.y * 23.0, r * 2.0 + 7.0));
        let collar = (-((r - 0.48) / 0.12).powi(2)).exp();
        let warm = Vec3::new(1.35, 1.05, 0.75);
        let mut iris = look.iris[0] * (1.0 + 0.55 * fibre) * Vec3::ONE.lerp(warm, 0.5 * collar);
        iris = iris.lerp(look.iris[1], smoothstep(0.72, 0.98, r));
        let pupil = Vec3::splat(0.004);
        let veins = noise(Vec3::new(at.x * 14.0, at.y * 14.0, 3.0)).max(0.0).powi(2);
        let back = smoothstep(0.75, 1.6, polar);
        let sclera = white.lerp(red, 0.55 * back + 0.25 * veins * smoothstep(0.6, 1.0, polar));
        let eye = pupil.lerp(iris, smoothstep(0.33, 0.37, r)).lerp(sclera, smoothstep(0.95, 1.07, r));
        Rgb(encode(eye))
    })
}
