//! Compares the exact, the converged and the texel methods with analytic results.

use crate::common::{HEAD, SplitMix64, measures_hair, set_filter, set_resolution, strands, texel_methods};
use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_shadow::methods::exact::ExactMap;
use lovelock_shadow::methods::texels::TexelFrame;
use lovelock_shadow::{
    ClusterSeeds, CpuShadow, LightFrame, ShadowInput, ShadowMethod, ShadowSettings, TexelFilter, converged,
    cpu_shadow,
};

/// Along every axis, and slantwise.
const LIGHTS: [Vec3; 7] =
    [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::new(0.4, -1.0, -0.5)];

fn input(strands: &Strands, direction: Vec3, strand_width: f32) -> ShadowInput<'_> {
    ShadowInput {
        strands,
        strand_width,
        extinction_scale: 0.5,
        light: LightFrame::new(direction),
        anchor: HEAD,
        maps: 1,
        projected: None,
    }
}

/// 64 texels along each edge for every method, and thin lines, which lie in one row of texels.
fn settings(filter: TexelFilter) -> ShadowSettings {
    let mut s = ShadowSettings::default();
    set_resolution(&mut s, 64);
    set_filter(&mut s, filter);
    s.density_clustering.prefiltered = false;
    // Room for steps as they are.
    (s.deep_shadow_maps.tolerance, s.deep_shadow_maps.nodes) = (1e-4, 32);
    s.adaptive.nodes = 32;
    s.fourier.terms = 15;
    s.method = ShadowMethod::Exact;
    s
}

fn built(
    method: ShadowMethod,
    input: &ShadowInput,
    settings: &ShadowSettings,
) -> Box<dyn CpuShadow + Send + Sync> {
    let mut map = cpu_shadow(method);
    map.build(input, settings).expect("fits");
    map
}

/// Points that hold the map's extent in place: 0.2 m along every axis of the light.
fn corners(light: &LightFrame) -> Vec<Vec<Vec3>> {
    [-0.1, 0.1].map(|c| vec![HEAD + light.world_from_light(Vec3::splat(c))]).to_vec()
}

/// Where texels lie for hair within the corners.
fn frame(direction: Vec3) -> TexelFrame {
    let hair = strands(&corners(&LightFrame::new(direction)));
    let mut map = ExactMap::default();
    map.build(&input(&hair, direction, 1e-4), &settings(TexelFilter::Nearest)).expect("fits");
    *map.frame().expect("built")
}

/// Whether a method has no place for every one of eight layers.
fn holds_all_hair_as_one(method: ShadowMethod) -> bool {
    matches!(method, ShadowMethod::DeepOpacityMaps | ShadowMethod::Fourier | ShadowMethod::Moments)
}

/// Depth of a layer: eight of them, well apart.
fn layer(i: i32) -> f32 {
    0.1 + 0.1 * i as f32
}

/// Eight layers of parallel strands across the light, one along the middle of every row of texels; every other layer
/// runs the other way.
fn layers(frame: &TexelFrame) -> Vec<Vec<Vec3>> {
    let mut made = corners(&frame.light);
    for i in 0..8 {
        for row in 20..44 {
            let ends = [20.0, 44.0]
                .map(|column| frame.world_from_texel(Vec3::new(column, row as f32 + 0.5, layer(i))));
            made.push(if i % 2 == 0 { ends.to_vec() } else { vec![ends[1], ends[0]] });
        }
    }
    made
}

/// What positions of some metres in floats lose: 1e-7 m of texels of 3 mm, times an optical depth of 1.
const ROUNDING: f32 = 2e-4;

