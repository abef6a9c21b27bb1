//! Properties of every grown hairstyle.

use glam::{Affine3A, Vec3};
use lovelock_base::settings::Settings;
use lovelock_groom::{
    GroomSettings, GrowError, GuideFrame, Hairstyle, NoObstacle, Obstacle, PlainHead, Preset, Scalp,
    ScalpError, ScalpIndex, Strands, grow, interpolate,
};
use proptest::prelude::*;

fn grown(settings: &GroomSettings, scalp: &Scalp) -> Hairstyle {
    grow(settings, scalp, &PlainHead).expect("it grows")
}

fn at_rest(style: &Hairstyle) -> Strands {
    let mut strands = Strands::default();
    interpolate(style, &GuideFrame::at_rest(&style.guides, Affine3A::IDENTITY, 0.0), &mut strands);
    strands
}

fn roots(style: &Hairstyle) -> Vec<Vec3> {
    let strands = at_rest(style);
    strands.first_point[..strands.count()].iter().map(|&i| strands.point(i as usize)).collect()
}

#[test]
fn presets_have_the_published_counts() {
    let scalp = PlainHead.scalp(40);
    for (preset, wisps, strands, segments) in
        [(Preset::Smooth, 134, 3_350, 100_500), (Preset::Curly, 134, 3_350, 201_000)]
    {
        let style = grown(&GroomSettings::preset(preset), &scalp);
        assert_eq!(style.wisps.len(), wisps);
        assert_eq!(style.guides.count(), 3 * wisps);
        assert!(style.wisps.iter().all(|w| w.strand_count == 25));
        assert_eq!((style.strands.count(), style.strands.segments()), (strands, segments));
        assert_eq!(style.name, preset.label());
    }
    for preset in Preset::ALL {
        let settings = GroomSettings::preset(preset);
        assert_eq!(settings, settings.clamped(), "{} is within its own ranges", preset.id());
        assert_eq!(Preset::from_id(preset.id()), Some(preset));
        let style = grown(&settings, &scalp);
        assert_eq!(style.strands.segments(), settings.segment_count());
        assert_eq!(style.check(), Ok(()));
    }
}

#[test]
fn every_root_lies_on_the_hairy_scalp() {
    let scalp = PlainHead.scalp(40);
    let index = ScalpIndex::new(&scalp);
    for preset in Preset::ALL {
        let settings = GroomSettings::preset(preset);
        for root in roots(&grown(&settings, &scalp)) {
            let on = index.closest(root).expect("a scalp");
            // Rounding of interpolation at this size, and of the closest point.
            assert!(on.position.distance(root) < 2e-6, "{root} is off the scalp");
            assert!(on.mask > settings.hairline - 1e-3, "{root} grows below the hairline");
        }
    }
}

/// Largest distance of a fully hairy vertex from the nearest root.
fn widest_gap(scalp: &Scalp, roots: &[Vec3]) -> f32 {
    let hairy = scalp.positions.iter().zip(&scalp.mask).filter(|(_, m)| **m >= 0.999);
    hairy
        .map(|(v, _)| roots.iter().map(|r| r.distance_squared(*v)).fold(f32::INFINITY, f32::min).sqrt())
        .fold(0.0, f32::max)
}

#[test]
fn no_bald_spots() {
    let scalp = PlainHead.scalp(40);
    for preset in Preset::ALL {
        let mut roots = roots(&grown(&GroomSettings::preset(preset), &scalp));
        // 3,350 roots on 0.065 m² are 4.4 mm apart on average. A triangle of them has its centre within 6.5 mm even
        // where the scatter of blue noise makes the sides half as long again.
        let gap = widest_gap(&scalp, &roots);
        assert!(gap < 0.0065, "{}: {gap} m without a root", preset.id());

        let spot = Vec3::new(0.05, 0.2, -0.02);
        roots.retain(|r| r.distance(spot) > 0.015);
        assert!(widest_gap(&scalp, &roots) > 0.01, "a bald spot of 3 cm must be found");
    }
}

