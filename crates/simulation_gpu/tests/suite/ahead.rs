//! Steps that are begun and finished later, of which the device keeps a part.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_gpu::{Gpu, read_buffer};
use lovelock_groom::{GuideFrame, Guides, Preset};
use lovelock_motion::{ColliderShape, PlacedCollider};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput, StepReport};
use lovelock_simulation_gpu::{GuideDevice, GuideKernels};

use crate::common::{STEP_SECS, Stage, straight, style};
use crate::{apart, device, points, step_on};

fn secs(step: u32) -> f64 {
    f64::from(step) * f64::from(STEP_SECS)
}

/// A step that is begun and then finished.
fn ahead(device: &mut GuideDevice, simulation: &mut Simulation, input: &StepInput) -> StepReport {
    let begun = simulation.begin_on(device, input, &SimulationSettings::default(), STEP_SECS);
    assert!(begun.is_none(), "{begun:?}");
    let (report, refusal) = simulation.finish(device).expect("a step was begun");
    assert_eq!(refusal, None);
    report
}

/// What the device publishes of `simulation`.
fn published(device: &GuideDevice, simulation: &Simulation) -> Option<Vec<f32>> {
    let buffer = device.guides(simulation.state_stamp())?;
    let mut numbers = vec![0.0; buffer.raw().size() as usize / 4];
    read_buffer(device.gpu(), buffer.raw(), &mut numbers).expect("it is read");
    Some(numbers)
}

fn guides_of(simulation: &Simulation) -> Vec<f32> {
    let mut frame =
        GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides: Guides::default() };
    simulation.frame(&mut frame);
    [frame.guides.x, frame.guides.y, frame.guides.z].concat()
}

#[test]
fn steps_that_are_begun_are_those_that_are_waited_for() {
    let (Some(mut device), Some(other)) = (device(), device()) else { return };
    let mut stage = Stage::of_wisps(Preset::Ponytail, 4);
    let settings = SimulationSettings::default();
    let (mut waited, mut begun) = (stage.simulation(Some(0.0)), stage.simulation(Some(0.0)));
    let mut other = other.publishing();
    assert_eq!(published(&other, &begun), None, "there was no step");
    for step in 1..=8 {
        let input = stage.at(Some(secs(step)));
        let report = step_on(&mut device, &mut waited, &input, &settings, STEP_SECS);
        assert_eq!(ahead(&mut other, &mut begun, &input), report, "step {step}");
        assert_eq!(waited.state_hash(), begun.state_hash(), "step {step}");
        let published = published(&other, &begun).expect("the guides of the step");
        assert_eq!(published, guides_of(&begun), "step {step}");
    }
    // What the device has kept is read, and the CPU goes on from it.
    let mut lacking = begun.clone();
    begun.complete(Some(&mut other));
    let input = stage.at(Some(secs(9)));
    assert_eq!(waited.step(&input, &settings, STEP_SECS), begun.step(&input, &settings, STEP_SECS));
    assert_eq!(waited.state_hash(), begun.state_hash());
    assert_eq!(published(&other, &begun), None, "the CPU has moved the hair");
    // Without the device it is computed from the positions, which is nearly the same.
    lacking.step(&input, &settings, STEP_SECS);
    let [rms, _, most] = apart(&waited, &lacking);
    println!("computed from positions: rms {rms} m, at most {most} m");
    assert_ne!(waited.state_hash(), lacking.state_hash(), "control: the state was not whole");
    assert!(most < 2e-3, "{most} m");
}

