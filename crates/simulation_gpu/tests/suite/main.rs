//! Tests of the simulation on the graphics card against that on the CPU, in one program.

#[path = "../../../simulation/tests/common/mod.rs"]
mod common;

mod agreement;
mod ahead;
mod contacts;
mod failures;

use std::sync::{Arc, LazyLock};

use glam::{Affine3A, Vec3};
use lovelock_gpu::Gpu;
use lovelock_groom::{GuideFrame, Guides};
use lovelock_simulation::{Simulation, SimulationSettings, StepInput, StepReport};
use lovelock_simulation_gpu::{GuideDevice, GuideKernels};

/// The kernels on the best adapter, shared by all tests; `None` without an adapter.
static KERNELS: LazyLock<Option<Arc<GuideKernels>>> = LazyLock::new(|| {
    let gpu = Gpu::open().inspect_err(|error| lovelock_testkit::skip_without_adapter(error)).ok()?;
    Some(Arc::new(GuideKernels::new(&gpu).expect("the kernels compile")))
});

/// A device without guides.
pub fn device() -> Option<GuideDevice> {
    KERNELS.as_ref().map(|kernels| GuideDevice::new(Arc::clone(kernels)))
}

/// A step on the device, which must not refuse it.
pub fn step_on(
    device: &mut GuideDevice,
    simulation: &mut Simulation,
    input: &StepInput,
    settings: &SimulationSettings,
    secs: f32,
) -> StepReport {
    let (report, refusal) = simulation.step_on(device, input, settings, secs);
    assert_eq!(refusal, None);
    report
}

/// The points of all guides, world space.
pub fn points(simulation: &Simulation) -> Vec<Vec3> {
    let mut frame =
        GuideFrame { time_secs: 0.0, world_from_head: Affine3A::IDENTITY, guides: Guides::default() };
    simulation.frame(&mut frame);
    let guides = frame.guides;
    (0..guides.x.len()).map(|i| Vec3::new(guides.x[i], guides.y[i], guides.z[i])).collect()
}

/// Root of the mean square, 99th percentile and maximum of the distances between the points of two simulations, metres.
pub fn apart(a: &Simulation, b: &Simulation) -> [f32; 3] {
    let mut off: Vec<f32> = points(a).iter().zip(points(b)).map(|(a, b)| a.distance(b)).collect();
    off.sort_by(f32::total_cmp);
    let mean = off.iter().map(|d| f64::from(*d).powi(2)).sum::<f64>() / off.len().max(1) as f64;
    let of = |share: f32| off.get((share * (off.len() - 1) as f32) as usize).copied().unwrap_or_default();
    [mean.sqrt() as f32, of(0.99), of(1.0)]
}
