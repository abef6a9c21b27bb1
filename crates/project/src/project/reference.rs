//! A picture that is compared with the image in the window.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};
use lovelock_picture::PictureFit;
use serde::{Deserialize, Serialize};

use crate::files::FileRef;

/// A picture that lies over the image in the window, to compare with it. Films and saved images do not have it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ReferenceSection {
    /// A PNG, JPEG, Radiance or `OpenEXR` picture; none where none.
    pub file: Option<FileRef>,
    /// Whether it is shown.
    pub shown: bool,
    /// How much it covers the image.
    pub opacity: f32,
    /// How it is laid over an image of another shape.
    pub fit: PictureFit,
    /// Whether left and right are swapped.
    pub flip: bool,
}

impl Default for ReferenceSection {
    fn default() -> Self {
        Self { file: None, shown: true, opacity: 0.5, fit: PictureFit::Fit, flip: false }
    }
}

impl Settings for ReferenceSection {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::switch(
            field!(Self, shown),
            "Show reference",
            "Shows the reference picture over the image in the window.",
        ),
        Setting::number(
            field!(Self, opacity),
            [0.0, 1.0],
            "Reference opacity",
            "How much the reference picture covers the image.",
        )
        .unit(Unit::FRACTION),
        Setting::choice::<PictureFit>(
            field!(Self, fit),
            "Reference fit",
            "How a reference picture of another shape lies over the image: cut off, with all of it inside, or stretched.",
        ),
        Setting::switch(
            field!(Self, flip),
            "Flip reference",
            "Swaps left and right of the reference picture.",
        ),
    ];
}
