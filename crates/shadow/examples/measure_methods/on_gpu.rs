//! The methods on the GPU.

use glam::Vec3;
use lovelock_shadow::{ShadowMethod, ShadowSettings};

use crate::gpu::{Built, Uploaded, device};
use crate::grooms::Groom;
use crate::measure::{MOST_MS, RUNS, Time, median, percentile, rmse};

pub(crate) struct OnGpu {
    /// RMSE against `exact`.
    pub(crate) exact: f64,
    /// The 99th percentile of the difference from the definition.
    pub(crate) difference: f64,
    pub(crate) build: Time,
    pub(crate) lookup: Time,
    /// Memory of the map and its builds, bytes.
    pub(crate) held: u64,
}

/// The name of the adapter; `None` without one.
pub(crate) fn adapter() -> Option<String> {
    device().map(|gpu| format!("{} ({})", gpu.info.name, gpu.info.backend))
}

/// A method with its default settings; `definition` and `exact` are transmittances at every point.
pub(crate) fn measure(
    method: ShadowMethod,
    groom: &Groom,
    definition: &[f32],
    exact: &[f32],
) -> Option<OnGpu> {
    let gpu = device()?;
    let hair = &groom.strands;
    let settings = ShadowSettings { method, ..ShadowSettings::default() };
    let (uploaded, mut built) = (Uploaded::new(gpu, hair), Built::empty(gpu, method));
    let at: Vec<Vec3> = (0..hair.points()).map(|i| hair.point(i)).collect();
    let input = uploaded.input(&groom.input());
    let mut light = Vec::new();
    let (mut builds, mut lookups) = (Vec::new(), Vec::new());
    // Not measured: the first build allocates the memory that later ones reuse.
    while builds.len() <= RUNS && (builds.len() < 2 || builds.iter().chain(&lookups).sum::<f64>() < MOST_MS) {
        built.build_from(0, &input, &settings).expect("hair fits");
        builds.push(built.passes.iter().fold(0.0, |sum, pass| sum + pass.ms));
        light = built.look_up(&at);
        lookups.push(built.passes.iter().fold(0.0, |sum, pass| sum + pass.ms));
    }
    let report = built.shadow.report(0);
    Some(OnGpu {
        exact: rmse(light.iter().copied().zip(exact.iter().copied())),
        difference: percentile(&light, definition),
        build: median(builds.split_off(1)),
        lookup: median(lookups.split_off(1)),
        held: report.memory_bytes + report.scratch_bytes,
    })
}
