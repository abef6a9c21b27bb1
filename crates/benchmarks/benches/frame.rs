//! Whole frames of the default project on the CPU backend: from the simulation to the image.
#![allow(missing_docs)] // Criterion's macros make public items.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lovelock_jobs::bench::BenchScene;
use lovelock_project::files::Access;
use lovelock_render::{Backend, Picture, Renderer, Transparency};
use lovelock_session::clock::FrameClock;
use lovelock_session::engine::Engine;
use lovelock_session::scene::{LoadControl, SceneLoader};

fn whole_frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cpu backend, 1280x720");
    group.sample_size(10);
    let modes = Transparency::ALL.map(|mode| (BenchScene::Smooth, mode));
    let more = [BenchScene::Curly, BenchScene::Smooth500k, BenchScene::Smooth2M];
    for (scene, transparency) in modes.into_iter().chain(more.map(|scene| (scene, Transparency::Sorted))) {
        let mut project = scene.project();
        project.picture.transparency = transparency;
        let cancelled = AtomicBool::new(false);
        let mut silent = |_: &str, _: f32| {};
        let mut control = LoadControl { cancelled: &cancelled, progress: &mut silent };
        let (loaded, _) =
            SceneLoader::new().load(&project, &Access::default(), &mut control).expect("the shipped dancer");
        let clock = FrameClock::new(30.0);
        let mut engine = Engine::with_step(Arc::clone(&loaded), project.simulation, clock.step_secs);
        let mut renderer = Renderer::open(Backend::Cpu).expect("the processor");
        let mut picture = Picture::default();
        let mut frame = 40;
        group.throughput(Throughput::Elements(loaded.style.strands.segments() as u64));
        group.bench_function(format!("{scene}, {transparency}"), |bencher| {
            bencher.iter(|| {
                frame += 1;
                engine.advance_to_step(clock.step_of_frame(frame));
                let snapshot = engine.snapshot();
                let camera = snapshot.camera(&project.camera);
                let input = snapshot.frame_input(&project, &camera);
                renderer.picture(&input, 1280, 720, &mut picture).expect("a picture");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, whole_frames);
criterion_main!(benches);
