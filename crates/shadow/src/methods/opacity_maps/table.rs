//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};

use super::super::texels;
use super::OpacityMapsSettings;

impl Settings for OpacityMapsSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::count(
            field!(Self, slices),
            [8, 256],
            "Slices",
            "Number of slices of equal depth. With few slices the shadow shows bands.",
        )
        .offered(&[8, 16, 32, 64, 128, 256]),
    ];
}
