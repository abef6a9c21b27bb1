//! Guides moved at random.
#![allow(dead_code, unreachable_pub, missing_docs)] // A module of tests, each of which uses its part.

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{GuideFrame, Hairstyle};

/// Seeded random numbers (xorshift).
pub struct Random(pub u64);

impl Random {
    /// In 0..1.
    pub fn unit(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    /// In -1..1.
    pub fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    /// In the cube -1..1.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Any rotation.
    pub fn turn(&mut self) -> Quat {
        let axis = self.cube().normalize_or(Vec3::Y);
        Quat::from_axis_angle(axis, std::f32::consts::PI * self.signed())
    }
}

/// A head at a random place in a room.
pub fn head(random: &mut Random) -> Affine3A {
    Affine3A::from_rotation_translation(random.turn(), Vec3::new(0.0, 1.5, 0.0) + random.cube())
}

/// Guides bent by waves, each slightly differently; roots stay on the head.
pub fn moved(style: &Hairstyle, head: Affine3A, random: &mut Random) -> GuideFrame {
    let mut frame = GuideFrame::at_rest(&style.guides, head, 0.0);
    let points = style.guides.points_per_guide;
    let (push, wave) = (0.12 * random.cube(), 9.0 * random.cube());
    let guides = &mut frame.guides;
    for g in 0..guides.count() {
        let own = 0.03 * random.cube();
        for p in 0..points {
            let (t, i) = (p as f32 / (points - 1) as f32, g * points + p);
            let shake = t * t * (push + own + 0.05 * (wave * t + Vec3::splat(0.1 * g as f32)).map(f32::sin));
            guides.x[i] += shake.x;
            guides.y[i] += shake.y;
            guides.z[i] += shake.z;
        }
    }
    frame
}

/// Guides pressed flat against a plane, with displaced points: kinks, folds, links of length zero.
pub fn squashed(style: &Hairstyle, head: Affine3A, random: &mut Random) -> GuideFrame {
    let mut frame = moved(style, head, random);
    let (normal, share) = (random.cube().normalize_or(Vec3::X), random.unit());
    let centre = head.transform_point3(Vec3::ZERO);
    let guides = &mut frame.guides;
    for i in 0..guides.x.len() {
        let p = Vec3::new(guides.x[i], guides.y[i], guides.z[i]);
        let flat = p - share * normal * normal.dot(p - centre) + 0.004 * random.cube();
        let held = i > 0 && random.unit() < 0.02;
        let flat = if held { Vec3::new(guides.x[i - 1], guides.y[i - 1], guides.z[i - 1]) } else { flat };
        (guides.x[i], guides.y[i], guides.z[i]) = (flat.x, flat.y, flat.z);
    }
    frame
}
