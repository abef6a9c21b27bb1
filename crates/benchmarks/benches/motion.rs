//! Times of the work per frame on a real body (pose, skin, colliders) and of one-time work (fitting,
//! distance).

use std::{hint::black_box, path::Path};

use criterion::{Criterion, criterion_group, criterion_main};
use lovelock_motion::{
    Pose, RestDistance, Skin, fit_colliders, load_character, load_motion, place_colliders, pose_at, retarget,
    skin,
};

fn frame(c: &mut Criterion) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let data = std::env::var_os("LOVELOCK_DATA").map_or_else(|| root.join("../shared/data"), Into::into);
    for file in [root.join("assets/dancer.glb"), data.join("characters/mh_body.glb")] {
        let Ok(character) = load_character(&file) else {
            println!("skipped: no {}", file.display());
            continue;
        };
        let body = &character.body;
        let motion =
            load_motion(&data.join("motion/jesse_dance.bvh")).ok().and_then(|m| retarget(&m, body).ok());
        let clip = motion.as_ref().or(character.clips.first().map(|c| &**c));
        let name = format!("{} ({} vertices)", body.name, body.mesh.positions.len());
        let (mut pose, mut surface, mut placed) = (Pose::default(), Skin::default(), Vec::new());
        let colliders = fit_colliders(body);
        let distance = RestDistance::new(body);
        let mut group = c.benchmark_group(&name);
        group.sample_size(20);
        let mut time = 0.0;
        group.bench_function("pose", |b| {
            b.iter(|| {
                time += 0.016;
                pose_at(body, clip, time, &mut pose);
                black_box(&pose);
            });
        });
        group.bench_function("skin", |b| {
            b.iter(|| {
                skin(body, &pose, &mut surface);
                black_box(&surface);
            });
        });
        group.bench_function("place colliders", |b| {
            b.iter(|| place_colliders(&colliders, body, &pose, &mut placed));
        });
        group.bench_function("rest distance, one query", |b| {
            let mut k = 0.0_f32;
            b.iter(|| {
                k += 0.61803;
                distance.distance(glam::Vec3::new(k.sin(), k.cos(), (2.0 * k).sin()) * 0.15)
            });
        });
        group.bench_function("fit colliders", |b| b.iter(|| fit_colliders(body)));
        group.bench_function("build rest distance", |b| b.iter(|| RestDistance::new(body)));
        group.bench_function("load", |b| b.iter(|| load_character(&file).is_ok()));
        group.finish();
    }
}

criterion_group!(benches, frame);
criterion_main!(benches);
