//! A saved and restored state continues with the same bits, and invalid bytes are refused.

use glam::{Affine3A, Vec3};
use lovelock_groom::{GroomSettings, HairTie, Preset, TieReach};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Integrator, RestoreError, Simulation, SimulationSettings, StepInput};

use crate::common::{STEP_SECS, Stage, straight, style, violent};

fn guides(count: usize, length: f32) -> Vec<Vec<Vec3>> {
    (0..count)
        .map(|g| {
            let out = Vec3::new((g as f32).cos(), 0.5 - 0.04 * g as f32, (g as f32).sin());
            let out = out.normalize_or(Vec3::Y);
            straight(out * 0.1, out, 15, length)
        })
        .collect()
}

fn body(time: f64) -> [PlacedCollider; 2] {
    let head = violent(time);
    let from_unit = head * Affine3A::from_scale(Vec3::new(0.07, 0.1, 0.09));
    let arm = Affine3A::from_translation(Vec3::new(0.2, -0.2 + 0.1 * time.sin() as f32, 0.0));
    let shape = ColliderShape::Capsule {
        a: arm.transform_point3(Vec3::ZERO),
        b: arm.transform_point3(Vec3::X),
        radius_a: 0.05,
        radius_b: 0.04,
    };
    [
        PlacedCollider { shape: ColliderShape::Ellipsoid { from_unit }, world_from_rest: head },
        PlacedCollider { shape, world_from_rest: arm },
    ]
}

fn step(simulation: &mut Simulation, n: u32, settings: &SimulationSettings) {
    let time_secs = f64::from(n) / 60.0;
    let colliders = body(time_secs);
    simulation.step(&StepInput::new(time_secs, violent(time_secs), &colliders), settings, STEP_SECS);
}

fn started(count: usize, length: f32) -> Simulation {
    let mut simulation = Simulation::new(style(&guides(count, length)));
    let colliders = body(0.0);
    simulation.reset(&StepInput::new(0.0, violent(0.0), &colliders));
    simulation
}

#[test]
fn a_restored_state_continues_with_the_same_bits() {
    for integrator in Integrator::ALL {
        for clamped_links in [1, 2] {
            let mut settings =
                SimulationSettings { integrator, clamped_links, ..SimulationSettings::default() };
            settings.wind.speed = 4.0;
            let mut whole = started(21, 0.2);
            (1..40).for_each(|n| step(&mut whole, n, &settings));
            let (bytes, at) = (whole.save(), whole.state_hash());
            // Restored into a simulation that has had another history and was not even reset in the same way.
            let mut other = Simulation::new(style(&guides(21, 0.2)));
            (1..9).for_each(|n| step(&mut other, 3 * n, &SimulationSettings::default()));
            assert_ne!(other.state_hash(), at);
            other.restore(&bytes).expect("its own bytes");
            assert_eq!((other.state_hash(), other.save() == bytes), (at, true));
            // Control: the same without one part of the state, the wind time.
            let mut calm = started(21, 0.2);
            (1..40).for_each(|n| step(&mut calm, n, &SimulationSettings { gravity: 9.0, ..settings }));
            for n in 40..80 {
                step(&mut whole, n, &settings);
                step(&mut other, n, &settings);
                step(&mut calm, n, &settings);
                assert_eq!(whole.state_hash(), other.state_hash(), "{integrator:?} at step {n}");
            }
            assert_ne!(whole.state_hash(), calm.state_hash());
            assert_ne!(whole.state_hash(), at, "a state that does not change proves nothing");
        }
    }
}

#[test]
fn a_state_saved_in_slow_motion_continues_with_the_same_bits() {
    // The lengths are factorised for the shape of some earlier step, which is part of the state.
    let settings = SimulationSettings::default();
    let slowly = |simulation: &mut Simulation, n: u32| {
        let time_secs = f64::from(n) / 60.0;
        let colliders = body(0.03 * time_secs);
        let input = StepInput::new(time_secs, violent(0.03 * time_secs), &colliders);
        simulation.step(&input, &settings, STEP_SECS);
    };
    for saved_at in [20, 33, 47] {
        let mut whole = started(21, 0.2);
        (1..saved_at).for_each(|n| slowly(&mut whole, n));
        let mut other = Simulation::new(style(&guides(21, 0.2)));
        other.restore(&whole.save()).expect("its own bytes");
        let at = whole.state_hash();
        for n in saved_at..saved_at + 20 {
            slowly(&mut whole, n);
            slowly(&mut other, n);
            assert_eq!(whole.state_hash(), other.state_hash(), "at step {n}");
        }
        assert_ne!(whole.state_hash(), at, "a state that does not change proves nothing");
    }
}