#[test]
fn layers_of_known_coverage_dim_by_its_power() {
    for direction in LIGHTS {
        let frame = frame(direction);
        let hair = strands(&layers(&frame));
        let width = 0.4 * frame.texel_size;
        let input = input(&hair, direction, width);
        // Coverage by fragments that take α of the light each: T = (1 − α)ⁿ.
        let alpha = 1.0 - (-0.5_f32 * 0.4).exp();
        for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
            let mut settings = settings(filter);
            settings.opacity_maps.slices = 256;
            settings.density_clustering.clusters = 8;
            settings.density_clustering.seeds = ClusterSeeds::Uniform;
            for method in texel_methods().filter(|method| measures_hair(*method)) {
                let map = built(method, &input, &settings);
                for n in 0..=8 {
                    // Three methods do not tell layers apart; all agree behind the last.
                    if holds_all_hair_as_one(method) && (1..8).contains(&n) {
                        continue;
                    }
                    let depth = if n == 8 { 1.5 } else { layer(n) - 0.05 };
                    let p = frame.world_from_texel(Vec3::new(31.3, 32.2, depth));
                    let expected = (1.0 - alpha).powi(n);
                    let t = map.transmittance(p);
                    assert!(
                        (t - expected).abs() < ROUNDING,
                        "{method}, {direction}: behind {n}: {t}, not {expected}"
                    );
                    // Control: one layer more or less is told apart.
                    assert!((t - (1.0 - alpha).powi(n + 1)).abs() > 10.0 * ROUNDING);
                }
            }
        }
    }
}

#[test]
fn converged_ribbons_cover_what_they_cover() {
    for direction in LIGHTS {
        let frame = frame(direction);
        let hair = strands(&layers(&frame));
        for coverage in [1.0, 0.5, 0.3] {
            let input = input(&hair, direction, coverage * frame.texel_size);
            let points = [(0, 0.05), (1, 0.15), (4, 0.45), (8, 1.5)]
                .map(|(n, depth)| (n, frame.world_from_texel(Vec3::new(31.3, 32.5, depth))));
            let axis = |axis: usize| points.map(|(_, p)| p[axis]);
            let found = converged(&input, &settings(TexelFilter::Bilinear), [&axis(0), &axis(1), &axis(2)]);
            let found = found.expect("fits");
            for ((n, _), t) in points.iter().zip(&found.transmittance) {
                // Ribbons lie one behind the other: a part of the light passes between them.
                let expected = 1.0 - coverage * (1.0 - (-0.5 * *n as f32).exp());
                // Where an edge of the ribbon cuts subtexels, these mix shade and light before the exponential: a
                // sixteenth of a texel twice, at most an eighth of what is lost.
                let edge = if coverage == 0.3 { 0.03 } else { 0.0 };
                let bound = ROUNDING + edge;
                assert!(
                    (t - expected).abs() < bound,
                    "{direction}, {coverage}: behind {n}: {t}, not {expected}"
                );
            }
            // Control: strands one texel wide, whatever their width, are another shadow.
            let texels = built(ShadowMethod::Exact, &input, &settings(TexelFilter::Nearest));
            let t = texels.transmittance(points[3].1);
            assert_eq!((t - found.transmittance[3]).abs() > 0.1, coverage < 1.0);
        }
    }
}

/// A box full of short strands across the light, scattered evenly: 0.2 m along it, 0.16 m across.
fn scattered(light: &LightFrame, count: usize) -> Vec<Vec<Vec3>> {
    let mut random = SplitMix64::new(3);
    let mut made = corners(light);
    for i in 0..count {
        let middle = Vec3::new(0.1, 0.08, 0.08) * random.signed_vec3();
        let half = 0.004 * if i % 2 == 0 { Vec3::Y } else { Vec3::Z };
        made.push([middle - half, middle + half].map(|p| HEAD + light.world_from_light(p)).to_vec());
    }
    made
}

/// Points spread evenly over the middle of the box at a depth of `along` from its front.
fn across(light: &LightFrame, along: f32, count: usize) -> [Vec<f32>; 3] {
    let step = 0.12 / count as f32;
    let point = |i: usize| {
        let (j, k) = (i % count, i / count);
        let c = |i: usize| (i as f32 + 0.5) * step - 0.06;
        HEAD + light.world_from_light(Vec3::new(along - 0.1, c(j), c(k)))
    };
    let points: Vec<_> = (0..count * count).map(point).collect();
    [0, 1, 2].map(|axis| points.iter().map(|p| p[axis]).collect())
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}

