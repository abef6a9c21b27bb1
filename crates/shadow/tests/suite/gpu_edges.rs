//! Maps on the GPU that are rebuilt, empty, of invalid hair, for several lights, and too large.

use crate::common::{EXTINCTION, HEAD, SMOOTH, SplitMix64, Style, grow, set_resolution, strands};
use crate::gpu::{Built, Uploaded, buffer, device};
use crate::grooms::Groom;
use glam::Vec3;
use lovelock_gpu::{PassTimer, read_buffer, read_texture_rgba8, wgpu};
use lovelock_groom::Strands;
use lovelock_shadow::{
    GpuTargets, LightFrame, MomentKind, SUM_WORDS, ShadowError, ShadowInput, ShadowMethod, ShadowSettings,
    cpu_shadow,
};
use lovelock_testkit::suite::sample;

fn input(strands: &Strands) -> ShadowInput<'_> {
    let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
    ShadowInput {
        strands,
        strand_width: 1e-3,
        extinction_scale: EXTINCTION,
        light,
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

fn hair(wisps: usize, seed: u64) -> Strands {
    strands(&grow(Style { wisps, ..SMOOTH }, seed))
}

/// Maps of a quarter of the default resolution: what these tests find does not depend on the number of texels.
fn coarse() -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.voxel_map.resolution = 48;
    settings.voxel_march.resolution = 48;
    set_resolution(&mut settings, 64);
    settings
}

/// Points around the head, on the hair, and invalid points.
fn points_around(hair: &Strands) -> Vec<Vec3> {
    let mut random = SplitMix64::new(5);
    let mut points: Vec<_> = (0..300).map(|_| HEAD + 0.3 * random.signed_vec3()).collect();
    points.extend((0..hair.points()).step_by(1 + hair.points() / 500).map(|i| hair.point(i)));
    points.extend(NOWHERE);
    points
}

const NOWHERE: [Vec3; 4] = [
    Vec3::NAN,
    Vec3::new(f32::NAN, 1.6, 0.0),
    Vec3::new(0.0, 1.6, f32::NAN),
    Vec3::new(f32::MAX, f32::NEG_INFINITY, 0.0),
];

/// Lists of fragments have no order: sorts them by texel for the comparison.
fn in_order(method: ShadowMethod, words: Vec<u32>) -> Vec<u32> {
    if method != ShadowMethod::Exact {
        return words;
    }
    let total = words.len() as u64;
    // The list follows the texels and starts with a header of four words, the first of which is its length.
    let texels = (64..=2048_u64)
        .step_by(16)
        .map(|n| 2 * n * n)
        .find(|texels| {
            let found = words.get(*texels as usize).map_or(0, |found| u64::from(*found));
            texels + 4 + 2 * found == total
        })
        .expect("a map of the exact shadow") as usize;
    let (texels, list) = words.split_at(texels);
    let of = |ends: &[u32]| &list[4 + 2 * ends[0] as usize..4 + 2 * ends[1] as usize];
    texels.chunks_exact(2).flat_map(|ends| [&[ends[1] - ends[0]], of(ends)].concat()).collect()
}

#[test]
fn the_same_hair_gives_the_same_words_whatever_was_before() {
    let Some(gpu) = device() else { return };
    let (first, second) = (hair(30, 2), hair(12, 9));
    let usual = coarse();
    let mut finer = usual;
    finer.density_clustering.clusters = 8;
    finer.opacity_maps.slices = 64;
    finer.deep_opacity_maps.layers = 6;
    finer.occupancy_maps.slices = 256;
    finer.deep_shadow_maps.tolerance = 1e-3;
    finer.approximate_deep.resolution = 128;
    finer.fourier.terms = 3;
    finer.adaptive.nodes = 16;
    finer.moments.bits = 16;
    finer.exact.resolution = 128;
    finer.voxel_map.resolution = 64;
    finer.voxel_march.resolution = 64;
    for &method in &ShadowMethod::ALL[1..] {
        let mut built = Built::empty(gpu, method);
        let mut words = |strands: &Strands, settings: &ShadowSettings| {
            built.build(0, &input(strands), settings).expect("it fits");
            in_order(method, built.words())
        };
        let once = words(&first, &usual);
        assert!(words(&first, &usual) == once, "{method}: built twice");
        // The hierarchy of the traced rays has no setting.
        assert_eq!(words(&first, &finer) == once, method == ShadowMethod::RayTraced, "{method}: control");
        assert!(words(&second, &usual) != once, "{method}: control");
        assert!(words(&first, &usual) == once, "{method}: other hair and back");
        words(&Strands::default(), &usual);
        assert!(words(&first, &usual) == once, "{method}: none and back");
    }
}

