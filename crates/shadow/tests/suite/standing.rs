//! Lights that stand somewhere, against answers known on paper: every method on the CPU.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::{
    CpuShadow, LightFrame, LightSource, MapKind, ShadowInput, ShadowMethod, ShadowSettings, converged,
    cpu_shadow,
};

use crate::common::{
    EXTINCTION, HEAD, SplitMix64, measures_hair, of_edge as settings, part_of_strands_across, strands,
};
use crate::grooms::Groom;

type Map = Box<dyn CpuShadow + Send + Sync>;

/// A light at `position` around hair at `anchor`.
fn from(position: Vec3, anchor: Vec3) -> LightFrame {
    LightFrame::new(Vec3::new(0.3, -1.0, 0.2)).standing(LightSource { position, radius: 0.005 }, anchor)
}

fn input(strands: &Strands, light: LightFrame, anchor: Vec3) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width: 2e-4,
        extinction_scale: EXTINCTION,
        light,
        anchor,
        maps: 1,
        projected: None,
    }
}

/// Methods with a map. Few rays are too few for means of dense strands: `ray_traced_truth.rs` has tests of its own.
fn methods() -> impl Iterator<Item = ShadowMethod> {
    let has_map = |method: &ShadowMethod| matches!(method.map_kind(), MapKind::Texels | MapKind::Cells);
    ShadowMethod::ALL.iter().copied().filter(has_map)
}

fn built(input: &ShadowInput, settings: &ShadowSettings) -> Map {
    let mut map = cpu_shadow(settings.method);
    map.build(input, settings).expect("it fits");
    map
}

fn at(map: &Map, points: &[Vec3]) -> Vec<f32> {
    let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let mut out = vec![f32::NAN; points.len()];
    map.transmittance_at(&x, &y, &z, &mut out);
    out
}

fn mean(values: impl IntoIterator<Item = f32>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0), |(sum, n), t| (sum + f64::from(t), n + 1));
    sum / f64::from(count.max(1))
}

/// Unit vectors spread evenly.
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let (z, a) = (1.0 - (2 * i + 1) as f32 / count as f32, i as f32 * 2.399_963);
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * a.cos(), r * a.sin(), z)
    })
}

/// Short strands that face the middle, spread evenly over the sphere of radius `radius` around it.
fn shell(middle: Vec3, radius: f32, count: usize, length: f32) -> Strands {
    let mut random = SplitMix64::new(5);
    let of = |way: Vec3| {
        let along = way.cross(random.signed_vec3()).normalize_or(way.any_orthonormal_vector());
        vec![middle + radius * way - 0.5 * length * along, middle + radius * way + 0.5 * length * along]
    };
    strands(&directions(count).map(of).collect::<Vec<_>>())
}

#[test]
fn a_shell_around_a_point_light_lets_the_same_light_through_everywhere() {
    const RADIUS: f32 = 0.2;
    const LENGTH: f32 = 0.01;
    const COUNT: usize = 60_000;
    let hair = shell(HEAD, RADIUS, COUNT, LENGTH);
    let light = from(HEAD, HEAD);
    // The optical depth on paper: that of all strands over the area of the sphere.
    let depth = f64::from(2.0 * 2e-4 * LENGTH) * COUNT as f64 / (4.0 * std::f64::consts::PI * 0.04);
    assert!((0.4..0.6).contains(&depth), "{depth}");
    let ways: Vec<_> = directions(6000).collect();
    let [inside, outside] = [0.15, 0.26].map(|r| ways.iter().map(|way| HEAD + r * *way).collect::<Vec<_>>());
    // The corners of the cube around the light are where a wrong weight would show.
    let slant = |way: &Vec3| {
        let along = [light.x, light.y, light.z].map(|axis| axis.dot(*way).abs());
        along[0].max(along[1]).max(along[2])
    };
    for method in methods().filter(|method| measures_hair(*method)) {
        let dense = ShadowInput { extinction_scale: 2.0, ..input(&hair, light, HEAD) };
        let edge = if method.map_kind() == MapKind::Cells { 32 } else { 64 };
        let depth = depth * part_of_strands_across(method);
        let map = built(&dense, &settings(method, edge));
        assert!(at(&map, &inside).iter().all(|t| *t > 0.999), "{method}: before the shell");
        let found = at(&map, &outside);
        for (low, high) in [(0.0, 0.65), (0.65, 0.8), (0.8, 0.95), (0.95, 1.0)] {
            let these = ways.iter().zip(&found).filter(|(way, _)| (low..=high).contains(&slant(way)));
            let logarithm = mean(these.map(|(_, t)| -t.max(1e-3).ln()));
            // Fragments are scattered over texels: their number varies, and filters average light, not depth.
            let error = logarithm / depth - 1.0;
            assert!(error.abs() < 0.06, "{method}, {low} to {high}: {logarithm} for {depth}");
        }
        // Control: hair twice as far away covers a quarter of the directions.
        let far = shell(HEAD, 2.0 * RADIUS, COUNT, LENGTH);
        let map = built(&ShadowInput { strands: &far, ..dense }, &settings(method, edge));
        let outside: Vec<_> = ways.iter().map(|way| HEAD + 0.5 * *way).collect();
        let quarter = mean(at(&map, &outside).iter().map(|t| -t.max(1e-3).ln())) / depth;
        assert!((quarter - 0.25).abs() < 0.03, "{method}: {quarter}");
    }
}

