//! The colour spaces of FLIP, with the authors' constants.

/// The inverse of the white point D65.
const INVERSE_WHITE: [f32; 3] = [1.052_156_9, 1.0, 0.918_357_7];
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

fn times(matrix: &[[f64; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] as f32 * v[0] + row[1] as f32 * v[1] + row[2] as f32 * v[2])
}

/// Linear value of an sRGB byte.
fn linear(byte: u8) -> f32 {
    let value = f32::from(byte) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// `YCxCz` of an sRGB colour: luminance, red-green and blue-yellow. In this linear space the contrast sensitivity filters apply.
pub(super) fn ycxcz(rgb: [u8; 3]) -> [f32; 3] {
    let xyz = times(&XYZ_FROM_RGB, rgb.map(linear));
    let [x, y, z] = std::array::from_fn(|i| xyz[i] * INVERSE_WHITE[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Threshold below which CIELAB's cube root is replaced by a straight line.
const DELTA: f32 = 6.0 / 29.0;

/// Converts a filtered colour of [`ycxcz`], clamped to the gamut of the display, to CIELAB with the Hunt adjustment of chroma.
pub(super) fn hunt_lab([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (y + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    let rgb = times(&RGB_FROM_XYZ, std::array::from_fn(|i| relative[i] * WHITE[i]));
    let xyz = times(&XYZ_FROM_RGB, rgb.map(|channel| channel.clamp(0.0, 1.0)));
    let [x, y, z] = std::array::from_fn(|i| {
        let value = xyz[i] * INVERSE_WHITE[i];
        if value > DELTA * DELTA * DELTA { value.cbrt() } else { value / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// `HyAB` distance: absolute difference of lightness plus Euclidean distance of chroma.
pub(super) fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::{hunt_lab, hyab, ycxcz};

    #[test]
    fn white_black_and_grey_have_the_published_values() {
        let [white, black] = [[255; 3], [0; 3]].map(|rgb| hunt_lab(ycxcz(rgb)));
        assert!((white[0] - 100.0).abs() < 1e-3 && white[1].abs() + white[2].abs() < 1e-2, "{white:?}");
        // The straight part of CIELAB reaches zero up to the rounding of 4/29.
        assert!(black[0].abs() < 1e-3, "{black:?}");
        assert!((hyab(white, black) - 100.0).abs() < 0.02);
        // CIE L* of sRGB 119 is 50.03 (Lindbloom's calculator gives 50.0344).
        assert!((hunt_lab(ycxcz([119; 3]))[0] - 50.034).abs() < 0.01);
        // Negative control: a colour has chroma.
        assert!(hunt_lab(ycxcz([255, 0, 0]))[1] > 20.0);
    }
}
