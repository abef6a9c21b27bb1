//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::VoxelMarchSettings;

impl Settings for VoxelMarchSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, resolution),
            [16, 512],
            "Map resolution",
            "Number of cells along the longest edge of the hair. More cells show finer shadows, and take longer and more memory.",
        )
        .unit(Unit::CELLS)
        .step(8)
        .stops(&[16, 32, 48, 64, 96, 128, 192, 256, 384, 512]),
        Setting::number(
            field!(Self, step),
            [0.25, 4.0],
            "Step",
            "Length of a step toward the light. Longer steps are faster and show stairs.",
        )
        .unit(Unit::CELLS)
        .decimals(2)
        .logarithmic(),
        Setting::switch(
            field!(Self, jitter),
            "Jitter",
            "Starts each point at a random place within the first step, which turns the stairs of long steps into noise.",
        ),
        Setting::count(
            field!(Self, memory_limit_bytes),
            [16 << 20, 32 << 30],
            "Memory limit",
            "Largest memory for the grid. Hair that needs more is refused.",
        )
        .unit(Unit::BYTES_AS_GIB)
        .soft([(1 << 28) as f64, (32_u64 << 30) as f64])
        .logarithmic(),
    ];
}
