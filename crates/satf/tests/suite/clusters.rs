//! Clusters of hairstyles.

use std::f32::consts::TAU;

use glam::{Affine3A, Vec2};
use lovelock_groom::{GroomSettings, Hairstyle, NoObstacle, PlainHead, Preset, grow};
use lovelock_satf::cluster::{ClusterSettings, Clusters};
use lovelock_satf::{Curl, DiskFrames};

use crate::hair::{LINKS, Made, at_rest, corners, guides, lively, random_weights, style};

fn wisp_of(seed: u64, count: usize) -> ([Vec<glam::Vec3>; 3], Vec<Made>) {
    (guides(|_| corners(0.01)), random_weights(seed, count).into_iter().map(Made::plain).collect())
}

fn placed(style: &Hairstyle, clusters: &Clusters) -> DiskFrames {
    let mut frames = DiskFrames::default();
    frames.place(style, &at_rest(style), &clusters.plan);
    frames
}

/// All hair of a cross-section, in strands.
fn strands_in(clusters: &Clusters, cluster: usize, sample: usize) -> f32 {
    let grid = clusters.grid;
    let sectors = |layer| (0..grid.sectors).map(move |sector| (layer, sector));
    (0..grid.layers)
        .flat_map(sectors)
        .map(|(layer, sector)| clusters.amount(cluster, sample, layer, sector))
        .sum()
}

