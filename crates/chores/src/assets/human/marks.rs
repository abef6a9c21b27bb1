//! Places on a figure that masks, colours and garments are measured from, and the masks where hair grows.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::surface::Surface;
use crate::assets::rig::{self, Rig};
use crate::assets::sdf::curve;

/// Half of the width over which the scalp's mask goes from 0 to 1, metres.
const HAIRLINE_HALF_WIDTH: f32 = 0.004;

/// Measures of a figure, world space at rest, metres; pairs are on the left side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Marks {
    /// The highest point.
    pub(super) crown: f32,
    /// The lowest point of the chin.
    pub(super) chin: f32,
    /// The middle of the eyeball, and its radius.
    pub(super) eye: Vec3,
    /// Radius of the eyeball.
    pub(super) eye_radius: f32,
    /// The tip of the nose.
    pub(super) nose: Vec3,
    /// The middle of the ear.
    pub(super) ear: Vec3,
    /// The middle of the skull, seen from above.
    pub(super) skull_z: f32,
    /// The shoulder joint.
    pub(super) shoulder: Vec3,
    /// The hip joint.
    pub(super) hip: Vec3,
    /// The ankle.
    pub(super) ankle: Vec3,
}

impl Marks {
    /// Measures a figure. `ears` says which vertices are those of ears.
    pub(super) fn measure(skin: &Surface, ears: &[bool], rig: &Rig, (eye, eye_radius): (Vec3, f32)) -> Self {
        let all = || skin.vertices.iter().map(|v| v.place);
        let middle = || all().filter(|p| p.x.abs() < 0.012);
        let crown = middle().map(|p| p.y).fold(f32::MIN, f32::max);
        let face = || middle().filter(move |p| p.y > crown - 0.19 && p.y < crown - 0.09);
        let nose = face().fold(Vec3::splat(f32::MIN), |a, b| if b.z > a.z { b } else { a });
        // The chin's lower edge is where the skin turns from forward to downward.
        let chin = skin
            .vertices
            .iter()
            .filter(|v| v.place.x.abs() < 0.02 && v.place.z > nose.z - 0.050 && v.place.y > crown - 0.26)
            .filter(|v| v.place.y < nose.y && v.normal.z > 0.1)
            .map(|v| v.place.y)
            .fold(f32::MAX, f32::min);
        let skull = all().filter(|p| p.y > crown - 0.09 && p.x.abs() < 0.1);
        let (back, front) = skull.fold((f32::MAX, f32::MIN), |(a, b), p| (a.min(p.z), b.max(p.z)));
        let left: Vec<Vec3> = skin
            .vertices
            .iter()
            .zip(ears)
            .filter(|(v, e)| **e && v.place.x > 0.0)
            .map(|(v, _)| v.place)
            .collect();
        let ear = left.iter().sum::<Vec3>() / left.len().max(1) as f32;
        let at = |joint: usize| rig.joints[joint].rest;
        Self {
            crown,
            chin,
            eye,
            eye_radius,
            nose: nose.with_x(0.0),
            ear,
            skull_z: 0.5 * (back + front),
            shoulder: at(rig::CLAVICLE + rig::UPPER_ARM),
            hip: at(rig::THIGH),
            ankle: at(rig::THIGH + rig::FOOT),
        }
    }

    /// The height of the head as a multiple of 0.23 m.
    fn head(&self) -> f32 {
        (self.crown - self.chin) / 0.23
    }

    /// Distance of a point of the skin from the hairline, metres, negative outside. The line runs across the forehead a third of the
    /// face above the brows, in front of the ears at the temples, behind them, and to the nape.
    fn inside_hairline(&self, p: Vec3) -> f32 {
        // Azimuth about the skull's axis, degrees from the face; height above the eyes on a head of 0.23 m.
        const LINE: [[f32; 2]; 16] = [
            [0.0, 0.0775],
            [14.0, 0.0785],
            [30.0, 0.0765],
            [44.0, 0.0660],
            [56.0, 0.0500],
            [66.0, 0.0340],
            [74.0, 0.0130],
            [80.0, -0.0080],
            [85.0, -0.0130],
            [91.0, -0.0020],
            [100.0, 0.0080],
            [110.0, -0.0040],
            [120.0, -0.0260],
            [132.0, -0.0520],
            [150.0, -0.0760],
            [180.0, -0.0840],
        ];
        let azimuth = p.x.abs().atan2(p.z - self.skull_z).to_degrees();
        let at = |a: f32| curve(&LINE, a.clamp(0.0, 180.0))[1];
        let radius = p.x.hypot(p.z - self.skull_z).max(0.02);
        let rise = (at(azimuth + 1.0) - at(azimuth - 1.0)) / (2.0_f32.to_radians() * radius);
        ((p.y - self.eye.y) - at(azimuth) * self.head()) / (1.0 + rise * rise).sqrt()
    }

