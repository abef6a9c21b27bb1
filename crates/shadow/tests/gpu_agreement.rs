//! Every method on the GPU against its definition on the processor: transmittance at seeded points, and the error against
//! every fragment sorted.

mod common;
#[path = "common/gpu.rs"]
mod gpu;
#[path = "common/grooms.rs"]
mod grooms;

use common::Random;
use glam::Vec3;
use gpu::{Built, device};
use grooms::Groom;
use lovelock_groom::Strands;
use lovelock_shadow::{CpuShadow, ShadowMethod, ShadowSettings, TexelFilter, cpu_shadow};

/// Points that are asked.
const POINTS: usize = 4096;

/// Differences of transmittance between the two, sorted. A byte's rounding is 0.002.
struct Differences(Vec<f32>);

impl Differences {
    fn of(a: &[f32], b: &[f32]) -> Self {
        let mut all: Vec<_> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
        all.sort_by(f32::total_cmp);
        Self(all)
    }

    fn p99(&self) -> f32 {
        self.0[self.0.len() * 99 / 100]
    }

    fn most(&self) -> f32 {
        self.0[self.0.len() - 1]
    }
}

/// Points of the hair, near it and beside it.
fn points(strands: &Strands, seed: u64) -> Vec<Vec3> {
    let mut random = Random(seed);
    (0..POINTS)
        .map(|i| {
            let at = (random.unit() * strands.points() as f32) as usize;
            let p = strands.point(at.min(strands.points() - 1));
            match i % 4 {
                0 | 1 => p,
                2 => p + 0.004 * random.cube(),
                _ => p + 0.15 * random.cube(),
            }
        })
        .collect()
}

fn ask(shadow: &dyn CpuShadow, at: &[Vec3]) -> Vec<f32> {
    at.iter().map(|&p| shadow.transmittance(p)).collect()
}

#[allow(dead_code)]
fn rmse(a: &[f32], b: &[f32]) -> f32 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt() as f32
}

fn one_strand() -> Groom {
    let line = (0..30).map(|i| Vec3::new(0.002 * i as f32, 0.1 - 0.005 * i as f32, 0.001 * i as f32));
    Groom { name: "one strand", strands: common::strands(&[line.collect()]), width: 2e-3 }
}

fn all_grooms() -> Vec<Groom> {
    let mut all = vec![one_strand(), Groom::slab(), Groom::tuft()];
    all.push(Groom::preset(lovelock_groom::Preset::Smooth));
    all.extend(Groom::straight());
    all
}

fn methods() -> impl Iterator<Item = ShadowMethod> {
    ShadowMethod::ALL.iter().copied().filter(|m| {
        !matches!(m, ShadowMethod::VoxelMap | ShadowMethod::DensityClustering | ShadowMethod::None)
    })
}

#[allow(dead_code)]
fn with_filter(filter: TexelFilter) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.opacity_maps.filter = filter;
    settings.deep_opacity_maps.filter = filter;
    settings.density_clustering.filter = filter;
    settings.occupancy_maps.filter = filter;
    settings.exact.filter = filter;
    settings
}

#[test]
fn transmittance_is_that_of_the_definition() {
    let Some(gpu) = device() else { return };
    for groom in all_grooms() {
        let input = groom.input();
        let at = points(&groom.strands, 1);
        for method in methods() {
            let settings = ShadowSettings::default();
            let mut cpu = cpu_shadow(method);
            cpu.build(&input, &settings).expect("fits");
            let mut built = Built::new(gpu, method, &input, &settings);
            let found = built.ask(&at);
            let differences = Differences::of(&ask(cpu.as_ref(), &at), &found);
            println!(
                "{}, {method}: p99 {:.4}, most {:.4}",
                groom.name,
                differences.p99(),
                differences.most()
            );
            assert!(differences.p99() < 0.004, "{}, {method}: {}", groom.name, differences.p99());
        }
    }
}