#[test]
fn guides_are_equal_links_outside_the_body() {
    let scalp = PlainHead.scalp(40);
    for preset in Preset::ALL {
        let style = grown(&GroomSettings::preset(preset), &scalp);
        for g in 0..style.guides.count() {
            let points = style.guides.points_per_guide;
            let link = style.guides.point(g, 0).distance(style.guides.point(g, 1));
            for p in 1..points {
                let (a, b) = (style.guides.point(g, p - 1), style.guides.point(g, p));
                // Positions of 0.3 m are rounded to 3e-8 m, and links are a millimetre or longer.
                assert!((a.distance(b) / link - 1.0).abs() < 1e-4, "link {p} of guide {g}");
                let (distance, _) = PlainHead.distance(b);
                assert!(distance > 0.0, "{}: point {p} of guide {g} is {distance} m deep", preset.id());
            }
        }
    }
}

#[test]
fn strands_at_rest_stay_out_of_the_body() {
    let scalp = PlainHead.scalp(64);
    for preset in Preset::ALL {
        let strands = at_rest(&grown(&GroomSettings::preset(preset), &scalp));
        // Roots lie on flat triangles, which cut up to 0.15 mm into the curved head.
        let deepest =
            (0..strands.points()).map(|i| PlainHead.distance(strands.point(i)).0).fold(0.0, f32::min);
        assert!(deepest > -0.0003, "{}: {deepest} m", preset.id());
    }
}

#[test]
fn deterministic_by_seed_and_threads() {
    let scalp = PlainHead.scalp(24);
    let settings = GroomSettings { wisps: 60, strands_per_wisp: 8, ..GroomSettings::default() };
    let grow_with = |threads: usize, settings: &GroomSettings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| grown(settings, &scalp))
    };
    let one = grow_with(1, &settings);
    for threads in [2, 8] {
        let other = grow_with(threads, &settings);
        assert!(one.guides == other.guides && one.strands == other.strands && one.wisps == other.wisps);
    }
    let reseeded = grow_with(1, &GroomSettings { seed: 2, ..settings });
    assert!(one.guides != reseeded.guides, "another seed is another hairstyle");
}

#[test]
fn wisps_keep_to_their_side_of_the_parting() {
    let scalp = PlainHead.scalp(48);
    let settings = GroomSettings { part_position: 0.0, part_strength: 1.0, ..GroomSettings::default() };
    let style = grown(&settings, &scalp);
    let roots = roots(&style);
    let (mut apart, mut crossing) = (0, 0);
    for (strand, &wisp) in style.strands.wisp.iter().enumerate() {
        let (root, middle) =
            (roots[strand], style.guides.point(style.wisps[wisp as usize].guides[0] as usize, 15));
        // The front half of the parting, beyond its deviation of 2 mm.
        if root.z > 0.03 && root.y > 0.17 && root.x.abs() > 0.004 {
            apart += 1;
            crossing += usize::from(root.x * middle.x < 0.0);
        }
    }
    assert!(apart > 100, "{apart} roots beside the parting");
    assert!(crossing * 50 < apart, "{crossing} of {apart} strands cross the parting");
}

#[test]
fn unusable_scalps_are_refused() {
    let good = PlainHead.scalp(12);
    let bare = Scalp { mask: vec![0.0; good.mask.len()], ..good.clone() };
    let torn = Scalp { normals: vec![], ..good.clone() };
    let mut wild = good.clone();
    wild.triangles[4] = [0, 1, 1_000_000];
    let mut missing = good.clone();
    missing.positions[9].y = f32::NAN;
    let settings = GroomSettings::default();
    let error = |scalp: &Scalp| grow(&settings, scalp, &NoObstacle).map(|_| ()).unwrap_err();
    assert_eq!(error(&bare), GrowError::Scalp(ScalpError::Bare));
    assert_eq!(error(&Scalp::default()), GrowError::Scalp(ScalpError::Bare));
    assert!(matches!(error(&torn), GrowError::Scalp(ScalpError::Lengths { .. })));
    assert_eq!(error(&wild), GrowError::Scalp(ScalpError::Index(4)));
    assert_eq!(error(&missing), GrowError::Scalp(ScalpError::NotFinite(9)));
}

