//! How pigment varies between strands and along them.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use lovelock_appearance::fibre::arithmetic::{clamp, floor, smoothstep};
use lovelock_base::settings::Settings as _;

use crate::HairLook;
use crate::fine::LOCK_NUMBERS;

/// The multiple of the shade whose fraction decides which strands are grey; twin of `WHITENING` in `strand_points.wgsl`.
pub const WHITENING: f32 = 97.381;
/// What is left of the pigment in grey strands.
pub const UNPIGMENTED: f32 = 0.03;
/// The fraction of a strand's length from the root over which lightening begins.
pub const PAINTED_FROM: f32 = 0.2;

/// How pigment varies between strands and along them, as factors on that of the hair. See the settings of the same names in [`HairLook`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PigmentVariation {
    /// See [`HairLook::variation`].
    pub variation: f32,
    /// See [`HairLook::tip_lightening`].
    pub tip_lightening: f32,
    /// See [`HairLook::grey`].
    pub grey: f32,
    /// See [`HairLook::highlights`].
    pub highlights: f32,
    /// See [`HairLook::highlight_lightening`].
    pub lightening: f32,
}

impl PigmentVariation {
    /// That of a look.
    pub fn of(look: &HairLook) -> Self {
        let HairLook { variation, tip_lightening, grey, highlights, highlight_lightening, .. } =
            look.clamped();
        Self { variation, tip_lightening, grey, highlights, lightening: highlight_lightening }
    }

    /// The part of [`Self::factor`] by which strands of that shade differ by nature, whatever their colour.
    ///
    /// Twin of `varied` in `strand_points.wgsl`.
    #[inline(always)]
    pub fn varied(&self, shade: f32) -> f32 {
        clamp(1.0 + self.variation * (2.0 * shade - 1.0), 0.0, f32::MAX)
    }

    /// The factor at the fraction `along` of a strand from its root. `shade` is that of the strand, 0 to 1, and `lock` the number of its
    /// lock, 0 to 63 (see [`lock_numbers`](crate::fine::lock_numbers)).
    ///
    /// Twin of `pigment_of` in `strand_points.wgsl`.
    #[inline(always)]
    pub fn factor(&self, along: f32, shade: f32, lock: i32) -> f32 {
        let lock = lock as f32 * (1.0 / LOCK_NUMBERS as f32);
        let lightened = 1.0 - self.tip_lightening * smoothstep(0.2, 1.0, along);
        let fraction = shade * WHITENING - floor(shade * WHITENING);
        let whitened = if fraction < self.grey { UNPIGMENTED } else { 1.0 };
        let painted = if lock < self.highlights { smoothstep(0.0, PAINTED_FROM, along) } else { 0.0 };
        self.varied(shade) * lightened * whitened * (1.0 - self.lightening * painted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_setting_lightens_what_it_names() {
        let even = PigmentVariation::default();
        for (along, shade, lock) in [(0.0, 0.0, 0), (0.5, 0.3, 17), (1.0, 1.0, 63)] {
            assert_eq!(even.factor(along, shade, lock), 1.0);
        }
        let tips = PigmentVariation { tip_lightening: 0.5, ..even };
        assert_eq!([0.0, 0.1, 1.0].map(|along| tips.factor(along, 0.5, 0)), [1.0, 1.0, 0.5]);
        let varied = PigmentVariation { variation: 0.25, ..even };
        assert_eq!([0.0, 0.5, 1.0].map(|shade| varied.factor(0.5, shade, 0)), [0.75, 1.0, 1.25]);
        let locks = PigmentVariation { highlights: 0.25, lightening: 0.6, ..even };
        let lightened = (0..LOCK_NUMBERS as i32).filter(|&lock| locks.factor(1.0, 0.5, lock) < 0.5).count();
        assert_eq!(lightened, 16);
        assert_eq!(locks.factor(0.0, 0.5, 0), 1.0, "not at the root");
        let grey = PigmentVariation { grey: 0.3, ..even };
        let white = (0..1000).filter(|&i| grey.factor(0.5, i as f32 / 1000.0, 0) == UNPIGMENTED).count();
        assert!((280..320).contains(&white), "{white}");
    }
}
