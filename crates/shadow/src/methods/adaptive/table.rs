//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings};

use super::super::texels;
use super::AdaptiveSettings;

impl Settings for AdaptiveSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::one_of(
            field!(Self, nodes),
            &[4, 8, 16, 32],
            "Nodes",
            "Number of nodes of the curve of light in each texel. More nodes follow the hair more closely and need more memory.",
        ),
    ];
}
