//! Empty, invalid and huge input, and settings out of range, for every method.

use std::sync::Arc;

use crate::common::{
    EXTINCTION, HEAD, SMOOTH, SplitMix64, Style, grow, set_resolution, strands, texel_methods,
};
use glam::Vec3;
use lovelock_base::settings::{Choices, Settings};
use lovelock_groom::Strands;
use lovelock_shadow::voxel_map::{VoxelDeposit, VoxelSlices};
use lovelock_shadow::{
    ClusterDeviation, ClusterSeeds, DepthRange, LayerGrowth, LightFrame, LineFilter, MomentKind, ShadowError,
    ShadowInput, ShadowMethod, ShadowSettings, TexelFilter, converged, cpu_shadow,
};
use lovelock_testkit::suite::{cases, sample};

const LIGHT: Vec3 = Vec3::new(0.3, -1.0, 0.2);

fn input(strands: &Strands) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: 1e-3,
        extinction_scale: EXTINCTION,
        light: LightFrame::new(LIGHT),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// Hair that is empty, invalid, flat, or at a single position.
fn bad_hair() -> Vec<(&'static str, Strands)> {
    let one = Vec3::new(0.1, 1.7, 0.05);
    let grown = grow(Style { wisps: 10, ..SMOOTH }, 1);
    let mut broken = grown.clone();
    broken[3][7] = Vec3::NAN;
    broken[40] = vec![Vec3::INFINITY; 31];
    broken[41][3].y = f32::NEG_INFINITY;
    broken[77][0].x = 1e30;
    broken[78][5].x = f32::MAX;
    broken[90].truncate(1);
    broken[91].clear();
    let light = LightFrame::new(LIGHT);
    let along = |i: usize| HEAD + light.x * 0.01 * i as f32;
    // Through the middle of one texel, at every depth.
    let mut random = SplitMix64::new(4);
    let crowd = |_| {
        let middle = light.x * 0.1 * random.signed();
        vec![HEAD + middle - 0.001 * light.y, HEAD + middle + 0.001 * light.y]
    };
    let mut crowd: Vec<_> = (0..70_000).map(crowd).collect();
    crowd.extend([vec![HEAD - 0.1 * Vec3::ONE], vec![HEAD + 0.1 * Vec3::ONE]]);
    vec![
        ("nothing at all", Strands::default()),
        ("no strands", strands(&[])),
        ("strands of no points", strands(&[vec![], vec![]])),
        ("one point", strands(&[vec![one]])),
        ("coincident points", strands(&vec![vec![one; 50]; 20])),
        ("along the light", strands(&[(0..30).map(along).collect()])),
        ("all broken", strands(&[vec![Vec3::NAN; 5], vec![Vec3::INFINITY; 5], vec![Vec3::splat(1e30); 4]])),
        ("partly broken", strands(&broken)),
        ("huge", strands(&[vec![Vec3::splat(-9e3), Vec3::splat(9e3)], vec![Vec3::ZERO, Vec3::X]])),
        ("a crowded texel", strands(&crowd)),
        ("hair", strands(&grown)),
    ]
}

