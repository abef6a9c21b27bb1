//! Traced rays against answers known on paper, against the sorted truth in hard light, and against the converged shadow.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::{
    CpuShadow, LightArea, LightFrame, LightSource, ShadowError, ShadowInput, ShadowMethod, ShadowSettings,
    converged, cpu_shadow,
};

use lovelock_testkit::suite::sample;

use crate::common::{HEAD, SplitMix64, strands};
use crate::grooms::Groom;

fn input(strands: &Strands, light: LightFrame, strand_width: f32) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width,
        extinction_scale: 0.5,
        light,
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// The same light with soft shadows. The number of samples is that of the methods with maps.
fn soft(light: LightFrame) -> LightFrame {
    LightFrame { area: LightArea { angle: 0.0, samples: 2 }, ..light }
}

fn with(rays: u32) -> ShadowSettings {
    let mut settings = ShadowSettings { method: ShadowMethod::RayTraced, ..ShadowSettings::default() };
    settings.ray_traced.rays = rays;
    settings
}

fn built(input: &ShadowInput, settings: &ShadowSettings) -> Box<dyn CpuShadow + Send + Sync> {
    let mut map = cpu_shadow(settings.method);
    map.build(input, settings).expect("it fits");
    map
}

fn at(map: &dyn CpuShadow, points: &[Vec3]) -> Vec<f32> {
    let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let mut out = vec![f32::NAN; points.len()];
    map.transmittance_at(&x, &y, &z, &mut out);
    out
}

fn mean(values: impl IntoIterator<Item = f32>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, n), t| (sum + f64::from(t), n + 1));
    sum / f64::from(count.max(1))
}

fn rmse(a: &[f32], b: &[f32]) -> f64 {
    mean(a.iter().zip(b).map(|(a, b)| (a - b).powi(2))).sqrt()
}

/// A sheet of strands along x at a height, side by side without gaps: each ray crosses one of them.
fn card(height: f32, width: f32) -> Vec<Vec<Vec3>> {
    let strand = |row: i32| {
        let z = (row as f32 + 0.5) * width;
        [-0.05, 0.05].map(|x| HEAD + Vec3::new(x, height, z)).to_vec()
    };
    (-40..40).map(strand).collect()
}

#[test]
fn cards_take_their_share_one_after_another_and_leave_gaps_as_they_are() {
    let width = 1e-3;
    let hair = strands(&[card(0.02, width), card(0.0, width), card(-0.03, width)].concat());
    for rays in [1, 16] {
        let map = built(&input(&hair, LightFrame::default(), width), &with(rays));
        for (height, cards) in [(0.03, 0), (0.01, 1), (-0.005, 2), (-0.029, 2), (-0.031, 3), (-5.0, 3)] {
            for across in [Vec3::ZERO, Vec3::new(0.02, 0.0, -0.03)] {
                // Off the borders between ribbons.
                let p = HEAD + across + Vec3::new(0.0, height, 0.0003);
                let expected = (-0.5 * cards as f32).exp();
                let found = map.transmittance(p);
                assert!((found - expected).abs() < 1e-5, "{rays}, {height}: {found}, not {expected}");
            }
        }
        // Beside the cards, and for what is not finite, all light.
        for lit in [HEAD + Vec3::new(0.07, -0.1, 0.0), Vec3::NAN, Vec3::splat(1e30)] {
            assert_eq!(map.transmittance(lit), 1.0, "{lit}");
        }
        // The ray says the same, from the light on.
        let marks = map.along_ray(HEAD + Vec3::new(0.0, -0.005, 0.0003)).marks;
        let starts: Vec<_> = marks.iter().map(|mark| (mark.start * 1000.0).round()).collect();
        assert_eq!(starts, [-25.0, -5.0, 25.0]);
        assert!((marks[2].transmittance - (-1.5_f32).exp()).abs() < 1e-6);
    }
    // Hair behind an opaque card is dark, and in front of it it is not.
    let opaque = ShadowInput { extinction_scale: 1e6, ..input(&hair, LightFrame::default(), width) };
    let map = built(&opaque, &with(4));
    let p = HEAD + 0.0003 * Vec3::Z;
    assert!(map.transmittance(p + 0.01 * Vec3::Y) < 1e-6 && map.transmittance(p + 0.03 * Vec3::Y) == 1.0);
}