/// Hair that is empty, invalid, flat, or at a single position.
fn bad_hair() -> Vec<(&'static str, Strands)> {
    let one = Vec3::new(0.1, 1.7, 0.05);
    let light = input(&Strands::default()).light;
    let mut broken = grow(Style { wisps: 10, ..SMOOTH }, 1);
    broken[3][7] = Vec3::NAN;
    broken[40] = vec![Vec3::INFINITY; 31];
    broken[77][0].x = 1e30;
    broken[90].truncate(1);
    broken[91].clear();
    // Through the middle of one texel and cell, at every depth and at one.
    let mut random = SplitMix64::new(4);
    let mut crowd = |spread: f32| {
        let line = |random: &mut SplitMix64| {
            let middle = HEAD + light.x * spread * random.signed();
            vec![middle - 0.001 * light.y, middle + 0.001 * light.y]
        };
        let mut all: Vec<_> = (0..100_000).map(|_| line(&mut random)).collect();
        all.extend([vec![HEAD - 0.1 * Vec3::ONE], vec![HEAD + 0.1 * Vec3::ONE]]);
        strands(&all)
    };
    vec![
        ("nothing at all", Strands::default()),
        ("strands of no points", strands(&[vec![], vec![]])),
        ("one point", strands(&[vec![one]])),
        ("two points in one place", strands(&vec![vec![one; 2]; 20])),
        ("along the light", strands(&[(0..30).map(|i| HEAD + light.x * 0.01 * i as f32).collect()])),
        ("all broken", strands(&[vec![Vec3::NAN; 5], vec![Vec3::INFINITY; 5], vec![Vec3::splat(1e30); 4]])),
        ("huge", strands(&[vec![Vec3::splat(-9e3), Vec3::splat(9e3)], vec![Vec3::ZERO, Vec3::X]])),
        ("partly broken", strands(&broken)),
        ("a crowded texel", crowd(0.1)),
        ("a crowded place", crowd(0.0)),
        ("hair", hair(10, 1)),
    ]
}

/// The tolerance. Half a step of 8 bits is 0.00196.
const TOLERANCE: f32 = 0.0025;

/// The tolerance for a point in hair. A fragment half way between two centres of clusters may go to either one: 0.0041 was measured.
fn tolerance(method: ShadowMethod) -> f32 {
    if method == ShadowMethod::DensityClustering { 0.02 } else { TOLERANCE }
}

#[test]
fn broken_hair_and_broken_points_are_as_in_the_definition() {
    let Some(gpu) = device() else { return };
    for &method in ShadowMethod::ALL {
        let mut built = Built::empty(gpu, method);
        for (what, hair) in bad_hair() {
            let at = points_around(&hair);
            // A crowd takes longest to build, and its lookups are no others than those of the rest.
            let every = if what.starts_with("a crowded") { 3 } else { 1 };
            for extinction_scale in sample([0.15, 0.0, 1e30], every) {
                let settings = ShadowSettings::default();
                let input = ShadowInput { extinction_scale, ..input(&hair) };
                let mut cpu = cpu_shadow(method);
                cpu.build(&input, &settings).expect("it fits");
                built.build(0, &input, &settings).expect("it fits");
                let found = built.look_up(&at);
                let wrong = |(p, t): &(&Vec3, &f32)| (cpu.transmittance(**p) - **t).abs() > tolerance(method);
                let wrong: Vec<_> = at.iter().zip(&found).filter(wrong).collect();
                // A ray along the edge of a ribbon may pass it on either side.
                let most = if method == ShadowMethod::RayTraced { at.len() / 100 } else { 0 };
                assert!(
                    wrong.len() <= most,
                    "{method}, {what}, {extinction_scale}: {}, {:?}",
                    wrong.len(),
                    wrong[0]
                );
                assert!(found[at.len() - NOWHERE.len()..].iter().all(|t| *t == 1.0), "{method}, {what}");
                let least = found.iter().copied().fold(1.0, f32::min);
                let shades = method != ShadowMethod::None
                    && extinction_scale > 0.0
                    && ["a crowded texel", "partly broken", "hair"].contains(&what);
                // Control: valid hair casts a shadow.
                assert!(!shades || least < 0.9, "{method}, {what}: {least}");
                assert!(extinction_scale > 0.0 || least == 1.0, "{method}, {what}: {least}");
            }
        }
    }
}

