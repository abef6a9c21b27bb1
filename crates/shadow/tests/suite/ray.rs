//! What methods hold along a ray agrees with their transmittance there.

use crate::common;

use common::{CURLY, EXTINCTION, SplitMix64, Style, grow, strands};
use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::voxel_map::VoxelMap;
use lovelock_shadow::{
    CpuShadow, ExactMap, LightFrame, RayMark, RayMarkKind, ShadowInput, ShadowMethod, ShadowSettings,
    TexelFilter, converged, cpu_shadow,
};

fn hair() -> Strands {
    strands(&grow(Style { wisps: 60, strands_per_wisp: 12, segments: 20, ..CURLY }, 5))
}

fn input(hair: &Strands) -> ShadowInput<'_> {
    let light = LightFrame::new(Vec3::new(0.3, -1.0, 0.2));
    ShadowInput {
        strands: hair,
        strand_width: 2e-3,
        extinction_scale: EXTINCTION,
        light,
        anchor: common::HEAD,
        maps: 1,
        projected: None,
    }
}

/// Settings with which a point reads a single texel.
fn nearest() -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    common::set_filter(&mut settings, TexelFilter::Nearest);
    settings.ray_traced.rays = 1;
    settings
}

/// Points of the hair, far apart in the list of them.
fn some_points(hair: &Strands) -> Vec<Vec3> {
    let mut random = SplitMix64::new(3);
    (0..60).map(|_| hair.point((random.unit() * (hair.points() - 1) as f32) as usize)).collect()
}

#[test]
fn marks_say_what_the_map_answers_behind_them() {
    let hair = hair();
    let input = input(&hair);
    for &method in ShadowMethod::ALL {
        let mut map = cpu_shadow(method);
        map.build(&input, &nearest()).expect("fits");
        let mut voxels = VoxelMap::default();
        voxels.build(&input, &nearest()).expect("fits");
        let lattice = voxels.lattice().expect("built");
        let (mut worst, mut moved, mut seen) = (0.0_f32, 0.0_f32, 0);
        let mut off = Vec::new();
        for mut p in some_points(&hair) {
            if method == ShadowMethod::VoxelMap {
                // To the middle of the column, where its neighbours have no weight.
                let at = lattice.window_from_world(p);
                let to_middle = |c: f32| (0.5 - c.fract()) * lattice.cell_size;
                p += input.light.y * to_middle(at.y) + input.light.z * to_middle(at.z);
            }
            if method == ShadowMethod::RayTraced {
                // Off the joint of two segments, where rounding decides which of their ribbons a ray crosses.
                p += Vec3::new(2e-4, 1e-4, -3e-4);
            }
            let ray = map.along_ray(p);
            for mark in &ray.marks {
                assert!(method.marks().contains(&mark.kind), "{method}: {mark:?}");
                assert!(mark.start <= mark.end && mark.optical_depth >= 0.0, "{method}: {mark:?}");
                // A little behind it: what lies at a depth does not count before it. Rounding of a place in the world is
                // some 1e-7 m; another fragment may lie as near as that.
                let step = mark.kind == RayMarkKind::FRAGMENT;
                let is_near = |gap: f32| (0.0..4e-6).contains(&gap);
                let hides = |other: &RayMark| {
                    // Light falls as steeply along a line between two fragments that are as near.
                    (step && is_near(other.start - mark.end))
                        || (other.end > mark.end && is_near(other.end - mark.end))
                };
                if ray.marks.iter().any(|other| other != mark && hides(other)) {
                    continue;
                }
                let behind = map.transmittance(p + input.light.x * (mark.end + 2e-6));
                off.push((behind - mark.transmittance).abs());
                let before = map.transmittance(p + input.light.x * (mark.start - 2e-3));
                moved = moved.max((before - mark.transmittance).abs());
                seen += 1;
            }
        }
        off.sort_by(f32::total_cmp);
        // A moved ray may pass the edge of a ribbon on the other side.
        let few = if method == ShadowMethod::RayTraced { off.len() / 20 } else { 0 };
        worst = worst.max(off.iter().rev().nth(few).copied().unwrap_or(0.0));
        println!("{method}: {seen} marks, differing by {worst} behind them and {moved} before");
        if method == ShadowMethod::None {
            assert_eq!(seen, 0);
            continue;
        }
        // Measured: up to 8e-4, where transmittance falls within 2e-6 m of an occupied slice; the control, 2 mm before each
        // mark, 0.3 and more. Up to 4e-3 along the steepest lines of curves.
        let has_curves = [ShadowMethod::DeepShadowMaps, ShadowMethod::Adaptive].contains(&method);
        let bound = if has_curves { 1e-2 } else { 2e-3 };
        assert!(seen >= 55 && worst < bound && moved > 0.1, "{method}: {seen} {worst} {moved}");
    }
}