/// Settings out of range, and at the ends of ranges.
fn hostile(of: u32) -> ShadowSettings {
    let mut s = ShadowSettings::default();
    let (n, x) =
        [(0, f32::NAN), (1, f32::NEG_INFINITY), (u32::MAX, f32::INFINITY), (100, -1.0)][of as usize % 4];
    // The largest maps would be slow here; `methods_memory.rs` tests them.
    let resolution = if n == u32::MAX { 300 } else { n };
    s.voxel_map.resolution = if n == u32::MAX { 64 } else { n };
    s.voxel_map.head_size = x;
    s.voxel_map.point_extinction = x;
    s.voxel_map.slices = [VoxelSlices::Uniform, VoxelSlices::Adaptive][of as usize % 2];
    s.voxel_map.deposit = VoxelDeposit::Isotropic;
    set_resolution(&mut s, resolution);
    s.opacity_maps.slices = n;
    s.deep_opacity_maps.layers = n;
    s.deep_opacity_maps.depth_share = x;
    s.deep_opacity_maps.growth = LayerGrowth::Even;
    s.density_clustering.clusters = n;
    s.density_clustering.steps = n;
    s.density_clustering.seeds = [ClusterSeeds::Uniform, ClusterSeeds::Histogram][of as usize % 2];
    s.density_clustering.deviation = ClusterDeviation::Merged;
    (s.density_clustering.line_filter, s.density_clustering.line_width) = (LineFilter::Gaussian, x);
    (s.occupancy_maps.slices, s.occupancy_maps.slabs) = (n, n);
    (s.deep_shadow_maps.nodes, s.deep_shadow_maps.tolerance) = (n, x);
    (s.approximate_deep.hairs, s.approximate_deep.spacing) = (n, x);
    (s.fourier.terms, s.fourier.window, s.fourier.depth_range) = (n, true, DepthRange::Map);
    s.adaptive.nodes = n;
    (s.moments.bits, s.moments.bias, s.moments.overestimation) = (n, x, x);
    (s.moments.count, s.moments.kind) = (n, MomentKind::ALL[of as usize % 2]);
    s.voxel_march.resolution = if n == u32::MAX { 64 } else { n };
    (s.voxel_march.step, s.voxel_march.jitter) = (x, true);
    s.voxel_march.memory_limit_bytes = u64::MAX;
    (s.ray_traced.rays, s.ray_traced.memory_limit_bytes) = (if n == u32::MAX { 16 } else { n }, u64::MAX);
    s.exact.memory_limit_bytes = u64::MAX;
    s.exact.filter = TexelFilter::Nearest;
    s
}

fn points_around(hair: &Strands) -> [Vec<f32>; 3] {
    let mut random = SplitMix64::new(5);
    let mut points: Vec<_> = (0..300).map(|_| HEAD + 0.3 * random.signed_vec3()).collect();
    points.extend((0..hair.points()).step_by(1 + hair.points() / 500).map(|i| hair.point(i)));
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
        points.extend([Vec3::splat(broken), Vec3::new(broken, 1.6, 0.0), Vec3::new(0.0, 1.6, broken)]);
    }
    [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect())
}

#[test]
fn every_answer_is_a_transmittance() {
    for (what, hair) in bad_hair() {
        let [x, y, z] = points_around(&hair);
        let mut out = vec![f32::NAN; x.len()];
        // A crowd takes longest to build: in the short suite with the first of each kind of settings alone, and other hair with half of them.
        let every = if what == "a crowded texel" { 7 } else { 2 };
        for &method in ShadowMethod::ALL {
            let mut map = cpu_shadow(method);
            // Each ray through a crowd meets all of it: every ray of the columns does so in the long suite alone.
            let slow = method == ShadowMethod::RayTraced && what == "a crowded texel";
            let has_columns = !slow || cases(&[false], &[true])[0];
            let mut check = |input: &ShadowInput, settings: &ShadowSettings| {
                let done = map.build(input, settings);
                assert!(done.is_ok(), "{method}, {what}: {done:?}");
                out.fill(f32::NAN);
                map.transmittance_at(&x, &y, &z, &mut out);
                assert!(out.iter().all(|t| (0.0..=1.0).contains(t)), "{method}, {what}: {out:?}");
                if let Some(columns) = has_columns.then(|| map.column_map()).flatten() {
                    assert!(
                        columns.transmittance.iter().all(|t| (0.0..=1.0).contains(t)),
                        "{method}, {what}"
                    );
                    assert!(columns.uv_from_world.is_finite(), "{method}, {what}");
                }
                out.iter().copied().fold(1.0, f32::min)
            };
            let usual = check(&input(&hair), &ShadowSettings::default());
            for of in sample(0..4, every) {
                check(&input(&hair), &hostile(of));
            }
            for extinction_scale in sample([0.0, -1.0, f32::NAN], every) {
                let input = ShadowInput { extinction_scale, ..input(&hair) };
                assert_eq!(check(&input, &ShadowSettings::default()), 1.0, "{method}, {what}: no extinction");
            }
            for extinction_scale in sample([1e30, 1e-30, 4.0, f32::INFINITY], every) {
                check(&ShadowInput { extinction_scale, ..input(&hair) }, &ShadowSettings::default());
            }
            for strand_width in sample([1e30, 0.0, -1.0, f32::NAN, 1e-40, f32::INFINITY], every) {
                check(&ShadowInput { strand_width, ..input(&hair) }, &ShadowSettings::default());
            }
            // Control: valid hair casts a shadow. Density without directions does so along strands, too.
            let along = method == ShadowMethod::VoxelMarch && what == "along the light";
            let is_valid = ["a crowded texel", "hair", "partly broken"].contains(&what);
            assert_eq!(
                usual < 0.9,
                method != ShadowMethod::None && is_valid || along,
                "{method}, {what}: {usual}"
            );
        }
    }
}

