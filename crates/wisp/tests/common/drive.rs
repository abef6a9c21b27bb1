//! Bytes as a day in the life of a simulation: settings, motions and edits in any order and with any numbers.
//!
//! Shared by the fuzz target (`fuzz/`) and the tests; needs glam, the groom, the motion and the simulator alone.
#![allow(dead_code, missing_docs, reason = "every user takes its part")]

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides, Hairstyle, StrandSet};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_wisp::{Integrator, RepulsionMode, Simulation, SimulationSettings, StepInput};

/// What a drive has met, so that a test can tell that drives meet everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Met {
    pub steps: u32,
    pub jumps: u32,
    pub recovered: u32,
    pub styles: u32,
    pub resets: u32,
    pub restored: u32,
    pub refused: u32,
    pub fastest: f32,
}

/// The most that one drive does, so that every input ends soon.
const MOST_ACTIONS: u32 = 120;

/// Takes a simulation through what `bytes` say.
///
/// # Panics
/// Where a point is not finite or far from the head, a report is not a number, or a state that was saved and
/// restored is another.
pub fn drive(bytes: &[u8]) -> Met {
    let mut input = Bytes(bytes);
    let mut met = Met::default();
    let mut simulation = Simulation::new(style(&mut input));
    let mut settings = SimulationSettings::default();
    let mut colliders = Vec::new();
    let (mut time_secs, mut head, mut dt) = (0.0, Affine3A::IDENTITY, 1.0 / 60.0);
    let mut saved: Option<Vec<u8>> = None;
    for _ in 0..MOST_ACTIONS {
        if input.0.is_empty() {
            break;
        }
        match input.byte() % 16 {
            0 => settings = any_settings(&mut input),
            1 => one_setting(&mut input, &mut settings),
            2 => colliders = any_colliders(&mut input),
            3 => {
                let at = input.byte() as usize;
                if let Some(collider) = colliders.get_mut(at % 4) {
                    *collider = any_collider(&mut input);
                }
            }
            4 => {
                simulation.set_style(style(&mut input));
                met.styles += 1;
                saved = None;
            }
            5 => {
                let at = StepInput::new(time_secs, head, &colliders);
                simulation.reset(&at);
                met.resets += 1;
            }
            6 => saved = Some(simulation.save()),
            7 => {
                if let Some(bytes) = &saved {
                    let mut bytes = bytes.clone();
                    let hurt = input.byte().is_multiple_of(2);
                    if hurt {
                        let at = (input.byte() as usize * 257 + input.byte() as usize) % bytes.len();
                        bytes[at] ^= input.byte() | 1;
                        if at.is_multiple_of(5) {
                            bytes.truncate(at);
                        }
                    }
                    let before = simulation.state_hash();
                    match simulation.restore(&bytes) {
                        Ok(()) => {
                            assert!(!hurt && simulation.save() == bytes, "a damaged state was taken");
                            met.restored += 1;
                        }
                        Err(error) => {
                            assert!(hurt && before == simulation.state_hash(), "{error}");
                            met.refused += 1;
                        }
                    }
                }
            }
            8 => dt = input.number(),
            9 => time_secs = f64::from(input.number()),
            10 => head = any_head(&mut input),
            _ => {
                dt = if dt > 0.0 && dt < 1.0 { dt } else { 1.0 / 60.0 };
                head = moved(&mut input, head);
            }
        }
        time_secs += f64::from(dt);
        let at = StepInput::new(time_secs, head, &colliders);
        let report = simulation.step(&at, &settings, dt);
        met.steps += 1;
        met.jumps += u32::from(report.jumped);
        met.recovered += report.recovered_guides;
        met.fastest = met.fastest.max(report.max_speed);
        assert!(report.substeps <= lovelock_wisp::MAX_SUBSTEPS);
        // Stretch and speed may be large where a setting asks for it, but they are numbers.
        let numbers = [report.max_stretch, report.max_penetration_m, report.kinetic_energy, report.max_speed];
        assert!(numbers.iter().all(|v| !v.is_nan()), "{report:?}");
        let mut frame = GuideFrame::at_rest(&Guides::default(), Affine3A::IDENTITY, 0.0);
        simulation.frame(&mut frame);
        assert!(sound(&frame), "a point is not finite after {report:?}");
    }
    met
}

/// Whether every point is finite and within reach of the head.
pub fn sound(frame: &GuideFrame) -> bool {
    let place = Vec3::from(frame.world_from_head.translation);
    let (g, size) = (&frame.guides, place.abs().max_element());
    // 320 m from the head is where the simulator itself takes a guide for lost; a head far away rounds.
    let near =
        |v: f32, at: f32| v.is_finite() && (v - at).abs() < 320.0 * (g.points_per_guide as f32).sqrt() + size;
    (0..g.x.len()).all(|i| near(g.x[i], place.x) && near(g.y[i], place.y) && near(g.z[i], place.z))
}

struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    /// The next byte, 0 where there are no more.
    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        first
    }

    /// A number between 0 and 1.
    fn unit(&mut self) -> f32 {
        f32::from(self.byte()) / 255.0
    }

    /// Any number, usual ones, large, small and none at all.
    fn number(&mut self) -> f32 {
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

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}

/// Finite locks of a few shapes around a head of 10 cm: also no lock, one point apart, and links of no length.
fn style(input: &mut Bytes) -> Arc<Hairstyle> {
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
    Arc::new(Hairstyle { guides, strands, ..Hairstyle::default() })
}

fn any_settings(input: &mut Bytes) -> SimulationSettings {
    let mut settings = SimulationSettings::default();
    for _ in 0..input.byte() % 32 {
        one_setting(input, &mut settings);
    }
    settings
}

fn one_setting(input: &mut Bytes, s: &mut SimulationSettings) {
    let which = input.byte() % 27;
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
        _ => s.relaxation_sweeps = input.byte().into(),
    }
}

fn any_colliders(input: &mut Bytes) -> Vec<PlacedCollider> {
    (0..input.byte() % 5).map(|_| any_collider(input)).collect()
}

fn any_collider(input: &mut Bytes) -> PlacedCollider {
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

/// Any twelve numbers.
fn any_head(input: &mut Bytes) -> Affine3A {
    let (x, y, z) = (input.vector(), input.vector(), input.vector());
    let mut m = Affine3A::from_translation(input.vector());
    if input.byte().is_multiple_of(4) {
        m.matrix3 = glam::Mat3A::from_cols(x.into(), y.into(), z.into());
    }
    m
}

/// A head that has moved on as heads do.
fn moved(input: &mut Bytes, head: Affine3A) -> Affine3A {
    let signed = |input: &mut Bytes| 2.0 * input.unit() - 1.0;
    let (turn, axis) = (0.4 * signed(input), input.byte());
    let axis = [Vec3::X, Vec3::Y, Vec3::Z][axis as usize % 3];
    let by = 0.1 * Vec3::new(signed(input), signed(input), signed(input));
    Affine3A::from_translation(by) * head * Affine3A::from_quat(Quat::from_axis_angle(axis, turn))
}
