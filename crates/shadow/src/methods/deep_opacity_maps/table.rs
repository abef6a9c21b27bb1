//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};

use super::super::texels;
use super::{DeepOpacityMapsSettings, LayerGrowth};

impl Settings for DeepOpacityMapsSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::count(
            field!(Self, layers),
            [*Self::LAYERS.start() as u64, *Self::LAYERS.end() as u64],
            "Layers",
            "Number of layers, which begin at the first hair of each texel. Hair behind the last \
             layer counts as part of it.",
        )
        .offered(&[3, 4, 5, 6, 8, 10, 12, 16]),
        Setting::choice::<LayerGrowth>(
            field!(Self, growth),
            "Layer growth",
            "Thickness of the layers: equal, or thinner where light falls off fastest.",
        ),
        Setting::number(
            field!(Self, depth_share),
            [0.05, 1.0],
            "Layer depth",
            "Thickness of all layers together, as a share of the depth of the hair.",
        )
        .unit(Unit::FRACTION),
    ];
}

impl Choices for LayerGrowth {
    const ALL: &'static [Self] = &[Self::Even, Self::Linear];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Even => ("even", "Even"),
            Self::Linear => ("linear", "Thicker inward"),
        }
    }
}
