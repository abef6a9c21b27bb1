//! Light that many fibres scatter, against the formulas in double precision and in its limits.

use std::f64::consts::{FRAC_PI_2, PI};

use lovelock_appearance::fibre::{
    CosineStep, Directions, Fibre, FibreTables, PointLight, PointScatter, Quadrature, azimuthal_distribution,
    backscattered, far_field, longitudinal, pigment::absorption_of_melanin, variances,
};

const COLOURS: [(&str, f64, f64); 5] =
    [("white", 0.0, 0.0), ("blonde", 0.3, 0.05), ("brown", 1.3, 0.1), ("red", 0.3, 0.8), ("black", 8.0, 0.0)];

fn light(theta_i: f64, phi: f64, fibres: f64) -> PointLight<1> {
    PointLight {
        sin_theta: [theta_i.sin() as f32],
        cos_theta: [theta_i.cos() as f32],
        phi: [phi as f32],
        fibres: [fibres as f32],
    }
}

fn point(tables: &FibreTables, theta_o: f64, sigma: [f64; 3]) -> PointScatter<1> {
    let [sin, cos] = [[theta_o.sin() as f32], [theta_o.cos() as f32]];
    PointScatter::new(tables, &sin, &cos, &sigma.map(|sigma| [sigma as f32]))
}

/// Radiance toward the eye, as a renderer computes it.
fn radiance(
    tables: &FibreTables,
    scatter: &PointScatter<1>,
    light: &PointLight<1>,
    strength: f32,
) -> [f32; 3] {
    scatter.radiance(tables, &tables.variances.map(|v| [v]), light, strength).map(|[value]| value)
}

/// Dual scattering in double precision, without tables and with a variance per channel.
fn dual_scattering(fibre: &Fibre, sigma: f64, at: &Directions, n: f64) -> f64 {
    let (width, half) = (Quadrature::new(96), Quadrature::new(96));
    let around = |centre: f64| {
        let mut sum = [0.0; 4];
        for &(x, weight) in &half.points {
            let d = azimuthal_distribution(fibre, sigma, at.theta_o, centre + FRAC_PI_2 * x, &width);
            for p in 0..4 {
                sum[p] += FRAC_PI_2 * weight * d[p];
            }
        }
        sum
    };
    let (forward, backward, global) = (around(PI), around(0.0), around(at.phi).map(|d| d / PI));
    let v = variances(fibre.roughness_along);
    let (a_f, a_b): (f64, f64) = (forward.iter().sum(), backward.iter().sum());
    let spread = |a: [f64; 4]| (0..4).map(|p| v[p] * a[p]).sum::<f64>() / a.iter().sum::<f64>();
    let (b_f, b_b) = (spread(forward), spread(backward));
    let v_b = 2.0 * b_f * a_f * a_f / (1.0 - a_f * a_f) + b_b;
    let hits = if n > 0.0 { n * a_f / -(-n * a_f).exp_m1() } else { 1.0 };
    let x = b_f * hits;
    let tilted = [-2.0, 1.0, 4.0, 0.0].map(|tilts| at.theta_o + tilts * fibre.tilt);
    let m = |v: f64, theta: f64| {
        longitudinal(v, at.theta_i.sin(), at.theta_i.cos(), theta.sin(), theta.cos().abs())
    };
    let f_s = far_field(fibre, [sigma; 3], at, &width)[0];
    let f_g: f64 = (0..4).map(|p| m(v[p] + x, tilted[p]) * global[p]).sum();
    let f_b = |x: f64| {
        if at.phi.cos() > 0.0 { 2.0 / PI * backscattered(a_f, a_b) * m(v_b + x, at.theta_o) } else { 0.0 }
    };
    let psi = (-n * (1.0 - a_f)).exp() - (-n).exp();
    (-n).exp() * (f_s + f_b(0.0)) + psi * (f_g + f_b(x))
}

/// Mean and largest error of a colour, relative to the brightest channel. The counts of fibres are changed by `factor`.
fn errors(tables: &FibreTables, [eumelanin, pheomelanin]: [f64; 2], factor: f64) -> (f64, f64) {
    let sigma = absorption_of_melanin(eumelanin, pheomelanin);
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for (i, n) in [0.0, 0.5, 1.0, 4.0, 16.0].into_iter().enumerate() {
        let theta_o = [0.0, 0.4, -0.8][i % 3];
        for phi in [0.3, 1.2, 1.9, 2.9] {
            let at = Directions { theta_o, theta_i: [0.1, -0.5, 0.3, 0.9][i % 4], phi };
            let light = light(at.theta_i, phi, factor * n);
            let value = radiance(tables, &point(tables, theta_o, sigma), &light, 1.0);
            let truth = sigma.map(|sigma| dual_scattering(&tables.fibre, sigma, &at, n));
            let scale = truth[0].max(truth[1]).max(truth[2]).max(1e-4);
            for c in 0..3 {
                let error = (f64::from(value[c]) - truth[c]).abs() / scale;
                largest = largest.max(error);
                sum += error;
                count += 1.0;
            }
        }
    }
    (sum / count, largest)
}