#[test]
fn pieces_of_one_kind_add_up_to_all_hair() {
    let hair = hair();
    let input = input(&hair);
    for &method in ShadowMethod::ALL {
        let mut map = cpu_shadow(method);
        map.build(&input, &nearest()).expect("fits");
        let mut seen = 0;
        for p in some_points(&hair) {
            let ray = map.along_ray(p);
            for &kind in method.marks() {
                let of: Vec<_> = ray.marks.iter().filter(|mark| mark.kind == kind).collect();
                if of.is_empty() {
                    continue;
                }
                seen += 1;
                // Neighbouring bins share a border but for its rounding.
                assert!(of.windows(2).all(|w| w[0].end <= w[1].start + 1e-6), "{method}");
                assert!(of.windows(2).all(|w| w[0].transmittance >= w[1].transmittance - 1e-6), "{method}");
                let sum: f32 = of.iter().map(|mark| mark.optical_depth).sum();
                let all = of[of.len() - 1].transmittance;
                assert!(((-sum).exp() - all).abs() < 1e-4, "{method} {kind}: {sum} and {all}");
            }
        }
        // A strand's end may lie in a texel over whose middle no strand goes.
        assert!(seen >= 55 * method.marks().len(), "{method}: {seen}");
    }
}

#[test]
fn rays_beside_the_hair_are_empty() {
    let hair = hair();
    for &method in ShadowMethod::ALL {
        let mut map = cpu_shadow(method);
        assert!(map.along_ray(common::HEAD).marks.is_empty(), "{method} before it is built");
        map.build(&input(&hair), &ShadowSettings::default()).expect("fits");
        for p in
            [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1e30), Vec3::splat(90.0), common::HEAD + 2.0 * Vec3::X]
        {
            assert!(map.along_ray(p).marks.is_empty(), "{method} at {p}");
        }
        assert_eq!(map.along_ray(hair.point(40)).marks.is_empty(), method == ShadowMethod::None);
        // No hair at all, and one strand along the light: all of it in one texel, or in none.
        for lines in [vec![], vec![vec![common::HEAD, common::HEAD + 0.1 * Vec3::NEG_Y]]] {
            let few = strands(&lines);
            let input = ShadowInput { light: LightFrame::default(), ..input(&few) };
            map.build(&input, &ShadowSettings::default()).expect("fits");
            let marks = map.along_ray(common::HEAD).marks;
            assert!(marks.iter().all(|mark| mark.start.is_finite() && mark.end.is_finite()), "{method}");
        }
    }
}

#[test]
fn fragments_before_points_are_the_steps_before_them() {
    let hair = hair();
    let mut map = ExactMap::default();
    map.build(&input(&hair), &ShadowSettings::default()).expect("fits");
    let points = some_points(&hair);
    let counts = map.fragments_before(&points).expect("it holds them");
    for (p, &count) in points.iter().zip(&counts) {
        let marks = map.along_ray(*p).marks;
        assert_eq!(marks.iter().filter(|mark| mark.start < 0.0).count(), count as usize);
        let moved = map.fragments_before(&[*p + input(&hair).light.x * 10.0]).expect("it holds them");
        assert_eq!(moved, [marks.len() as u32], "behind all of it");
    }
    assert!(counts.iter().any(|&count| count > 10) && counts.iter().any(|&count| count < 10), "{counts:?}");
    assert_eq!(map.fragments_before(&[Vec3::NAN, Vec3::splat(50.0)]), Some(vec![0, 0]));
    assert_eq!(map.fragments_before(&[]), Some(Vec::new()));
}

#[test]
fn every_round_of_the_converged_truth_is_told() {
    let hair = hair();
    let axis = |of: &[f32]| of.iter().copied().step_by(97).collect::<Vec<_>>();
    let (x, y, z) = (axis(&hair.x), axis(&hair.y), axis(&hair.z));
    let settings = ShadowSettings { method: ShadowMethod::Exact, ..ShadowSettings::default() };
    let found = converged(&input(&hair), &settings, [&x, &y, &z]).expect("fits");
    assert_eq!(found.changes.last(), Some(&(found.samples, found.change)));
    let samples: Vec<u32> = found.changes.iter().map(|(samples, _)| *samples).collect();
    assert!(samples.windows(2).all(|w| w[1] == 2 * w[0]) && samples[0] == 2, "{samples:?}");
    // Doubling brings less and less, by some half each time.
    assert!(
        found.changes.len() > 1 && found.changes.windows(2).all(|w| w[1].1 < w[0].1),
        "{:?}",
        found.changes
    );
}
