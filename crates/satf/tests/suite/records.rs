//! Records of the database and how they are read.

use std::f32::consts::TAU;

use lovelock_satf::features::depth_of;
use lovelock_satf::layout::{ANGLES, DEPTHS, MIP_START, MIPS, SECTORS, TEXELS, texels_of};
use lovelock_satf::{Curl, Database, Features, SectorRef};

use crate::database;

fn features(optical_depth: f32, s_centroid: f32) -> Features {
    Features { optical_depth, s_centroid, t_centroid: 0.56, curl: Curl::Straight }
}

/// The middle of a texel.
fn middle(texel: usize) -> f32 {
    (texel as f32 + 0.5) / TEXELS as f32
}

fn azimuth(k: usize) -> f32 {
    k as f32 * TAU / ANGLES as f32
}

#[test]
fn any_number_of_threads_makes_the_same_bytes_and_progress_ends_at_one() {
    let last = std::sync::Mutex::new(0.0_f32);
    let build = || {
        Database::build(&|part| {
            let mut last = last.lock().unwrap();
            *last = last.max(part);
        })
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(build);
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap().install(build);
    assert!(one == two && one == *database());
    assert_eq!(*last.lock().unwrap(), 1.0);
}

#[test]
fn a_look_up_at_a_record_is_that_record() {
    let database = database();
    for (sector, view, light, texel) in
        [(0, 0, 0, 0), (17, 3, 9, 31), (200, 15, 15, 12), (SECTORS - 1, 8, 1, 5)]
    {
        let of = SectorRef { index: sector as u32, mirrored: false, tau_ratio: 1.0 };
        let stored = (
            f32::from(database.opacity_record(sector, view)[texel]) / 255.0,
            f32::from(database.reflectance_record(sector, view, light)[texel]) / 255.0,
        );
        let (theta_v, theta_l) = (azimuth(view), azimuth(light) - TAU);
        let read = database.sample(of, theta_v, theta_l, middle(texel) + 1.0, 0.0);
        assert!((read.0 - stored.0).abs() < 1e-3 && (read.1 - stored.1).abs() < 1e-3, "{read:?} {stored:?}");
        let nearest = database.sample_nearest(of, [theta_v + 0.1, theta_l - 0.1], middle(texel) + 0.01, 0.2);
        assert_eq!(nearest, stored);
        assert!((database.opacity(of, theta_v, middle(texel), 0.0) - stored.0).abs() < 1e-3);
    }
}

#[test]
fn values_between_samples_are_halfway_in_each_dimension_also_around_the_ends() {
    let database = database();
    let of = SectorRef { index: 11, mirrored: false, tau_ratio: 1.0 };
    let near = |value: f32, a: f32, b: f32| (value - 0.5 * (a + b)).abs() < 1e-4;
    let last = middle(TEXELS - 1);
    let at = |theta_v: f32, theta_l: f32, u: f32| database.sample(of, theta_v, theta_l, u, 0.0);
    let step = azimuth(1);
    let (a, b) = (at(0.0, 0.0, last), at(0.0, 0.0, middle(0)));
    assert!(near(at(0.0, 0.0, 0.0).0, a.0, b.0) && near(at(0.0, 0.0, 1.0).1, a.1, b.1));
    let (a, b) = (at(-step, 1.0, 0.3), at(0.0, 1.0, 0.3));
    assert!(near(at(-0.5 * step, 1.0, 0.3).0, a.0, b.0) && near(at(TAU - 0.5 * step, 1.0, 0.3).1, a.1, b.1));
    let (a, b) = (at(0.7, -step, 0.3), at(0.7, 0.0, 0.3));
    assert!(near(at(0.7, -0.5 * step, 0.3).1, a.1, b.1));
    assert!((a.1 - b.1).abs() > 1e-3, "the control: the records differ");
}

#[test]
fn mirrored_features_find_the_mirror_image() {
    let database = database();
    for depth in [0.1, 0.9, 4.0] {
        let left = database.find(&features(depth, 0.3));
        let right = database.find(&features(depth, 0.7));
        assert!(!left.mirrored && right.mirrored && left.index == right.index);
        for (theta_v, theta_l, u) in [(0.3, 1.0, 0.2), (-2.0, 0.4, 0.55), (1.5, -3.0, 0.9)] {
            let (a, b) = (
                database.sample(left, theta_v, theta_l, u, 0.5),
                database.sample(right, -theta_v, -theta_l, 1.0 - u, 0.5),
            );
            assert!((a.0 - b.0).abs() < 1e-5 && (a.1 - b.1).abs() < 1e-5);
            let unmirrored = database.sample(right, theta_v, theta_l, u, 0.5);
            assert!((a.1 - unmirrored.1).abs() > 1e-4, "the control");
        }
    }
}

#[test]
fn opacity_follows_the_optical_depth_between_and_beyond_bins() {
    let database = database();
    let of = database.find(&features(depth_of(7), 0.44));
    let stored = database.opacity(of, 0.4, 0.3, 0.0);
    for ratio in [0.0, 0.5, 0.9, 1.1, 3.0] {
        let scaled = database.opacity(SectorRef { tau_ratio: ratio, ..of }, 0.4, 0.3, 0.0);
        let (depth, wanted) = (-(1.0 - scaled).ln(), -(1.0 - stored).ln() * ratio);
        assert!((depth - wanted).abs() < 1e-4, "{ratio}: {depth} for {wanted}");
        if ratio > 2.0 {
            assert!((scaled - stored * ratio).abs() > 0.05, "the control: opacity is not proportional");
        }
    }
    assert_eq!(database.opacity(database.find(&features(0.0, 0.5)), 0.0, 0.0, 0.0), 0.0);
    assert!(database.opacity(database.find(&features(1e9, 0.5)), 0.0, 0.0, 0.0) > 0.999);
}

#[test]
fn a_denser_sector_is_nowhere_more_transparent_on_average() {
    let mean = |index: usize| {
        (0..ANGLES)
            .map(|view| u32::from(database().opacity_record(index, view)[MIP_START[MIPS - 1]]))
            .sum::<u32>()
    };
    for pattern in 0..SECTORS / DEPTHS {
        for depth in 1..DEPTHS {
            assert!(
                mean(pattern * DEPTHS + depth) >= mean(pattern * DEPTHS + depth - 1),
                "{pattern} {depth}"
            );
        }
    }
}

#[test]
fn levels_of_detail_are_means_and_reflectance_is_weighted_by_opacity() {
    let database = database();
    let mut differs = false;
    for (sector, view, light) in [(24, 0, 3), (100, 5, 12), (333, 2, 2)] {
        let opacity = database.opacity_record(sector, view);
        let reflectance = database.reflectance_record(sector, view, light);
        for mip in 1..MIPS {
            for texel in 0..texels_of(mip) {
                let fine = texel << mip..(texel + 1) << mip;
                let sum: f32 = fine.clone().map(|i| f32::from(opacity[i])).sum();
                let mean = sum / fine.len() as f32;
                assert!((f32::from(opacity[MIP_START[mip] + texel]) - mean).abs() <= 0.51);
                let product: f32 =
                    fine.clone().map(|i| f32::from(opacity[i]) * f32::from(reflectance[i])).sum();
                let found = f32::from(reflectance[MIP_START[mip] + texel]);
                assert!((found - product / sum).abs() <= 0.6, "{found} for {}", product / sum);
                let plain = fine.clone().map(|i| f32::from(reflectance[i])).sum::<f32>() / fine.len() as f32;
                differs |= (found - plain).abs() > 1.0;
            }
        }
    }
    assert!(differs, "the control: a plain mean is another one");
}

#[test]
fn an_eye_along_the_strands_sees_the_mean_of_all_views() {
    // What is stored, without the ratio of optical depths.
    let of = SectorRef { tau_ratio: 1.0, ..database().find(&features(0.5, 0.44)) };
    let (opacity, reflectance) = database().stored_any_view(of, 0.8, 0.2, 1.0);
    let all = (0..ANGLES).map(|k| database().sample(of, azimuth(k), 0.8, 0.2, 1.0));
    let sum = all.fold((0.0, 0.0), |sum, (a, r)| (sum.0 + a, sum.1 + r));
    assert!((opacity - sum.0 / 16.0).abs() < 1e-5 && (reflectance - sum.1 / 16.0).abs() < 1e-5);
}

#[test]
fn look_ups_with_what_is_no_number_are_finite() {
    for odd in [f32::NAN, f32::INFINITY, -1e30] {
        for mirrored in [false, true] {
            let of = SectorRef { index: 3, mirrored, tau_ratio: 1.0 };
            for (alpha, re) in
                [database().sample(of, odd, odd, odd, odd), database().sample_nearest(of, [odd; 2], odd, odd)]
            {
                assert!((0.0..=1.0).contains(&alpha) && (0.0..=1.0).contains(&re), "{odd}");
            }
        }
    }
}