#[test]
fn single_precision_with_tables_is_close_to_the_formulas() {
    let tables = FibreTables::bake(&Fibre::default());
    for (name, eumelanin, pheomelanin) in COLOURS {
        let (mean, largest) = errors(&tables, [eumelanin, pheomelanin], 1.0);
        println!("{name}: mean {mean:.4}, largest {largest:.4}");
        // Measured 0.7 % and 4.7 % for blonde; the other lobes than TT share a variance between the channels.
        assert!(mean < 0.01 && largest < 0.06, "{name}: {mean} {largest}");
    }
    // A tenth more fibres has to be seen.
    let (mean, largest) = errors(&tables, [1.3, 0.1], 1.1);
    assert!(mean > 0.02 && largest > 0.06, "{mean} {largest}");
}

#[test]
fn without_crossed_fibres_it_is_one_fibre_and_light_from_behind() {
    let fibre = Fibre::default();
    let (tables, rule) = (FibreTables::bake(&fibre), Quadrature::new(96));
    let sigma = absorption_of_melanin(0.3, 0.05);
    for (phi, returned) in [(0.5, true), (2.5, false)] {
        let at = Directions { theta_o: 0.2, theta_i: -0.1, phi };
        let one = far_field(&fibre, sigma, &at, &rule);
        let scatter = point(&tables, at.theta_o, sigma);
        let [all, thin] =
            [1.0, 0.0].map(|strength| radiance(&tables, &scatter, &light(at.theta_i, phi, 0.0), strength));
        for c in 0..3 {
            // Measured 1.6 %, next to the bright edge of TRT, where the table is coarse.
            assert!((f64::from(thin[c]) / one[c] - 1.0).abs() < 0.02);
            assert_eq!(f64::from(all[c]) > 1.02 * one[c], returned, "{phi}: {all:?} {one:?}");
        }
    }
}

#[test]
fn strength_fades_to_light_that_arrives_directly() {
    let fibre = Fibre::default();
    let (tables, rule) = (FibreTables::bake(&fibre), Quadrature::new(96));
    let sigma = absorption_of_melanin(0.3, 0.05);
    for n in [0.0, 1.0, 5.0_f64] {
        let at = Directions { theta_o: 0.2, theta_i: -0.1, phi: 0.7 };
        let expected = far_field(&fibre, sigma, &at, &rule).map(|f| (-n).exp() * f);
        let scatter = point(&tables, at.theta_o, sigma);
        let [off, half, full] =
            [0.0, 0.5, 1.0].map(|s| radiance(&tables, &scatter, &light(at.theta_i, at.phi, n), s));
        for c in 0..3 {
            // Measured 1.1 %, the error of the table.
            assert!((f64::from(off[c]) / expected[c] - 1.0).abs() < 0.02, "{n}");
            assert!((0.5 * (off[c] + full[c]) / half[c] - 1.0).abs() < 1e-4);
            assert!(full[c] > off[c]);
        }
    }
}