#[test]
fn the_edge_of_a_card_casts_the_penumbra_of_a_disc() {
    // Half of the plane at HEAD is covered, from z = 0 on; the lamp is 0.4 m above it and a point 0.2 m below.
    let width = 2e-4;
    let strand =
        |row: i32| [-0.5, 0.5].map(|x| HEAD + Vec3::new(x, 0.0, (row as f32 + 0.5) * width)).to_vec();
    let hair = strands(&(0..1500).map(strand).collect::<Vec<_>>());
    let radius = 0.04;
    let source = LightSource { position: HEAD + 0.4 * Vec3::Y, radius };
    let light = soft(LightFrame::default().standing(source, HEAD));
    let opaque = ShadowInput { extinction_scale: 1e6, ..input(&hair, light, width) };
    let map = built(&opaque, &with(256));
    // Rays that end at height h of the disc cross the plane at z (0.4 + 0.2)⁻¹ of the way: z_plane = z 2/3 + h/3 < 0 is lit.
    for share in [-1.5_f32, -0.75, -0.5, 0.0, 0.25, 0.5, 0.9, 1.5] {
        let z = 0.5 * radius * share;
        let found = map.transmittance(HEAD + Vec3::new(0.003, -0.2, z));
        // The part of a disc beyond a chord at h = −share, of its radius: lit where h < −share.
        let x = (-share).clamp(-1.0, 1.0);
        let lit = 1.0 - (x.acos() - x * (1.0 - x * x).sqrt()) / std::f32::consts::PI;
        assert!((found - lit).abs() < 0.03, "{share}: {found}, not {lit}");
    }
    // With hard shadows the same lamp has a hard edge.
    let hard = LightFrame::default().standing(source, HEAD);
    let map = built(&ShadowInput { light: hard, ..opaque }, &with(64));
    for (z, lit) in [(-0.002, 1.0), (0.002, 0.0)] {
        assert_eq!(map.transmittance(HEAD + Vec3::new(0.003, -0.2, z)).round(), lit, "{z}");
    }
}

#[test]
fn in_hard_light_it_is_the_exact_shadow_within_what_texels_lose() {
    let grooms: [fn() -> Groom; 2] = [Groom::tuft, || Groom::preset(lovelock_groom::Preset::Smooth)];
    for groom in sample(grooms, 2) {
        let groom = groom();
        let every = 1 + groom.strands.points() / 1500;
        let points: Vec<_> =
            (0..groom.strands.points()).step_by(every).map(|i| groom.strands.point(i)).collect();
        let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
        let exact =
            at(&*built(&groom.input(), &ShadowSettings { method: ShadowMethod::Exact, ..with(1) }), &points);
        let truth = converged(&groom.input(), &with(1), [&x, &y, &z]).expect("it fits").transmittance;
        let of = |rays: u32| at(&*built(&groom.input(), &with(rays)), &points);
        let [one, four, sixteen, many] = [1, 4, 16, 64].map(of);
        let bias = mean(many.iter().copied()) - mean(exact.iter().copied());
        let against = |light: &[f32]| [rmse(light, &exact), rmse(light, &truth)];
        println!(
            "{}: bias {bias:.4}; RMSE against exact and converged of 1, 4, 16, 64 rays {:.4?}",
            groom.name,
            [&one, &four, &sixteen, &many].map(|light| against(light))
        );
        // Texels hold the mean over a texel and draw strands one texel wide: as far from the converged shadow as `exact` itself.
        let of_exact = rmse(&exact, &truth);
        assert!(bias.abs() < 0.02, "{}: {bias}", groom.name);
        let [from_exact, from_truth] = against(&many);
        assert!(from_exact < 1.3 * of_exact + 0.01, "{}: {from_exact} beside {of_exact}", groom.name);
        // Both are means over a square as wide as a strand, whose size texels round up by at most a twentieth.
        assert!(from_truth < 0.8 * of_exact, "{}: {from_truth} beside {of_exact}", groom.name);
        // Control: the exact shadow of a light that turned by 10 degrees is farther away.
        let turned = LightFrame::new(groom.input().light.x + 0.18 * groom.input().light.y);
        let turned = ShadowInput { light: turned, ..groom.input() };
        let turned =
            at(&*built(&turned, &ShadowSettings { method: ShadowMethod::Exact, ..with(1) }), &points);
        assert!(rmse(&many, &turned) > 1.5 * from_exact, "{}", groom.name);
        // More rays are nearer.
        let errors = [&one, &four, &sixteen, &many].map(|light| rmse(light, &truth));
        assert!(errors.is_sorted_by(|more, less| more > less), "{}: {errors:?}", groom.name);
    }
}

#[test]
fn in_soft_light_more_rays_come_nearer_to_many() {
    let groom = Groom::tuft();
    let anchor = groom.input().anchor;
    let source = LightSource { position: anchor + Vec3::new(-0.1, 0.35, 0.2), radius: 0.06 };
    let light = soft(LightFrame::default().standing(source, anchor));
    let soft = ShadowInput { light, ..groom.input() };
    // Strands have 41 points.
    let points: Vec<_> = (0..groom.strands.points()).step_by(37).map(|i| groom.strands.point(i)).collect();
    let truth = at(&*built(&soft, &with(256)), &points);
    let errors = [1, 4, 16, 64].map(|rays| rmse(&at(&*built(&soft, &with(rays)), &points), &truth));
    println!("1, 4, 16, 64 rays: {errors:.4?}");
    assert!(errors.is_sorted_by(|more, less| more > less) && errors[3] < 0.04, "{errors:?}");
    // Control: a hard light is another one.
    let hard = LightFrame::default().standing(source, anchor);
    let hard = at(&*built(&ShadowInput { light: hard, ..groom.input() }, &with(64)), &points);
    assert!(rmse(&hard, &truth) > 2.0 * errors[3], "{}", rmse(&hard, &truth));
}

