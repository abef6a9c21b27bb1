//! Error, time and memory of the methods on one hairstyle.

use glam::Vec3;
use lovelock_base::clock::Stopwatch;
use lovelock_base::settings::Settings;
use lovelock_shadow::{
    CpuShadow, ExactMap, MapKind, ShadowMethod, ShadowReport, ShadowSettings, converged, cpu_shadow,
};

use crate::common::SplitMix64;
use crate::grooms::Groom;
use crate::on_gpu::{self, OnGpu};

/// The number of runs per median.
pub(crate) const RUNS: usize = 15;
/// Runs that take longer together are fewer, milliseconds.
pub(crate) const MOST_MS: f64 = 10_000.0;
/// Random points of the comparison with the converged shadow.
pub(crate) const CONVERGED_POINTS: usize = 2000;
/// A point with fewer fragments than this before it belongs to the first ten.
pub(crate) const FIRST: u32 = 10;

/// Errors are differences of transmittance, 0 to 1.
pub(crate) struct Errors {
    /// RMSE against `exact` with the same number of texels.
    pub(crate) exact: f64,
    /// The same over points among the first ten fragments.
    pub(crate) first: f64,
    /// Mean difference from `exact`: above 0 if the method is too bright.
    pub(crate) bias: f64,
    /// The 99th percentile of the absolute difference.
    pub(crate) percentile: f64,
    /// RMSE against the converged shadow.
    pub(crate) converged: f64,
}

/// Milliseconds of many runs.
pub(crate) struct Time {
    pub(crate) median: f64,
    /// The quartiles: half of the runs lie between.
    pub(crate) low: f64,
    pub(crate) high: f64,
}

pub(crate) struct Measured {
    pub(crate) method: ShadowMethod,
    /// Texels or cells along the edge of the map.
    pub(crate) edge: u32,
    pub(crate) errors: Errors,
    pub(crate) build: Time,
    pub(crate) lookup: Time,
    pub(crate) report: ShadowReport,
    pub(crate) on_gpu: Option<OnGpu>,
    /// Points among the first ten fragments.
    pub(crate) first_points: usize,
}

/// The methods with their default settings.
pub(crate) fn methods(groom: &Groom, methods: &[ShadowMethod]) -> Vec<Measured> {
    let truth = Converged::new(groom);
    let mut exact: Vec<Exact> = Vec::new();
    let measured = methods.iter().map(|&method| {
        let resolution = resolution(method);
        if exact.iter().all(|exact| exact.resolution != resolution) {
            exact.push(Exact::new(groom, resolution));
        }
        let exact = exact.iter().find(|exact| exact.resolution == resolution).expect("made above");
        one(method, groom, exact, &truth)
    });
    measured.collect()
}

/// Texels or cells along the edge of the map with default settings. `none` has no map and is compared with `exact`.
fn resolution(method: ShadowMethod) -> u32 {
    let settings = ShadowSettings { method, ..ShadowSettings::default() };
    settings.map_size().map_or_else(|| settings.exact.clamped().resolution, |size| size.edge)
}

/// Texels or cells along the edge of the map that was made: texels are no narrower than strands, so that there may be
/// fewer of them than asked for.
fn edge(report: &ShadowReport, method: ShadowMethod) -> u32 {
    let cells = report.cells_total as f64;
    let edge = if method.map_kind() == MapKind::Cells { cells.cbrt() } else { cells.sqrt() };
    edge.round() as u32
}

/// The sorted shadow at every point.
struct Exact {
    resolution: u32,
    light: Vec<f32>,
    /// Whether each point lies among the first ten fragments.
    first: Vec<bool>,
}

impl Exact {
    fn new(groom: &Groom, resolution: u32) -> Self {
        let mut settings = ShadowSettings::default();
        settings.exact.resolution = resolution;
        let mut map = ExactMap::default();
        map.build(&groom.input(), &settings).expect("hair fits");
        let hair = &groom.strands;
        let points: Vec<_> = (0..hair.points()).map(|point| hair.point(point)).collect();
        let first = map
            .fragments_before(&points)
            .unwrap_or_default()
            .into_iter()
            .map(|before| before < FIRST)
            .collect();
        Self { resolution, light: look_up(&map, groom), first }
    }
}