/// Any number, including NaN and infinities.
fn anything() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -1.0f32..1.0,
        2 => -1e3f32..1e3,
        1 => Just(f32::NAN),
        1 => Just(f32::INFINITY),
        1 => Just(f32::NEG_INFINITY),
        1 => Just(0.0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn settings_of_any_value_grow_finite_hair(
        values in proptest::collection::vec(anything(), 27),
        counts in proptest::array::uniform4(0u32..40),
    ) {
        let settings = GroomSettings {
            seed: counts[3],
            wisps: counts[0],
            strands_per_wisp: counts[1],
            segments_per_strand: counts[2],
            length: values[0], layering: values[1], length_variation: values[2], face_framing: values[3],
            fringe: values[4], fringe_length: values[5], hairline: values[6], part_position: values[7],
            part_strength: values[8], sweep: values[9], volume: values[10], crown_volume: values[11],
            root_lift: values[12], hold: values[13], ends: values[14], clump: values[15], locks: values[16],
            frizz: values[17], frizz_scale: values[18], strays: values[19], stray_reach: values[20],
            curl_radius: values[21], curl_pitch: values[22], curl_onset: values[23], curl_wander: values[24],
            wave: values[25], wave_length: values[26], taper: values[0],
            ..GroomSettings::default()
        };
        let scalp = PlainHead.scalp(16);
        let style = grown(&settings, &scalp);
        prop_assert_eq!(style.check(), Ok(()));
        prop_assert_eq!(style.strands.count(), settings.clamped().strand_count());
        let strands = at_rest(&style);
        prop_assert!((0..strands.points()).all(|i| strands.point(i).is_finite()));
        prop_assert!(style.strands.taper.iter().chain(&style.strands.shade).all(|v| (0.0..=1.0).contains(v)));
        for g in 0..style.guides.count() {
            let link = style.guides.point(g, 0).distance(style.guides.point(g, 1));
            prop_assert!(link > 1e-4);
            for p in 1..style.guides.points_per_guide {
                let (a, b) = (style.guides.point(g, p - 1), style.guides.point(g, p));
                prop_assert!((a.distance(b) / link - 1.0).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn settings_survive_a_file_and_old_files_take_defaults() {
    let settings = GroomSettings::preset(Preset::Curly);
    let text = serde_json::to_string(&settings).expect("plain numbers");
    assert_eq!(serde_json::from_str::<GroomSettings>(&text).expect("its own text"), settings);
    let old: GroomSettings = serde_json::from_str(r#"{"length": 0.2}"#).expect("missing fields are defaults");
    assert_eq!(old, GroomSettings { length: 0.2, ..GroomSettings::default() });
}

#[test]
fn the_closest_point_is_the_closest_of_all_triangles() {
    let scalp = PlainHead.scalp(20);
    let index = ScalpIndex::new(&scalp);
    for k in 0..300 {
        let t = k as f32;
        let p = Vec3::new((1.7 * t).sin() * 0.2, 0.1 + (2.3 * t).sin() * 0.2, (3.1 * t).cos() * 0.2);
        let found = index.closest(p).expect("a scalp");
        // Corners and centres of triangles lie on the scalp, so none may be nearer than the result.
        for t in 0..scalp.triangles.len() as u32 {
            for b in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0 / 3.0; 3], [0.5, 0.5, 0.0]] {
                let nearer = scalp.point(t, b).position.distance(p);
                assert!(found.position.distance(p) <= nearer + 1e-6, "{p}");
            }
        }
        assert!(index.closest_within(p, 0.9 * found.position.distance(p)).is_none());
        assert_eq!(index.closest_within(p, 1.1 * found.position.distance(p) + 1e-6), Some(found));
    }
    assert!(ScalpIndex::new(&Scalp::default()).closest(Vec3::ZERO).is_none());
}
