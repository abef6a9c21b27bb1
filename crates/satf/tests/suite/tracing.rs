//! Planar ray tracing of sectors.

use std::f32::consts::TAU;

use glam::Vec2;
use lovelock_satf::layout::{ANGLES, TEXELS};
use lovelock_satf::sector::{Sector, WIDTH};
use lovelock_satf::trace::{AMBIENT, LONGEST_PATH, Rays, optical_depth, trace};

/// A sector with strands on its left side.
fn one_sided() -> Sector {
    let mut sector = Sector::empty();
    for (s, t, depth) in [(0.2, 0.3, 0.4), (0.35, 0.7, 0.3), (0.1, 0.6, 0.2)] {
        sector.add(Vec2::new(s, t), Sector::sigma(0.0), depth);
    }
    sector
}

fn azimuth(k: usize) -> f32 {
    k as f32 * TAU / ANGLES as f32
}

#[test]
fn a_uniform_density_lets_through_the_exponential_of_the_path() {
    for depth in [0.1, 0.7, 2.0] {
        for k in 0..ANGLES {
            let cosine = azimuth(k).cos().abs().max(1.0 / (LONGEST_PATH * WIDTH));
            let exact = 1.0 - (-depth / cosine).exp();
            for opacity in trace(&Sector::uniform(depth), k).opacity {
                assert!((opacity - exact).abs() < 2e-3, "{depth} {k}: {opacity} for {exact}");
            }
            let without_obliquity = 1.0 - (-depth).exp();
            let oblique = !k.is_multiple_of(8);
            assert_eq!((without_obliquity - exact).abs() > 2e-3, oblique, "the control");
        }
    }
}

#[test]
fn the_angle_along_the_strand_changes_nothing() {
    // N strands of the width w fill a block of the area `area`. A ray at the angle ψ to them, at the azimuth θ, meets
    // N w / area sin ψ per metre on its way, which is 1 / (cos θ sin ψ) long.
    let (strands, width, area, theta) = (7.0_f32, 0.05, WIDTH, 0.6_f32);
    let sector = Sector::uniform(strands * width / area);
    let planar = optical_depth(&sector, theta, 0.4);
    for psi in [0.3_f32, 0.9, 1.2] {
        let per_metre = strands * width / area * psi.sin();
        let path = 1.0 / (theta.cos() * psi.sin());
        assert!((per_metre * path - planar).abs() < 1e-4);
        let without_sine = strands * width / area * path;
        assert!((without_sine - planar).abs() > 1e-3, "the control");
    }
}

#[test]
fn an_empty_sector_is_transparent_and_a_dense_one_opaque() {
    for k in 0..ANGLES {
        let empty = trace(&Sector::empty(), k);
        assert!(empty.opacity.iter().all(|&o| o == 0.0));
        assert!(empty.reflected.iter().flatten().all(|&r| r == 0.0));
        // A ray that stops early is recorded too.
        let dense = trace(&Sector::uniform(50.0), k);
        assert!(dense.opacity.iter().all(|&o| o > 0.998));
        // Without a gradient there is only the ambient part, and light that came first counts first.
        let reflected = dense.reflected.iter().flatten();
        assert!(reflected.copied().all(|r| (r - AMBIENT).abs() < 1e-3));
    }
}

#[test]
fn the_mean_over_the_arc_is_the_optical_depth_of_the_radius_for_any_pattern() {
    let sector = one_sided();
    assert!((sector.optical_depth() - 0.9).abs() < 1e-5);
    for theta in [0.0, 0.5, -0.8, 2.5] {
        let mean = |weight: fn(f32) -> f32| {
            (0..256).map(|i| weight(optical_depth(&sector, theta, (i as f32 + 0.5) / 256.0))).sum::<f32>()
                / 256.0
        };
        let exact = 0.9 / theta.cos().abs();
        assert!((mean(|depth| depth) - exact).abs() < 5e-3, "{theta}");
        // The transmittance of the mean is not the mean of transmittances: gaps let more through.
        assert!(mean(|depth| (-depth).exp()) > (-exact).exp() + 5e-3, "the control");
    }
}

#[test]
fn a_view_from_behind_sees_the_same_opacity_at_the_same_texel() {
    let sector = one_sided();
    for theta in [0.0, 0.4, -0.9] {
        for u in [0.1, 0.37, 0.8] {
            let front = optical_depth(&sector, theta, u);
            // The same line has the opposite direction.
            let entry = (u - theta.tan() / WIDTH).rem_euclid(1.0);
            let back = optical_depth(&sector, theta + 0.5 * TAU, entry);
            let along_other_line = optical_depth(&sector, theta + 0.5 * TAU, u);
            let same = optical_depth(&sector, theta, entry);
            assert!((along_other_line - front).abs() < 2e-4 + 1e-3 * front, "{theta} {u}");
            assert!((back - same).abs() < 2e-4 + 1e-3 * same);
        }
    }
}

#[test]
fn mirrored_sectors_agree_under_mirrored_angles() {
    let (sector, mirror) = (one_sided(), one_sided().mirrored());
    let close = |a: &Rays, b: &Rays, light: usize| {
        (0..TEXELS).all(|i| {
            let j = TEXELS - 1 - i;
            let other = (ANGLES - light) % ANGLES;
            (a.opacity[i] - b.opacity[j]).abs() < 1e-4
                && (a.reflected[light][i] - b.reflected[other][j]).abs() < 1e-4
        })
    };
    for k in 0..ANGLES {
        let rays = trace(&sector, k);
        let mirrored = trace(&mirror, (ANGLES - k) % ANGLES);
        assert!((0..ANGLES).all(|light| close(&rays, &mirrored, light)), "{k}");
        if !k.is_multiple_of(8) {
            let same_angle = trace(&mirror, k);
            assert!(!(0..ANGLES).all(|light| close(&rays, &same_angle, light)), "the control");
        }
    }
}

#[test]
fn hair_is_brightest_on_the_side_of_the_light() {
    // One thick strand in the middle, seen from outside: light from the left (12) brightens its left, that from the right
    // (4) its right. A normal along the gradient instead of against it would exchange them.
    let mut sector = Sector::empty();
    sector.add(Vec2::new(0.5, 0.5), 0.15, 1.0);
    let rays = trace(&sector, 0);
    let side =
        |light: usize, texels: std::ops::Range<usize>| rays.reflected[light][texels].iter().sum::<f32>();
    assert!(side(12, 8..16) > 1.3 * side(12, 16..24));
    assert!(side(4, 16..24) > 1.3 * side(4, 8..16));
    // Light from the eye's side is brighter than that from behind.
    assert!(side(0, 0..TEXELS) > 1.3 * side(8, 0..TEXELS));
}
