//! Colour maps for numbers.

use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// A colour map with perceptually equal steps. The colours are those of the crate colorous.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// From dark violet over green to yellow; suitable for the colour-blind.
    Viridis,
    /// From black over violet to pale yellow, the usual map for FLIP.
    #[default]
    Magma,
    /// From dark blue to yellow, designed for the colour-blind.
    Cividis,
    /// From orange (negative) over white (zero) to violet (positive), for signed numbers.
    Diverging,
}

impl ColorMap {
    /// Every map.
    pub const ALL: [Self; 4] = [Self::Viridis, Self::Magma, Self::Cividis, Self::Diverging];

    /// The sRGB colour at `t`, where 0 is the start of the range and 1 its end. Values outside are clamped.
    pub fn at(self, t: f32) -> [u8; 3] {
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Cividis => colorous::CIVIDIS,
            Self::Diverging => colorous::PURPLE_ORANGE,
        };
        let t = if t > 0.0 { f64::from(t.min(1.0)) } else { 0.0 };
        // In colorous the map starts with violet.
        let color = gradient.eval_continuous(if self == Self::Diverging { 1.0 - t } else { t });
        [color.r, color.g, color.b]
    }

    /// A range for values up to `largest`: from 0 for sequential maps, symmetric about 0 for the diverging map.
    pub fn range_to(self, largest: f32) -> RangeInclusive<f32> {
        match self {
            Self::Diverging => -largest..=largest,
            Self::Viridis | Self::Magma | Self::Cividis => 0.0..=largest,
        }
    }
}

/// The sRGB colours of `values`, four bytes each. The start of `range` has the map's first colour, its end the last one. NaN
/// becomes transparent black.
pub fn paint(values: &[f32], range: RangeInclusive<f32>, map: ColorMap) -> Vec<u8> {
    let (low, high) = range.into_inner();
    // A thousand steps are finer than 8-bit colours can show.
    let table: Vec<[u8; 3]> = (0..=1000).map(|i| map.at(i as f32 / 1000.0)).collect();
    let color = |&value: &f32| {
        if value.is_nan() {
            return [0; 4];
        }
        let [r, g, b] = table[((value - low) / (high - low) * 1000.0).round().clamp(0.0, 1000.0) as usize];
        [r, g, b, 255]
    };
    values.iter().flat_map(color).collect()
}

#[cfg(test)]
mod tests {
    use super::{ColorMap, paint};

    /// CIE lightness, 0 to 100.
    fn lightness(rgb: [u8; 3]) -> f64 {
        let linear = rgb.map(|byte| {
            let value = f64::from(byte) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        let y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        if y > 0.008_856 { 116.0 * y.cbrt() - 16.0 } else { 903.3 * y }
    }

    #[test]
    fn lightness_rises_evenly_and_diverging_maps_are_lightest_in_the_middle() {
        for map in [ColorMap::Viridis, ColorMap::Magma, ColorMap::Cividis] {
            let steps: Vec<f64> = (0..=20).map(|i| lightness(map.at(i as f32 / 20.0))).collect();
            let [first, last] = [steps[0], steps[20]];
            for (i, &value) in steps.iter().enumerate() {
                // Measured deviation from a straight line: at most 1.7, and 5.9 for magma, whose steps are equal in a space that
                // includes chroma.
                let line = first + (last - first) * i as f64 / 20.0;
                let most = if map == ColorMap::Magma { 7.0 } else { 2.5 };
                assert!((value - line).abs() < most, "{map:?} {i}: {value} {line}");
            }
            assert!(last - first > 60.0 && steps.windows(2).all(|pair| pair[1] > pair[0]), "{map:?}");
        }
        let [low, middle, high] = [0.0, 0.5, 1.0].map(|t| lightness(ColorMap::Diverging.at(t)));
        assert!(middle > 90.0 && low < 45.0 && high < 45.0, "{low} {middle} {high}");
        let ([r, _, b], [r2, _, b2]) = (ColorMap::Diverging.at(0.1), ColorMap::Diverging.at(0.9));
        assert!(r > b && b2 > r2, "orange below, violet above");
    }

    #[test]
    fn painting_clamps_and_leaves_holes() {
        let map = ColorMap::Viridis;
        let painted = paint(&[-1.0, 2.0, 3.0, 4.0, f32::INFINITY, f32::NAN], 2.0..=4.0, map);
        let pixels: Vec<&[u8]> = painted.chunks_exact(4).collect();
        let [first, middle, last] = [0.0, 0.5, 1.0].map(|t| map.at(t));
        assert_eq!(pixels[0][..3], first);
        assert_eq!(pixels[0], pixels[1]);
        assert_eq!(pixels[2][..3], middle);
        assert_eq!(pixels[3][..3], last);
        assert_eq!(pixels[3], pixels[4]);
        assert_eq!(pixels[5], [0; 4]);
        // An empty range also gives colours.
        assert_eq!(paint(&[1.0, 2.0], 1.0..=1.0, map).len(), 8);
        assert_eq!(map.at(f32::NAN), first);
    }
}
