//! Invalid input, jumps and unusual styles: nothing breaks, and every incident is counted.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_base::settings::Settings;
use lovelock_groom::{Hairstyle, Wisp};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Integrator, RepulsionMode, Simulation, SimulationSettings, StepInput, StepReport};
use lovelock_testkit::suite::is_long;
use proptest::prelude::*;

use crate::common::{STEP_SECS, frame, head, straight, style};

fn guides(count: usize) -> Vec<Vec<Vec3>> {
    (0..count)
        .map(|g| {
            let out = Vec3::new((g as f32).cos(), -0.5, (g as f32).sin());
            straight(out * 0.1, out.normalize_or(Vec3::Y), 15, 0.2)
        })
        .collect()
}

fn skull(radius: f32) -> PlacedCollider {
    let shape = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y * 0.05, radius_a: radius, radius_b: 0.09 };
    PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY }
}

fn input(step: i32, colliders: &[PlacedCollider]) -> StepInput<'_> {
    let sway = 0.1 * (step as f32 * 0.3).sin();
    StepInput::new(f64::from(step) / 60.0, Affine3A::from_translation(Vec3::X * sway), colliders)
}

fn all_finite(simulation: &Simulation) -> bool {
    let guides = frame(simulation).guides;
    [guides.x, guides.y, guides.z].iter().flatten().all(|v| v.is_finite() && v.abs() < 100.0)
}

#[test]
fn non_finite_colliders_and_heads_are_survived() {
    let settings = SimulationSettings::default();
    let nan = f32::NAN;
    let broken = [
        PlacedCollider { world_from_rest: Affine3A::NAN, ..skull(0.1) },
        skull(nan),
        skull(f32::INFINITY),
        PlacedCollider {
            shape: ColliderShape::Ellipsoid { from_unit: Affine3A::NAN },
            world_from_rest: Affine3A::IDENTITY,
        },
    ];
    for bad in broken {
        let mut simulation = Simulation::new(style(&guides(20)));
        simulation.reset(&input(0, &[skull(0.08)]));
        for step in 1..60 {
            let collider = if step % 7 == 3 { bad } else { skull(0.08) };
            simulation.step(&input(step, &[collider]), &settings, STEP_SECS);
            assert!(all_finite(&simulation), "{bad:?} at step {step}");
        }
    }
    let mut simulation = Simulation::new(style(&guides(20)));
    simulation.reset(&input(0, &[]));
    for step in 1..60 {
        let mut input = input(step, &[]);
        if step % 5 == 0 {
            input.world_from_head = Affine3A::NAN;
        }
        if step % 11 == 0 {
            input.time_secs = f64::NAN;
        }
        let dt = if step % 13 == 0 { nan } else { STEP_SECS };
        simulation.step(&input, &settings, dt);
        assert!(all_finite(&simulation), "step {step}");
    }
}

#[test]
fn a_non_finite_guide_is_counted_and_does_not_affect_the_others() {
    let mut guides = guides(20);
    let good = style(&guides);
    guides[7][9].y = f32::NAN;
    let run = |style: Arc<Hairstyle>| -> (u32, [Vec3; 2]) {
        let mut simulation = Simulation::new(style);
        simulation.reset(&input(0, &[]));
        let mut settings = SimulationSettings::default();
        // Guides interact through the grid only.
        (settings.repulsion.strength, settings.repulsion.cohesion) = (0.0, 0.0);
        (settings.hair_friction, settings.air_shelter) = (0.0, 0.0);
        let recovered =
            (1..30).map(|s| simulation.step(&input(s, &[]), &settings, STEP_SECS).recovered_guides).sum();
        // One in the same block of sixteen, and one in another block.
        (recovered, [1, 3].map(|guide| frame(&simulation).guides.point(guide, 15)))
    };
    let (none, tips) = run(good);
    let (some, same) = run(style(&guides));
    assert_eq!(none, 0);
    assert!(some > 0, "a non-finite guide must be counted");
    assert_eq!(tips, same);
}

/// Velocities in the head's frame, as the difference of two frames.
fn tips(simulation: &Simulation) -> Vec<Vec3> {
    let now = frame(simulation);
    let from = now.world_from_head.inverse();
    let n = now.guides.points_per_guide;
    (0..now.guides.count()).map(|g| from.transform_point3(now.guides.point(g, n - 1))).collect()
}