#[test]
fn scattered_strands_dim_as_chance_has_it() {
    for direction in LIGHTS {
        let light = LightFrame::new(direction);
        let texel = f64::from(frame(direction).texel_size);
        for (count, width, bound) in [(40_000, 2e-4_f32, 0.012), (4000, 2e-3, 0.025)] {
            let hair = strands(&scattered(&light, count));
            let input = input(&hair, direction, width);
            let settings = settings(TexelFilter::Nearest);
            let mut maps: Vec<_> = texel_methods()
                .filter(|method| measures_hair(*method))
                .map(|method| (method, built(method, &input, &settings)))
                .collect();
            for along in [0.05, 0.1, 0.2_f32] {
                // σd = s w ℓ n d, with n strands of length ℓ in a volume.
                let sigma_d =
                    0.5 * f64::from(width) * 0.008 * count as f64 / (0.2 * 0.16 * 0.16) * f64::from(along);
                // Fragments of a texel are scattered: of λ in the mean, each lets 1 − α pass, so that the mean of
                // (1 − α)ⁿ is e^(−λα); with many thin strands that is e^(−σd).
                let beta = 0.5 * f64::from(width) / texel;
                let expected = (-sigma_d / beta * (1.0 - (-beta).exp())).exp();
                let thin = (-sigma_d).exp();
                let [x, y, z] = across(&light, along, 36);
                for (method, map) in &mut maps {
                    // Within even hair four moments leave a wide choice, of which a quarter is used.
                    let one = [ShadowMethod::DeepOpacityMaps, ShadowMethod::Moments].contains(method);
                    if one && along < 0.2 {
                        continue;
                    }
                    let mut out = vec![0.0; x.len()];
                    map.transmittance_at(&x, &y, &z, &mut out);
                    // Some 1300 texels, each of some 40 or 4 fragments, a deviation of 20 or 60 % of e^(−σd); the
                    // methods beside `exact` see the box's borders a little elsewhere.
                    let t = mean(&out);
                    assert!(
                        (t - expected).abs() < bound,
                        "{method}, {direction}: {t} at {along}, not {expected}"
                    );
                }
                if count == 40_000 {
                    assert!((expected - thin).abs() < 0.01, "thin strands: {expected}, {thin}");
                } else if along == 0.2 {
                    assert!((expected - thin).abs() > 2.0 * bound, "control: wide ones do not");
                }
            }
        }
    }
}

#[test]
fn converged_scattered_ribbons_dim_as_chance_has_it() {
    for direction in [Vec3::NEG_Y, Vec3::new(0.4, -1.0, -0.5)] {
        let light = LightFrame::new(direction);
        let hair = strands(&scattered(&light, 4000));
        let input = input(&hair, direction, 2e-3);
        let [x, y, z] = across(&light, 0.2, 20);
        let found = converged(&input, &settings(TexelFilter::Bilinear), [&x, &y, &z]).expect("fits");
        // Ribbons over a point are scattered, each lets e^−s pass.
        let ribbons = 2e-3 * 0.008 * 4000.0 / (0.16 * 0.16);
        let expected = (-ribbons * (1.0 - (-0.5_f64).exp())).exp();
        let t = mean(&found.transmittance);
        // 400 boxes of 3 mm, of which neighbours share strands.
        assert!((t - expected).abs() < 0.03, "{direction}: {t}, not {expected}");
        assert!(
            (expected - (-0.5 * ribbons).exp()).abs() > 0.06,
            "control: without chance it would be darker"
        );
        // Edges along the texels cut a row of subtexels alike from end to end, and converge no faster than these shrink.
        assert!(
            found.change <= 2.0 * lovelock_shadow::CONVERGED_CHANGE && found.samples >= 4,
            "{}",
            found.change
        );
    }
}

#[test]
fn a_prefiltered_strand_is_shared_by_two_rows() {
    for direction in LIGHTS {
        let frame = frame(direction);
        let at = |column: f32, row: f32, depth: f32| frame.world_from_texel(Vec3::new(column, row, depth));
        for (place, shares) in [(32.5, [0.0, 1.0, 0.0]), (32.75, [0.0, 0.75, 0.25]), (32.1, [0.4, 0.6, 0.0])]
        {
            let mut of = corners(&frame.light);
            of.push(vec![at(20.0, place, 0.5), at(44.0, place, 0.5)]);
            let hair = strands(&of);
            let mut settings = settings(TexelFilter::Nearest);
            settings.density_clustering.prefiltered = true;
            let input = input(&hair, direction, 0.5 * frame.texel_size);
            let map = built(ShadowMethod::DensityClustering, &input, &settings);
            for (row, share) in [31.5, 32.5, 33.5].into_iter().zip(shares) {
                let (before, behind) =
                    (map.transmittance(at(31.5, row, 0.49)), map.transmittance(at(31.5, row, 0.9)));
                assert!(
                    before == 1.0 && (behind - (-0.25 * share as f32).exp()).abs() < ROUNDING,
                    "{place}: {row}: {behind}"
                );
            }
        }
    }
}

