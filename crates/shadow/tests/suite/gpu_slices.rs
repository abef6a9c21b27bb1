//! Compares the texels of opacity maps, deep opacity maps and density clustering on the GPU with the records of their definitions.

use crate::common;

use crate::gpu::{Built, device};
use crate::grooms::{Groom, LIGHT};
use glam::Vec3;
use lovelock_shadow::methods::deep_opacity_maps::Layers;
use lovelock_shadow::methods::density_clustering::{Bin, Clustering};
use lovelock_shadow::methods::occupancy_maps::OccupancyMaps;
use lovelock_shadow::methods::opacity_maps::Slices;
use lovelock_shadow::methods::texels::{TexelMap, TexelMethod};
use lovelock_shadow::voxel_map::{Columns, VoxelSlices};
use lovelock_shadow::{
    ClusterDeviation, ClusterSeeds, CpuShadow, LayerGrowth, LightFrame, ShadowError, ShadowMethod,
    ShadowSettings, TexelFilter,
};
use lovelock_testkit::suite::is_long;

/// The relative error of the weight of a fragment, an integer from 1024 on; sums of floats are rounded too.
const WEIGHT_ROUNDING: f32 = 0.5 / 1024.0 + 1e-5;

/// The error of the sums of a texel, in units, where two texels share a fragment: the smaller part is rounded too.
const SHARE_ROUNDING: f32 = 8.0;

/// The map of the definition, and the words of the map on the GPU.
struct Both<M: TexelMethod> {
    cpu: TexelMap<M>,
    words: Vec<u32>,
    /// Optical depth of a unit of weight.
    unit: f32,
}

impl<M: TexelMethod> Both<M> {
    fn new(groom: &Groom, settings: &ShadowSettings) -> Option<Self> {
        Self::of_two(groom, settings, settings)
    }

    /// A definition with other settings than the GPU.
    fn of_two(groom: &Groom, on_cpu: &ShadowSettings, on_gpu: &ShadowSettings) -> Option<Self> {
        let gpu = device()?;
        let mut cpu = TexelMap::<M>::default();
        cpu.build(&groom.input(), on_cpu).expect("it fits");
        let words = Built::new(gpu, M::METHOD, &groom.input(), on_gpu).words();
        let texel_size = cpu.frame().expect("it was built").texel_size;
        let unit = groom.extinction_scale * groom.width / texel_size / 1024.0;
        Some(Self { cpu, words, unit })
    }

    /// The words of each texel with the record of the texel `aside` columns further.
    fn texels(&self, aside: u32) -> impl Iterator<Item = (&[u32], Option<&[M::Cell]>)> {
        let n = self.cpu.frame().expect("it was built").resolution;
        let each = self.words.len() / (n * n) as usize;
        let texels = self.words.chunks_exact(each).zip(0_u32..);
        texels.map(move |(words, texel)| (words, self.cpu.record(texel % n + aside, texel / n)))
    }

    /// The largest relative difference of optical depth, for sums that start at word `first`.
    fn worst(&self, first: usize, aside: u32) -> f32
    where
        M: TexelMethod<Cell = f32>,
    {
        let mut worst = 0.0_f32;
        for (words, record) in self.texels(aside) {
            for (at, &word) in words.iter().enumerate().skip(first) {
                let (found, expected) = (word as f32 * self.unit, record.map_or(0.0, |record| record[at]));
                worst = worst.max((found - expected).abs() / expected.max(1024.0 * self.unit));
            }
        }
        worst
    }
}

fn opacity_maps(slices: u32) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.opacity_maps.slices = slices;
    settings
}

fn deep_opacity_maps(layers: u32, growth: LayerGrowth) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    (settings.deep_opacity_maps.layers, settings.deep_opacity_maps.growth) = (layers, growth);
    settings
}

/// Removes the weight of the sum at `at` from it and from all later sums.
fn drop_sum(words: &mut [u32], each: usize, at: usize) {
    for texel in words.chunks_exact_mut(each) {
        let weight = texel[at] - texel[at - 1];
        texel[at..].iter_mut().for_each(|sum| *sum -= weight);
    }
}

