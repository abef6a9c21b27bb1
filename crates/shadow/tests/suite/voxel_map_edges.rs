//! Empty, flat, invalid and huge input.

use crate::common::{EXTINCTION, HEAD, SMOOTH, Style, grow, strands};
use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_groom::Strands;
use lovelock_shadow::voxel_map::reference::{Addressing, DenseMap};
use lovelock_shadow::voxel_map::{MapExtent, VoxelMap};
use lovelock_shadow::{CpuShadow, LightFrame, ShadowInput, ShadowMethod, ShadowSettings, cpu_shadow};

fn input(strands: &Strands, direction: Vec3) -> ShadowInput<'_> {
    let strand_width = 80e-6 * 100_000.0 / strands.count().max(1) as f32;
    ShadowInput {
        strands,
        strand_width,
        extinction_scale: EXTINCTION,
        light: LightFrame::new(direction),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

fn settings(resolution: u32) -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    settings.voxel_map.resolution = resolution;
    settings
}

fn built(input: &ShadowInput, settings: &ShadowSettings) -> VoxelMap {
    let mut map = VoxelMap::default();
    map.build(input, settings).expect("fits");
    map
}

const DOWN: Vec3 = Vec3::NEG_Y;

#[test]
fn a_map_that_was_never_built_is_lit() {
    for &method in ShadowMethod::ALL {
        let map = cpu_shadow(method);
        assert_eq!(map.transmittance(HEAD), 1.0);
        let mut out = [0.0; 3];
        map.transmittance_at(&[0.0; 3], &[0.0; 3], &[0.0; 3], &mut out);
        assert_eq!(out, [1.0; 3]);
        assert_eq!(map.column_map(), None);
        assert_eq!(map.report().samples, 0);
    }
}

#[test]
fn hair_of_no_extent_casts_nothing() {
    let one = Vec3::new(0.1, 0.2, 0.3);
    let cases: [(&str, Vec<Vec<Vec3>>); 5] = [
        ("no strands", vec![]),
        ("strands of no points", vec![vec![], vec![]]),
        ("a single point", vec![vec![one]]),
        ("points that coincide", vec![vec![one; 100]; 50]),
        ("all points broken", vec![vec![Vec3::NAN; 5], vec![Vec3::INFINITY; 5]]),
    ];
    for (what, of) in cases {
        for extent in [MapExtent::Fit, MapExtent::Paper] {
            let hair = strands(&of);
            let mut settings = settings(64);
            settings.voxel_map.extent = extent;
            let map = built(&input(&hair, DOWN), &settings);
            for p in [one, HEAD, one - 5.0 * Vec3::Y] {
                assert_eq!(map.transmittance(p), 1.0, "{what}");
            }
            let columns = map.column_map().expect("built");
            assert!(columns.transmittance.iter().all(|t| *t == 1.0), "{what}");
        }
    }
    // Strands without even the end of the last one.
    let map = built(&input(&Strands::default(), DOWN), &settings(64));
    assert_eq!(map.transmittance(HEAD), 1.0);
}

#[test]
fn a_strand_along_the_light_casts_nothing_and_one_across_it_does() {
    let strand = |axis: Vec3| strands(&[(0..30).map(|i| HEAD + 0.01 * i as f32 * axis).collect()]);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let hair = strand(axis);
        for sign in [1.0, -1.0] {
            let along = ShadowInput { strand_width: 1e-3, ..input(&hair, sign * axis) };
            let map = built(&along, &settings(64));
            // sinθ is 0 up to rounding of the positions.
            assert!(map.transmittance(HEAD + (0.15 + sign) * axis) > 0.999);
            let across = sign * axis.any_orthonormal_vector();
            let map = built(&ShadowInput { light: LightFrame::new(across), ..along }, &settings(64));
            assert!(map.transmittance(HEAD + 0.15 * axis + across) < 0.99);
        }
    }
}

#[test]
fn broken_points_are_left_out_and_counted() {
    let mut of = grow(Style { wisps: 10, ..SMOOTH }, 1);
    let whole = strands(&of);
    of[3][7] = Vec3::NAN;
    of[40] = vec![Vec3::INFINITY; 31];
    of[77][0].x = 1e30;
    let hair = strands(&of);
    let width = 2e-3;
    let broken = ShadowInput { strand_width: width, ..input(&hair, DOWN) };
    let map = built(&broken, &settings(64));
    assert_eq!(map.report().points_ignored, 33);
    let mut out = vec![f32::NAN; hair.points()];
    map.transmittance_at(&hair.x, &hair.y, &hair.z, &mut out);
    assert!(out.iter().all(|t| (0.0..=1.0).contains(t)));
    let dense = DenseMap::build(&broken, &settings(64), Addressing::Window);
    let untouched = built(&ShadowInput { strand_width: width, ..input(&whole, DOWN) }, &settings(64));
    assert_eq!(untouched.report().points_ignored, 0);
    let mut difference = 0.0_f64;
    for i in 0..whole.points() {
        let p = whole.point(i);
        difference = difference.max((f64::from(map.transmittance(p)) - dense.transmittance(p)).abs());
    }
    // See `voxel_map_agreement.rs`.
    assert!(difference < 1.5e-4, "{difference}");
}

