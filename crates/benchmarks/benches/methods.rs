//! Every method on the published hairstyle of 100,500 points: build, and lookups at every point.
#![allow(missing_docs)] // `criterion_main` makes functions without.

#[path = "../../shadow/tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{CURLY, SMOOTH, Style, grow, lit, strands};
use criterion::{Criterion, criterion_group, criterion_main};
use lovelock_shadow::{ShadowMethod, ShadowSettings, cpu_shadow};

fn methods(c: &mut Criterion) {
    let styles = [("100k", SMOOTH), ("curly-200k", CURLY), ("1m", Style { strands_per_wisp: 241, ..SMOOTH })];
    for (name, style) in styles {
        let hair = strands(&grow(style, 1));
        let mut out = vec![0.0; hair.points()];
        let settings = ShadowSettings::default();
        let mut group = c.benchmark_group(name);
        if hair.points() > 500_000 {
            group.sample_size(10);
        }
        for &method in ShadowMethod::ALL {
            let mut map = cpu_shadow(method);
            group.bench_function(format!("{method}/build"), |b| {
                b.iter(|| map.build(black_box(&lit(&hair)), &settings).expect("fits"));
            });
            group.bench_function(format!("{method}/lookup"), |b| {
                b.iter(|| map.transmittance_at(&hair.x, &hair.y, &hair.z, black_box(&mut out)));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, methods);
criterion_main!(benches);