#[test]
fn slices_hold_the_optical_depth_of_the_definition() {
    for groom in Groom::for_both_backends() {
        for slices in [8, 128] {
            let settings = opacity_maps(slices);
            let Some(mut both) = Both::<Slices>::new(&groom, &settings) else { return };
            let (worst, moved) = (both.worst(0, 0), both.worst(0, 1));
            println!("{}, {slices} slices: {worst:.6}, moved {moved}", groom.name);
            assert!(worst < WEIGHT_ROUNDING, "{}, {slices}: {worst}", groom.name);
            assert!(moved > 0.5, "control: by a texel, {moved}");
            let first = |record: &[f32]| (1..record.len()).find(|&at| record[at] > record[at - 1]);
            let with_hair = both.texels(0).filter_map(|(_, record)| record).find_map(first).expect("hair");
            drop_sum(&mut both.words, slices as usize, with_hair);
            assert!(both.worst(0, 0) > 0.2, "control: a slice less, {}", both.worst(0, 0));
        }
    }
}

#[test]
fn layers_hold_the_optical_depth_of_the_definition() {
    for groom in Groom::for_both_backends() {
        for (layers, growth) in [(3, LayerGrowth::Even), (4, LayerGrowth::Linear), (16, LayerGrowth::Linear)]
        {
            let settings = deep_opacity_maps(layers, growth);
            let Some(mut both) = Both::<Layers>::new(&groom, &settings) else { return };
            for (words, record) in both.texels(0) {
                let near = record.map_or(0, |record| !record[0].to_bits());
                assert_eq!(words[0], near, "{}: the first fragment", groom.name);
            }
            let (worst, moved) = (both.worst(1, 0), both.worst(1, 1));
            println!("{}, {layers} layers: {worst:.6}, moved {moved}", groom.name);
            assert!(worst < WEIGHT_ROUNDING, "{}, {layers}: {worst}", groom.name);
            assert!(moved > 0.5, "control: by a texel, {moved}");
            // One strand has nothing behind its first layer.
            if groom.strands.count() > 1 {
                drop_sum(&mut both.words, layers as usize + 1, 2);
                assert!(both.worst(1, 0) > 0.2, "control: a layer less, {}", both.worst(1, 0));
                let other = deep_opacity_maps(layers, LayerGrowth::Even);
                let linear = deep_opacity_maps(layers, LayerGrowth::Linear);
                let swapped = Both::<Layers>::of_two(&groom, &other, &linear).expect("a device");
                assert!(swapped.worst(1, 0) > 0.2, "control: other layers, {}", swapped.worst(1, 0));
            }
        }
    }
}

/// The fraction of columns whose slices lie elsewhere than in the definition, because a share of their hair is rounded another way, and
/// the fraction of slices of the other columns with other hair before their end.
fn columns_apart(both: &Both<Columns>, aside: u32) -> [f32; 2] {
    const HEADER: usize = 3;
    let (mut columns, mut moved, mut slices, mut other) = (0_usize, 0_usize, 0_usize, 0_usize);
    for (words, record) in both.texels(aside) {
        let Some(record) = record else { continue };
        columns += 1;
        if words[..HEADER] != record[..HEADER] {
            moved += 1;
            continue;
        }
        slices += record.len() - HEADER;
        let pairs = words.iter().zip(record).skip(HEADER);
        other += pairs
            .filter(|(found, defined)| {
                let (found, defined) = (**found as f32 * both.unit, f32::from_bits(**defined));
                (found - defined).abs() > WEIGHT_ROUNDING * defined + SHARE_ROUNDING * both.unit
            })
            .count();
    }
    [moved as f32 / columns as f32, other as f32 / slices.max(1) as f32]
}

#[test]
fn adaptive_columns_hold_the_optical_depth_of_the_definition() {
    for groom in Groom::for_both_backends() {
        let mut settings = ShadowSettings::default();
        settings.voxel_map.slices = VoxelSlices::Adaptive;
        let Some(both) = Both::<Columns>::new(&groom, &settings) else { return };
        let [moved, other] = columns_apart(&both, 0);
        let aside = columns_apart(&both, 1);
        println!("{}: {moved:.4} of the columns, {other:.5} of the slices; control {aside:.4?}", groom.name);
        // Measured: at most 0.072 and 0; the control, 0.50 and more, and 0.041 and more.
        assert!(moved < 0.1 && other < 1e-4, "{}: {moved}, {other}", groom.name);
        assert!(aside[0] > 0.4 && aside[1] > 0.02, "control: by a texel, {aside:?}");
    }
}

