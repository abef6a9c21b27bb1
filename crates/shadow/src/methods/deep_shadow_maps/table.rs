//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};

use super::super::texels;
use super::DeepShadowMapsSettings;

impl Settings for DeepShadowMapsSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::number(
            field!(Self, tolerance),
            [1e-4, 0.25],
            "Tolerance",
            "Largest difference of the compressed curve from the light behind each hair. A smaller one needs more nodes.",
        )
        .symbol("ε")
        .decimals(4)
        .logarithmic(),
        Setting::one_of(
            field!(Self, nodes),
            &[8, 16, 32],
            "Most nodes",
            "Largest number of nodes of a texel's curve. Texels that would need more have a larger tolerance.",
        ),
    ];
}
