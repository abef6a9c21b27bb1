//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};

use super::super::texels;
use super::OccupancyMapsSettings;

impl Settings for OccupancyMapsSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::one_of(
            field!(Self, slices),
            &[128, 256, 512],
            "Slices",
            "Number of slices of a texel's depth range, one bit each. More slices resolve more \
             depth.",
        ),
        Setting::one_of(
            field!(Self, slabs),
            &[4, 8, 16],
            "Slabs",
            "Number of slabs of slices that count their hair; the paper has 4.",
        ),
    ];
}