#[test]
fn what_is_not_the_next_step_needs_the_whole_state() {
    let (Some(mut device), Some(mut other)) = (device(), device()) else { return };
    let mut stage = Stage::of_wisps(Preset::Smooth, 3);
    let settings = SimulationSettings::default();
    let (mut waited, mut begun) = (stage.simulation(Some(0.0)), stage.simulation(Some(0.0)));
    for step in 1..=4 {
        let input = stage.at(Some(secs(step)));
        step_on(&mut device, &mut waited, &input, &settings, STEP_SECS);
        ahead(&mut other, &mut begun, &input);
    }
    // A jump, another number of carried links, and a step that is waited for.
    for (at, settings) in [
        (3.0, settings),
        (3.0 + f64::from(STEP_SECS), SimulationSettings { clamped_links: 2, ..settings }),
        (3.0 + 2.0 * f64::from(STEP_SECS), settings),
    ] {
        let input = stage.at(Some(at));
        let report = step_on(&mut device, &mut waited, &input, &settings, STEP_SECS);
        let (own, refusal) = match begun.begin_on(&mut other, &input, &settings, STEP_SECS) {
            Some(done) => done,
            None => begun.finish(&mut other).expect("a step was begun"),
        };
        assert_eq!((own, refusal), (report, None), "{at} s");
        assert_eq!(waited.state_hash(), begun.state_hash(), "{at} s");
    }
    // Another number of colliders, for which the device makes room anew.
    for (n, count) in [(3.0, 1), (4.0, 3)] {
        let balls = [Affine3A::from_translation(Vec3::Y * 3.0); 3].map(|world_from_rest| PlacedCollider {
            shape: ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y, radius_a: 0.1, radius_b: 0.1 },
            world_from_rest,
        });
        let mut input = stage.at(Some(3.0 + n * f64::from(STEP_SECS)));
        input.colliders = &balls[..count];
        let report = step_on(&mut device, &mut waited, &input, &settings, STEP_SECS);
        assert_eq!(ahead(&mut other, &mut begun, &input), report);
        assert_eq!(waited.state_hash(), begun.state_hash(), "{count} colliders");
    }
    // Hair that was moved by hand.
    let mut frame =
        GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides: Guides::default() };
    begun.frame(&mut frame);
    let rest = begun.style().guides.clone();
    begun.complete(Some(&mut other));
    for simulation in [&mut waited, &mut begun] {
        simulation.move_guides(&frame, &rest, &[0, 4]);
    }
    let input = stage.at(Some(3.0 + 5.0 * f64::from(STEP_SECS)));
    let report = step_on(&mut device, &mut waited, &input, &settings, STEP_SECS);
    assert_eq!(ahead(&mut other, &mut begun, &input), report);
    assert_eq!(waited.state_hash(), begun.state_hash());
}

#[test]
fn a_device_that_is_lost_during_a_step_leaves_the_hair_on_the_head() {
    // The kernels of the shared device are compiled first, so that the driver knows them.
    if device().is_none() {
        return;
    }
    let gpu = Gpu::open().expect("there is an adapter");
    let kernels = Arc::new(GuideKernels::new(&gpu).expect("the kernels compile"));
    let mut device = GuideDevice::new(kernels).publishing();
    let mut stage = Stage::of_wisps(Preset::Smooth, 3);
    let settings = SimulationSettings::default();
    let mut simulation = stage.simulation(Some(0.0));
    for step in 1..4 {
        ahead(&mut device, &mut simulation, &stage.at(Some(secs(step))));
    }
    let before = points(&simulation);
    assert!(simulation.begin_on(&mut device, &stage.at(Some(secs(4))), &settings, STEP_SECS).is_none());
    gpu.device.destroy();
    let refusal = simulation.finish(&mut device).expect("a step was begun").1;
    // A driver may have done the step before the device was lost.
    if let Some(refusal) = refusal {
        assert!(refusal.contains("lost"), "{refusal}");
        assert!(device.is_lost() && published(&device, &simulation).is_none());
    }
    let after = points(&simulation);
    let moved = before.iter().zip(&after).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(moved > 0.0 && moved < 0.1, "{moved} m in a step");
    // It goes on without the device.
    let report = simulation.step(&stage.at(Some(secs(5))), &settings, STEP_SECS);
    assert!(report.recovered_guides == 0 && report.max_stretch < 1e-5, "{report:?}");
}

#[test]
fn guides_that_are_reset_do_not_disturb_the_others() {
    let Some(device) = device() else { return };
    let mut device = device.publishing();
    let mut guides: Vec<_> =
        (0..20).map(|g| straight(Vec3::X * (0.01 * g as f32), Vec3::NEG_Y, 12, 0.2)).collect();
    guides[7][5] = Vec3::NAN;
    let style = style(&guides);
    let still = |step: u32| StepInput::new(secs(step), Affine3A::IDENTITY, &[]);
    let mut simulation = Simulation::new(style);
    simulation.reset(&still(0));
    let mut waited = simulation.clone();
    for step in 1..6 {
        let report = ahead(&mut device, &mut simulation, &still(step));
        assert_eq!(report.recovered_guides, 1);
        assert!(published(&device, &simulation).is_none(), "the device has another state");
        step_on(&mut device, &mut waited, &still(step), &SimulationSettings::default(), STEP_SECS);
    }
    let finite = |simulation: &Simulation| -> Vec<Vec3> {
        points(simulation).into_iter().filter(|p| p.is_finite()).collect()
    };
    assert_eq!(finite(&simulation), finite(&waited));
    assert!(finite(&simulation).len() >= 19 * 13);
}
