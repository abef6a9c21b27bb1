//! Noise for the step from RGB to the 8-bit planes of a film, which breaks up bands in smooth gradients.
//!
//! The noise has a triangular distribution (TPDF), so the mean of what is rounded stays as it is. It depends on the
//! position alone: areas that stand still stay still, and cost nothing from one key frame to the next.
//!
//! Noise of one code in single pixels, which is enough for rounding, does not reach the screen: the encoder drops transform
//! coefficients below two thirds of its quantiser's step. The noise is therefore constant in cells of 2×2 samples, which
//! moves its energy to coefficients of low frequency, and its amplitude is a third of the step. Images from the renderer are
//! dithered themselves, so their local mean is finer than 8 bits.

use lovelock_base::random::SplitMix64;

/// Cells along each side of the pattern, which repeats after that.
const SIDE: usize = 64;

/// Largest amplitude of luma noise in codes. Draft films would need more, and it would be visible.
const MAX_CODES: f64 = 4.0;

/// Noise for the three planes of a film.
pub(crate) struct Dither {
    pub(crate) luma: Tile,
    pub(crate) blue: Tile,
    pub(crate) red: Tile,
}

impl Dither {
    /// Noise that survives an encoder with the quantiser `qp` of H.264, 0 to 51. Chroma has an amplitude of one code, because
    /// stronger noise shows as coloured specks.
    pub(crate) fn for_quantiser(qp: u8) -> Self {
        let step = 0.625 * f64::exp2(f64::from(qp) / 6.0);
        Self {
            luma: Tile::new(1, (step / 3.0).min(MAX_CODES)),
            blue: Tile::new(2, 1.0),
            red: Tile::new(3, 1.0),
        }
    }

    /// No noise.
    #[cfg(test)]
    pub(crate) fn none() -> Self {
        Self { luma: Tile::new(1, 0.0), blue: Tile::new(2, 0.0), red: Tile::new(3, 0.0) }
    }
}

/// A pattern of noise that repeats, in codes with 16 fraction bits.
pub(crate) struct Tile(Vec<[i32; SIDE]>);

impl Tile {
    /// Noise from `-amplitude` to `amplitude` codes.
    fn new(seed: u64, amplitude: f64) -> Self {
        // Rounded to 1/256 code, so that every machine has the same noise.
        let scale = (amplitude * 256.0).round() as i64;
        let mut random = SplitMix64::new(seed);
        let mut noise = || {
            let bits = random.bits();
            // The difference of two uniform numbers of 16 bits.
            ((bits >> 48) as i64 - (bits & 0xFFFF) as i64) * scale / 256
        };
        Self((0..SIDE).map(|_| std::array::from_fn(|_| noise() as i32)).collect())
    }

    /// Noise of the sample at a column and row of the plane.
    pub(crate) fn at(&self, column: usize, row: usize) -> i32 {
        self.0[row / 2 % SIDE][column / 2 % SIDE]
    }
}

#[cfg(test)]
mod tests {
    use super::{Dither, SIDE, Tile};

    fn codes(tile: &Tile) -> Vec<f64> {
        tile.0.as_flattened().iter().map(|&noise| f64::from(noise) / 65_536.0).collect()
    }

    #[test]
    fn the_distribution_is_triangular() {
        let codes = codes(&Tile::new(5, 2.0));
        let count = codes.len() as f64;
        let mean = codes.iter().sum::<f64>() / count;
        let variance = codes.iter().map(|code| code * code).sum::<f64>() / count;
        // Amplitude squared over 6; 4,096 cells leave 1.3 % of the mean and 2 % of the variance to chance.
        assert!(mean.abs() < 0.04 && (variance - 4.0 / 6.0).abs() < 0.04, "{mean} {variance}");
        // Half of the amplitude holds three quarters of a triangle, and half of a rectangle.
        let inner = codes.iter().filter(|code| code.abs() < 1.0).count() as f64 / count;
        assert!((inner - 0.75).abs() < 0.03, "{inner}");
        assert!(codes.iter().all(|code| code.abs() < 2.0));
    }

    #[test]
    fn neighbours_and_planes_are_independent() {
        let Dither { luma, blue, .. } = Dither::for_quantiser(20);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (luma, blue) = (codes(&luma), codes(&blue));
        for (a, b) in [(&luma[1..], &luma[..]), (&luma[SIDE..], &luma[..]), (&luma[..], &blue[..])] {
            let correlation = product(a, b) / (product(a, a) * product(&b[..a.len()], &b[..a.len()])).sqrt();
            assert!(correlation.abs() < 0.06, "{correlation}");
        }
    }

    #[test]
    fn cells_of_two_by_two_samples_share_a_value() {
        let tile = Tile::new(1, 1.0);
        assert_eq!(tile.at(2, 4), tile.at(3, 5));
        assert_ne!(tile.at(2, 4), tile.at(4, 4));
        assert_eq!(tile.at(6, 8), tile.at(6 + 2 * SIDE, 8 + 2 * SIDE));
    }

    #[test]
    fn the_amplitude_follows_the_quantiser() {
        let most = |qp| codes(&Dither::for_quantiser(qp).luma).into_iter().fold(0.0, f64::max);
        for (qp, wanted) in [(15, 1.18), (20, 2.10), (25, 3.74), (30, 4.0)] {
            assert!((0.94..=1.0).contains(&(most(qp) / wanted)), "{qp}: {}", most(qp));
        }
    }
}
