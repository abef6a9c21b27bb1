//! Clothes and colours of the figure, as functions of positions in the rest pose.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::head::{self, BROW_Y};
use super::rig::rest;
use super::sdf::curve;

/// Skin, linear sRGB like every colour here.
const SKIN: Vec3 = Vec3::new(0.550, 0.360, 0.270);
const BLUSH: Vec3 = Vec3::new(0.560, 0.290, 0.225);
const LIPS: Vec3 = Vec3::new(0.430, 0.155, 0.130);
const BROW: Vec3 = Vec3::new(0.075, 0.045, 0.032);
const LASH: Vec3 = Vec3::new(0.035, 0.022, 0.018);
const SCLERA: Vec3 = Vec3::new(0.640, 0.600, 0.560);
const IRIS: Vec3 = Vec3::new(0.085, 0.105, 0.085);
const IRIS_RIM: Vec3 = Vec3::new(0.025, 0.032, 0.028);
const PUPIL: Vec3 = Vec3::new(0.006, 0.006, 0.006);
const TOP: Vec3 = Vec3::new(0.052, 0.108, 0.118);
const LEGGINGS: Vec3 = Vec3::new(0.046, 0.056, 0.070);
const SLIPPERS: Vec3 = Vec3::new(0.185, 0.125, 0.115);

/// Height in metres above which there is no cloth.
pub(super) const STRAPS_Y: f32 = 1.475;

/// Distance of a point from the edge of the top along the surface in metres; negative on bare skin.
fn inside_top(p: Vec3) -> f32 {
    let x = p.x.abs();
    let [_, edge] = curve(
        &[[1.235, 0.210], [1.262, 0.160], [1.290, 0.134], [1.325, 0.119], [1.370, 0.112], [1.430, 0.108]],
        p.y,
    );
    let armhole = (edge - x) * 0.85;
    // A scoop before and behind; its sides are the straps' inner edges.
    let depth = 0.105 + 0.035 * smoothstep(0.03, -0.06, p.z);
    let (u, v) = (x / 0.080, (p.y - 1.415).min(0.0) / depth);
    let rho = (u.powf(2.6) + v.abs().powf(2.6)).powf(1.0 / 2.6);
    let neck = (rho - 1.0) * if v.abs() > u { depth } else { 0.080 };
    armhole.min(neck)
}

/// The same for the leggings' ends and the slippers.
fn inside_slipper(p: Vec3) -> f32 {
    let q = Vec3::new(p.x.abs() - rest::ANKLE.x, p.y, p.z - rest::ANKLE.z);
    let along = q.dot(rest::foot_direction());
    let [_, top] = curve(
        &[
            [-0.055, 0.062],
            [-0.030, 0.056],
            [0.010, 0.036],
            [0.050, 0.032],
            [0.085, 0.042],
            [0.105, 0.070],
            [0.130, 0.110],
        ],
        along,
    );
    (top - p.y) * 0.8
}

/// Height of the top's lower edge, where the leggings begin: cut high over the hip.
fn leg_line(p: Vec3) -> f32 {
    let x = p.x.abs();
    let back = smoothstep(0.02, -0.05, p.z);
    0.795 + (0.125 - 0.030 * back) * smoothstep(0.0, 0.155, x - 0.01)
}

/// Distance of a point of the surface from the edge of any cloth in metres; negative on bare skin.
pub(super) fn inside_cloth(p: Vec3) -> f32 {
    if p.y < 0.14 {
        return (p.y - 0.118).max(inside_slipper(p));
    }
    inside_top(p)
}

/// Signed distance along the surface to the nearest edge between two colours of the clothes, in metres.
pub(super) fn seam(p: Vec3) -> f32 {
    if p.y > STRAPS_Y || (p.x.abs() > 0.22 && p.y > 0.2) {
        return 1.0;
    }
    let nearer = |a: f32, b: f32| if a.abs() < b.abs() { a } else { b };
    if p.y < 0.14 {
        return nearer(p.y - 0.118, inside_slipper(p));
    }
    nearer((p.y - leg_line(p)) * 0.75, inside_top(p))
}