#[test]
fn a_jump_moves_the_hair_rigidly() {
    let settings = SimulationSettings::default();
    // A teleport, a seek back, a seek forward, a rotation of the whole body.
    let shift = Affine3A::from_translation(Vec3::new(3.0, 0.2, -1.0));
    let turned = Affine3A::from_rotation_y(2.5);
    for (there, clock) in [(shift, 0.0), (shift, -0.4), (shift, 5.0), (turned, 0.0)] {
        let mut stays = Simulation::new(style(&guides(30)));
        stays.reset(&input(0, &[]));
        for step in 1..20 {
            stays.step(&input(step, &[]), &settings, STEP_SECS);
        }
        let mut jumps = stays.clone();
        let place = |s: i32, moved: bool| {
            let still = input(s, &[]);
            if moved {
                head(still.time_secs + clock, there * input(19, &[]).world_from_head)
            } else {
                head(still.time_secs, input(19, &[]).world_from_head)
            }
        };
        let before = tips(&jumps);
        let report = jumps.step(&place(19, true), &settings, STEP_SECS);
        assert!(report.jumped, "{clock} s");
        for (a, b) in before.iter().zip(tips(&jumps)) {
            // Rounding of world positions of 3 m.
            assert!((*a - b).length() < 2e-6, "hair moved relative to the head in a jump");
        }
        // In the next second the hair moves as if nothing had happened.
        let mut whip = 0.0_f32;
        for step in 20..80 {
            let a = stays.step(&place(step, false), &settings, STEP_SECS);
            let b = jumps.step(&place(step, true), &settings, STEP_SECS);
            whip = whip.max(b.max_speed - a.max_speed);
            assert!(!b.jumped);
        }
        // Rounding at another place grows a little over a second of motion.
        assert!(whip < 0.02, "the jump whips the hair by {whip} m/s");
        for (a, b) in tips(&stays).iter().zip(tips(&jumps)) {
            assert!((*a - b).length() < 2e-3, "{a} became {b}");
        }
    }
    // The same movement within an ordinary step does whip it.
    let mut dragged = Simulation::new(style(&guides(30)));
    dragged.reset(&head(0.0, Affine3A::IDENTITY));
    let far = Affine3A::from_translation(Vec3::X * 0.4);
    let report = dragged.step(&head(1.0 / 60.0, far), &settings, STEP_SECS);
    assert!(!report.jumped && report.max_speed > 5.0, "{report:?}");
}

#[test]
fn a_new_style_keeps_the_motion() {
    let settings = SimulationSettings::default();
    let longer: Vec<Vec<Vec3>> =
        guides(30).iter().map(|g| straight(g[0], (g[1] - g[0]).normalize_or(Vec3::Y), 15, 0.22)).collect();
    let mut simulation = Simulation::new(style(&guides(30)));
    simulation.reset(&input(0, &[]));
    let mut report = StepReport::default();
    for step in 1..25 {
        report = simulation.step(&input(step, &[]), &settings, STEP_SECS);
    }
    let before = tips(&simulation);
    simulation.set_style(style(&longer));
    for (n, (a, b)) in before.iter().zip(tips(&simulation)).enumerate() {
        let root = longer[n][0];
        // The same shape, a tenth longer.
        assert!(((b - root) - (*a - root) * 1.1).length() < 2e-3, "guide {n} moved from {a} to {b}");
    }
    let after = simulation.step(&input(25, &[]), &settings, STEP_SECS);
    assert!(after.kinetic_energy > 0.5 * report.kinetic_energy, "the motion was lost");
    assert!(after.max_speed < 2.0 * report.max_speed, "the change threw the hair");
    // A different number of guides cannot take over the motion and starts at rest.
    simulation.set_style(style(&guides(12)));
    assert_eq!(frame(&simulation).guides.count(), 12);
    assert!(all_finite(&simulation));
}

#[test]
fn degenerate_styles_are_safe() {
    let settings = SimulationSettings::default();
    let p = Vec3::new(0.0, 0.1, 0.0);
    let odd: Vec<Arc<Hairstyle>> = vec![
        Arc::new(Hairstyle::default()),
        style(&[]),
        style(&[straight(p, Vec3::Y, 30, 0.2)]),
        style(&[vec![p, p + Vec3::Y * 0.05]]),
        style(&[vec![p; 8]]),
        style(&[vec![p, p, p + Vec3::X * 0.01, p + Vec3::X * 0.01, p]]),
        style(&guides(17)),
    ];
    for style in odd {
        for clamped_links in 0..3 {
            let settings = SimulationSettings { clamped_links, ..settings };
            let mut simulation = Simulation::new(Arc::clone(&style));
            simulation.reset(&input(0, &[skull(0.08)]));
            for step in 1..40 {
                let report = simulation.step(&input(step, &[skull(0.08)]), &settings, STEP_SECS);
                assert_eq!(report.recovered_guides, 0);
                assert!(report.max_stretch < 1e-4 && all_finite(&simulation));
            }
            assert_eq!(frame(&simulation).guides.count(), style.guides.count());
        }
    }
}

/// Any number, with a bias to those that cause problems.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>(), -10.0_f32..300.0, Just(f32::NAN), Just(f32::INFINITY), Just(0.0)]
}