#[test]
fn invalid_states_are_refused_and_change_nothing() {
    let mut simulation = started(21, 0.2);
    (1..20).for_each(|n| step(&mut simulation, n, &SimulationSettings::default()));
    let (bytes, hash) = (simulation.save(), simulation.state_hash());
    let refused = |bytes: &[u8]| {
        let mut copy = simulation.clone();
        let error = copy.restore(bytes).expect_err("a state of something else");
        assert_eq!(copy.state_hash(), hash, "{error}");
        error
    };
    assert!(matches!(refused(b""), RestoreError::Foreign { .. }));
    assert!(matches!(refused(b"\x89PNG\r\n\x1a\n and more"), RestoreError::Foreign { .. }));
    let mut newer = bytes.clone();
    newer[4] = 99;
    assert_eq!(refused(&newer), RestoreError::Version { found: 99 });
    assert_eq!(refused(&started(20, 0.2).save()), RestoreError::Style);
    assert_eq!(refused(&started(21, 0.21).save()), RestoreError::Style);
    for end in [5, 12, 16, 40, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(matches!(refused(&bytes[..end]), RestoreError::Damaged { .. }), "cut at {end}");
    }
    for at in (16..bytes.len()).step_by(997) {
        let mut changed = bytes.clone();
        changed[at] ^= 4;
        assert!(matches!(refused(&changed), RestoreError::Damaged { .. }), "changed at {at}");
    }
    let mut longer = bytes.clone();
    longer.extend_from_slice(&[0; 12]);
    assert!(matches!(refused(&longer), RestoreError::Damaged { .. }));
    // Control: the unchanged bytes are accepted.
    assert_eq!(simulation.clone().restore(&bytes), Ok(()));
}

#[test]
fn a_simulation_without_hair_can_be_saved() {
    let mut empty = Simulation::new(style(&[]));
    let bytes = empty.save();
    assert_eq!(empty.restore(&bytes), Ok(()));
}

#[test]
fn a_restored_state_on_the_dancer_continues_with_the_same_bits_for_any_number_of_threads() {
    let mut stage = Stage::grown(&GroomSettings { wisps: 12, ..GroomSettings::preset(Preset::Long) });
    assert!(stage.field.is_some(), "the shipped dancer has a field");
    stage.tie(&[HairTie { reach: TieReach::BehindEars, ..HairTie::default() }]);
    let settings = SimulationSettings::default();
    let on = |threads: usize, work: &mut (dyn FnMut() + Send)| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(work);
    };
    let mut whole = stage.simulation(Some(0.0));
    let mut other = stage.simulation(Some(3.0));
    let dance = |simulation: &mut Simulation, stage: &mut Stage, steps: std::ops::Range<u32>| {
        for n in steps {
            simulation.step(&stage.at(Some(f64::from(n) / 60.0)), &settings, STEP_SECS);
        }
    };
    on(2, &mut || dance(&mut whole, &mut stage, 1..60));
    let saved = whole.save();
    other.restore(&saved).expect("the same hair on the same body");
    on(1, &mut || dance(&mut whole, &mut stage, 60..100));
    on(8, &mut || dance(&mut other, &mut stage, 60..100));
    assert_eq!(whole.state_hash(), other.state_hash());
    // Restored in the simulation itself.
    whole.restore(&saved).expect("its own state");
    dance(&mut whole, &mut stage, 60..100);
    assert_eq!(whole.state_hash(), other.state_hash());
    // Refused without the body it was saved on.
    let mut alone = Simulation::new(std::sync::Arc::clone(&stage.style));
    assert_eq!(alone.restore(&saved), Err(RestoreError::Body));
    // Control: with one step fewer the state differs.
    other.restore(&saved).expect("the same hair on the same body");
    dance(&mut other, &mut stage, 60..99);
    assert_ne!(whole.state_hash(), other.state_hash());
}
