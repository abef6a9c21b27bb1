//! Factors of a hairstyle on the settings of single guides.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_groom::{GuideFrame, Hairstyle, MotionFactors};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};

use crate::common::{STEP_SECS, bare, frame, head, straight, style, violent};

/// A change of the settings, and the list of factors that does the same.
type Case = (fn(&mut MotionFactors) -> &mut Vec<f32>, fn(&mut SimulationSettings, f32));

const CASES: [(&str, Case); 4] = [
    (
        "stiffness",
        (
            |motion| &mut motion.stiffness,
            |s, f| {
                s.stiffness_root *= f;
                s.stiffness_tip *= f;
            },
        ),
    ),
    ("hold", (|motion| &mut motion.hold, |s, f| s.hold *= f)),
    (
        "damping",
        (
            |motion| &mut motion.damping,
            |s, f| {
                s.bend_damping *= f;
                s.settle *= f;
            },
        ),
    ),
    (
        "friction",
        (
            |motion| &mut motion.friction,
            |s, f| {
                s.friction *= f;
                s.cloth_friction *= f;
            },
        ),
    ),
];

/// Two guides far apart, which do not touch each other.
fn two() -> Hairstyle {
    let guides = [-0.1, 0.1].map(|x| straight(Vec3::new(x, 0.0, 0.0), Vec3::new(0.6, -0.8, 0.0), 12, 0.24));
    Hairstyle::clone(&style(&guides))
}

/// The same factor on the first guides of a hairstyle.
fn factors(style: &Hairstyle, guides: usize, factor: f32) -> Vec<f32> {
    let points = style.guides.points_per_guide;
    (0..style.guides.x.len()).map(|i| if i < guides * points { factor } else { 1.0 }).collect()
}

fn settings() -> SimulationSettings {
    let mut settings = SimulationSettings { hair_friction: 0.0, ..SimulationSettings::default() };
    (settings.repulsion.strength, settings.repulsion.cohesion) = (0.0, 0.0);
    settings
}

/// A ball below each root of [`two`].
fn balls() -> [PlacedCollider; 2] {
    [-0.1, 0.1].map(|x| {
        let at = Vec3::new(x + 0.03, -0.1, 0.0);
        let shape = ColliderShape::Capsule { a: at, b: at + Vec3::Z * 0.01, radius_a: 0.05, radius_b: 0.05 };
        PlacedCollider { shape, world_from_rest: Affine3A::IDENTITY }
    })
}

/// The guides after a second and a half of fast motion among two balls.
fn moved(style: &Hairstyle, settings: &SimulationSettings) -> GuideFrame {
    let mut simulation = Simulation::new(Arc::new(style.clone()));
    let balls = balls();
    simulation.reset(&StepInput::new(0.0, Affine3A::IDENTITY, &balls));
    for step in 1..90 {
        let t = f64::from(step) / 60.0;
        let sway = Vec3::X * (0.03 * (t as f32 * 9.0).sin());
        simulation.step(&StepInput::new(t, Affine3A::from_translation(sway), &balls), settings, STEP_SECS);
    }
    frame(&simulation)
}

fn points(frame: &GuideFrame, guide: usize) -> Vec<Vec3> {
    (0..frame.guides.points_per_guide).map(|i| frame.guides.point(guide, i)).collect()
}

#[test]
fn a_factor_on_a_guide_is_that_factor_on_the_settings_and_leaves_other_guides_alone() {
    let plain = two();
    let settings = settings();
    let as_it_is = moved(&plain, &settings);
    for (name, (list, scale)) in CASES {
        let mut doubled = plain.clone();
        *list(&mut doubled.motion) = factors(&plain, 1, 2.0);
        let mut set = settings;
        scale(&mut set, 2.0);
        let (with_factor, with_settings) = (moved(&doubled, &settings), moved(&plain, &set));
        // Powers of two are exact.
        assert_eq!(points(&with_factor, 0), points(&with_settings, 0), "{name}");
        assert_eq!(points(&with_factor, 1), points(&as_it_is, 1), "{name}, the other guide");
        assert_ne!(points(&with_factor, 0), points(&as_it_is, 0), "control: {name} changes something");
        *list(&mut doubled.motion) = factors(&plain, 2, 1.0);
        assert_eq!(moved(&doubled, &settings), as_it_is, "{name}: factors of 1");
        *list(&mut doubled.motion) = factors(&plain, 2, f32::NAN);
        assert_eq!(moved(&doubled, &settings), as_it_is, "{name}: factors that are not numbers");
    }
}

