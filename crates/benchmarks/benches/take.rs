//! Takes: bytes per second, and the times of recording, playback and opening.
#![allow(missing_docs, reason = "the macros of criterion make public items without any")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{Affine3A, EulerRot, Quat, Vec3};
use lovelock_groom::{GuideFrame, Guides};
use lovelock_record::{TakeFrame, TakeHeader, TakeReader, TakeWriter};
use std::path::Path;

/// Number of guides of a shipped hairstyle.
const GUIDES: usize = 402;
const POINTS: usize = 31;
const LINK_M: f32 = 0.01;

/// Hair that swings about a turning, nodding and walking head, each guide with its own phase. Each coordinate has noise of up
/// to `noise_m` metres in both directions.
fn frames(count: usize, noise_m: f32) -> Vec<TakeFrame> {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1_u32 << 23) as f32 - 1.0
    };
    (0..count)
        .map(|n| {
            let t = n as f32 / 60.0;
            let turn = Quat::from_euler(
                EulerRot::YXZ,
                (t * 5.0).sin(),
                0.4 * (t * 7.0).cos(),
                0.2 * (t * 3.0).sin(),
            );
            let head = Affine3A::from_rotation_translation(turn, Vec3::new(t.sin(), 1.6, 0.4 * t));
            let mut guides = Guides { points_per_guide: POINTS, ..Guides::default() };
            for g in 0..GUIDES {
                let (round, own) = (g as f32 * 0.391, 1.0 + 0.2 * (g as f32 * 1.7).sin());
                let out = Vec3::new(round.cos(), 0.6 * (g as f32 * 0.77).sin(), round.sin());
                let mut p = head.transform_point3(0.1 * out);
                let mut points = Vec::with_capacity(POINTS);
                for i in 0..POINTS {
                    points.push(p + noise_m * Vec3::new(random(), random(), random()));
                    // A wave moves down the guide with an amplitude that grows toward the tip; the root follows the head.
                    let down = i as f32 / POINTS as f32;
                    let phase = t * 9.0 * own + round - 4.0 * down;
                    let swing = Vec3::new(phase.sin(), 0.0, (phase * 0.7).cos()) * 0.8 * down;
                    let root = head.transform_vector3(out) * (1.0 - down);
                    p += LINK_M * (Vec3::NEG_Y + swing + root).normalize_or(Vec3::NEG_Y);
                }
                guides.push(&points);
            }
            let guides = GuideFrame { time_secs: f64::from(t), world_from_head: head, guides };
            TakeFrame { guides, clip_secs: f64::from(t), wall_frame: n as u64, substeps: 4, jumped: false }
        })
        .collect()
}

fn header() -> TakeHeader {
    let (guides, points_per_guide) = (GUIDES as u32, POINTS as u32);
    TakeHeader { guides, points_per_guide, project: "(field: 1)\n".repeat(700), ..TakeHeader::default() }
}

/// Records the frames repeatedly until there are `count`. Returns their size in bytes.
fn record(path: &Path, frames: &[TakeFrame], count: usize) -> u64 {
    let mut writer = TakeWriter::create(path, header()).expect("a take");
    for frame in frames.iter().cycle().take(count) {
        writer.push(frame).expect("a frame");
    }
    writer.finish().expect("a whole take").bytes
}

fn takes(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for the takes");
    let mut group = criterion.benchmark_group("take_402x31");
    group.sample_size(10);
    for (name, noise_m) in [("swing", 0.0), ("swing_and_0.1_mm", 1e-4)] {
        let frames = frames(120, noise_m);
        let path = folder.path().join(format!("{name}.take"));
        let bytes = record(&path, &frames, 120);
        println!("{name}: {:.3} MB per second", bytes as f64 / 2.0 / 1e6);

        group.throughput(Throughput::Elements(120));
        group.bench_function(BenchmarkId::new("record_120_frames", name), |bencher| {
            bencher.iter(|| record(&path, &frames, 120));
        });
        let mut take = TakeReader::open(&path).expect("the take");
        let mut out = TakeFrame::default();
        group.bench_function(BenchmarkId::new("play_120_frames", name), |bencher| {
            take.set_cache_bytes(0);
            bencher.iter(|| (0..120).for_each(|n| take.frame_into(n, &mut out).expect("a frame")));
        });
        group.throughput(Throughput::Elements(1));
        let mut n = 0;
        group.bench_function(BenchmarkId::new("any_frame", name), |bencher| {
            // Never a cached chunk, because the last one is 30 frames away.
            bencher.iter(|| {
                n = (n + 31) % 120;
                take.frame_into(n, &mut out).expect("a frame");
            });
        });
        group.bench_function(BenchmarkId::new("between_two_frames", name), |bencher| {
            bencher.iter(|| take.frame_at(0.0261, &mut out).expect("a frame"));
        });
    }
    group.finish();
}

fn open(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for the take");
    let path = folder.path().join("ten minutes.take");
    let bytes = record(&path, &frames(60, 0.0), 36_000);
    println!("ten minutes: {bytes} bytes");
    let mut group = criterion.benchmark_group("take_of_ten_minutes");
    group.sample_size(10);
    group.bench_function("open", |bencher| {
        bencher.iter(|| TakeReader::open(&path).expect("the take").frames());
    });
    let part = folder.path().join("ten minutes cut.take.part");
    std::fs::copy(&path, &part).expect("a copy");
    let file = std::fs::OpenOptions::new().write(true).open(&part).expect("the copy");
    file.set_len(bytes - 1).expect("a cut");
    group.bench_function("open_cut", |bencher| {
        bencher.iter(|| TakeReader::open(&part).expect("the take").frames());
    });
    group.bench_function("verify", |bencher| {
        let mut take = TakeReader::open(&path).expect("the take");
        bencher.iter(|| take.verify().expect("the disk reads").is_whole());
    });
    group.finish();
}

criterion_group!(benches, takes, open);
criterion_main!(benches);