/// Strands across the vertical, in a flat box around [`HEAD`].
fn mat(half: f32, count: usize) -> Strands {
    let mut random = SplitMix64::new(9);
    let of = |i: usize| {
        let [x, y, z] = [half, 0.01, half].map(|size| size * random.signed());
        let along = if i.is_multiple_of(2) { Vec3::X } else { Vec3::Z };
        (-2..=2).map(|part| HEAD + Vec3::new(x, y, z) + 0.004 * part as f32 * along).collect()
    };
    strands(&(0..count).map(of).collect::<Vec<_>>())
}

#[test]
fn the_optical_depth_of_a_mat_is_the_same_from_any_distance() {
    let hair = mat(0.08, 16_000);
    // Straight below the middle, where rays from all heights pass the mat at right angles.
    let below: Vec<_> =
        directions(400).map(|way| HEAD + Vec3::new(0.01 * way.x, -0.02, 0.01 * way.z)).collect();
    let area = f64::from(0.16_f32).powi(2);
    let depth = f64::from(2.0 * 2e-4 * 0.016_f32) * 16_000.0 / area;
    for method in methods().filter(|method| measures_hair(*method)) {
        let depth = depth * part_of_strands_across(method);
        let of = |light: LightFrame| {
            let input = ShadowInput { extinction_scale: 2.0, ..input(&hair, light, HEAD) };
            mean(at(&built(&input, &settings(method, 64)), &below).iter().map(|t| -t.max(1e-3).ln())) / depth
        };
        let parallel = of(LightFrame::new(Vec3::NEG_Y));
        assert!((parallel - 1.0).abs() < 0.12, "{method}: {parallel} of {depth}");
        for distance in [0.1, 0.3, 1.0, 10.0, 1000.0] {
            let found = of(from(HEAD + distance * Vec3::Y, HEAD));
            assert!((found - parallel).abs() < 0.05, "{method} at {distance} m: {found} for {parallel}");
        }
    }
}

#[test]
fn more_than_a_hundred_head_sizes_away_a_light_is_a_directional_one() {
    let groom = Groom::tuft();
    let way = LightFrame::new(Vec3::new(0.4, -1.0, -0.5));
    let anchor = groom.input().anchor;
    let points: Vec<_> = (0..groom.strands.points()).map(|i| groom.strands.point(i)).collect();
    for method in methods() {
        let of = |light: LightFrame| {
            at(&built(&ShadowInput { light, ..groom.input() }, &settings(method, 128)), &points)
        };
        let directional = of(way);
        let off = |distance: f32| {
            let source = LightSource { position: anchor - distance * way.x, radius: 0.05 };
            let found = of(way.standing(source, anchor));
            mean(found.iter().zip(&directional).map(|(a, b)| (a - b).abs()))
        };
        // At this distance cells are as large as in directional light: only rays differ.
        let (far, near) = (off(31.99), off(0.4));
        // Nodes of compressed curves go or stay by small differences. Measured: 0.011.
        let has_curves = [ShadowMethod::DeepShadowMaps, ShadowMethod::Adaptive].contains(&method);
        assert!(far < if has_curves { 0.02 } else { 0.01 }, "{method}: {far}");
        assert!(near > 2.0 * far, "{method}, control: {near} beside {far}");
    }
}

#[test]
fn methods_come_as_near_to_the_truth_as_in_directional_light() {
    let groom = Groom::tuft();
    let anchor = groom.input().anchor;
    let points: Vec<_> = (0..groom.strands.points()).step_by(97).map(|i| groom.strands.point(i)).collect();
    let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let off = |a: &[f32], b: &[f32]| mean(a.iter().zip(b).map(|(a, b)| (a - b).powi(2))).sqrt();
    let way = Vec3::new(-0.15, 0.3, 0.2);
    for (method, edge) in [(ShadowMethod::VoxelMap, 64), (ShadowMethod::Exact, 256)] {
        let settings = settings(method, edge);
        let found = |light| at(&built(&ShadowInput { light, ..groom.input() }, &settings), &points);
        let truth = |light| {
            let input = ShadowInput { light, ..groom.input() };
            converged(&input, &settings, [&x, &y, &z]).expect("it fits").transmittance
        };
        let (parallel, standing) = (LightFrame::new(-way), from(anchor + way, anchor));
        let of_parallel = off(&found(parallel), &truth(parallel));
        let (true_light, light) = (truth(standing), found(standing));
        let of_standing = off(&light, &true_light);
        assert!(of_standing < 1.3 * of_parallel + 1e-3, "{method}: {of_standing} beside {of_parallel}");
        if method == ShadowMethod::VoxelMap {
            // So few cells differ more from the truth than two lights do.
            continue;
        }
        // Controls: the truth is not that of a light elsewhere, nor that of a directional one.
        for other in [from(anchor - way, anchor), parallel] {
            let other = off(&found(other), &true_light);
            assert!(other > 1.3 * of_standing, "{method}: {other} beside {of_standing}");
        }
    }
}

