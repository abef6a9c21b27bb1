//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Setting, Settings, Unit};

use super::super::texels;
use super::{MomentKind, MomentsSettings};

impl Settings for MomentsSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::one_of(
            field!(Self, count),
            &[4, 6, 8],
            "Moments",
            "Numbers that describe the hair of a texel. More of them follow the hair more closely and need more memory and time.",
        ),
        Setting::choice::<MomentKind>(
            field!(Self, kind),
            "Kind",
            "Functions of depth whose means are stored. Trigonometric ones err less in the mean and take more time.",
        ),
        Setting::one_of(
            field!(Self, bits),
            &[16, 32],
            "Bits",
            "Bits of each moment. 16 bits need less memory and more bias, which blurs the shadow along the light.",
        ),
        Setting::number(
            field!(Self, bias),
            [0.0, 1000.0],
            "Bias",
            "Factor on the published share of even hair that is mixed into the moments. Without it noise shows where hair is thin or \
             lies in few places.",
        )
        .symbol("α")
        .unit(Unit::TIMES)
        .soft([0.0, 20.0]),
        Setting::number(
            field!(Self, overestimation),
            [0.0, 1.0],
            "Overestimation",
            "Share of the hair at a point's own depth that counts as before it. Higher values make the shadow darker.",
        )
        .unit(Unit::FRACTION),
        texels::depth_range(field!(Self, depth_range)),
    ];
}
