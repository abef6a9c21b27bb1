//! What is behind the figure.

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// What is behind the figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BackgroundForm {
    /// The two colours from top to bottom, with a pool of light behind the figure.
    #[default]
    Studio,
    /// The upper colour everywhere.
    Plain,
    /// The two colours from top to bottom.
    Vertical,
    /// The lower colour in the middle, and the upper one in the corners.
    Radial,
    /// A picture of the user; the upper colour beside it, and everywhere while there is none.
    Picture,
}

impl Choices for BackgroundForm {
    const ALL: &'static [Self] = &[Self::Studio, Self::Plain, Self::Vertical, Self::Radial, Self::Picture];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Studio => ("studio", "Studio"),
            Self::Plain => ("plain", "One colour"),
            Self::Vertical => ("vertical", "Vertical gradient"),
            Self::Radial => ("radial", "Radial gradient"),
            Self::Picture => ("picture", "Picture"),
        }
    }
}

/// How a picture of another shape is laid into an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PictureFit {
    /// It covers the image; what exceeds it is cut off.
    #[default]
    Fill,
    /// All of it is shown, with borders.
    Fit,
    /// It is stretched to the shape of the image.
    Stretch,
}

impl Choices for PictureFit {
    const ALL: &'static [Self] = &[Self::Fill, Self::Fit, Self::Stretch];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Fill => ("fill", "Fill"),
            Self::Fit => ("fit", "Fit"),
            Self::Stretch => ("stretch", "Stretch"),
        }
    }
}

impl PictureFit {
    /// The size of a picture of size `picture` in an image of size `image`, both width and height in any unit. It is centred.
    pub fn size(self, picture: [f32; 2], image: [f32; 2]) -> [f32; 2] {
        let [x, y] = [0, 1].map(|axis| image[axis] / picture[axis].max(1e-6));
        match self {
            Self::Fill => picture.map(|side| side * x.max(y)),
            Self::Fit => picture.map(|side| side * x.min(y)),
            Self::Stretch => image,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_fills_an_image_or_fits_into_it() {
        let of = |fit: PictureFit| fit.size([200.0, 100.0], [300.0, 300.0]);
        assert_eq!(of(PictureFit::Fill), [600.0, 300.0]);
        assert_eq!(of(PictureFit::Fit), [300.0, 150.0]);
        assert_eq!(of(PictureFit::Stretch), [300.0, 300.0]);
    }
}