#[test]
fn questions_about_broken_points_are_answered_with_light() {
    let hair = strands(&grow(Style { wisps: 10, ..SMOOTH }, 1));
    let map = built(&input(&hair, Vec3::new(0.3, -1.0, 0.2)), &settings(64));
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for p in [Vec3::splat(broken), Vec3::new(broken, 1.6, 0.0), Vec3::new(0.0, broken, 0.0)] {
            assert_eq!(map.transmittance(p), 1.0, "{p}");
        }
    }
}

#[test]
fn long_segments_leave_no_holes() {
    // One segment across the whole map, among short ones: a shadow all along it.
    let (from, to) = (HEAD - 0.3 * Vec3::X, HEAD + 0.3 * Vec3::X);
    let mut of = vec![vec![from, to]];
    of.extend((0..30).map(|i| vec![HEAD + 0.2 * Vec3::Z, HEAD + Vec3::new(0.001 * i as f32, 0.0, 0.2)]));
    let hair = strands(&of);
    for resolution in [64, 256, 512] {
        let one = ShadowInput { strand_width: 1e-3, ..input(&hair, DOWN) };
        let map = built(&one, &settings(resolution));
        let behind: Vec<_> = (0..=100)
            .map(|i| map.transmittance(from.lerp(to, 0.05 + 0.009 * i as f32) - 0.1 * Vec3::Y))
            .collect();
        let (least, most) = behind.iter().fold((1.0_f32, 0.0_f32), |(a, b), t| (a.min(*t), b.max(*t)));
        // Samples at most half a cell apart: 2 or 3 in each cell; the mean over two columns evens that out to 1/5.
        assert!(most < 1.0 && most.ln() / least.ln() > 0.6, "{resolution}: {least}..{most}");
    }
}

#[test]
fn the_column_map_says_what_lies_behind() {
    let hair = strands(&grow(SMOOTH, 4));
    let direction = Vec3::new(0.2, -1.0, 0.4);
    for resolution in [64, 128] {
        let map = built(&input(&hair, direction), &settings(resolution));
        let columns = map.column_map().expect("built");
        let n = columns.size as usize;
        assert_eq!(
            (n, columns.transmittance.len()),
            (resolution as usize, (resolution * resolution) as usize)
        );
        for i in 0..n {
            for border in [i, (n - 1) * n + i, i * n, i * n + n - 1] {
                assert_eq!(columns.transmittance[border], 1.0);
            }
        }
        assert!(columns.transmittance.iter().any(|t| *t < 0.1));
        // The centre of each texel equals a lookup far behind the hair.
        let light = LightFrame::new(direction);
        let world_from_uv = columns.uv_from_world.inverse();
        for at in (0..n * n).step_by(37) {
            let uv = Vec3::new((at % n) as f32 + 0.5, (at / n) as f32 + 0.5, 0.0) / n as f32;
            let p = world_from_uv.transform_point3(uv) + 3.0 * light.x;
            let again = columns.uv_from_world.transform_point3(p);
            assert!((again - uv).truncate().length() < 1e-4 && again.z > 1.0);
            // Rounding of the matrices: some 1e-4 of a cell, times the steepest change between columns.
            assert!((map.transmittance(p) - columns.transmittance[at]).abs() < 2e-3, "texel {at}");
        }
    }
}

#[test]
fn settings_that_no_slider_gives_are_safe() {
    let hair = strands(&grow(Style { wisps: 5, ..SMOOTH }, 1));
    for resolution in [0, 1, 33, 100, 127, 128] {
        let map = built(&input(&hair, DOWN), &settings(resolution));
        let used = map.lattice().expect("built").resolution;
        assert!(used.is_multiple_of(8) && (16..=512).contains(&used));
        assert!(used.abs_diff(resolution.max(16)) <= 4);
    }
    assert_eq!(settings(u32::MAX).voxel_map.clamped().resolution, 512);
    for width in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e30] {
        let map = built(&ShadowInput { strand_width: width, ..input(&hair, DOWN) }, &settings(64));
        let t = map.transmittance(HEAD - Vec3::Y);
        assert!((0.0..=1.0).contains(&t), "{width}: {t}");
    }
    let mut odd = settings(64);
    odd.voxel_map.extent = MapExtent::Paper;
    for head_size in [f32::NAN, -1.0, 1e30] {
        odd.voxel_map.head_size = head_size;
        assert!(built(&input(&hair, DOWN), &odd).transmittance(HEAD) <= 1.0);
    }
}