#[test]
fn the_converged_shadow_takes_anything_too_long_suite() {
    for (what, hair) in bad_hair() {
        let [x, y, z] = points_around(&hair).map(|c| c.into_iter().step_by(9).collect::<Vec<_>>());
        let all = [(1e-3, 0.15), (f32::NAN, 0.15), (1e30, f32::INFINITY), (1e-3, 0.0)];
        for (strand_width, extinction_scale) in sample(all, if what == "a crowded texel" { 4 } else { 1 }) {
            let mut settings = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
            settings.exact.resolution = 64;
            let input = ShadowInput { strand_width, extinction_scale, ..input(&hair) };
            let found = converged(&input, &settings, [&x, &y, &z]).expect("fits");
            assert!(found.transmittance.iter().all(|t| (0.0..=1.0).contains(t)), "{what}: {found:?}");
        }
    }
    let nothing = converged(&input(&Strands::default()), &ShadowSettings::default(), [&[], &[], &[]]);
    assert!(nothing.expect("fits").transmittance.is_empty());
}

/// Zigzag strands whose segments span the whole map.
fn zigzag(lines: usize) -> Strands {
    let light = LightFrame::new(LIGHT);
    let at = |i: usize| {
        let side = if (i / 2 + i).is_multiple_of(2) { -1.0 } else { 1.0 };
        let across = (i / 2) as f32 / lines as f32 * 2.0 - 1.0;
        HEAD + light.world_from_light(0.2 * Vec3::new(0.1 * side, side, across))
    };
    strands(&[(0..2 * lines).map(at).collect()])
}

#[test]
fn maps_that_do_not_fit_are_refused_with_the_number() {
    // 150,000 lines of 2000 texels: 3 · 10⁸ fragments.
    let hair = zigzag(150_000);
    let fine = ShadowInput { strand_width: 1e-5, ..input(&hair) };
    let mut settings = ShadowSettings::default();
    set_resolution(&mut settings, 2048);
    settings.density_clustering.prefiltered = false;
    settings.exact.memory_limit_bytes = 1 << 30;
    for method in texel_methods() {
        let mut map = cpu_shadow(method);
        map.build(&input(&strands(&grow(Style { wisps: 2, ..SMOOTH }, 1))), &settings)
            .expect("a little fits");
        let error = map.build(&fine, &settings).expect_err("does not fit");
        let ShadowError::TooLarge { method: of, needed_bytes, limit_bytes, .. } = error else {
            panic!("{method}: {error}");
        };
        assert_eq!(of, method);
        // 21 bytes each.
        assert!(
            needed_bytes > limit_bytes && (5_800_000_000..6_800_000_000).contains(&needed_bytes),
            "{error}"
        );
        let text = error.to_string();
        let needed = format!("needs {:.1} GiB", needed_bytes as f64 / f64::from(1 << 30));
        assert!(text.starts_with(method.id()) && text.contains(&needed), "{text}");
        assert_eq!(map.transmittance(HEAD + 0.5 * input(&hair).light.x), 1.0, "lit until it fits");
        assert_eq!(map.column_map(), None);
    }
    // Fragments fit, but records do not: 4 million texels of 256 slices.
    let hair = zigzag(2000);
    let fine = ShadowInput { strand_width: 1e-5, ..input(&hair) };
    settings.opacity_maps.slices = 256;
    let mut map = cpu_shadow(ShadowMethod::OpacityMaps);
    let error = map.build(&fine, &settings).expect_err("does not fit").to_string();
    assert!(error.contains("needs 4.0 GiB") && error.contains("limit of 2.0 GiB"), "{error}");
    // Both fit with less.
    settings.opacity_maps.resolution = 512;
    map.build(&fine, &settings).expect("fits");
    settings.exact.memory_limit_bytes = 8 << 30;
    cpu_shadow(ShadowMethod::Exact).build(&fine, &settings).expect("fits");
}

