//! Instructions of the inner loops, by valgrind. `cargo xtask count` runs this and compares the counts with `counts.json`.
#![allow(missing_docs)] // Gungraun's macros make public items.

use std::hint::black_box;

use gungraun::prelude::*;
use lovelock_benchmarks::{DANCER, Drawn, Moving, Shadowed, guides, hair_file, one_thread, strands, style};
use lovelock_groom::{HairFile, Strands, interpolate, load_hair_bytes};
use lovelock_motion::{Character, load_character_bytes};
use lovelock_render::Transparency;

/// Makes an input on one thread.
fn on_one_thread<T>(input: impl FnOnce() -> T) -> T {
    one_thread();
    input()
}

fn shadowed() -> Shadowed {
    on_one_thread(Shadowed::new)
}

#[library_benchmark]
#[bench::of(shadowed())]
fn voxel_map_build(mut shadowed: Shadowed) -> Shadowed {
    shadowed.build();
    black_box(shadowed)
}

#[library_benchmark]
#[bench::of(shadowed())]
fn voxel_map_lookup(mut shadowed: Shadowed) -> Shadowed {
    shadowed.look_up();
    black_box(shadowed)
}

#[library_benchmark]
#[bench::of(on_one_thread(Moving::new))]
fn simulation_step(mut moving: Moving) -> Moving {
    moving.step();
    black_box(moving)
}

fn hair() -> (std::sync::Arc<lovelock_groom::Hairstyle>, lovelock_groom::GuideFrame, Strands) {
    on_one_thread(|| {
        let style = style();
        let (guides, strands) = (guides(&style), strands(&style));
        (style, guides, strands)
    })
}

#[library_benchmark]
#[bench::of(hair())]
fn interpolation(
    (style, guides, mut strands): (
        std::sync::Arc<lovelock_groom::Hairstyle>,
        lovelock_groom::GuideFrame,
        Strands,
    ),
) -> Strands {
    interpolate(&style, &guides, &mut strands);
    black_box(strands)
}

fn drawn(transparency: Transparency) -> Drawn {
    on_one_thread(|| Drawn::new(transparency))
}

#[library_benchmark]
#[bench::sorted(drawn(Transparency::Sorted))]
#[bench::occupancy_order(drawn(Transparency::OccupancyOrder))]
#[bench::exact(drawn(Transparency::Exact))]
fn coverage(mut drawn: Drawn) -> Drawn {
    drawn.draw();
    black_box(drawn)
}

#[library_benchmark]
#[bench::of(on_one_thread(hair_file))]
fn load_hair(bytes: Vec<u8>) -> HairFile {
    black_box(load_hair_bytes("counted.hair", &bytes).expect("a sound file"))
}

#[library_benchmark]
#[bench::of(on_one_thread(|| DANCER))]
fn load_body(bytes: &[u8]) -> Character {
    black_box(load_character_bytes("dancer.glb", bytes, None).expect("the shipped dancer"))
}

library_benchmark_group!(
    name = counts,
    benchmarks =
        [voxel_map_build, voxel_map_lookup, simulation_step, interpolation, coverage, load_hair, load_body]
);
main!(library_benchmark_groups = counts);
