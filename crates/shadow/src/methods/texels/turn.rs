//! Sine and cosine with the same results on every processor. Twin of turn.wgsl.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

/// The sine of a quarter of a turn before and behind 0, in turns: the Taylor series, with an error below 6e-8.
#[inline(always)]
fn quarter_sine(x: f32) -> f32 {
    let square = x * x;
    let p = -15.094_643_f32;
    let p = p * square + 42.058_693;
    let p = p * square + -76.705_86;
    let p = p * square + 81.605_25;
    let p = p * square + -41.341_7;
    let p = p * square + std::f32::consts::TAU;
    p * x
}

/// The sine of `x` turns, −1 to 2.
#[inline(always)]
fn sine(x: f32) -> f32 {
    let part = x - (x + 0.5).floor();
    let folded = if part > 0.25 { 0.5 - part } else { part };
    quarter_sine(if folded < -0.25 { -0.5 - folded } else { folded })
}

/// Cosine and sine of `x` turns, −1 to 1.
#[inline(always)]
pub(crate) fn turn(x: f32) -> [f32; 2] {
    [sine(x + 0.25), sine(x)]
}

/// Cosine and sine of the sum of two angles.
#[inline(always)]
pub(crate) fn turn_on(a: [f32; 2], by: [f32; 2]) -> [f32; 2] {
    [a[0] * by[0] - a[1] * by[1], a[1] * by[0] + a[0] * by[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_those_of_double_precision() {
        for step in -1000..=1000 {
            let x = step as f32 / 1000.0;
            let angle = std::f64::consts::TAU * f64::from(x);
            let one = turn(x);
            let mut all = one;
            for k in 1..=15 {
                let expected = [(angle * f64::from(k)).cos(), (angle * f64::from(k)).sin()];
                for (found, expected) in all.iter().zip(expected) {
                    assert!(
                        (f64::from(*found) - expected).abs() < 8e-6,
                        "{k} times {x}: {found}, {expected}"
                    );
                }
                all = turn_on(all, one);
            }
        }
    }
}
