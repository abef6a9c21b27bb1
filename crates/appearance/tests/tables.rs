//! The tables of a fibre against direct evaluation.

use std::f64::consts::PI;

use lovelock_appearance::fibre::{
    CosineStep, Fibre, ManyTable, Quadrature, ScatterTable, azimuthal_distribution, distributions,
};

/// Evenly distributed numbers in 0..1 by the additive recurrence of Roberts in three dimensions.
fn samples(count: usize) -> impl Iterator<Item = [f64; 3]> {
    (1..=count)
        .map(|i| [0.819_172_513, 0.671_043_607, 0.549_700_478].map(|step: f64| (i as f64 * step).fract()))
}

/// Mean and largest error of the sum of all lobes, relative to the mean of the distribution, over 1,500 samples. `damage` changes
/// the absorption that the table is read with.
fn table_errors(roughness_around: f64, damage: f64) -> (f64, f64) {
    let fibre = Fibre { roughness_around, ..Fibre::default() };
    let ([table, _], many) = (ScatterTable::bake(&fibre), ManyTable::bake(&fibre));
    let rule = Quadrature::new(96);
    let (mut sum, mut largest, mut mean) = (0.0, 0.0_f64, 0.0);
    for [u, v, w] in samples(1500) {
        let (phi, cos_o) = (PI * u, 0.05 + 0.95 * v);
        let sigma = 0.02 * 600.0_f64.powf(w);
        let truth: f64 = azimuthal_distribution(&fibre, sigma, cos_o.acos(), phi, &rule).iter().sum();
        let (eye, sigma) = (CosineStep::new(cos_o as f32), (sigma * damage) as f32);
        let value =
            distributions(&table.row(eye, phi as f32), sigma).iter().sum::<f32>() + many.row(eye, sigma)[7];
        let error = (f64::from(value) - truth).abs();
        sum += error;
        largest = largest.max(error);
        mean += truth;
    }
    (sum / mean, largest / (mean / 1500.0))
}

#[test]
fn table_of_the_distribution_against_direct_evaluation() {
    // Measured: mean 0.0014, 0.0021 and 0.0008, largest 0.023, 0.107 and 0.004. The smoothest fibre has the peak of TRT at a few azimuths,
    // three steps of the table wide, and it moves by more than a step between two cosines. Between four entries around it, the table is too
    // low at the peak and too high beside it.
    for (roughness, mean_bound, largest_bound) in
        [(0.3, 0.003, 0.03), (0.15, 0.003, 0.11), (0.7, 0.003, 0.03)]
    {
        let (mean, largest) = table_errors(roughness, 1.0);
        println!("roughness {roughness}: mean {mean:.5}, largest {largest:.5}");
        assert!(mean < mean_bound && largest < largest_bound, "{roughness}: {mean} {largest}");
    }
    // A twentieth more absorption has to be seen.
    assert!(table_errors(0.3, 1.05).0 > 0.003);
}

#[test]
fn table_of_the_mean_over_half_against_an_integral() {
    let fibre = Fibre::default();
    let ([_, table], many) = (ScatterTable::bake(&fibre), ManyTable::bake(&fibre));
    let (rule, over_half) = (Quadrature::new(96), Quadrature::new(120));
    let (mut sum, mut largest, mut mean) = (0.0, 0.0_f64, 0.0);
    for [u, v, w] in samples(30) {
        let (phi, cos_o, sigma) = (PI * u, 0.05 + 0.95 * v, 0.02 * 600.0_f64.powf(w));
        let truth = over_half.integrate(phi - PI / 2.0, phi + PI / 2.0, |x| {
            azimuthal_distribution(&fibre, sigma, cos_o.acos(), x, &rule).iter().sum::<f64>() / PI
        });
        let eye = CosineStep::new(cos_o as f32);
        let row = table.row(eye, phi as f32);
        let value = distributions(&row, sigma as f32).iter().sum::<f32>() + many.row(eye, sigma as f32)[7];
        sum += (f64::from(value) - truth).abs();
        largest = largest.max((f64::from(value) - truth).abs());
        mean += truth;
    }
    println!("mean {:.5}, largest {:.5}", sum / mean, largest / (mean / 30.0));
    assert!(sum / mean < 0.003 && largest / (mean / 30.0) < 0.01);
}

/// Absorptions of hair colours in red, green and blue, from the amounts of eumelanin and pheomelanin.
fn sigma(eumelanin: f32, pheomelanin: f32) -> [f32; 3] {
    [(0.419, 0.187), (0.697, 0.4), (1.37, 1.05)].map(|(e, p)| eumelanin * e + pheomelanin * p)
}

#[test]
fn shares_forward_and_backward_of_known_colours() {
    // From a separate implementation in numpy, with three digits. Red's backward share was not printed.
    let known = [
        ("white", [0.0; 3], [0.903; 3], [0.097; 3]),
        ("blonde", sigma(0.3, 0.05), [0.710, 0.602, 0.403], [0.073, 0.062, 0.047]),
        ("brown", sigma(1.3, 0.1), [0.342, 0.189, 0.067], [0.043, 0.037, 0.034]),
        ("red", sigma(0.3, 0.8), [0.555, 0.362, 0.125], [f32::NAN; 3]),
        ("black", sigma(8.0, 0.0), [0.043, 0.041, 0.041], [0.034; 3]),
    ];
    let table = ManyTable::bake(&Fibre::default());
    let eye = CosineStep::new(1.0);
    for (name, sigma, forward, backward) in known {
        for channel in 0..3 {
            let row = table.row(eye, sigma[channel]);
            println!("{name} {channel}: {:.4} {:.4}", row[0], row[1]);
            // Half of the last digit, and the interpolation over absorption.
            assert!((row[0] - forward[channel]).abs() < 0.000_75, "{name} {channel}: {}", row[0]);
            let error = (row[1] - backward[channel]).abs();
            assert!(error < 0.000_75 || backward[channel].is_nan(), "{name} {channel}: {}", row[1]);
        }
    }
}