/// Differences between bins on the GPU and in the definition.
#[derive(Debug)]
struct Apart {
    /// The fraction of texels in which a bin has different hair: a fragment lies on the border of two clusters.
    other_hair: f32,
    /// The 99th percentile of the error of the ends of bins in the other texels, in widths of the bin.
    ends: f32,
}

impl Apart {
    fn of(both: &Both<Clustering>, aside: u32) -> Self {
        let (mut texels, mut other, mut ends) = (0_usize, 0_usize, Vec::new());
        for (words, record) in both.texels(aside) {
            let found: Vec<_> = words.chunks_exact(3).map(|words| bin(words, both.unit)).collect();
            let expected = record.map_or_else(|| vec![Bin::default(); found.len()], <[_]>::to_vec);
            texels += usize::from(record.is_some());
            let pairs = || expected.iter().zip(&found);
            let rounded = |of: f32| WEIGHT_ROUNDING * of + SHARE_ROUNDING * both.unit;
            if pairs().any(|(a, b)| (a.optical_depth - b.optical_depth).abs() > rounded(a.optical_depth)) {
                other += 1;
                continue;
            }
            for (a, b) in pairs().filter(|(a, _)| a.optical_depth > 0.0) {
                let (of_a, of_b) = (1.0 / a.per_depth, 1.0 / b.per_depth);
                let off = (a.start - b.start).abs().max((a.start + of_a - b.start - of_b).abs());
                // Depths are rounded to 6e-8.
                ends.push(off / of_a.max(1e-6));
            }
        }
        ends.sort_by(f32::total_cmp);
        Self {
            other_hair: other as f32 / texels as f32,
            ends: ends.get(ends.len() * 99 / 100).copied().unwrap_or(0.0),
        }
    }

    /// Measured on all hairstyles with thin lines: at most 0.0009 of the texels, and 0.0004 widths. With pre-filtered lines the smaller
    /// parts of fragments are a few units, rounded: 0.0016, and 0.0043.
    fn is_in_step(&self, settings: &ShadowSettings) -> bool {
        let (other_hair, ends) =
            if settings.density_clustering.prefiltered { (0.004, 0.01) } else { (0.002, 0.001) };
        self.other_hair < other_hair && self.ends < ends
    }
}

fn bin(words: &[u32], unit: f32) -> Bin {
    Bin {
        start: f32::from_bits(words[0]),
        per_depth: f32::from_bits(words[1]),
        optical_depth: words[2] as f32 * unit,
    }
}

fn clusters(seeds: ClusterSeeds, deviation: ClusterDeviation, steps: u32, clusters: u32) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    let own = &mut settings.density_clustering;
    (own.seeds, own.deviation, own.steps, own.clusters) = (seeds, deviation, steps, clusters);
    settings
}

fn thin_lines(mut settings: ShadowSettings) -> ShadowSettings {
    settings.density_clustering.prefiltered = false;
    settings
}

#[test]
fn bins_lie_where_the_definition_has_them_long_suite() {
    use ClusterDeviation::{Exact, Merged};
    use ClusterSeeds::{Histogram, TowardLight, Uniform};
    let usual = clusters(TowardLight, Exact, 1, 4);
    let all = [
        usual,
        thin_lines(usual),
        clusters(Uniform, Merged, 1, 4),
        thin_lines(clusters(Histogram, Exact, 1, 1)),
        clusters(Uniform, Exact, 3, 8),
        thin_lines(clusters(Histogram, Merged, 2, 8)),
    ];
    for groom in Groom::for_both_backends() {
        for settings in all {
            let own = settings.density_clustering;
            let Some(mut both) = Both::<Clustering>::new(&groom, &settings) else { return };
            let apart = Apart::of(&both, 0);
            println!("{}, {own:?}: {apart:?}", groom.name);
            assert!(apart.is_in_step(&settings), "{}, {own:?}: {apart:?}", groom.name);
            assert!(!Apart::of(&both, 1).is_in_step(&settings), "control: by a texel");
            for texel in both.words.chunks_exact_mut(3 * own.clusters as usize) {
                texel[2] = 0;
            }
            assert!(!Apart::of(&both, 0).is_in_step(&settings), "control: without the first bin");
        }
    }
}