#[test]
fn every_strand_is_in_a_sector_up_to_its_end() {
    let mut strands: Vec<Made> = random_weights(5, 60).into_iter().map(Made::plain).collect();
    for strand in &mut strands[..20] {
        strand.end = 0.5 * LINKS as f32;
    }
    let style = style(&[(lively(), strands)]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    let along = clusters.grid.along;
    for sample in 0..=along {
        let found = strands_in(&clusters, 0, sample);
        let wanted = if 2 * sample < along { 60.0 } else { 40.0 };
        // The cross-section at the shorter strands' end has a part of them.
        let near = (2 * sample).abs_diff(along) <= 2;
        assert!(near || (found - wanted).abs() < 0.01, "{sample}: {found}");
    }
}

#[test]
fn a_cut_wisp_ends_where_its_hair_ends() {
    let mut strands: Vec<Made> = random_weights(5, 30).into_iter().map(Made::plain).collect();
    for strand in &mut strands {
        strand.end = 5.0;
    }
    let style = style(&[(lively(), strands)]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    assert_eq!(clusters.plan.ends, [5.0]);
    assert_eq!(clusters.plan.param(0, clusters.grid.along), 5.0);
    assert!((strands_in(&clusters, 0, clusters.grid.along) - 30.0).abs() < 0.01);
}

#[test]
fn the_optical_depth_of_a_cross_section_is_that_of_its_strands() {
    // A ray along the radius of a round disk meets all strands' widths over the circumference of their layer.
    let style = style(&[wisp_of(2, 400)]);
    let settings = ClusterSettings { layers: 1, core: 0.5, sectors: 8, ..ClusterSettings::default() };
    let clusters = Clusters::of(&style, &settings).unwrap();
    let frames = placed(&style, &clusters);
    let width = 1e-4;
    let sample = 6;
    let depths = (0..8).map(|sector| clusters.features(&frames, 0, sample, 0, sector, width).optical_depth);
    let mean = depths.sum::<f32>() / 8.0;
    let e = frames.ellipse[sample];
    assert!((e.a - e.b).abs() < 0.15 * e.a, "{e:?}");
    let exact = 400.0 * width / (TAU * 0.75 * 0.5 * (e.a + e.b));
    assert!((mean - exact).abs() < 0.02 * exact, "{mean} for {exact}");
    // Twice as wide a disk has half the optical depth.
    let mut wide = frames.clone();
    for axis in wide.x.iter_mut().chain(&mut wide.y) {
        *axis *= 2.0;
    }
    let (near, far) = (
        clusters.features(&frames, 0, sample, 0, 3, width).optical_depth,
        clusters.features(&wide, 0, sample, 0, 3, width).optical_depth,
    );
    assert!((near / far - 2.0).abs() < 1e-3);
}

#[test]
fn disks_hold_their_strands() {
    let style = style(&[wisp_of(7, 300)]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    let frames = placed(&style, &clusters);
    let set = &style.strands;
    let mut outside = 0;
    for weights in &set.weights {
        let point = lovelock_groom::WispCurve::at_rest(&style.guides, &style.wisps[0]).blend(*weights, 6.0);
        let i = 16 * clusters.grid.along / 32;
        let i = if clusters.plan.param(0, i) == 6.0 { i } else { clusters.grid.along / 2 };
        let from = point - frames.centre[i];
        let axes = glam::Mat3::from_cols(frames.x[i], frames.y[i], frames.tangent[i]);
        outside += usize::from((axes.inverse() * from).truncate().length() > 1.001);
    }
    assert!(outside > 0 && outside <= 300 / 20, "a few strays are outside: {outside}");
}

#[test]
fn curled_strands_have_another_class_than_straight_ones() {
    let curled = |offset: fn(f32) -> Vec2| {
        let strands =
            random_weights(4, 50).into_iter().map(|weights| Made { offset, ..Made::plain(weights) });
        // Strands that do not move together, so that the disk does not follow them.
        let mut strands: Vec<Made> = strands.collect();
        for strand in strands.iter_mut().skip(1).step_by(2) {
            strand.offset = |_| Vec2::ZERO;
        }
        let style = style(&[(guides(|_| corners(0.01)), strands)]);
        let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
        let bent =
            clusters.faces.iter().filter(|face| face.part() > 0.0 && face.curl() != Curl::Straight).count();
        bent as f32 / clusters.faces.iter().filter(|face| face.part() > 0.0).count() as f32
    };
    let straight = curled(|_| Vec2::ZERO);
    let tight = curled(|param| 0.004 * Vec2::from_angle(2.5 * param));
    assert!(straight < 0.02 && tight > 0.3, "{straight} {tight}");
}

#[test]
fn equal_wisps_share_their_features_and_unequal_ones_do_not() {
    let style = style(&[wisp_of(1, 50), wisp_of(1, 50), wisp_of(2, 50), wisp_of(1, 50)]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    assert_eq!(clusters.set_of, [0, 0, 1, 0]);
    assert_eq!(clusters.sets(), 2);
    let bytes = clusters.bytes();
    assert_eq!(bytes.unshared, 2 * (bytes.shared - 16));
    for cluster in 0..4 {
        assert!((strands_in(&clusters, cluster, 5) - 50.0).abs() < 0.05);
    }
    let all = ClusterSettings { macro_tolerance: 1.0, ..ClusterSettings::default() };
    assert_eq!(Clusters::of(&style, &all).unwrap().sets(), 1);
}

#[test]
fn a_shared_set_keeps_the_amount_of_each_clusters_hair() {
    let (guides, strands) = wisp_of(1, 50);
    let twice = random_weights(1, 50).into_iter().flat_map(|w| [w, w]).map(Made::plain).collect();
    let style = style(&[(guides.clone(), strands), (guides, twice)]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    assert_eq!(clusters.sets(), 1);
    assert!((strands_in(&clusters, 0, 5) - 50.0).abs() < 0.05);
    assert!((strands_in(&clusters, 1, 5) - 100.0).abs() < 0.1);
}

#[test]
fn many_clusters_stay_within_the_limit_of_volumes() {
    let settings = ClusterSettings::default();
    let volumes = |clusters: usize| {
        let grid = settings.grid(clusters, 30);
        (grid, clusters * grid.layers * grid.sectors * grid.along)
    };
    assert_eq!((volumes(40).0.sectors, volumes(40).0.along), (32, 32));
    assert_eq!(volumes(4096).0.sectors, 8);
    for clusters in [1, 64, 500, 5000] {
        assert!(volumes(clusters).1 <= 2_000_000, "{clusters}");
    }
    // Odd settings are clamped.
    let odd =
        ClusterSettings { layers: 0, core: f32::NAN, sectors: 0, along: 0, most_volumes: 0, ..settings };
    let grid = odd.grid(0, 0);
    assert_eq!((grid.layers, grid.sectors, grid.along, grid.core), (1, 4, 2, 0.35));
}

#[test]
fn odd_hair_makes_clusters_too() {
    let collapsed = [(); 3].map(|()| vec![glam::Vec3::ZERO; LINKS + 1]);
    let no_length = Made { end: 0.0, ..Made::plain([0.3, 0.3, 0.4]) };
    let far = Made { offset: |_| Vec2::new(f32::NAN, 1.0), ..Made::plain([0.3, 0.3, 0.4]) };
    let one = vec![Made::plain([0.3, 0.3, 0.4])];
    let style =
        style(&[(collapsed, one), (lively(), vec![no_length]), (lively(), vec![far]), (lively(), vec![])]);
    let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
    // The wisp without strands is no cluster.
    assert_eq!((clusters.count(), &clusters.plan.wisps[..]), (3, &[0, 1, 2][..]));
    let frames = placed(&style, &clusters);
    for cluster in 0..3 {
        for sample in 0..clusters.grid.samples() {
            for sector in 0..clusters.grid.sectors {
                let features = clusters.features(&frames, cluster, sample, 2, sector, 1e-4);
                assert!(features.optical_depth.is_finite() && features.optical_depth >= 0.0);
            }
        }
    }
    assert_eq!(Clusters::of(&crate::hair::style(&[]), &ClusterSettings::default()).unwrap().count(), 0);
    let mut broken = style.clone();
    broken.strands.taper.pop();
    assert!(Clusters::of(&broken, &ClusterSettings::default()).is_err());
}

#[test]
fn grown_hair_makes_clusters_that_hold_all_of_it() {
    for preset in [Preset::Smooth, Preset::Curly] {
        let mut settings = GroomSettings::preset(preset);
        settings.wisps = 40;
        let style = grow(&settings, &PlainHead.scalp(24), &NoObstacle).unwrap();
        let clusters = Clusters::of(&style, &ClusterSettings::default()).unwrap();
        let mut frames = DiskFrames::default();
        let moved = lovelock_groom::GuideFrame::at_rest(
            &style.guides,
            Affine3A::from_rotation_y(1.0) * Affine3A::from_translation(glam::Vec3::Y),
            0.0,
        );
        frames.place(&style, &moved, &clusters.plan);
        assert!(frames.centre.iter().chain(&frames.x).all(|v| v.is_finite()));
        for (cluster, wisp) in clusters.plan.wisps.iter().enumerate() {
            let strands = style.wisps[*wisp as usize].strand_count as f32;
            let found = strands_in(&clusters, cluster, 1);
            assert!((found - strands).abs() < 0.2 * strands, "{preset:?} {cluster}: {found} of {strands}");
        }
    }
}