#[test]
fn one_strand_shadows_what_lies_behind_it_and_nothing_else() {
    for direction in LIGHTS {
        let frame = frame(direction);
        let at = |column: f32, row: f32, depth: f32| frame.world_from_texel(Vec3::new(column, row, depth));
        let mut of = corners(&frame.light);
        of.push(vec![at(20.0, 32.5, 0.5), at(44.0, 32.5, 0.5)]);
        let hair = strands(&of);
        let input = input(&hair, direction, 0.5 * frame.texel_size);
        let expected = (-0.25_f32).exp();
        for method in texel_methods().filter(|method| measures_hair(*method)) {
            let map = built(method, &input, &settings(TexelFilter::Nearest));
            for (depth, t) in
                [(-3.0, 1.0), (0.1, 1.0), (0.49, 1.0), (0.9, expected), (1.0, expected), (50.0, expected)]
            {
                // Layers of deep opacity maps reach half of the range.
                let depth =
                    if method == ShadowMethod::DeepOpacityMaps && depth > 0.5 { depth + 0.2 } else { depth };
                let found = map.transmittance(at(31.5, 32.5, depth));
                assert!((found - t).abs() < ROUNDING, "{method}, {direction}: {found} at {depth}, not {t}");
                for (column, row) in [(31.5, 33.6), (31.5, 31.4), (19.4, 32.5), (44.6, 32.5), (-9.0, 32.5)] {
                    assert_eq!(map.transmittance(at(column, row, depth)), 1.0, "beside it");
                }
            }
            // Bilinear: half of its shadow half a texel off.
            let map = built(method, &input, &settings(TexelFilter::Bilinear));
            for (off, part) in [(0.0, 1.0), (0.25, 0.75), (-0.5, 0.5), (0.75, 0.25), (1.1, 0.0), (-1.1, 0.0)]
            {
                let t = map.transmittance(at(31.5, 32.5 + off, 1.2));
                assert!((t - (1.0 - part * (1.0 - expected))).abs() < ROUNDING, "{method}: {t}, {off} off");
            }
        }
        // The ribbon covers half of the box around a point on it, all of it or none of it.
        for (off, part) in [(0.0, 0.5), (0.5, 0.25), (0.8, 0.0)] {
            let p = at(31.5, 32.5 + off, 1.2);
            let found =
                converged(&input, &settings(TexelFilter::Nearest), [&[p.x], &[p.y], &[p.z]]).expect("fits");
            let t = found.transmittance[0];
            assert!(
                (t - (1.0 - part * (1.0 - (-0.5_f32).exp()))).abs() < ROUNDING,
                "{direction}: {t}, {off} off"
            );
        }
    }
}

#[test]
fn hair_behind_an_opaque_card_is_dark_and_hair_before_it_is_lit() {
    let direction = LIGHTS[6];
    let frame = frame(direction);
    // A card of 16 strands in one place in every row, with an optical depth of 8 in all, and four layers behind it.
    let mut made = corners(&frame.light);
    let depths = [0.3; 16].into_iter().chain([0.6, 0.7, 0.8, 0.9]);
    for (depth, row) in depths.flat_map(|depth| (20..44).map(move |row| (depth, row))) {
        let ends =
            [20.0, 44.0].map(|column| frame.world_from_texel(Vec3::new(column, row as f32 + 0.5, depth)));
        made.push(ends.to_vec());
    }
    let hair = strands(&made);
    let input = input(&hair, direction, frame.texel_size);
    for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
        for method in texel_methods().filter(|method| measures_hair(*method)) {
            let map = built(method, &input, &settings(filter));
            let light = |depth: f32| map.transmittance(frame.world_from_texel(Vec3::new(31.3, 32.2, depth)));
            assert_eq!(light(0.29), 1.0, "{method}: before the card");
            for depth in [0.45, 0.65, 0.75, 1.5] {
                assert!(light(depth) < 0.02, "{method}: {} at {depth}", light(depth));
            }
        }
    }
}

