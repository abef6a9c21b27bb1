//! Arbitrary numbers, settings, guides, colliders and poses, generated from bytes.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{Guides, Hairstyle, StrandSet, Wisp};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Integrator, RepulsionMode, SimulationSettings};

/// The remaining input.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// The next byte, 0 at the end of the input.
    pub fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// A number between 0 and 1.
    pub fn unit(&mut self) -> f32 {
        f32::from(self.byte()) / 255.0
    }

    /// Any number: ordinary, large, small, infinite or NaN.
    pub fn number(&mut self) -> f32 {
        match self.byte() % 16 {
            0 => f32::from_bits(u32::from_le_bytes([self.byte(), self.byte(), self.byte(), self.byte()])),
            1 => [
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::MAX,
                f32::MIN,
                f32::MIN_POSITIVE,
                1e-40,
                -0.0,
            ][self.byte() as usize % 8],
            2 => 1e4 * (self.unit() - 0.5),
            3 => 0.0,
            4..8 => self.unit() * 0.05,
            8..12 => 2.0 * self.unit() - 1.0,
            _ => 40.0 * self.unit(),
        }
    }

    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}

/// Finite guides of a few shapes around a head of 10 cm, including no guide, single points, and zero-length
/// links.
pub fn style(input: &mut Bytes) -> Arc<Hairstyle> {
    let points = [2, 3, 4, 9, 16][input.byte() as usize % 5];
    let count = [0, 1, 5, 16, 17, 33][input.byte() as usize % 6];
    let (length, curl) = (0.4 * input.unit(), 0.02 * input.unit());
    let mut guides = Guides { points_per_guide: points, ..Guides::default() };
    for g in 0..count {
        let out = Vec3::new((g as f32).cos(), 0.7 - 0.05 * g as f32, (g as f32).sin()).normalize_or(Vec3::Y);
        let line: Vec<Vec3> = (0..points)
            .map(|i| {
                let along = i as f32 / (points - 1) as f32;
                let turn = 5.0 * along + g as f32;
                out * (0.1 + length * along) + Vec3::new(turn.cos(), turn.sin(), 0.0) * curl * along
            })
            .collect();
        guides.push(&line);
    }
    let strands = StrandSet { first_point: vec![0], ..StrandSet::default() };
    // Some styles have locks, and guides that belong to none.
    let locks = if points % 2 == 1 { count / 3 } else { 0 };
    let wisps = (0..locks)
        .map(|w| Wisp { guides: [3 * w, 3 * w + 1, 3 * w + 2], first_strand: 0, strand_count: 0 })
        .collect();
    Arc::new(Hairstyle { guides, wisps, strands, ..Hairstyle::default() })
}

pub fn any_settings(input: &mut Bytes) -> SimulationSettings {
    let mut settings = SimulationSettings::default();
    for _ in 0..input.byte() % 32 {
        one_setting(input, &mut settings);
    }
    settings
}

pub fn one_setting(input: &mut Bytes, s: &mut SimulationSettings) {
    let which = input.byte() % 39;
    let v = input.number();
    match which {
        0 => s.gravity = v,
        1 => s.style_support = v,
        2 => s.substeps = input.byte().into(),
        3 => s.stiffness_root = 10.0 * v,
        4 => s.stiffness_tip = 10.0 * v,
        5 => s.bend_damping = v,
        6 => s.hold = v,
        7 => s.settle = v,
        8 => s.drag = v,
        9 => s.wind.speed = v,
        10 => s.wind.gusts = v,
        11 => s.wind.turbulence = v,
        12 => s.wind.seed = v.to_bits(),
        13 => s.wind.direction = input.vector().to_array(),
        14 => s.friction = v,
        15 => s.skin_margin = v,
        16 => s.layering = v,
        17 => s.repulsion.strength = v,
        18 => s.repulsion.threshold = v,
        19 => s.repulsion.cohesion = v,
        20 => {
            s.repulsion.mode =
                if input.byte().is_multiple_of(2) { RepulsionMode::Centre } else { RepulsionMode::Pressure };
        }
        21 => s.clamped_links = u32::from(input.byte() % 5),
        22 => {
            s.integrator = Integrator::ALL[input.byte() as usize % 3];
            s.follow_damping = v;
        }
        23 => s.stiffness_bias = v,
        24 => s.wind.sheltering = v,
        25 => s.repulsion.anisotropy = v,
        26 => s.weight = v,
        27 => s.weight_tip = v,
        28 => s.drag_tip = v,
        29 => s.air_shelter = v,
        30 => s.cloth_friction = v,
        31 => s.hair_friction = v,
        32 => s.hair_friction_tip = v,
        33 => s.hold_reach = v,
        34 => s.locks.cohesion = 10.0 * v,
        35 => s.locks.cohesion_tip = v,
        36 => s.locks.friction = v,
        37 => s.locks.opening = v,
        _ => s.relaxation_sweeps = input.byte().into(),
    }
}

pub fn any_colliders(input: &mut Bytes) -> Vec<PlacedCollider> {
    (0..input.byte() % 5).map(|_| any_collider(input)).collect()
}

pub fn any_collider(input: &mut Bytes) -> PlacedCollider {
    let world_from_rest = if input.byte().is_multiple_of(4) { any_head(input) } else { Affine3A::IDENTITY };
    let shape = match input.byte() % 4 {
        0 => {
            let (a, b) = (input.vector(), input.vector());
            ColliderShape::Capsule { a, b, radius_a: input.number(), radius_b: input.number() }
        }
        1 => ColliderShape::Ellipsoid { from_unit: any_head(input) },
        2 => {
            let radius = 0.05 + 0.1 * input.unit();
            let b = Vec3::NEG_Y * 0.3 * input.unit();
            ColliderShape::Capsule { a: Vec3::ZERO, b, radius_a: radius, radius_b: 0.08 }
        }
        _ => {
            let from_unit = Affine3A::from_scale(Vec3::new(0.08, 0.11, 0.09) * (0.5 + input.unit()));
            ColliderShape::Ellipsoid { from_unit }
        }
    };
    PlacedCollider { shape, world_from_rest }
}

/// A head transform of any twelve numbers.
pub fn any_head(input: &mut Bytes) -> Affine3A {
    let (x, y, z) = (input.vector(), input.vector(), input.vector());
    let mut m = Affine3A::from_translation(input.vector());
    if input.byte().is_multiple_of(4) {
        m.matrix3 = glam::Mat3A::from_cols(x.into(), y.into(), z.into());
    }
    m
}