    /// How far skin moves with the head alone: that with hair does, and it fades away below the hairline.
    pub(super) fn moves_with_head(&self, p: Vec3) -> f32 {
        smoothstep(-0.045, -0.003, self.inside_hairline(p)).max(smoothstep(self.chin, self.nose.y, p.y))
    }

    /// The scalp: above the hairline, not on the ears, and only on skin that is joined to the crown by such skin.
    pub(super) fn scalp(&self, skin: &Surface, ears: &[bool]) -> Vec<f32> {
        let near_ear: Vec<Vec3> =
            skin.vertices.iter().zip(ears).filter(|(_, ear)| **ear).map(|(v, _)| v.place).collect();
        let raw: Vec<f32> = skin
            .vertices
            .iter()
            .map(|v| {
                let mut inside = self.inside_hairline(v.place);
                if inside > -0.01 && (v.place - self.ear.beside(v.place)).length() < 0.07 {
                    let ear = near_ear.iter().map(|e| e.distance(v.place)).fold(f32::MAX, f32::min);
                    inside = inside.min(ear - 0.011);
                }
                smoothstep(-HAIRLINE_HALF_WIDTH, HAIRLINE_HALF_WIDTH, inside)
            })
            .collect();
        let neighbours = skin.neighbours();
        let top = (0..raw.len())
            .max_by(|a, b| skin.vertices[*a].place.y.total_cmp(&skin.vertices[*b].place.y))
            .unwrap_or(0);
        let mut reached = vec![false; raw.len()];
        let mut open = vec![top as u32];
        while let Some(v) = open.pop() {
            if raw[v as usize] > 0.0 && !std::mem::replace(&mut reached[v as usize], true) {
                open.extend(&neighbours[v as usize]);
            }
        }
        raw.iter().zip(reached).map(|(mask, reached)| if reached { *mask } else { 0.0 }).collect()
    }

    /// The mask of the brows at a place on the skin of the face: an arch that is thick at its inner end and thins outward.
    pub(super) fn brow(&self, p: Vec3) -> f32 {
        let size = self.head();
        let (from, to) = (self.eye.x - 0.0195 * size, self.eye.x + 0.0245 * size);
        let s = (p.x.abs() - from) / (to - from);
        if !(-0.1..1.1).contains(&s) || p.z < self.eye.z {
            return 0.0;
        }
        let arch = 0.0210 + 0.0045 * (1.0 - 0.8 * ((s - 0.64) / 0.64).powi(2)) - 0.0070 * (s - 0.64).max(0.0);
        let half = 0.0042 - 0.0028 * s.clamp(0.0, 1.0);
        let away = half * size - (p.y - self.eye.y - arch * size).abs();
        smoothstep(-0.0015, 0.0010, away) * smoothstep(-0.03, 0.05, s) * smoothstep(1.04, 0.92, s)
    }

    /// Distance from the edge of the top along the skin, metres, negative outside of the cloth: a scoop before and behind with
    /// straps, armholes, and a lower edge at the hips.
    pub(super) fn inside_top(&self, p: Vec3) -> f32 {
        let size = self.shoulder.x / 0.156;
        let x = p.x.abs() / size;
        let y = (p.y - self.shoulder.y) / size + 1.364;
        let z = (p.z - self.shoulder.z) / size - 0.020;
        let [_, edge] = curve(
            &[[1.235, 0.205], [1.262, 0.158], [1.290, 0.134], [1.325, 0.123], [1.370, 0.117], [1.430, 0.114]],
            y,
        );
        let armhole = (edge - x) * 0.85;
        let depth = 0.108 + 0.030 * smoothstep(0.03, -0.06, z);
        let (u, v) = (x / 0.077, (y - 1.425).min(0.0) / depth);
        let rho = (u.powf(2.6) + v.abs().powf(2.6)).powf(1.0 / 2.6);
        let neck = (rho - 1.0) * if v.abs() > u { depth } else { 0.077 };
        armhole.min(neck).min((1.50 - y) * 0.7).min(p.y - self.hem()) * size.min(1.2)
    }

    /// Height of the lower edge of the top.
    fn hem(&self) -> f32 {
        self.hip.y + 0.055 * self.hip.y / 0.885
    }

    /// The same for the leggings, whose upper edge is under the top, and which end above the ankles.
    pub(super) fn inside_leggings(&self, p: Vec3) -> f32 {
        let size = self.hip.y / 0.885;
        let above = self.ankle.y + 0.050 * size;
        (self.hem() + 0.045 - p.y).min(p.y - above).min(0.34 * size - p.x.abs())
    }
}

trait Mirror {
    /// The vector with its x on the side of another.
    fn beside(self, other: Vec3) -> Vec3;
}

impl Mirror for Vec3 {
    fn beside(self, other: Vec3) -> Vec3 {
        self.with_x(self.x.abs().copysign(other.x))
    }
}