#[test]
fn approximate_deep_shadow_maps_take_density_for_known() {
    let direction = LIGHTS[6];
    let frame = frame(direction);
    let hair = strands(&layers(&frame));
    let mut settings = settings(TexelFilter::Nearest);
    (settings.approximate_deep.spacing, settings.approximate_deep.hairs) = (0.005, 20);
    let input = input(&hair, direction, frame.texel_size);
    let map = built(ShadowMethod::ApproximateDeep, &input, &settings);
    let at = |depth: f32| map.transmittance(frame.world_from_texel(Vec3::new(31.3, 32.2, depth)));
    // The first layer lies at a depth of 0.1. A hair every 5 mm lets e^(−0.5) pass, up to 20 hairs; how many layers there are
    // does not matter.
    let hairs = |depth: f32| ((depth - layer(0)) * frame.depth_range / 0.005).clamp(0.0, 20.0);
    for depth in [0.0, 0.09, 0.15, 0.25, 0.45, 0.95] {
        let expected = (-0.5 * hairs(depth)).exp();
        assert!((at(depth) - expected).abs() < 1e-3, "{} at {depth}, not {expected}", at(depth));
    }
    assert!((at(5.0) - (-10.0_f32).exp()).abs() < 1e-4, "as much as there can be behind all hair");
}

#[test]
fn a_strand_on_the_border_of_the_map_counts() {
    for direction in LIGHTS {
        let light = LightFrame::new(direction);
        let at = |p: Vec3| HEAD + light.world_from_light(p);
        // The edges of a square are the hair's extent, on all four sides.
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let hair = strands(&[square.map(|(y, z)| at(0.1 * Vec3::new(0.0, y, z))).to_vec()]);
        let input = input(&hair, direction, 1e-3);
        for method in texel_methods() {
            for filter in [TexelFilter::Nearest, TexelFilter::Bilinear] {
                let map = built(method, &input, &settings(filter));
                for (y, z) in [(-0.1, 0.03), (0.1, -0.02), (0.05, 0.1), (0.0, -0.1)] {
                    let t = map.transmittance(at(Vec3::new(0.5, y, z)));
                    assert!(t < 0.97, "{method}, {direction}: {t} behind ({y}, {z})");
                    assert_eq!(map.transmittance(at(Vec3::new(0.5, 1.08 * y, 1.08 * z))), 1.0, "beside it");
                    assert_eq!(map.transmittance(at(Vec3::new(-0.5, y, z))), 1.0, "before it");
                }
                let columns = map.column_map().expect("built");
                let n = columns.size as usize;
                for i in 0..n {
                    for border in [i, (n - 1) * n + i, i * n, i * n + n - 1] {
                        assert_eq!(columns.transmittance[border], 1.0);
                    }
                }
                assert!(columns.transmittance.iter().any(|t| *t < 0.9));
            }
        }
    }
}

#[test]
fn the_column_map_is_what_lies_behind_all_hair() {
    let direction = LIGHTS[6];
    let light = LightFrame::new(direction);
    let hair = strands(&scattered(&light, 4000));
    let input = input(&hair, direction, 1e-3);
    for method in texel_methods() {
        let map = built(method, &input, &settings(TexelFilter::Bilinear));
        let columns = map.column_map().expect("built");
        let n = columns.size as usize;
        let world_from_uv = columns.uv_from_world.inverse();
        for at in (0..n * n).step_by(37) {
            let uv = Vec3::new((at % n) as f32 + 0.5, (at / n) as f32 + 0.5, 0.0) / n as f32;
            let p = world_from_uv.transform_point3(uv) + 3.0 * light.x;
            // Rounding of the matrices: some 1e-4 of a texel, times the steepest change between texels.
            assert!((map.transmittance(p) - columns.transmittance[at]).abs() < 2e-3, "{method}, texel {at}");
        }
        assert!(columns.transmittance.iter().any(|t| *t < 0.3));
    }
}