#[test]
fn maps_of_several_lights_keep_apart_and_answers_lie_in_their_bytes() {
    let Some(gpu) = device() else { return };
    let hair = hair(20, 3);
    let at = points_around(&hair);
    let settings = coarse();
    let lights = [Vec3::NEG_Y, Vec3::new(0.8, -0.3, 0.2), Vec3::new(-0.2, -0.5, -1.0)];
    let inputs = lights.map(|light| ShadowInput { light: LightFrame::new(light), maps: 3, ..input(&hair) });
    for &method in ShadowMethod::ALL {
        let mut together = Built::empty(gpu, method);
        for (slot, input) in inputs.iter().enumerate() {
            together.build(slot, input, &settings).expect("it fits");
        }
        let found = together.ask_slots(&[0, 1, 2], &at);
        for (slot, input) in inputs.iter().enumerate() {
            let alone = Built::new(gpu, method, input, &settings).ask_slots(&[0], &at);
            for (all, one) in found.iter().zip(&alone) {
                assert_eq!((all >> (8 * slot)) & 0xff, one & 0xff, "{method}, light {slot}");
                assert_eq!(
                    (all >> 24, one >> 8),
                    (0xff, 0x00ff_ffff),
                    "{method}: no such light is all light"
                );
            }
        }
    }
}

#[test]
fn the_sum_of_answers_the_stride_and_what_lies_behind_are_right() {
    let Some(gpu) = device() else { return };
    let groom = Groom::tuft();
    let settings = coarse();
    for &method in ShadowMethod::ALL {
        let mut built = Built::new(gpu, method, &groom.input(), &settings);
        // Every third point of the strands, in place.
        let hair = Uploaded::new(gpu, &groom.strands);
        let (count, stride) = (groom.strands.points() as u32 / 3, 3);
        // Sums are added to the content of the buffer.
        let mut before = vec![0_u32; SUM_WORDS as usize];
        before[0] = 7;
        let (out, sum) = (buffer(gpu, &vec![0_u32; count as usize]), buffer(gpu, &before));
        let points = hair.input(&groom.input()).strands.points;
        let (out_raw, total) = (out.raw(), Some(sum.raw()));
        let targets =
            GpuTargets { points, stride, count, out: out_raw, sum: total, byte: None, projected: None };
        let mut timer = PassTimer::new(gpu).expect("a timer");
        let mut commands = timer.begin(gpu, "test");
        built.shadow.look_up(0, gpu, &mut commands, &targets);
        let size = built.shadow.columns_size(0);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: size.max(1), height: size.max(1), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let columns = built.shadow.columns((0, 0), gpu, &mut commands, &view);
        commands.submit();
        gpu.check().expect("the device takes it");

        let mut words = vec![0_u32; count as usize];
        read_buffer(gpu, out.raw(), &mut words).expect("read back");
        let mut sums = vec![0_u32; SUM_WORDS as usize];
        read_buffer(gpu, sum.raw(), &mut sums).expect("read back");
        assert_eq!(
            sums.iter().sum::<u32>(),
            7 + words.iter().map(|word| word & 0xff).sum::<u32>(),
            "{method}"
        );
        let at: Vec<_> = (0..count).map(|i| groom.strands.point((stride * i) as usize)).collect();
        assert_eq!(words, built.ask_slots(&[0], &at), "{method}");

        let mut cpu = cpu_shadow(method);
        cpu.build(&groom.input(), &settings).expect("it fits");
        let defined = cpu.column_map();
        assert_eq!(columns.is_some(), defined.is_some(), "{method}");
        if let (Some(columns), Some(defined)) = (columns, defined) {
            assert_eq!(
                (columns.size, columns.uv_from_world),
                (defined.size, defined.uv_from_world),
                "{method}"
            );
            let mut bytes = Vec::new();
            read_texture_rgba8(gpu, &texture, &mut bytes).expect("read back");
            let found = bytes.chunks_exact(4).map(|texel| f32::from(texel[0]) / 255.0);
            let mut errors: Vec<_> = found.zip(&defined.transmittance).map(|(a, b)| (a - b).abs()).collect();
            errors.sort_by(f32::total_cmp);
            // A ray along the edge of a ribbon may pass it on either side.
            let few = if method == ShadowMethod::RayTraced { errors.len() / 1000 } else { 0 };
            let error = errors[errors.len() - 1 - few];
            assert!(error < TOLERANCE, "{method}: {error}");
            assert!(defined.transmittance.iter().any(|t| *t < 0.5), "{method}: control");
        }
    }
}