#[test]
fn bins_of_other_settings_are_found_out() {
    use ClusterDeviation::{Exact, Merged};
    use ClusterSeeds::{Histogram, TowardLight, Uniform};
    let groom = Groom::tuft();
    let usual = thin_lines(clusters(TowardLight, Exact, 1, 4));
    for (seeds, deviation, steps) in
        [(Uniform, Exact, 1), (Histogram, Exact, 1), (TowardLight, Merged, 1), (TowardLight, Exact, 2)]
    {
        let other = thin_lines(clusters(seeds, deviation, steps, 4));
        let Some(both) = Both::<Clustering>::of_two(&groom, &usual, &other) else { return };
        assert!(!Apart::of(&both, 0).is_in_step(&usual), "{seeds:?}, {deviation:?}, {steps}");
    }
    let other = clusters(TowardLight, Exact, 1, 4);
    let both = Both::<Clustering>::of_two(&groom, &usual, &other).expect("a device");
    assert!(!Apart::of(&both, 0).is_in_step(&other), "other lines");
}

#[test]
fn many_fragments_of_one_texel_do_not_wrap() {
    // Far more than a word of offsets can hold: 1024 · 2^20 each.
    const COUNT: usize = 10_000;
    let Some(gpu) = device() else { return };
    let ends =
        |i: usize| vec![Vec3::new(-0.01, 0.1 - 1e-7 * (i % 1000) as f32, 0.0), Vec3::new(0.01, 0.1, 0.0)];
    let made: Vec<_> = (0..COUNT).map(ends).collect();
    let groom = Groom { name: "many", strands: common::strands(&made), width: 5e-8, extinction_scale: 1.0 };
    for method in [
        ShadowMethod::OpacityMaps,
        ShadowMethod::DeepOpacityMaps,
        ShadowMethod::DensityClustering,
        ShadowMethod::OccupancyMaps,
    ] {
        let mut settings = ShadowSettings::default();
        settings.opacity_maps.resolution = 64;
        settings.deep_opacity_maps.resolution = 64;
        settings.density_clustering.resolution = 64;
        settings.occupancy_maps.resolution = 64;
        let mut cpu = lovelock_shadow::cpu_shadow(method);
        cpu.build(&groom.input(), &settings).expect("it fits");
        let mut built = Built::new(gpu, method, &groom.input(), &settings);
        let behind = groom.input().light.x * 0.05;
        let at: Vec<_> = (0..40).map(|i| Vec3::new(-0.01 + 0.0005 * i as f32, 0.1, 0.0) + behind).collect();
        let expected: Vec<_> = at.iter().map(|&p| cpu.transmittance(p)).collect();
        assert!(expected.iter().any(|t| (0.02..0.5).contains(t)), "neither all nor nothing: {expected:?}");
        for (found, expected) in built.look_up(&at).iter().zip(&expected) {
            assert!((found - expected).abs() < 0.004, "{method}: {found}, not {expected}");
        }
    }
}

