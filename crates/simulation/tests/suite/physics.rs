//! Chains against analytic solutions.

use glam::{Affine3A, Vec3};
use lovelock_simulation::{Simulation, SimulationSettings, Wind};

use crate::common::{STEP_SECS, bare, distance_from_style, frame, head, straight, stretch, style, violent};

const G: f32 = 9.81;

fn at_rest(guides: &[Vec<Vec3>]) -> Simulation {
    let mut simulation = Simulation::new(style(guides));
    simulation.reset(&head(0.0, Affine3A::IDENTITY));
    simulation
}

#[test]
fn hair_on_a_falling_head_falls_freely() {
    // Root and hair fall together, so no link is under tension. After n substeps of h the semi-implicit rule
    // has fallen by g h^2 n (n + 1) / 2, and so has the head.
    let guides = [straight(Vec3::ZERO, Vec3::X, 10, 0.5)];
    let mut simulation = at_rest(&guides);
    let h = 1.0 / 240.0;
    let settings = SimulationSettings { substeps: 1, ..bare() };
    for step in 1..=120 {
        let n = f64::from(step);
        let fallen = f64::from(G) * h * h * n * (n + 1.0) * 0.5;
        let pose = Affine3A::from_translation(Vec3::new(0.0, -fallen as f32, 0.0));
        let report = simulation.step(&head(n * h, pose), &settings, h as f32);
        assert_eq!(report.substeps, 1);
        let speed = G * step as f32 / 240.0;
        // The head's position is rounded to 1e-7 m, which is 3e-5 m/s over a substep.
        assert!((report.max_speed - speed).abs() < 2e-4, "{} m/s, expected {speed}", report.max_speed);
    }
    // The chain keeps its shape, up to rounding over the head's path of 1.2 m.
    let worst = distance_from_style(&simulation).into_iter().fold(0.0, f32::max);
    assert!(worst * 0.5 < 1e-4, "{} m from free fall", worst * 0.5);
    // With the head held still, the chain hangs down far from where it was.
    let mut held = at_rest(&guides);
    for step in 1..=30 {
        held.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &bare(), STEP_SECS);
    }
    assert!(distance_from_style(&held).into_iter().fold(0.0, f32::max) > 0.3);
}

/// A quarter and a half of the period of a one-link pendulum released at `angle`, from its first two passes
/// through the vertical.
fn pendulum(angle: f32, length: f32) -> (f32, f32) {
    let direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
    let mut simulation = at_rest(&[straight(Vec3::ZERO, direction, 1, length)]);
    let (mut last, mut passes) = (direction.x * length, Vec::new());
    for step in 1..120 {
        simulation.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &bare(), STEP_SECS);
        let x = frame(&simulation).guides.point(0, 1).x;
        if last * x < 0.0 {
            passes.push(STEP_SECS * (step as f32 - x / (x - last)));
        }
        last = x;
    }
    (passes[0], passes[1] - passes[0])
}

#[test]
fn a_pendulum_swings_with_its_period() {
    for length in [0.1_f32, 0.25] {
        let paper = core::f32::consts::TAU * (length / G).sqrt();
        let (_, half) = pendulum(0.05, length);
        assert!((2.0 * half / paper - 1.0).abs() < 0.01, "{} s, expected {paper} s", 2.0 * half);
        // From 120 degrees it takes 1.3729 times as long (complete elliptic integral). Wide swings lose some
        // energy to the placement pass, so only the first quarter is measured there.
        let (quarter, _) = pendulum(2.0944, length);
        assert!(
            (4.0 * quarter / paper / 1.3729 - 1.0).abs() < 0.01,
            "{} times the small one",
            4.0 * quarter / paper
        );
    }
}

#[test]
fn an_undriven_chain_never_gains_energy() {
    for links in [1, 5, 30] {
        let mut simulation = at_rest(&[straight(Vec3::ZERO, Vec3::X, links, 0.3)]);
        let height = |s: &Simulation| {
            let guides = frame(s).guides;
            (1..=links).map(|i| guides.point(0, i).y).sum::<f32>() / links as f32
        };
        let start = G * height(&simulation);
        let fall = G * 0.3;
        let mut moved = 0.0_f32;
        for step in 1..600 {
            let report =
                simulation.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &bare(), STEP_SECS);
            let energy = report.kinetic_energy + G * height(&simulation);
            moved = moved.max(report.kinetic_energy);
            // 1 % of the energy that the chain can lose.
            assert!(
                energy < start + 0.01 * fall,
                "step {step}: {links} links gained {} J/kg",
                energy - start
            );
        }
        assert!(moved > 0.3 * fall, "a chain that does not move proves nothing");
    }
}

