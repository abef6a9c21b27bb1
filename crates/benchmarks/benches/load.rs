//! From a hair file on disk to a hairstyle: reading, importing, and both.
//!
//! Uses the real files if they exist; otherwise prints a message.

use std::hint::black_box;
use std::path::PathBuf;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;
use lovelock_groom::{ImportSettings, PlainHead, import, load_hair, load_hair_bytes};

fn data_dir() -> Option<PathBuf> {
    let folder = std::env::var_os("LOVELOCK_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    folder.is_dir().then_some(folder)
}

fn real_files(c: &mut Criterion) {
    let Some(data) = data_dir() else {
        println!("skipped: no data folder");
        return;
    };
    let scalp = PlainHead.scalp(48);
    let settings = ImportSettings::default();
    for (name, path) in
        [("straight.hair", "hair/yuksel/straight.hair"), ("sintel_16pt.tfx", "hair/tressfx/sintel_16pt.tfx")]
    {
        let path = data.join(path);
        let mut group = c.benchmark_group(name);
        group.sample_size(20);
        group.bench_function("load", |b| b.iter(|| load_hair(black_box(&path)).expect("a sound file")));
        let file = load_hair(&path).expect("a sound file");
        group.bench_function("import", |b| {
            b.iter(|| import(black_box(&file), &settings, &scalp).expect("hair"));
        });
        group.bench_function("load and import", |b| {
            b.iter(|| {
                let file = load_hair(black_box(&path)).expect("a sound file");
                import(&file, &settings, &scalp).expect("hair")
            });
        });
        group.finish();
    }
}

/// The time must grow no faster than the number of strands.
fn many_strands(c: &mut Criterion) {
    let scalp = PlainHead.scalp(48);
    let settings = ImportSettings::default();
    let mut group = c.benchmark_group("import of made-up strands");
    group.sample_size(10);
    for strands in [10_000_usize, 100_000, 1_000_000] {
        let bytes = cap(strands);
        let file = load_hair_bytes("cap.hair", &bytes).expect("a sound file");
        group.bench_function(strands.to_string(), |b| {
            b.iter(|| import(black_box(&file), &settings, &scalp).expect("hair"));
        });
    }
    group.finish();
}

/// A `.hair` file of strands of 8 points on a hemisphere, Z up.
fn cap(strands: usize) -> Vec<u8> {
    let mut bytes = b"HAIR".to_vec();
    bytes.extend([strands as u32, 8 * strands as u32, 2, 7].iter().flat_map(|n| n.to_le_bytes()));
    bytes.resize(128, 0);
    for i in 0..strands {
        let height = 1.0 - i as f32 / strands as f32;
        let angle = (i as f64 * 2.399_963_229_728_653).rem_euclid(std::f64::consts::TAU) as f32;
        let across = (1.0 - height * height).sqrt();
        let out = Vec3::new(across * angle.cos(), across * angle.sin(), height);
        for k in 0..8 {
            let t = k as f32 / 7.0;
            let point = 21.0 * (out * (1.0 + 0.2 * t) - Vec3::Z * t * t);
            bytes.extend(point.to_array().iter().flat_map(|v| v.to_le_bytes()));
        }
    }
    bytes
}

criterion_group!(benches, real_files, many_strands);
criterion_main!(benches);