/// The converged shadow at some of the points, over texels of the default map of `exact`.
struct Converged {
    points: Vec<usize>,
    light: Vec<f32>,
}

impl Converged {
    fn new(groom: &Groom) -> Self {
        let hair = &groom.strands;
        let mut random = SplitMix64::new(12);
        let draw = |_| (random.unit() * hair.points() as f32) as usize % hair.points();
        let points: Vec<_> = (0..CONVERGED_POINTS).map(draw).collect();
        let axis = |of: fn(Vec3) -> f32| points.iter().map(|at| of(hair.point(*at))).collect::<Vec<_>>();
        let (x, y, z) = (axis(|p| p.x), axis(|p| p.y), axis(|p| p.z));
        let settings = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
        let found = converged(&groom.input(), &settings, [&x, &y, &z]).expect("hair fits");
        eprintln!("  {} samples an edge, change {:.4}", found.samples, found.change);
        Self { points, light: found.transmittance }
    }
}

fn one(method: ShadowMethod, groom: &Groom, exact: &Exact, truth: &Converged) -> Measured {
    let settings = ShadowSettings { method, ..ShadowSettings::default() };
    let mut map = cpu_shadow(method);
    // Not measured: the first build allocates the memory that later ones reuse.
    map.build(&groom.input(), &settings).expect("hair fits");
    let build = time(|| map.build(&groom.input(), &settings).expect("hair fits"));
    let mut light = look_up(&*map, groom);
    let hair = &groom.strands;
    let lookup = time(|| map.transmittance_at(&hair.x, &hair.y, &hair.z, &mut light));
    let first = exact.first.iter().enumerate().filter(|(_, first)| **first).map(|(point, _)| point);
    let pairs = |point: usize| (light[point], exact.light[point]);
    Measured {
        method,
        edge: edge(&map.report(), method),
        errors: Errors {
            exact: rmse((0..light.len()).map(pairs)),
            first: rmse(first.clone().map(pairs)),
            bias: mean((0..light.len()).map(pairs).map(|(a, b)| f64::from(a) - f64::from(b))),
            percentile: percentile(&light, &exact.light),
            converged: rmse(truth.points.iter().zip(&truth.light).map(|(point, t)| (light[*point], *t))),
        },
        build,
        lookup,
        report: map.report(),
        on_gpu: on_gpu::measure(method, groom, &light, &exact.light),
        first_points: first.count(),
    }
}

fn look_up(map: &dyn CpuShadow, groom: &Groom) -> Vec<f32> {
    let hair = &groom.strands;
    let mut light = vec![f32::NAN; hair.points()];
    map.transmittance_at(&hair.x, &hair.y, &hair.z, &mut light);
    light
}

fn time(mut run: impl FnMut()) -> Time {
    let mut times = Vec::new();
    while times.len() < RUNS && times.iter().sum::<f64>() < MOST_MS {
        let watch = Stopwatch::start();
        run();
        times.push(watch.ms());
    }
    median(times)
}

/// Of at least one time, milliseconds.
pub(crate) fn median(mut times: Vec<f64>) -> Time {
    times.sort_by(f64::total_cmp);
    let runs = times.len();
    Time { median: times[runs / 2], low: times[runs / 4], high: times[runs - 1 - runs / 4] }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    if count == 0 { 0.0 } else { sum / count as f64 }
}

pub(crate) fn rmse(pairs: impl Iterator<Item = (f32, f32)>) -> f64 {
    mean(pairs.map(|(a, b)| (f64::from(a) - f64::from(b)).powi(2))).sqrt()
}

pub(crate) fn percentile(a: &[f32], b: &[f32]) -> f64 {
    let mut errors: Vec<_> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    errors.sort_by(f32::total_cmp);
    errors.get(errors.len() * 99 / 100).copied().map_or(0.0, f64::from)
}
