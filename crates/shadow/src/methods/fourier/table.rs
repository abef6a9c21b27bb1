//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};

use super::super::texels;
use super::FourierSettings;

impl Settings for FourierSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::one_of(
            field!(Self, terms),
            &[3, 7, 15],
            "Terms",
            "Number of terms of the series. With few terms light rises and falls in waves along the light.",
        ),
        Setting::switch(
            field!(Self, window),
            "Window",
            "Reduces the higher terms, which removes waves and blurs the shadow along the light.",
        ),
        texels::depth_range(field!(Self, depth_range)),
    ];
}