#[test]
fn occupancy_maps_keep_the_whole_of_a_slab_with_more_fragments_than_it_counts() {
    const COUNT: usize = 200_000;
    /// The most that a slab counts.
    const COUNTED: f32 = 65_535.0;
    let Some(gpu) = device() else { return };
    let light = LightFrame::new(LIGHT);
    // Through four texels of one row in the first slab, and one strand behind them through all texels of the row.
    let strand = |i: usize| {
        let (depth, half) = if i == COUNT { (0.1, 0.005) } else { (1e-8 * i as f32, 0.0003) };
        [-half, half].map(|across| light.world_from_light(Vec3::new(depth, across, 0.0))).to_vec()
    };
    let made: Vec<_> = (0..=COUNT).map(strand).collect();
    let mut groom =
        Groom { name: "crowd", strands: common::strands(&made), width: 1e-9, extinction_scale: 1.0 };
    let mut settings = ShadowSettings::default();
    settings.occupancy_maps.resolution = 64;
    settings.occupancy_maps.filter = TexelFilter::Nearest;
    let mut map = OccupancyMaps::default();
    map.build(&groom.input(), &settings).expect("it fits");
    // An optical depth of 1 behind all strands: a fragment has s w / t.
    groom.width = map.frame().expect("it was built").texel_size / (COUNT + 1) as f32;
    map.build(&groom.input(), &settings).expect("it fits");
    let mut built = Built::new(gpu, ShadowMethod::OccupancyMaps, &groom.input(), &settings);
    let at: Vec<_> = (-3..=3).map(|i| light.world_from_light(Vec3::new(0.2, 3e-5 * i as f32, 0.0))).collect();
    let expected = (-1.0_f32).exp();
    // What a mean of at most twice the least weight would leave.
    let clamped = (-2.0 * COUNTED / COUNT as f32).exp();
    for (found, p) in built.look_up(&at).iter().zip(&at) {
        let defined = map.transmittance(*p);
        println!("{found}, defined {defined}, by hand {expected}, clamped {clamped}");
        assert!((found - expected).abs() < 0.0025 && (defined - expected).abs() < 1e-3, "{found}, {defined}");
        assert!((found - clamped).abs() > 0.1, "control: {found} is that of a clamped mean");
    }
}

#[test]
fn maps_larger_than_the_device_takes_are_refused() {
    let Some(gpu) = device() else { return };
    // Strands so thin that texels have the resolution of the setting.
    let groom = Groom { width: 1e-5, ..Groom::tuft() };
    let mut settings = opacity_maps(256);
    let limit = gpu.most_storage_bytes();
    for resolution in [512, 1024] {
        settings.opacity_maps.resolution = resolution;
        // Sizes of texels are rounded up to a sixteenth of an octave, so there may be a few fewer of them.
        let most = 4 * 256 * u64::from(resolution).pow(2);
        let built = Built::try_new(gpu, ShadowMethod::OpacityMaps, &groom.input(), &settings);
        match built {
            Ok(built) => assert!(4 * built.words().len() as u64 <= limit, "{resolution}"),
            Err(ShadowError::Device { needed_bytes, limit_bytes, .. }) => {
                assert!(needed_bytes > limit && needed_bytes <= most && limit_bytes == limit, "{resolution}");
            }
            Err(error) => panic!("{resolution}: {error}"),
        }
    }
    // Few enough to fit every device.
    settings.opacity_maps.resolution = 64;
    Built::new(gpu, ShadowMethod::OpacityMaps, &groom.input(), &settings);
}

#[test]
fn every_pass_is_timed_by_its_name() {
    let Some(gpu) = device() else { return };
    let of: [(ShadowMethod, &[&str]); 3] = [
        (ShadowMethod::OpacityMaps, &["shadow/slices", "shadow/sums"]),
        (ShadowMethod::DeepOpacityMaps, &["shadow/near", "shadow/layers", "shadow/sums"]),
        (
            ShadowMethod::DensityClustering,
            &[
                "shadow/range",
                "shadow/seeds",
                "shadow/clusters",
                "shadow/centres",
                "shadow/spread",
                "shadow/bins",
                "shadow/fill",
            ],
        ),
    ];
    for groom in [Groom::tuft()].into_iter().chain(is_long().then(Groom::straight).flatten()) {
        for (method, names) in of {
            let mut built = Built::new(gpu, method, &groom.input(), &ShadowSettings::default());
            // Once more, with allocated memory.
            built.build(0, &groom.input(), &ShadowSettings::default()).expect("it fits");
            let found: Vec<_> = built.passes.iter().map(|pass| pass.name.as_str()).collect();
            let times: Vec<_> =
                built.passes.iter().map(|pass| format!("{} {:.2}", pass.name, pass.ms)).collect();
            println!("{}, {method}, ms: {}", groom.name, times.join(", "));
            assert!(found == names || !gpu.has_timestamps(), "{method}: {found:?}");
        }
    }
}
