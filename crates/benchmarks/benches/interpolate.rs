//! Interpolating and growing the two published hairstyles.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Affine3A, Vec3};
use lovelock_groom::{
    GroomSettings, GuideFrame, PlainHead, Preset, StrandBounds, Strands, grow, interpolate,
};

fn interpolation(c: &mut Criterion) {
    let scalp = PlainHead.scalp(48);
    for preset in [Preset::Smooth, Preset::Curly] {
        let style = grow(&GroomSettings::preset(preset), &scalp, &PlainHead).expect("a preset grows");
        let frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        let mut strands = Strands::default();
        c.bench_function(&format!("interpolate/{}/{}", preset.id(), style.strands.segments()), |b| {
            b.iter(|| interpolate(&style, black_box(&frame), &mut strands));
        });
    }
}

fn bounding(c: &mut Criterion) {
    let scalp = PlainHead.scalp(48);
    for preset in [Preset::Smooth, Preset::Curly] {
        let style = grow(&GroomSettings::preset(preset), &scalp, &PlainHead).expect("a preset grows");
        let style = Arc::new(style);
        let frame = GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0);
        let bounds = StrandBounds::new(&style);
        let (side, other) = Vec3::new(0.4, -1.0, -0.5).normalize_or(Vec3::Y).any_orthonormal_pair();
        let axes = [side.cross(other), side, other];
        c.bench_function(&format!("bounds/{}/{}", preset.id(), style.strands.segments()), |b| {
            b.iter(|| bounds.along(black_box(&frame), axes, Vec3::ZERO));
        });
    }
}

fn growing(c: &mut Criterion) {
    let scalp = PlainHead.scalp(48);
    for preset in Preset::ALL {
        let settings = GroomSettings::preset(preset);
        c.bench_function(&format!("grow/{}", preset.id()), |b| {
            b.iter(|| grow(black_box(&settings), &scalp, &PlainHead));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = interpolation, bounding, growing
}
criterion_main!(benches);