#[test]
fn numbers_beyond_their_limits_become_the_nearest() {
    let mut least = ShadowSettings::default();
    (least.adaptive.nodes, least.deep_shadow_maps.nodes, least.fourier.terms) = (0, 0, 0);
    least.moments.count = 0;
    (least.moments.bits, least.ray_traced.rays, least.voxel_march.resolution) = (0, 0, 0);
    least.voxel_march.step = -1.0;
    let least = least.clamped();
    assert_eq!((least.adaptive.nodes, least.deep_shadow_maps.nodes, least.fourier.terms), (4, 8, 3));
    assert_eq!((least.moments.bits, least.ray_traced.rays, least.voxel_march.resolution), (16, 1, 16));
    assert_eq!((least.voxel_march.step, least.moments.count), (0.25, 4));
    let mut most = ShadowSettings::default();
    (most.adaptive.nodes, most.deep_shadow_maps.nodes, most.fourier.terms) = (u32::MAX, u32::MAX, u32::MAX);
    most.moments.count = u32::MAX;
    (most.moments.bits, most.ray_traced.rays, most.voxel_march.resolution) = (u32::MAX, u32::MAX, u32::MAX);
    most.voxel_march.step = f32::INFINITY;
    let most = most.clamped();
    assert_eq!((most.adaptive.nodes, most.deep_shadow_maps.nodes, most.fourier.terms), (32, 32, 15));
    assert_eq!((most.moments.bits, most.ray_traced.rays, most.voxel_march.resolution), (32, 256, 512));
    assert!(most.voxel_march.step <= 4.0 && most.moments.count == 8);
}

#[test]
fn a_grid_that_does_not_fit_is_refused_with_the_number() {
    let hair = strands(&grow(SMOOTH, 1));
    let mut settings = ShadowSettings::default();
    (settings.voxel_march.resolution, settings.voxel_march.memory_limit_bytes) = (512, 0);
    let mut map = cpu_shadow(ShadowMethod::VoxelMarch);
    map.build(&input(&hair), &ShadowSettings::default()).expect("the default fits");
    let error = map.build(&input(&hair), &settings).expect_err("finer cells do not");
    let ShadowError::TooLarge { method, needed_bytes, limit_bytes, .. } = error else { panic!("{error}") };
    assert_eq!((method, limit_bytes), (ShadowMethod::VoxelMarch, 16 << 20), "{error}");
    assert!(needed_bytes > limit_bytes, "{error}");
    let text = error.to_string();
    assert!(text.starts_with("voxel-march needs") && text.ends_with("or raise the limit"), "{text}");
    assert_eq!(map.transmittance(HEAD + 0.5 * input(&hair).light.x), 1.0, "lit until it fits");
    assert_eq!(map.column_map(), None);
    // With the limit that it names it fits; lights share a limit.
    settings.voxel_march.memory_limit_bytes = needed_bytes;
    map.build(&input(&hair), &settings).expect("fits");
    let report = map.report();
    assert!(report.memory_bytes <= report.needed_bytes && report.needed_bytes == needed_bytes, "{report:?}");
    // The formula: a word a brick of the window, and 9³ words a brick with hair.
    let bricks = report.cells_touched / 512;
    assert!((bricks * 729 * 4..bricks * 729 * 4 + 4 * 68 * 68 * 68).contains(&needed_bytes), "{report:?}");
    let error = map.build(&ShadowInput { maps: 2, ..input(&hair) }, &settings).expect_err("two do not");
    assert!(error.to_string().contains("as one of 2 lights"), "{error}");
}

#[test]
fn the_converged_shadow_is_refused_where_a_row_does_not_fit() {
    // All in one row of texels.
    let light = LightFrame::new(LIGHT);
    let at = |i: usize| HEAD + light.y * if i.is_multiple_of(2) { 0.3 } else { -0.3 };
    let hair = strands(&[(0..60_000).map(at).collect()]);
    let mut settings = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
    settings.exact.memory_limit_bytes = 0;
    let found = converged(&input(&hair), &settings, [&[HEAD.x], &[HEAD.y], &[HEAD.z]]);
    assert!(
        matches!(found, Err(ShadowError::TooLarge { limit_bytes, .. }) if limit_bytes == 16 << 20),
        "{found:?}"
    );
}

