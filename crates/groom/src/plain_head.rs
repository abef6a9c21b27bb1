//! A head of average size made of a few smooth solids, for use without a character.

use glam::Vec3;

use crate::{Obstacle, Scalp};

/// Head, ears, neck and shoulders of an adult as blended ellipsoids and capsules: 0.23 m from chin to crown, 0.155 m
/// wide, 0.195 m deep, facing +Z. Its head joint is the origin.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlainHead;

/// Height of the hairline by the angle from the front, degrees and metres: forehead, temple, before and above
/// the ear, behind the ear, nape.
const HAIRLINE: [(f32, f32); 11] = [
    (0.0, 0.178),
    (22.0, 0.179),
    (38.0, 0.170),
    (52.0, 0.145),
    (64.0, 0.112),
    (74.0, 0.098),
    (84.0, 0.122),
    (100.0, 0.120),
    (116.0, 0.078),
    (135.0, 0.045),
    (180.0, 0.030),
];

impl PlainHead {
    /// The point from which the whole surface of the head is visible.
    const CENTRE: Vec3 = Vec3::new(0.0, 0.11, -0.005);

    /// The head's surface, with hair where a head has it: `rings` of `2 * rings` vertices. 48 rings give triangles of
    /// about 6 mm.
    pub fn scalp(self, rings: usize) -> Scalp {
        let rings = rings.clamp(6, 512);
        let across = 2 * rings;
        let mut scalp = Scalp::default();
        for ring in 0..=rings {
            // From the crown down to the neck below the nape, where the head ends.
            let polar = (ring as f32 / rings as f32) * 2.35;
            for i in 0..across {
                let azimuth = (i as f32 / across as f32) * std::f32::consts::TAU;
                let out = Vec3::new(polar.sin() * azimuth.sin(), polar.cos(), polar.sin() * azimuth.cos());
                let p = self.surface_along(out);
                scalp.positions.push(p);
                scalp.normals.push(self.distance(p).1);
                scalp.mask.push(hair_mask(p));
            }
        }
        let vertex = |ring: usize, i: usize| (ring * across + i % across) as u32;
        for ring in 0..rings {
            for i in 0..across {
                let [a, b] = [vertex(ring, i), vertex(ring, i + 1)];
                let [c, d] = [vertex(ring + 1, i), vertex(ring + 1, i + 1)];
                if ring > 0 {
                    scalp.triangles.push([a, c, b]);
                }
                scalp.triangles.push([b, c, d]);
            }
        }
        scalp
    }

    /// Where the ray from the centre leaves the head.
    fn surface_along(self, direction: Vec3) -> Vec3 {
        let (mut inside, mut outside) = (0.02, 0.02);
        while outside < 0.25 && self.distance(Self::CENTRE + direction * outside).0 < 0.0 {
            inside = outside;
            outside += 0.004;
        }
        for _ in 0..24 {
            let middle = 0.5 * (inside + outside);
            if self.distance(Self::CENTRE + direction * middle).0 < 0.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Self::CENTRE + direction * outside
    }
}

/// 1 above the hairline, 0 below, with a transition over 8 mm.
fn hair_mask(p: Vec3) -> f32 {
    let from_centre = p - PlainHead::CENTRE;
    let degrees = from_centre.x.abs().atan2(from_centre.z).to_degrees();
    let next = HAIRLINE.iter().position(|&(angle, _)| angle >= degrees).unwrap_or(HAIRLINE.len() - 1).max(1);
    let ((a0, y0), (a1, y1)) = (HAIRLINE[next - 1], HAIRLINE[next]);
    let line = y0 + (y1 - y0) * ((degrees - a0) / (a1 - a0)).clamp(0.0, 1.0);
    let t = ((p.y - line) / 0.008 + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Obstacle for PlainHead {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let mirrored = Vec3::new(p.x.abs(), p.y, p.z);
        let sign = if p.x < 0.0 { -1.0 } else { 1.0 };
        let cranium = ellipsoid(mirrored, Vec3::new(0.0, 0.122, -0.005), Vec3::new(0.0775, 0.093, 0.0975));
        let face = ellipsoid(mirrored, Vec3::new(0.0, 0.062, 0.030), Vec3::new(0.058, 0.077, 0.058));
        let ear = ellipsoid(mirrored, Vec3::new(0.0745, 0.098, -0.008), Vec3::new(0.010, 0.031, 0.018));
        let neck = capsule(mirrored, Vec3::new(0.0, 0.05, -0.020), Vec3::new(0.0, -0.10, -0.035), 0.054);
        let shoulder =
            capsule(mirrored, Vec3::new(0.0, -0.135, -0.035), Vec3::new(0.165, -0.165, -0.035), 0.055);
        let arm = capsule(mirrored, Vec3::new(0.165, -0.165, -0.035), Vec3::new(0.20, -0.45, -0.045), 0.046);
        let chest = ellipsoid(mirrored, Vec3::new(0.0, -0.32, -0.02), Vec3::new(0.165, 0.24, 0.115));
        let head = blend(blend(cranium, face, 0.03), ear, 0.004);
        let trunk = blend(blend(shoulder, arm, 0.02), chest, 0.04);
        let (distance, normal) = blend(blend(head, neck, 0.02), blend(trunk, neck, 0.05), 0.01);
        let normal = normal.normalize_or(Vec3::Y);
        (distance, Vec3::new(normal.x * sign, normal.y, normal.z))
    }
}

fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> (f32, Vec3) {
    let q = p - centre;
    let (scaled, gradient) = (q / radii, q / (radii * radii));
    let (k, slope) = (scaled.length(), gradient.length().max(1e-6));
    // First-order distance: exact at the surface, a lower bound of the right order elsewhere.
    (k * (k - 1.0) / slope, gradient / slope)
}

fn capsule(p: Vec3, a: Vec3, b: Vec3, radius: f32) -> (f32, Vec3) {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    let out = p - (a + (b - a) * along);
    let length = out.length();
    (length - radius, out / length.max(1e-6))
}

/// Smooth union over `k` metres, with its gradient.
fn blend(a: (f32, Vec3), b: (f32, Vec3), k: f32) -> (f32, Vec3) {
    let h = (0.5 + 0.5 * (b.0 - a.0) / k).clamp(0.0, 1.0);
    (b.0 + (a.0 - b.0) * h - k * h * (1.0 - h), b.1 + (a.1 - b.1) * h)
}