/// Colour at a point of the surface, linear sRGB.
pub(super) fn colour(p: Vec3) -> Vec3 {
    if p.y > 1.44 && (p.y > STRAPS_Y || p.x.abs() < 0.072) {
        return face(p);
    }
    let cloth = smoothstep(-0.0004, -0.0001, inside_cloth(p));
    if p.y < 0.14 {
        let shoe = smoothstep(-0.0004, -0.0001, inside_slipper(p));
        let leg = smoothstep(-0.0004, -0.0001, p.y - 0.118);
        return SKIN.lerp(LEGGINGS, leg).lerp(SLIPPERS, shoe);
    }
    let top = smoothstep(-0.0004, -0.0001, p.y - leg_line(p));
    SKIN.lerp(LEGGINGS.lerp(TOP, top), cloth)
}

fn face(p: Vec3) -> Vec3 {
    let x = p.x.abs();
    let mut c = SKIN;
    if p.z < 0.03 {
        return c;
    }
    let q = Vec3::new(x, p.y, p.z);
    // A little blood in the cheeks and the tip of the nose.
    let cheek = (-(q - Vec3::new(0.046, 1.548, 0.074)).length_squared() / 0.0005).exp();
    let nose = (-(q - Vec3::new(0.0, 1.545, 0.120)).length_squared() / 0.00022).exp();
    c = c.lerp(BLUSH, (0.45 * cheek + 0.35 * nose).min(1.0));
    // Lips: an outline with a bow above.
    let t = (x / 0.0235).min(1.0);
    let upper = 1.5128 + 0.0082 * (1.0 - t.powf(1.6)) - 0.0022 * (-(x / 0.0035).powi(2)).exp();
    let lower = 1.5128 - 0.0122 * (1.0 - t.powf(2.2));
    let lip = (upper - p.y).min(p.y - lower).min(0.0235 - x);
    c = c.lerp(LIPS, 0.85 * smoothstep(-0.0008, 0.0010, lip));
    let line = (p.y - 1.5122).abs();
    c = c.lerp(LIPS * 0.45, 0.8 * smoothstep(0.0014, 0.0002, line) * smoothstep(0.024, 0.021, x));
    // Brows: an arch that thins outward.
    let s = (x - 0.0125) / 0.0370;
    let arch = BROW_Y - 0.0010 + 0.0060 * (1.0 - ((s - 0.62) / 0.62).powi(2)) - 0.0040 * (s - 0.62).max(0.0);
    let half = (0.0030 - 0.0021 * s.clamp(0.0, 1.0)) * smoothstep(-0.06, 0.08, s) * smoothstep(1.06, 0.85, s);
    let brow = half - (p.y - arch).abs();
    c = c.lerp(
        BROW,
        0.8 * smoothstep(-0.0009, 0.0009, brow) * smoothstep(-0.05, 0.05, s) * smoothstep(1.05, 0.95, s),
    );
    eye(p, c)
}

fn eye(p: Vec3, skin: Vec3) -> Vec3 {
    let opening = head::lid_opening(p);
    let ball = head::eyeball(p);
    if opening > 0.006 {
        return skin;
    }
    let q = Vec3::new(p.x.abs(), p.y, p.z) - head::EYE;
    // The gaze is level and a little lowered.
    let from_axis = q.truncate().distance(glam::Vec2::new(-0.0002, -0.0006));
    let white = SCLERA * (0.75 + 0.25 * smoothstep(0.0, 0.0022, -opening));
    let iris = IRIS.lerp(IRIS_RIM, smoothstep(0.0040, 0.0056, from_axis));
    let eye = PUPIL.lerp(iris, smoothstep(0.0022, 0.0028, from_axis));
    let eye = eye.lerp(white, smoothstep(0.0054, 0.0063, from_axis));
    let on_ball = smoothstep(0.0007, 0.0003, ball) * smoothstep(0.0004, -0.0002, opening);
    // Lashes darken the rim of the upper lid; the lower one a little.
    let above = smoothstep(-0.0005, 0.0015, q.y);
    let rim = smoothstep(0.0017, 0.0009, opening.abs());
    skin.lerp(eye, on_ball).lerp(LASH, rim * (0.25 + 0.70 * above))
}
