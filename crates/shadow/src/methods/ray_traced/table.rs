//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::RayTracedSettings;

impl Settings for RayTracedSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::one_of(
            field!(Self, rays),
            &[1, 4, 16, 64, 256],
            "Rays",
            "Number of rays from each point to the light. One makes shadows hard, few show soft edges several times, and more take longer.",
        ),
        Setting::count(
            field!(Self, memory_limit_bytes),
            [1 << 20, 32 << 30],
            "Memory limit",
            "Largest memory for the hierarchy of strands. Hair that needs more is refused.",
        )
        .unit(Unit::BYTES_AS_GIB)
        .soft([(1 << 28) as f64, (32_u64 << 30) as f64])
        .logarithmic(),
    ];
}
