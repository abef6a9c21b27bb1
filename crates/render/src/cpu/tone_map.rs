//! Tone mapping: the twin of `tone_map.wgsl`.
//!
//! `AgX` is Troy Sobotka's; the polynomial for its curve and the matrices are Benjamin Wrensch's fit (2023).
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use super::math::{clamp, exp2, log2, max, pow, saturate};

const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_636, -0.098_043_45, 1.151_073_7],
];
/// The range of the curve in stops below and above middle grey, as logarithms.
const LOW: f32 = -12.473_93;
const HIGH: f32 = 4.026_069;

/// Linear light of `N` pixels to sRGB-encoded values in 0..1, in place.
///
/// Stage by stage over all pixels, so that each loop vectorises.
#[inline(always)]
pub(crate) fn encode<const N: usize>(color: &mut [[f32; N]; 3], exposure: f32) {
    let mut curved = [[0.0; N]; 3];
    for (c, row) in INSET.iter().enumerate() {
        for x in 0..N {
            let [r, g, b] = [max(color[0][x], 0.0), max(color[1][x], 0.0), max(color[2][x], 0.0)];
            let inset = (row[0] * r + row[1] * g + row[2] * b) * exposure;
            let stops = clamp(log2(max(inset, 1e-10)), LOW, HIGH);
            let x1 = (stops - LOW) * (1.0 / (HIGH - LOW));
            let x2 = x1 * x1;
            let x4 = x2 * x2;
            let curve =
                15.5 * x4 * x2 - 40.14 * x4 * x1 + 31.96 * x4 - 6.868 * x2 * x1 + 0.4298 * x2 + 0.1191 * x1
                    - 0.00232;
            // A little contrast.
            curved[c][x] = pow(max(curve, 0.0), 1.08);
        }
    }
    // A little saturation, so that natural hair colours do not turn grey.
    for x in 0..N {
        let grey = curved[0][x] * 0.2126 + curved[1][x] * 0.7152 + curved[2][x] * 0.0722;
        curved[0][x] = max(grey + 1.18 * (curved[0][x] - grey), 0.0);
        curved[1][x] = max(grey + 1.18 * (curved[1][x] - grey), 0.0);
        curved[2][x] = max(grey + 1.18 * (curved[2][x] - grey), 0.0);
    }
    for (row, out) in OUTSET.iter().zip(color) {
        for x in 0..N {
            let c = row[0] * curved[0][x] + row[1] * curved[1][x] + row[2] * curved[2][x];
            // The curve's end is encoded with the power 2.2; sRGB is piecewise, and its linear part ends at
            // 0.0031308, which is 0.0727 before the power. Below, x^2.2 is exp(2.2 log x) with the same logarithm.
            let power = log2(max(saturate(c), 1e-30));
            let low = 12.92 * exp2(2.2 * power);
            let high = 1.055 * exp2((2.2 / 2.4) * power) - 0.055;
            out[x] = if c <= 0.072_68 { low } else { high };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steps of the shader in double precision.
    fn reference(linear: [f64; 3]) -> [f64; 3] {
        let apply = |m: &[[f32; 3]; 3], v: [f64; 3]| {
            [0, 1, 2].map(|r| (0..3).map(|c| f64::from(m[r][c]) * v[c]).sum::<f64>())
        };
        let y = apply(&INSET, linear).map(|c| {
            let (low, high) = (f64::from(LOW), f64::from(HIGH));
            let x = (c.max(1e-10).log2().clamp(low, high) - low) / (high - low);
            let p = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
            p.iter().rev().fold(0.0, |sum, c| sum * x + c).max(0.0).powf(1.08)
        });
        let grey = y[0] * 0.2126 + y[1] * 0.7152 + y[2] * 0.0722;
        apply(&OUTSET, y.map(|c| (grey + 1.18 * (c - grey)).max(0.0))).map(|c| {
            let linear = c.clamp(0.0, 1.0).powf(2.2);
            if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
        })
    }

    #[test]
    fn the_curve_is_the_shaders() {
        for r in [0.0, 1e-4, 0.01, 0.18, 0.5, 1.0, 4.0, 100.0_f32] {
            for g in [0.0, 0.002, 0.18, 2.0_f32] {
                let linear = [r, g, 0.3 * (r + g)];
                let truth = reference(linear.map(f64::from));
                let mut color = linear.map(|c| [c; 2]);
                encode(&mut color, 1.0);
                for ([got, _], truth) in color.into_iter().zip(truth) {
                    // A hundredth of a step of 8 bits.
                    assert!((f64::from(got) - truth).abs() < 4e-5, "{linear:?}: {got} {truth}");
                }
            }
        }
    }

    #[test]
    fn nonsense_becomes_a_color() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, f32::MAX] {
            let mut color = [[bad], [0.2], [bad]];
            encode(&mut color, 1.0);
            for [c] in color {
                assert!((-0.01..=1.01).contains(&c), "{bad}: {c}");
            }
        }
    }
}
