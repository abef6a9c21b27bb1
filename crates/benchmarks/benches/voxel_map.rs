//! Stages of the voxel map. The published figure for 100,500 points is 90 ms in all (Pentium 4, 3 GHz).
#![allow(missing_docs)] // `criterion_main` makes functions without.

#[path = "../../shadow/tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{SMOOTH, Style, grow, lit, strands};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use lovelock_shadow::voxel_map::VoxelMap;
use lovelock_shadow::voxel_map::reference::{Addressing, DenseMap};
use lovelock_shadow::{CpuShadow, ShadowSettings};

fn settings(resolution: u32) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.voxel_map.resolution = resolution;
    settings
}

fn stages(c: &mut Criterion, name: &str, style: Style) {
    let hair = strands(&grow(style, 1));
    let mut out = vec![0.0; hair.points()];
    for resolution in [64, 128, 256, 512] {
        let settings = settings(resolution);
        let mut map = VoxelMap::default();
        let mut group = c.benchmark_group(format!("{name}/{resolution}"));
        group.bench_function("build", |b| {
            b.iter(|| map.build(black_box(&lit(&hair)), &settings).expect("fits"));
        });
        group.bench_function("lookup", |b| {
            b.iter(|| map.transmittance_at(&hair.x, &hair.y, &hair.z, black_box(&mut out)));
        });
        group.bench_function("both", |b| {
            b.iter(|| {
                map.build(black_box(&lit(&hair)), &settings).expect("fits");
                map.transmittance_at(&hair.x, &hair.y, &hair.z, black_box(&mut out));
            });
        });
        group.finish();
    }
}

fn quick(c: &mut Criterion) {
    stages(c, "100k", SMOOTH);
    stages(c, "1m", Style { strands_per_wisp: 241, ..SMOOTH });
}

fn plain(c: &mut Criterion) {
    let hair = strands(&grow(SMOOTH, 1));
    let mut group = c.benchmark_group("reference");
    group.sample_size(10);
    for resolution in [64, 128] {
        group.bench_with_input(
            BenchmarkId::new("build", resolution),
            &settings(resolution),
            |b, settings| {
                b.iter(|| DenseMap::build(black_box(&lit(&hair)), settings, Addressing::Window));
            },
        );
    }
    group.finish();
}

criterion_group!(benches, quick, plain);
criterion_main!(benches);