#[test]
fn links_keep_their_length_at_every_step_of_a_violent_dance() {
    let guides: Vec<_> = (0..20)
        .map(|g| {
            let turn = g as f32 * 0.7;
            let out = Vec3::new(turn.cos(), 0.4 - 0.05 * g as f32, turn.sin());
            straight(out * 0.1, out.normalize_or(Vec3::Y), 30, 0.3)
        })
        .collect();
    for settings in [SimulationSettings::default(), bare()] {
        let mut simulation = at_rest(&guides);
        for step in 1..400 {
            let time = f64::from(step) / 60.0;
            let report = simulation.step(&head(time, violent(time)), &settings, STEP_SECS);
            assert!(!report.jumped && report.recovered_guides == 0);
            // Positions of up to 0.4 m in f32 are 3e-8 apart; a link of 1 cm has two of them.
            assert!(report.max_stretch < 1e-5, "step {step}: {}", report.max_stretch);
            // In world coordinates, up to 0.7 m, rounding is twice as large.
            assert!(stretch(&simulation) < 2e-5, "step {step}: {}", stretch(&simulation));
            assert!(report.max_speed < 20.0, "step {step}: {} m/s", report.max_speed);
        }
    }
}

#[test]
fn a_crowded_bundle_spreads() {
    // 64 guides that fan out from a patch of 4 cm hang without stiffness: they meet below it in a bundle far
    // denser than the original fan.
    let fan: Vec<_> = (0..64)
        .map(|g| {
            let out = Vec3::new((g % 8) as f32 - 3.5, 0.0, (g / 8) as f32 - 3.5);
            straight(out * 0.005, (out * 0.5 - Vec3::Y).normalize_or(Vec3::NEG_Y), 20, 0.2)
        })
        .collect();
    let run = |strength: f32| {
        let mut settings = SimulationSettings { settle: 4.0, ..bare() };
        settings.repulsion.strength = strength;
        let (mut simulation, mut crowded) = (at_rest(&fan), 0);
        for step in 1..=180 {
            let report =
                simulation.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &settings, STEP_SECS);
            crowded = report.over_dense_cells;
        }
        let guides = frame(&simulation).guides;
        let off_axis = |g: usize| (guides.point(g, 20) * Vec3::new(1.0, 0.0, 1.0)).length();
        ((0..64).map(off_axis).sum::<f32>() / 64.0, crowded)
    };
    let (hanging, _) = run(0.0);
    let (spread, crowded) = run(0.5);
    // The mean distance of the roots from the axis is 19 mm, which is the width of a bundle of guides without
    // interaction.
    assert!((hanging - 0.019).abs() < 0.004, "{hanging} m");
    assert!(crowded > 0, "the bundle is not crowded");
    assert!(spread > 1.1 * hanging, "{spread} m wide with repulsion, {hanging} m without");
}

#[test]
fn the_same_seed_gives_the_same_wind() {
    let guides: Vec<_> = (0..9).map(|g| straight(Vec3::X * 0.01 * g as f32, Vec3::NEG_Y, 20, 0.25)).collect();
    let run = |seed: u32, speed: f32| {
        let wind = Wind { seed, speed, ..Wind::default() };
        let settings = SimulationSettings { wind, ..SimulationSettings::default() };
        let mut simulation = at_rest(&guides);
        for step in 1..=90 {
            simulation.step(&head(f64::from(step) / 60.0, Affine3A::IDENTITY), &settings, STEP_SECS);
        }
        let tip = frame(&simulation).guides.point(4, 20);
        (simulation.state_hash(), tip)
    };
    let (a, tip) = run(1, 5.0);
    assert_eq!(a, run(1, 5.0).0);
    assert_ne!(a, run(2, 5.0).0, "another seed is another wind");
    let (_, calm) = run(1, 0.0);
    assert!(tip.x > calm.x + 0.02, "a wind along +X carries the tip there: {tip}, {calm} without");
}