/// Period of the slowest sway of a stiff, weightless wisp that its hold pulls back, seconds.
fn period(hold: f32) -> f32 {
    let mut hair = Hairstyle::clone(&style(&[straight(Vec3::ZERO, Vec3::NEG_Y, 10, 0.2)]));
    hair.motion.hold = factors(&hair, 1, hold);
    let settings = SimulationSettings {
        gravity: 0.0,
        stiffness_root: 120.0,
        stiffness_tip: 120.0,
        hold: 20.0,
        ..bare()
    };
    let mut simulation = Simulation::new(Arc::new(hair));
    // Released with the head turned back by a fifth of a radian.
    simulation.reset(&head(0.0, Affine3A::from_rotation_z(0.2)));
    let (mut last, mut passes, mut time) = (None, Vec::new(), 0.0_f32);
    let dt = 1.0 / 480.0;
    for step in 1..4000 {
        simulation.step(&head(f64::from(step) * f64::from(dt), Affine3A::IDENTITY), &settings, dt);
        let x = frame(&simulation).guides.point(0, 10).x;
        time += dt;
        if let Some(last) = last.filter(|last: &f32| last * x < 0.0) {
            passes.push(time - dt * x / (x - last));
        }
        last = Some(x);
        if passes.len() == 3 {
            break;
        }
    }
    assert_eq!(passes.len(), 3, "it sways");
    passes[2] - passes[0]
}

#[test]
fn a_wisp_held_twice_as_firmly_sways_twice_as_fast() {
    let [once, twice] = [1.0, 2.0].map(period);
    println!("{once} s, {twice} s");
    assert!((once / twice - 2.0).abs() < 0.06, "{}", once / twice);
}

#[test]
fn damped_hair_comes_to_rest_sooner() {
    let left = |factor: f32| {
        let mut hair = two();
        hair.motion.damping = factors(&hair, 2, factor);
        let mut simulation = Simulation::new(Arc::new(hair));
        simulation.reset(&head(0.0, Affine3A::from_rotation_z(0.5)));
        let mut energy = 0.0;
        for step in 1..60 {
            let report =
                simulation.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &settings(), STEP_SECS);
            if step > 40 {
                energy += report.kinetic_energy;
            }
        }
        energy
    };
    let [none, one, four] = [0.0, 1.0, 4.0].map(left);
    println!("{none} {one} {four}");
    assert!(four < 0.2 * one && one < none, "{four}, {one} and {none} J/kg");
}

#[test]
fn hair_with_friction_stays_where_it_lies_when_its_root_moves_aside() {
    const ASIDE: f32 = 0.02;
    let followed = |factor: f32| {
        // Nearly a plane, on which the hair lies.
        let lying = straight(Vec3::ZERO, Vec3::X, 12, 0.18);
        let mut hair = Hairstyle::clone(&style(&[lying]));
        hair.motion.friction = factors(&hair, 1, factor);
        let below = Vec3::NEG_Y * 2.002;
        let ball =
            ColliderShape::Capsule { a: below, b: below + Vec3::Z * 1e-3, radius_a: 2.0, radius_b: 2.0 };
        let ball = [PlacedCollider { shape: ball, world_from_rest: Affine3A::IDENTITY }];
        let settings = SimulationSettings { friction: 0.1, cloth_friction: 0.1, ..bare() };
        let mut simulation = Simulation::new(Arc::new(hair));
        simulation.reset(&StepInput::new(0.0, Affine3A::IDENTITY, &ball));
        let mut before = Vec3::ZERO;
        for step in 1..80 {
            let aside = (0.002 * (step - 30).max(0) as f32).min(ASIDE);
            let at = Affine3A::from_translation(Vec3::Z * aside);
            simulation.step(&StepInput::new(f64::from(step) / 60.0, at, &ball), &settings, STEP_SECS);
            if step == 30 {
                before = frame(&simulation).guides.point(0, 11);
            }
        }
        (frame(&simulation).guides.point(0, 11) - before).z / ASIDE
    };
    let [loose, plain, clinging] = [0.0, 1.0, 8.0].map(|factor| followed(factor).abs());
    println!("{loose}, {plain} and {clinging} times the way of the root");
    assert!(loose > 10.0 * plain && plain > 5.0 * clinging, "{loose}, {plain}, {clinging}");
}

#[test]
fn factors_and_strands_change_in_motion_without_a_jump() {
    let plain = two();
    let mut firm = plain.clone();
    firm.motion.stiffness = factors(&plain, 1, 4.0);
    firm.motion.hold = factors(&plain, 2, 4.0);
    let run = |change: bool| {
        let mut simulation = Simulation::new(Arc::new(plain.clone()));
        simulation.reset(&head(0.0, Affine3A::IDENTITY));
        let mut fastest = 0.0_f32;
        for step in 1..60 {
            if change && step == 20 {
                let before = simulation.state_hash();
                simulation.set_style(Arc::new(firm.clone()));
                assert_eq!(simulation.state_hash(), before, "the state stays, bit for bit");
            }
            let report = simulation.step(
                &head(f64::from(step) / 60.0, violent(f64::from(step) / 60.0)),
                &settings(),
                STEP_SECS,
            );
            fastest = fastest.max(report.max_speed);
        }
        (fastest, simulation.state_hash())
    };
    let ((plain, before), (changed, after)) = (run(false), run(true));
    println!("{plain} m/s, {changed} m/s");
    assert!(changed < 1.3 * plain, "{changed} m/s, {plain} m/s without a change");
    assert_ne!(before, after, "control: the factors act");
}
