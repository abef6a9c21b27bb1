//! What a device cannot do: the CPU does the whole step, and a sentence says why.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use lovelock_gpu::{Gpu, wgpu};
use lovelock_groom::Preset;
use lovelock_simulation::{Simulation, SimulationSettings, StepInput};
use lovelock_simulation_gpu::{GuideDevice, GuideKernels};

use crate::common::{STEP_SECS, Stage, bare, straight, style};
use crate::{device, points, step_on};

#[test]
fn a_device_that_is_lost_leaves_the_step_to_the_cpu() {
    let Some(gpu) = Gpu::open().inspect_err(|error| lovelock_testkit::skip_without_adapter(error)).ok()
    else {
        return;
    };
    let kernels = Arc::new(GuideKernels::new(&gpu).expect("the kernels compile"));
    let mut device = GuideDevice::new(kernels);
    let mut stage = Stage::of_wisps(Preset::Smooth, 4);
    let settings = SimulationSettings::default();
    let mut simulation = stage.simulation(Some(0.0));
    let secs = |step: u32| Some(f64::from(step) * f64::from(STEP_SECS));
    for step in 1..6 {
        step_on(&mut device, &mut simulation, &stage.at(secs(step)), &settings, STEP_SECS);
    }
    assert!(!device.is_lost());
    gpu.device.destroy();
    let mut on_cpu = simulation.clone();
    for step in 6..9 {
        let input = stage.at(secs(step));
        let (report, refusal) = simulation.step_on(&mut device, &input, &settings, STEP_SECS);
        let refusal = refusal.expect("the device is lost");
        assert!(refusal.contains("lost"), "{refusal}");
        assert_eq!(report, on_cpu.step(&input, &settings, STEP_SECS));
        assert_eq!(simulation.state_hash(), on_cpu.state_hash(), "the last positions of the device go on");
    }
    assert!(device.is_lost());
}

#[test]
fn a_device_with_small_buffers_says_how_small() {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let wait = |adapter: wgpu::Adapter| {
        let mut descriptor = Gpu::device_descriptor(&adapter);
        descriptor.required_features = wgpu::Features::empty();
        descriptor.required_limits.max_storage_buffer_binding_size = 8 << 20;
        let opened = pollster::block_on(adapter.request_device(&descriptor)).expect("a small device");
        Gpu::adopt(opened.0, opened.1, adapter.get_info())
    };
    let options = wgpu::RequestAdapterOptions::default();
    let gpu = match pollster::block_on(instance.request_adapter(&options)) {
        Ok(adapter) => wait(adapter),
        Err(error) => return lovelock_testkit::skip_without_adapter(&error),
    };
    let mut device = GuideDevice::new(Arc::new(GuideKernels::new(&gpu).expect("the kernels compile")));
    let guides: Vec<_> =
        (0..2000).map(|g| straight(Vec3::X * (1e-4 * g as f32), Vec3::NEG_Y, 30, 0.3)).collect();
    let mut simulation = Simulation::new(style(&guides));
    let still = StepInput::new(0.0, Affine3A::IDENTITY, &[]);
    simulation.reset(&still);
    let mut other = simulation.clone();
    let (_, refusal) = simulation.step_on(&mut device, &still, &bare(), STEP_SECS);
    let refusal = refusal.expect("too many guides");
    println!("{refusal}");
    assert!(refusal.contains("guides") && refusal.contains("at most 8 MB"), "{refusal}");
    assert!(!device.has_room());
    other.step(&still, &bare(), STEP_SECS);
    assert_eq!(simulation.state_hash(), other.state_hash());
    // Fewer guides fit, on the same device.
    let mut small = Simulation::new(style(&guides[..50]));
    small.reset(&still);
    assert_eq!(small.step_on(&mut device, &still, &bare(), STEP_SECS).1, None);
    assert!(device.has_room());
}

#[test]
fn no_guides_need_no_device() {
    let Some(mut device) = device() else { return };
    let mut simulation = Simulation::new(style(&[]));
    let still = StepInput::new(0.0, Affine3A::IDENTITY, &[]);
    simulation.reset(&still);
    let report = step_on(&mut device, &mut simulation, &still, &SimulationSettings::default(), STEP_SECS);
    assert_eq!(report.recovered_guides, 0);
    assert!(points(&simulation).is_empty());
}

#[test]
fn guides_that_are_not_finite_do_not_disturb_the_others() {
    let Some(mut device) = device() else { return };
    let mut guides: Vec<_> =
        (0..20).map(|g| straight(Vec3::X * (0.01 * g as f32), Vec3::NEG_Y, 12, 0.2)).collect();
    let sound = style(&guides);
    guides[7][5] = Vec3::NAN;
    guides[11][3].x = f32::INFINITY;
    let broken = style(&guides);
    let settings = SimulationSettings::default();
    let mut run = |style| {
        let mut simulation = Simulation::new(style);
        simulation.reset(&StepInput::new(0.0, Affine3A::IDENTITY, &[]));
        for step in 1..20 {
            let at = Affine3A::from_translation(Vec3::X * (0.002 * step as f32));
            let input = StepInput::new(f64::from(step) / 60.0, at, &[]);
            step_on(&mut device, &mut simulation, &input, &settings, STEP_SECS);
        }
        points(&simulation)
    };
    let (broken, sound) = (run(broken), run(sound));
    let of = |all: &[Vec3], g: usize| all[13 * g..][..13].to_vec();
    for g in (0..20).filter(|g| ![7, 11].contains(g)) {
        let apart = of(&broken, g).iter().zip(of(&sound, g)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        // The density grid lacks two guides.
        assert!(apart < 5e-3, "guide {g}: {apart} m");
    }
    assert!(of(&broken, 7).iter().any(|p| !p.is_finite()), "control: the guide has no place to return to");
}

#[test]
fn jumps_and_absurd_time_steps_are_those_of_the_cpu() {
    let Some(mut device) = device() else { return };
    let mut stage = Stage::of_wisps(Preset::Smooth, 3);
    let settings = SimulationSettings::default();
    let mut simulation = stage.simulation(Some(0.0));
    let mut other = simulation.clone();
    for (secs, dt) in [(0.02, 0.02), (5.0, 0.02), (5.02, f32::NAN), (5.02, -1.0), (5.04, 0.02)] {
        let input = stage.at(Some(secs));
        let report = step_on(&mut device, &mut simulation, &input, &settings, dt);
        let own = other.step(&input, &settings, dt);
        assert_eq!((report.jumped, report.substeps), (own.jumped, own.substeps));
    }
    let [_, _, most] = crate::apart(&simulation, &other);
    assert!(most < 1e-4, "{most} m");
}