#[test]
fn a_shell_around_a_lamp_and_one_within_it() {
    // Short strands that face the middle, spread evenly over a sphere.
    let directions = |count: usize| {
        (0..count).map(move |i| {
            let (z, a) = (1.0 - (2 * i + 1) as f32 / count as f32, i as f32 * 2.399_963);
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * a.cos(), r * a.sin(), z)
        })
    };
    let shell = |radius: f32, count: usize, length: f32| {
        let mut random = SplitMix64::new(5);
        let of = |way: Vec3| {
            let along = way.cross(random.signed_vec3()).normalize_or(way.any_orthonormal_vector());
            let middle = HEAD + radius * way;
            vec![middle - 0.5 * length * along, middle + 0.5 * length * along]
        };
        strands(&directions(count).map(of).collect::<Vec<_>>())
    };
    let outside: Vec<_> = directions(3000).map(|way| HEAD + 0.3 * way).collect();
    let lamp = |radius| LightFrame::default().standing(LightSource { position: HEAD, radius }, HEAD);
    let (count, length, width) = (30_000, 0.01, 4e-4);
    let hair = shell(0.2, count, length);
    let map = built(&input(&hair, lamp(0.005), width), &with(16));
    // A ray crosses λ ribbons in the mean, each of which lets e^−½ through: the mean over all numbers is e^(−λ (1 − e^−½)).
    let crossed = f64::from(width * length) * count as f64 / (4.0 * std::f64::consts::PI * 0.04);
    let expected = (-crossed * (1.0 - (-0.5_f64).exp())).exp();
    let found = mean(at(&*map, &outside));
    assert!((found - expected).abs() < 0.012, "{found}, not {expected}");
    let inside: Vec<_> = outside.iter().map(|p| HEAD + 0.5 * (*p - HEAD)).collect();
    assert!(at(&*map, &inside).iter().all(|t| *t == 1.0), "before the shell");
    // Hair within the lamp casts no shadow.
    let near = shell(0.03, count, 0.004);
    assert_eq!(mean(at(&*built(&input(&near, lamp(0.05), width), &with(4)), &outside)), 1.0);
    assert!(mean(at(&*built(&input(&near, lamp(0.01), width), &with(4)), &outside)) < 0.8, "control");
}

#[test]
fn far_away_a_light_is_a_directional_one_and_threads_do_not_matter() {
    let groom = Groom::tuft();
    let anchor = groom.input().anchor;
    let points: Vec<_> = (0..groom.strands.points()).step_by(31).map(|i| groom.strands.point(i)).collect();
    let way = groom.input().light;
    let directional = at(&*built(&groom.input(), &with(16)), &points);
    let from = |distance: f32| {
        let source = LightSource { position: anchor - distance * way.x, radius: 0.01 };
        let light = way.standing(source, anchor);
        at(&*built(&ShadowInput { light, ..groom.input() }, &with(16)), &points)
    };
    let off = |light: &[f32]| mean(light.iter().zip(&directional).map(|(a, b)| (a - b).abs()));
    let (far, near) = (off(&from(1000.0)), off(&from(0.4)));
    assert!(far < 0.015 && near > 2.0 * far, "{far}, {near}");
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| from(0.3))
    };
    assert!(of(1) == of(3));
}

#[test]
fn hair_that_does_not_fit_is_refused_with_the_number() {
    let groom = Groom::tuft();
    let mut settings = with(4);
    settings.ray_traced.memory_limit_bytes = 0;
    let mut map = built(&groom.input(), &with(4));
    let report = map.report();
    // Two ends and a key with them for each segment, and boxes for leaves of four.
    let segments = 48_000_u64;
    assert_eq!(report.needed_bytes, segments * (24 + 32) + 2 * 65_536 / 4 * 24, "{report:?}");
    assert!(report.memory_bytes <= report.needed_bytes && report.samples == segments, "{report:?}");
    let error = map.build(&groom.input(), &settings).expect_err("a mebibyte is too little");
    let ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps } = error else { panic!("{error}") };
    assert_eq!((method, limit_bytes, maps), (ShadowMethod::RayTraced, 1 << 20, 1));
    assert!(
        needed_bytes == report.needed_bytes && error.to_string().contains("or raise the limit"),
        "{error}"
    );
    assert_eq!(map.transmittance(groom.strands.point(40)), 1.0, "lit until it fits");
}
