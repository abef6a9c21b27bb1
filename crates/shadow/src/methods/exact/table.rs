//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::super::texels;
use super::ExactSettings;

impl Settings for ExactSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::count(
            field!(Self, memory_limit_bytes),
            [16 << 20, 32 << 30],
            "Memory limit",
            "Largest memory for the shadow map. Hair that needs more is refused.",
        )
        .unit(Unit::BYTES_AS_GIB)
        .soft([(1 << 28) as f64, (32_u64 << 30) as f64])
        .logarithmic(),
    ];
}