#[test]
fn more_fibres_darken_coloured_hair_and_everything_is_finite() {
    for roughness in [0.05, 0.3, 1.0, f64::NAN] {
        let fibre = Fibre { roughness_along: roughness, roughness_around: roughness, ..Fibre::default() };
        let tables = FibreTables::bake(&fibre);
        for sigma in [0.0, 0.02, 0.5, 2.0, 12.0, 100.0, f64::INFINITY, f64::NAN] {
            for theta_o in [-FRAC_PI_2, -0.5, 0.0, 1.4] {
                let scatter = point(&tables, theta_o, [sigma; 3]);
                assert!((0.0..=1.001).contains(&scatter.albedo[0][0]), "{}", scatter.albedo[0][0]);
                let rate = tables.many.row(scatter.eye[0], sigma as f32)[6];
                assert!((0.0..=1.0).contains(&rate));
                for phi in [0.0, 1.5, PI, f64::NAN] {
                    // Light spreads from fibre to fibre, so one direction can become brighter: all of them together must not.
                    // From four fibres the maximum of the light that was scattered forward is past.
                    let mut last = f32::INFINITY;
                    for n in [0.0, 0.1, 1.0, 4.0, 8.0, 16.0, 40.0, 1e9, f64::NAN] {
                        let mut sum = 0.0;
                        for theta_i in (-15..=15).map(|i| f64::from(i) * 0.1) {
                            let value = radiance(&tables, &scatter, &light(theta_i, phi, n), 1.0)[0];
                            assert!(
                                value.is_finite() && value >= 0.0,
                                "{roughness} {sigma} {theta_o} {phi} {n}: {value}"
                            );
                            sum += value;
                        }
                        if n >= 4.0 && sigma >= 0.5 {
                            assert!(sum <= last, "{roughness} {sigma} {theta_o} {phi} {n}: {sum} {last}");
                            last = sum;
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn diffuse_light_is_lost_in_coloured_hair_and_not_in_white() {
    let tables = FibreTables::bake(&Fibre::default());
    let white = point(&tables, 0.0, [0.0; 3]);
    let rate = |sigma: f64| tables.many.row(CosineStep::new(1.0), sigma as f32)[6];
    assert!(rate(0.0) < 1e-3 && (white.albedo[0][0] - 1.0).abs() < 1e-5, "{white:?}");
    let sigma = absorption_of_melanin(1.3, 0.1);
    let brown = point(&tables, 0.0, sigma);
    assert!(rate(sigma[0]) > 0.5 && rate(sigma[2]) > rate(sigma[0]));
    assert!(brown.albedo[0] > brown.albedo[1] && brown.albedo[1] > brown.albedo[2]);
}

#[test]
fn only_a_change_around_the_fibre_or_of_the_index_bakes_again() {
    let mut tables = FibreTables::bake(&Fibre::default());
    let before = tables.clone();
    tables.update(&Fibre { roughness_along: 0.5, tilt: 0.0, ..Fibre::default() });
    assert!(
        tables.direct == before.direct && tables.many == before.many && tables.variances != before.variances
    );
    let fresh = FibreTables::bake(&tables.fibre);
    assert!(fresh.variances == tables.variances && fresh.tilts == tables.tilts);
    tables.update(&Fibre { index: 1.4, ..Fibre::default() });
    assert!(tables.direct != before.direct && tables.many != before.many);
}

#[test]
fn points_that_are_computed_together_have_the_bits_of_single_ones() {
    let tables = FibreTables::bake(&Fibre::default());
    let at = |lane: usize, factor: f32| (lane as f32 * factor + 0.3).sin();
    let sin: [f32; 16] = std::array::from_fn(|lane| at(lane, 0.7));
    let cos = sin.map(|sin| (1.0 - sin * sin).sqrt());
    let sigma = [0.1, 0.9, 2.5].map(|sigma| std::array::from_fn(|lane| sigma * (1.0 + at(lane, 0.4))));
    let light = PointLight {
        sin_theta: std::array::from_fn(|lane| at(lane, 1.1)),
        cos_theta: std::array::from_fn(|lane| (1.0 - at(lane, 1.1) * at(lane, 1.1)).sqrt()),
        phi: std::array::from_fn(|lane| lane as f32 * 0.2),
        fibres: std::array::from_fn(|lane| lane as f32 * 1.5),
    };
    let variances = tables.variances.map(|v| std::array::from_fn(|lane| v + 0.01 * lane as f32));
    let scatter = PointScatter::<16>::new(&tables, &sin, &cos, &sigma);
    let all = scatter.radiance(&tables, &variances, &light, 0.8);
    let mut seen = std::collections::BTreeSet::new();
    for lane in 0..16 {
        let one = PointScatter::new(&tables, &[sin[lane]], &[cos[lane]], &sigma.map(|s| [s[lane]]));
        let light = PointLight {
            sin_theta: [light.sin_theta[lane]],
            cos_theta: [light.cos_theta[lane]],
            phi: [light.phi[lane]],
            fibres: [light.fibres[lane]],
        };
        let value = one.radiance(&tables, &variances.map(|v| [v[lane]]), &light, 0.8);
        for c in 0..3 {
            assert_eq!(value[c][0].to_bits(), all[c][lane].to_bits(), "{lane} {c}");
            assert_eq!(one.albedo[c][0].to_bits(), scatter.albedo[c][lane].to_bits(), "{lane} {c}");
            seen.insert(value[c][0].to_bits());
        }
    }
    assert!(seen.len() > 40, "control: the points differ: {}", seen.len());
}