#[test]
fn shadows_are_the_same_for_any_number_of_threads() {
    let hair = strands(&grow(Style { wisps: 60, ..SMOOTH }, 2));
    let [x, y, z] = points_around(&hair);
    for &method in ShadowMethod::ALL {
        let answer = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| {
                let mut map = cpu_shadow(method);
                map.build(&input(&hair), &ShadowSettings::default()).expect("fits");
                let mut out = vec![f32::NAN; x.len()];
                map.transmittance_at(&x, &y, &z, &mut out);
                let columns = map.column_map();
                (out.into_iter().map(f32::to_bits).collect::<Vec<_>>(), columns)
            })
        };
        let one = answer(1);
        for threads in [2, 3, 7] {
            assert!(answer(threads) == one, "{method} on {threads} threads");
        }
    }
    let settings = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
    let answer = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let few = |c: &[f32]| c.iter().copied().step_by(20).collect::<Vec<_>>();
        pool.install(|| converged(&input(&hair), &settings, [&few(&x), &few(&y), &few(&z)]).expect("fits"))
    };
    assert!(answer(1) == answer(3));
}

#[test]
fn a_map_that_is_built_again_remembers_nothing() {
    let (first, second) = (grow(Style { wisps: 30, ..SMOOTH }, 2), grow(Style { wisps: 12, ..SMOOTH }, 9));
    let (first, second) = (strands(&first), strands(&second));
    let [x, y, z] = points_around(&second);
    for &method in ShadowMethod::ALL {
        let mut used = cpu_shadow(method);
        let mut finer = ShadowSettings::default();
        finer.density_clustering.clusters = 8;
        finer.opacity_maps.slices = 256;
        used.build(&input(&first), &finer).expect("fits");
        let mut fresh = cpu_shadow(method);
        let answers = [&mut used, &mut fresh].map(|map| {
            map.build(&input(&second), &ShadowSettings::default()).expect("fits");
            let mut out = vec![f32::NAN; x.len()];
            map.transmittance_at(&x, &y, &z, &mut out);
            out
        });
        assert_eq!(answers[0], answers[1], "{method}");
    }
}

#[test]
fn moments_that_no_distribution_has_are_counted() {
    let hair = strands(&grow(Style { wisps: 20, ..SMOOTH }, 1));
    let counted = |(kind, count, bits): (MomentKind, u32, u32), bias: f32| {
        let mut settings = ShadowSettings::default();
        (settings.moments.kind, settings.moments.count) = (kind, count);
        (settings.moments.bits, settings.moments.bias) = (bits, bias);
        let mut map = cpu_shadow(ShadowMethod::Moments);
        map.build(&input(&hair), &settings).expect("fits");
        (map.report().fallbacks, map.report().cells_touched)
    };
    for kind in [MomentKind::Power, MomentKind::Trigonometric] {
        for case in [(kind, 4, 16), (kind, 4, 32), (kind, 6, 16), (kind, 6, 32), (kind, 8, 16), (kind, 8, 32)]
        {
            let (usual, unbiased) = (counted(case, 1.0), counted(case, 0.0));
            println!("{case:?}: {usual:?} with the bias, {unbiased:?} without");
            // Without the bias, texels with few hairs have no room for rounding; four trigonometric means of 16 bits are rounded more rarely
            // to such that no hair has.
            let least = if case == (MomentKind::Trigonometric, 4, 16) { 20 } else { unbiased.1 / 20 };
            assert!(usual.0 == 0 && unbiased.0 > least, "{case:?}: {usual:?}, {unbiased:?}");
        }
    }
}

#[test]
fn strands_without_their_last_index_are_empty() {
    let hair = Strands { first_point: Arc::from([0_u32]), ..Strands::default() };
    for &method in ShadowMethod::ALL {
        let mut map = cpu_shadow(method);
        map.build(&input(&hair), &ShadowSettings::default()).expect("fits");
        assert_eq!(map.transmittance(HEAD), 1.0);
    }
}
