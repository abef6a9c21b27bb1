//! False-colour images with legends.

use lovelock_metrics::{ColorMap, Image, paint};
use lovelock_render::{FrameInput, RenderError, ValueRenderer};

use crate::report::Legend;

/// One kind of map. Its scale is the same for all methods and reports, so that colours can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind {
    pub id: &'static str,
    title: &'static str,
    /// Short title above the scale in an image.
    short: &'static str,
    map: ColorMap,
    largest: f32,
}

/// Transmittance itself.
pub(super) const TRANSMITTANCE: Kind =
    Kind { id: "transmittance", title: "Transmittance", short: "T", map: ColorMap::Viridis, largest: 1.0 };
/// Its signed error.
pub(super) const TRANSMITTANCE_ERROR: Kind = Kind {
    id: "transmittance-error",
    title: "Error of transmittance: above zero too bright",
    short: "T error",
    map: ColorMap::Diverging,
    largest: 0.2,
};
/// FLIP.
pub(super) const PICTURE_ERROR: Kind = Kind {
    id: "picture-error",
    title: "Perceived image difference (FLIP)",
    short: "FLIP",
    map: ColorMap::Magma,
    largest: 0.3,
};
/// Deviation under shifts of the map.
pub(super) const SWIM: Kind = Kind {
    id: "swim",
    title: "Deviation of transmittance under shifts of the map by less than a texel",
    short: "Swim",
    map: ColorMap::Magma,
    largest: 0.1,
};
/// Largest change from frame to frame.
pub(super) const POP: Kind = Kind {
    id: "pop",
    title: "Largest change of transmittance from one frame to the next",
    short: "Pop",
    map: ColorMap::Magma,
    largest: 0.5,
};
/// Change from frame to frame that differs from the reference.
pub(super) const FLICKER: Kind = Kind {
    id: "flicker",
    title: "Change of transmittance from frame to frame that the reference does not show",
    short: "Flicker",
    map: ColorMap::Magma,
    largest: 0.1,
};

/// The kinds of a report, in the order of its legends; pop and flicker only for several frames.
pub(super) fn kinds(of_several_frames: bool) -> impl Iterator<Item = Kind> {
    let all = [TRANSMITTANCE, TRANSMITTANCE_ERROR, PICTURE_ERROR, SWIM, POP, FLICKER];
    all.into_iter().take(if of_several_frames { 6 } else { 4 })
}

impl Kind {
    /// The scale, for the report.
    pub(super) fn legend(&self) -> Legend {
        let (low, high) = self.map.range_to(self.largest).into_inner();
        Legend {
            of: self.id.to_owned(),
            title: self.title.to_owned(),
            range: [low, high],
            colors: format!("{:?}", self.map).to_lowercase(),
            file: None,
        }
    }

    /// Values per pixel as colours.
    pub(super) fn colours(&self, values: &[f32]) -> Vec<u8> {
        paint(values, self.map.range_to(self.largest), self.map)
    }

    /// The scale, to be drawn beside images.
    pub(super) fn scale(&self) -> lovelock_metrics::Legend {
        let range = self.map.range_to(self.largest);
        lovelock_metrics::Legend { map: self.map, range, title: self.short.to_owned() }
    }

    /// Values per pixel as colours with the legend beside them: width, height and bytes.
    pub(super) fn painted(&self, width: u32, height: u32, values: &[f32]) -> Option<(u32, u32, Vec<u8>)> {
        let rgba = self.colours(values);
        let image = Image::new(width, height, &rgba).ok()?;
        let canvas = self.scale().beside(&image);
        Some((canvas.width() as u32, canvas.height() as u32, canvas.into_rgba()))
    }
}

/// Values per pixel from values per strand point; NaN where no hair is visible.
///
/// # Errors
/// As [`ValueRenderer::picture`].
pub(super) fn at_pixels(
    renderer: &mut ValueRenderer,
    input: &FrameInput,
    values: &[f32],
    [width, height]: [u32; 2],
) -> Result<Vec<f32>, RenderError> {
    let mut picture = renderer.picture(input, values, width, height)?;
    for (value, weight) in picture.value.iter_mut().zip(&picture.weight) {
        // Hair that hardly covers a pixel is not visible in an image either.
        if *weight < 0.05 {
            *value = f32::NAN;
        }
    }
    Ok(picture.value)
}