/// Settings from twenty-four floats in the order of the fields, and five integers.
fn settings_of(v: &[f32], n: [u32; 5]) -> SimulationSettings {
    let mut s = SimulationSettings {
        gravity: v[0],
        style_support: v[1],
        substeps: n[0],
        stiffness_root: v[2],
        stiffness_tip: v[3],
        bend_damping: v[4],
        hold: v[5],
        settle: v[6],
        drag: v[7],
        friction: v[8],
        skin_margin: v[9],
        layering: v[10],
        clamped_links: n[1],
        integrator: Integrator::ALL[n[3] as usize % 3],
        relaxation_sweeps: n[4],
        follow_damping: v[20],
        stiffness_bias: v[21],
        ..SimulationSettings::default()
    };
    s.wind.direction = [v[11], v[12], v[13]];
    (s.wind.speed, s.wind.gusts, s.wind.turbulence, s.wind.seed) = (v[14], v[15], v[16], n[2]);
    (s.wind.sheltering, s.repulsion.anisotropy) = (v[22], v[23]);
    (s.repulsion.strength, s.repulsion.threshold, s.repulsion.cohesion) = (v[17], v[18], v[19]);
    (s.weight, s.weight_tip, s.drag_tip, s.air_shelter) = (v[24], v[25], v[26], v[27]);
    (s.cloth_friction, s.hair_friction, s.hair_friction_tip) = (v[28], v[29], v[30]);
    (s.hold_reach, s.locks.opening) = (v[31], v[32]);
    (s.locks.cohesion, s.locks.cohesion_tip, s.locks.friction) = (v[33], v[34], v[35]);
    s.repulsion.mode = if n[2].is_multiple_of(2) { RepulsionMode::Pressure } else { RepulsionMode::Centre };
    s
}

/// The least and the greatest value of each of those numbers.
const LEAST: [f32; NUMBERS] = {
    let mut least = [0.0; NUMBERS];
    (least[18], least[21]) = (1.0, 0.05);
    (least[24], least[25], least[31]) = (0.2, 0.2, 0.02);
    least
};
const GREATEST: [f32; NUMBERS] = [
    30.0, 1.0, 200.0, 200.0, 0.2, 60.0, 20.0, 20.0, 2.0, 0.03, 1.0, 1.0, 1.0, 1.0, 30.0, 1.0, 1.0, 1.0, 10.0,
    20.0, 1.0, 0.95, 1.0, 1.0, 5.0, 5.0, 5.0, 1.0, 2.0, 2.0, 5.0, 2.0, 3.0, 240.0, 2.0, 60.0,
];

/// How many of the settings are numbers.
const NUMBERS: usize = 36;

/// A swaying guide on a skull survives 40 steps with the settings `s`.
fn survives(s: &SimulationSettings) -> Result<(), TestCaseError> {
    // Five locks, and two guides that belong to none.
    let lock = |w: u32| Wisp { guides: [3 * w, 3 * w + 1, 3 * w + 2], first_strand: 0, strand_count: 0 };
    let wisps = (0..5).map(lock).collect();
    let hair = Hairstyle { wisps, ..Hairstyle::clone(&style(&guides(17))) };
    let mut simulation = Simulation::new(Arc::new(hair));
    simulation.reset(&input(0, &[skull(0.08)]));
    for step in 1..40 {
        let report = simulation.step(&input(step, &[skull(0.08)]), s, STEP_SECS);
        // Without its correction follow-the-leader gains energy until guides are lost, and relaxation
        // stretches.
        if s.integrator != Integrator::FollowTheLeader {
            prop_assert_eq!(report.recovered_guides, 0);
            // 30 m/s^2 and a storm of 60 m/s.
            prop_assert!(report.max_speed < 150.0, "{:?}", report);
        }
        if s.integrator != Integrator::Relaxation {
            prop_assert!(report.max_stretch < 1e-3, "{:?}", report);
        }
        prop_assert!(all_finite(&simulation));
    }
    Ok(())
}

#[test]
fn the_tested_ranges_are_those_of_the_settings() {
    let most = settings_of(&[f32::MAX; NUMBERS], [u32::MAX; 5]).clamped();
    let mut v = GREATEST;
    // An infinite wind direction is replaced by the default, because the direction has no range.
    (v[11], v[12], v[13]) = (1.0, 0.0, 0.0);
    assert_eq!(most, settings_of(&v, [16, 2, u32::MAX, u32::MAX, 200]));
    let least = settings_of(&[f32::MIN; NUMBERS], [0; 5]).clamped();
    v = LEAST;
    v[11] = 1.0;
    assert_eq!(least, settings_of(&v, [1, 0, 0, 0, 1]));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(if is_long() { 128 } else { 24 }) })]
    #[test]
    fn no_setting_breaks_the_motion(v in prop::collection::vec(number(), NUMBERS), n in any::<[u32; 5]>()) {
        survives(&settings_of(&v, n))?;
    }

    #[test]
    fn every_setting_s_whole_range_is_safe(
        share in prop::collection::vec(prop_oneof![0.0_f32..=1.0, Just(0.0), Just(1.0)], NUMBERS),
        n in (1_u32..=16, 0_u32..=2, any::<u32>(), 0_u32..3, 1_u32..=200),
    ) {
        let v: Vec<f32> = (0..NUMBERS).map(|i| LEAST[i] * (1.0 - share[i]) + GREATEST[i] * share[i]).collect();
        let s = settings_of(&v, [n.0, n.1, n.2, n.3, n.4]);
        prop_assert_eq!(s, s.clamped());
        survives(&s)?;
    }
}
