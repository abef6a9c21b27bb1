//! The colours of values in false-colour images.

/// The colours of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorScale {
    /// The values of the first and of the last colour.
    pub range: [f32; 2],
    /// Red, green and blue (sRGB-encoded), evenly spaced over the range.
    pub colors: [[u8; 3]; 256],
    /// Brightness of the picture under the colours, 0 to 1.
    pub behind: f32,
    /// How much of its colour that picture keeps: 0 is grey, 1 is as it is.
    pub saturation: f32,
    /// How strongly light and shadow of the hair show in its colours: 0 is not at all, so that each value has exactly its colour.
    pub relief: f32,
}

impl ColorScale {
    /// The factor on colours over hair of this brightness, sRGB-encoded, 0 to 1: twin of `relief` in `false_colors.wgsl`.
    pub(crate) fn light_on(&self, luminance: f32) -> f32 {
        1.0 - self.relief + self.relief * (2.0 * luminance).clamp(0.0, 1.0).sqrt()
    }
}
