//! The memory that methods compute before a build is an upper bound, and maps share the limit.

use crate::common::{
    EXTINCTION, HEAD, SMOOTH, SplitMix64, Style, grow, set_resolution, strands, texel_methods,
};
use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::{LightFrame, ShadowError, ShadowInput, ShadowMethod, ShadowSettings, cpu_shadow};

const LIGHT: Vec3 = Vec3::new(0.4, -1.0, -0.5);

fn input(strands: &Strands) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: 1e-4,
        extinction_scale: EXTINCTION,
        light: LightFrame::new(LIGHT),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// Every method with as many texels as there can be.
fn finest() -> ShadowSettings {
    let mut settings = ShadowSettings::default();
    set_resolution(&mut settings, 2048);
    settings
}

/// Random walks in a head-sized ball with steps of 5 mm, about 25 texels of the finest map.
fn wandering(count: usize, segments: usize) -> Strands {
    let mut random = SplitMix64::new(5);
    let strand = |_| {
        let mut p = 0.14 * random.signed_vec3();
        let mut step = || {
            p += 0.005 * random.signed_vec3().normalize_or(Vec3::X);
            p = p.clamp_length_max(0.15);
            HEAD + p
        };
        (0..=segments).map(|_| step()).collect::<Vec<_>>()
    };
    strands(&(0..count).map(strand).collect::<Vec<_>>())
}

/// The memory that `exact` computes for `input`, from its error with the least limit.
fn counted_by_exact(input: &ShadowInput) -> u64 {
    let mut settings = finest();
    settings.exact.memory_limit_bytes = 0;
    let error =
        cpu_shadow(ShadowMethod::Exact).build(input, &settings).expect_err("more than the least limit");
    let ShadowError::TooLarge { needed_bytes, limit_bytes, maps, .. } = error else { panic!("{error}") };
    assert_eq!(limit_bytes, (16 << 20) / u64::from(maps), "{error}");
    needed_bytes
}

#[test]
fn two_million_segments_fit_in_eight_gibibytes() {
    // Counted and not built: 40,000 strands of 50 segments.
    let hair = wandering(40_000, 50);
    let needed = counted_by_exact(&input(&hair));
    println!("2 million segments: {:.2} GiB", needed as f64 / f64::from(1 << 30));
    // Also as one of four lights. One fragment per 0.17 mm makes about 30 million of 21 bytes.
    assert!((600 << 20..2 << 30).contains(&needed), "{needed}");
    // The number is linear: a twentieth of the strands needs a twentieth, plus the fixed size of a map.
    let part = counted_by_exact(&input(&wandering(2000, 50)));
    assert!(part < needed / 20 + (64 << 20), "{part} of {needed}");
}

#[test]
fn what_is_held_is_no_more_than_was_counted() {
    let hair = strands(&grow(Style { wisps: 60, ..SMOOTH }, 2));
    let little = strands(&grow(Style { wisps: 1, ..SMOOTH }, 2));
    for (what, hair) in [("hair", &hair), ("wandering", &wandering(500, 50)), ("little", &little)] {
        for (which, settings) in [("usual", ShadowSettings::default()), ("finest", finest())] {
            for method in texel_methods() {
                let mut map = cpu_shadow(method);
                map.build(&input(hair), &settings).expect("fits");
                let report = map.report();
                let held = report.memory_bytes + report.scratch_bytes;
                println!("{what}, {which}: {method} holds {held} of {}", report.needed_bytes);
                assert!(held <= report.needed_bytes, "{what}, {which}: {method}: {report:?}");
                // The rest is partly filled blocks of fragments, which dominate for little hair: at most 2 pieces per thread, 16 in
                // all, with 128 bands of 3 KiB.
                assert!(
                    report.needed_bytes <= held + held / 5 + (8 << 20),
                    "{what}, {which}: {method}: {report:?}"
                );
            }
        }
    }
}

#[test]
fn what_is_kept_from_build_to_build_stays_within_the_limit() {
    let (much, little) = (wandering(4000, 50), wandering(100, 50));
    let mut settings = finest();
    let mut map = cpu_shadow(ShadowMethod::Exact);
    settings.exact.memory_limit_bytes = counted_by_exact(&input(&much)) + 1;
    for (hair, turn) in [(&much, 0.0), (&little, 0.3), (&much, 0.0), (&much, 0.0)] {
        let light = LightFrame::new(LIGHT + turn * Vec3::X);
        map.build(&ShadowInput { light, ..input(hair) }, &settings).expect("fits");
        let report = map.report();
        assert!(
            report.memory_bytes + report.scratch_bytes <= settings.exact.memory_limit_bytes,
            "{report:?}"
        );
    }
    // With a lower limit, memory of the last build is freed before the next one allocates.
    settings.exact.memory_limit_bytes = 48 << 20;
    map.build(&input(&little), &settings).expect("fits");
    let report = map.report();
    assert!(report.memory_bytes + report.scratch_bytes <= 48 << 20, "{report:?}");
}

#[test]
fn maps_share_the_limit() {
    let hair = wandering(300, 50);
    let mut settings = finest();
    settings.opacity_maps.resolution = 512;
    settings.opacity_maps.slices = 256;
    // Alone each fits, with the limit that is a setting and with the fixed one.
    settings.exact.memory_limit_bytes = 2 * counted_by_exact(&input(&hair)) + 1;
    let mut exact = cpu_shadow(ShadowMethod::Exact);
    for maps in [0, 1, 2] {
        exact.build(&ShadowInput { maps, ..input(&hair) }, &settings).expect("fits");
        assert!(exact.report().samples > 0);
    }
    let error = exact.build(&ShadowInput { maps: 3, ..input(&hair) }, &settings).expect_err("three do not");
    let ShadowError::TooLarge { needed_bytes, limit_bytes, maps, .. } = error else { panic!("{error}") };
    assert_eq!((limit_bytes, maps), (settings.exact.memory_limit_bytes / 3, 3));
    assert!(needed_bytes > limit_bytes && error.to_string().contains("as one of 3 lights"), "{error}");

    let hair = wandering(4000, 50);
    let mut opacity = cpu_shadow(ShadowMethod::OpacityMaps);
    opacity.build(&ShadowInput { maps: 4, ..input(&hair) }, &settings).expect("four of half a gibibyte fit");
    let error = opacity.build(&ShadowInput { maps: 32, ..input(&hair) }, &settings).expect_err("32 do not");
    assert!(error.to_string().contains("limit of 64.0 MiB as one of 32 lights"), "{error}");
}
