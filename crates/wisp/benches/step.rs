//! One step of the published hairstyle while the dancer dances.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use lovelock_groom::Preset;
use lovelock_motion::PlacedCollider;
use lovelock_wisp::{SimulationSettings, StepInput, Wind};

#[path = "../tests/common/mod.rs"]
mod common;
use common::{STEP_SECS, Stage};

fn step(c: &mut Criterion) {
    for preset in [Preset::Smooth, Preset::Long] {
        let mut stage = Stage::new(preset);
        // Two seconds of the dance, worked out before, so that only the hair is measured. At a quarter of its
        // speed four substeps are enough nearly always; at full speed quick turns take up to sixteen.
        let mut poses = |speed: f64| -> Vec<(f64, glam::Affine3A, Vec<PlacedCollider>)> {
            let mut pose = |i: u32| {
                let input = stage.at(Some(f64::from(i) / 60.0 * speed));
                (f64::from(i) / 60.0, input.world_from_head, input.colliders.to_vec())
            };
            (0..120).map(&mut pose).collect()
        };
        let (slow, quick) = (poses(0.25), poses(1.0));
        let guides = &stage.style.guides;
        let name = format!(
            "step of {} guides x {} links, {} colliders",
            guides.count(),
            guides.points_per_guide - 1,
            stage.colliders.len()
        );
        let calm = SimulationSettings::default();
        let windy = SimulationSettings { wind: Wind { speed: 4.0, ..Wind::default() }, ..calm };
        for (what, settings, poses) in
            [(", slow", calm, &slow), (", quick", calm, &quick), (", quick, wind", windy, &quick)]
        {
            let mut simulation = stage.simulation(Some(0.0));
            let mut next = 0;
            c.bench_function(&format!("{name}{what}"), |b| {
                b.iter(|| {
                    next = (next + 1) % poses.len();
                    let (time_secs, world_from_head, colliders) = &poses[next];
                    let input = StepInput::new(*time_secs, *world_from_head, colliders);
                    black_box(simulation.step(&input, &settings, STEP_SECS))
                });
            });
        }
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