#[test]
fn a_list_that_was_too_short_grows_to_what_is_needed() {
    let Some(gpu) = device() else { return };
    // 900 segments of about 250 texels each.
    let light = input(&Strands::default()).light;
    let at = |i: usize| {
        let side = if (i / 2 + i).is_multiple_of(2) { -1.0 } else { 1.0 };
        HEAD + light.world_from_light(0.2 * Vec3::new(0.1 * side, side, i as f32 / 450.0 - 1.0))
    };
    let long = strands(&[(0..900).map(at).collect()]);
    let fine = ShadowInput { strand_width: 1e-4, ..input(&long) };
    let settings = ShadowSettings::default();
    let mut built = Built::empty(gpu, ShadowMethod::Exact);
    assert_eq!(built.build(0, &fine, &settings), Ok(2), "no guess is so high");
    assert_eq!(built.build(0, &fine, &settings), Ok(1), "what was needed is kept");
    let report = built.shadow.report(0);
    assert!((200_000..250_000).contains(&report.samples), "{report:?}");
    assert!(report.memory_bytes >= report.needed_bytes && report.needed_bytes > 8 * report.samples);
    // Replaced by a little hair, the map needs little.
    let few = hair(2, 1);
    built.build(0, &input(&few), &settings).expect("it fits");
    built.build(0, &input(&few), &settings).expect("it fits");
    assert!(
        built.shadow.report(0).memory_bytes < report.memory_bytes / 5 * 3,
        "{:?}",
        built.shadow.report(0)
    );
}