#[test]
fn a_light_between_strands_and_anywhere_else_gives_finite_light() {
    let groom = Groom::tuft();
    let anchor = groom.input().anchor;
    let within = groom.strands.point(700);
    let places = [
        within,
        within + Vec3::splat(1e-3),
        anchor,
        anchor + Vec3::new(0.0, 1000.0, 0.0),
        Vec3::splat(-577.0),
        Vec3::splat(1e30),
        Vec3::NAN,
    ];
    let mut points: Vec<_> =
        (0..groom.strands.points()).step_by(101).map(|i| groom.strands.point(i)).collect();
    points.extend([within, Vec3::NAN, Vec3::splat(1e9), Vec3::ZERO]);
    let mut torn = groom.strands.clone();
    torn.x[40] = f32::NAN;
    torn.y[90] = f32::INFINITY;
    torn.z[200] = 1e20;
    let nothing = Strands::default();
    for &method in ShadowMethod::ALL {
        for (strands, position) in
            places.iter().map(|place| (&torn, *place)).chain([(&nothing, Vec3::ONE), (&nothing, anchor)])
        {
            for radius in [0.0, f32::NAN] {
                let light = LightFrame::default().standing(LightSource { position, radius }, anchor);
                let input = ShadowInput { strands, light, ..groom.input() };
                let map = built(&input, &settings(method, 64));
                let found = at(&map, &points);
                assert!(found.iter().all(|t| (0.0..=1.0).contains(t)), "{method} at {position}");
                assert!(found[points.len() - 3] == 1.0, "{method} at {position}: NaN is lit");
                for p in [within, anchor] {
                    assert!(map.along_ray(p).marks.iter().all(|mark| mark.optical_depth.is_finite()));
                }
                let lit = map.column_maps().into_iter().flat_map(|columns| columns.transmittance);
                assert!(lit.into_iter().all(|t| (0.0..=1.0).contains(&t)), "{method} at {position}");
                if strands.points() == 0 {
                    assert!(found.iter().all(|t| *t == 1.0), "{method}: without hair everything is lit");
                }
            }
        }
    }
}

#[test]
fn hair_within_the_lamp_casts_no_shadow() {
    let hair = shell(HEAD, 0.03, 20_000, 0.004);
    for method in methods() {
        let behind = |radius: f32| {
            let light = LightFrame::default().standing(LightSource { position: HEAD, radius }, HEAD);
            let map = built(
                &ShadowInput { extinction_scale: 4.0, ..input(&hair, light, HEAD) },
                &settings(method, 64),
            );
            mean(at(&map, &directions(500).map(|way| HEAD + 0.1 * way).collect::<Vec<_>>()))
        };
        assert_eq!(behind(0.05), 1.0, "{method}");
        assert!(behind(0.01) < 0.7, "{method}, control: {}", behind(0.01));
    }
}

#[test]
fn light_does_not_jump_between_the_sides_of_the_cube() {
    let hair = shell(HEAD, 0.2, 60_000, 0.01);
    let light = from(HEAD, HEAD);
    let pairs: Vec<_> = (0..400)
        .map(|i| {
            // Across the edge between two sides, at a place along it.
            let along = -0.98 + 1.96 * i as f32 / 399.0;
            let ways = [1.0 - 1e-4, 1.0 + 1e-4].map(|y| light.x + y * light.y + along * light.z);
            ways.map(|way| HEAD + 0.3 * way.normalize_or_zero())
        })
        .collect();
    for method in methods() {
        let map =
            built(&ShadowInput { extinction_scale: 8.0, ..input(&hair, light, HEAD) }, &settings(method, 64));
        let [a, b] = [0, 1].map(|k| at(&map, &pairs.iter().map(|pair| pair[k]).collect::<Vec<_>>()));
        let jump = mean(a.iter().zip(&b).map(|(a, b)| (a - b).abs()));
        let mean_of = mean(a.iter().copied());
        // The texels of the two sides differ: light scatters from texel to texel, by 0.1 for this shell.
        assert!(jump < 0.12, "{method}: {jump} of {mean_of}");
        let both = (mean_of - mean(b.iter().copied())).abs();
        assert!(both < 0.02, "{method}: {both}");
    }
}

#[test]
fn several_threads_and_one_give_the_same_bits() {
    let groom = Groom::tuft();
    let points: Vec<_> = (0..groom.strands.points()).map(|i| groom.strands.point(i)).collect();
    let light = from(groom.strands.point(300) + Vec3::splat(0.01), groom.input().anchor);
    for method in methods() {
        let of = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| {
                at(&built(&ShadowInput { light, ..groom.input() }, &settings(method, 64)), &points)
            })
        };
        let one = of(1);
        assert!(of(3) == one, "{method}");
    }
}
