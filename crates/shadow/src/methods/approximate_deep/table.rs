//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::super::texels;
use super::ApproximateDeepSettings;

impl Settings for ApproximateDeepSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::number(
            field!(Self, spacing),
            [5e-5, 0.05],
            "Hair spacing",
            "Assumed distance between hairs along the light. A smaller distance makes the inside of the hair darker.",
        )
        .unit(Unit::METRES_AS_MM)
        .logarithmic(),
        Setting::count(
            field!(Self, hairs),
            [1, 1000],
            "Most hairs",
            "Largest number of hairs that a point is taken to lie behind. A smaller number leaves more light deep inside.",
        )
        .symbol("M")
        .logarithmic(),
    ];
}
