//! Time to encode a frame of 1280×720 in a film and in a sequence.
#![allow(missing_docs, reason = "the macros of criterion make public items without any")]

use criterion::{Criterion, criterion_group, criterion_main};
use lovelock_record::{FilmQuality, PictureSink, SinkSettings};

/// A moving texture similar to strands, the hardest part of a real recording.
fn pictures(count: usize) -> Vec<Vec<u8>> {
    let pixel = |frame: usize, x: usize, y: usize| {
        let (dx, dy) = (x as f32 - 640.0, y as f32 - 300.0);
        let inside = (dx * dx + dy * dy).sqrt() < 220.0;
        let phase = (dx + frame as f32 * 3.0) * 1.3 + (dy * 0.05).sin() * 6.0;
        let light =
            if inside { 0.5 + 0.5 * (phase.sin() * (phase * 0.37).cos()) } else { 0.2 + y as f32 / 1440.0 };
        [(light * 170.0) as u8, (light * 120.0) as u8, (light * 90.0) as u8, 255]
    };
    (0..count)
        .map(|frame| (0..720).flat_map(|y| (0..1280).flat_map(move |x| pixel(frame, x, y))).collect())
        .collect()
}

fn encode(criterion: &mut Criterion) {
    let pictures = pictures(12);
    let folder = tempfile::tempdir().expect("a folder for the films");
    let mut group = criterion.benchmark_group("12_frames_1280x720");
    group.sample_size(10);
    for (name, quality) in [
        ("film_high.mp4", FilmQuality::High),
        ("film_draft.mp4", FilmQuality::Draft),
        ("frames", FilmQuality::High),
    ] {
        let path = folder.path().join(name);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let settings = SinkSettings { quality, ..SinkSettings::new(1280, 720, 30.0) };
                let mut sink = PictureSink::for_path(&path, settings).expect("an output");
                for picture in &pictures {
                    sink.push(picture).expect("a frame");
                }
                sink.finish().expect("the output").bytes()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, encode);
criterion_main!(benches);