#[test]
fn what_does_not_fit_is_refused_with_its_bytes_and_leaves_all_lit() {
    let Some(gpu) = device() else { return };
    let hair = hair(134, 1);
    let at = points_around(&hair);
    let mut large = ShadowSettings::default();
    large.voxel_map.resolution = 512;
    set_resolution(&mut large, 2048);
    large.opacity_maps.slices = 256;
    large.deep_opacity_maps.layers = 8;
    large.density_clustering.clusters = 8;
    large.occupancy_maps.slices = 512;
    large.exact.memory_limit_bytes = 16 << 20;
    (large.voxel_march.resolution, large.voxel_march.memory_limit_bytes) = (512, 0);
    large.ray_traced.memory_limit_bytes = 0;
    // One word per texel: only the finest map is too large.
    large.approximate_deep.resolution = 4096;
    let fine = ShadowInput { strand_width: 1e-5, maps: 64, ..input(&hair) };
    for &method in &ShadowMethod::ALL[1..] {
        let mut built = Built::new(gpu, method, &input(&hair), &ShadowSettings::default());
        assert!(built.look_up(&at).iter().any(|t| *t < 0.9), "{method}: control");
        let error = built.build(0, &fine, &large);
        let (of, needed, limit) = match error {
            Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps }) => {
                // Lights share one grid or hierarchy, and so its limit.
                assert_eq!(maps, if method.in_world() { 1 } else { 64 });
                (method, needed_bytes, limit_bytes)
            }
            Err(ShadowError::Device { method, needed_bytes, limit_bytes }) => {
                (method, needed_bytes, limit_bytes)
            }
            Ok(_) if method == ShadowMethod::VoxelMap && gpu.most_storage_bytes() >= 512 << 20 => continue,
            Err(ShadowError::User { .. }) => panic!("{method} is no method of a user"),
            Ok(_) => panic!("{method} fits"),
        };
        assert_eq!(of, method);
        assert!(needed > limit, "{method}: {needed}, {limit}");
        let text = error.expect_err("found above").to_string();
        let mib = needed as f64 / f64::from(1 << 20);
        let named = [format!("{mib:.1} MiB"), format!("{:.1} GiB", mib / 1024.0)];
        assert!(text.starts_with(method.id()) && named.iter().any(|bytes| text.contains(bytes)), "{text}");
        assert!(built.look_up(&at).iter().all(|t| *t == 1.0), "{method}: lit until it fits");
        assert_eq!(built.shadow.columns_size(0), 0, "{method}");
        built.build(0, &input(&hair), &ShadowSettings::default()).expect("fits");
        assert!(built.look_up(&at).iter().any(|t| *t < 0.9), "{method}: control");
    }
    // The exact method detects it after counting.
    let mut settings = ShadowSettings::default();
    settings.exact.memory_limit_bytes = 16 << 20;
    let one = ShadowInput { strand_width: 5e-4, ..input(&hair) };
    let mut built = Built::empty(gpu, ShadowMethod::Exact);
    built.build(0, &one, &settings).expect("one fits");
    assert!(built.look_up(&at).iter().any(|t| *t < 0.9), "control");
    let report = built.shadow.report(0);
    let error = built.build(0, &ShadowInput { maps: 4, ..one }, &settings).expect_err("four do not");
    let (method, needed_bytes) = (ShadowMethod::Exact, report.needed_bytes);
    assert_eq!(error, ShadowError::TooLarge { method, needed_bytes, limit_bytes: 4 << 20, maps: 4 });
    assert!(
        needed_bytes > 8 * report.cells_total + 8 * report.samples && report.samples > 100_000,
        "{report:?}"
    );
    assert!(built.look_up(&at).iter().all(|t| *t == 1.0), "lit until it fits");
}

#[test]
fn moments_that_no_distribution_has_are_counted_on_the_device() {
    let Some(gpu) = device() else { return };
    let hair = hair(30, 2);
    let mut built = Built::empty(gpu, ShadowMethod::Moments);
    for (kind, count, bits) in [(MomentKind::Power, 4, 16), (MomentKind::Trigonometric, 8, 32)] {
        let mut settings = coarse();
        (settings.moments.kind, settings.moments.count, settings.moments.bits) = (kind, count, bits);
        let mut counted = |bias: f32| {
            settings.moments.bias = bias;
            built.build(0, &input(&hair), &settings).expect("it fits");
            let mut cpu = cpu_shadow(ShadowMethod::Moments);
            cpu.build(&input(&hair), &settings).expect("it fits");
            [built.shadow.report(0).fallbacks, cpu.report().fallbacks]
        };
        let (usual, unbiased) = (counted(1.0), counted(0.0));
        println!("{count} {kind:?}, {bits} bits: {usual:?} with the bias, {unbiased:?} without");
        // Which of the singular systems count as solvable is a matter of rounding: 2 of 468 differ.
        assert!(usual == [0, 0] && unbiased[0] > 20 && unbiased[1] > 20, "{usual:?}, {unbiased:?}");
        assert!(unbiased[0].abs_diff(unbiased[1]) <= unbiased[1] / 50, "{unbiased:?}");
    }
}
