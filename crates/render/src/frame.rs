//! Everything that one picture shows.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_gpu::PassTime;
use lovelock_groom::{GuideFrame, HairLook, Hairstyle, Strands, interpolate};
use lovelock_motion::{Body, Skin};

use crate::{Camera, KnownTransmittance, Light, PictureSettings, ShadowSettings};

/// Everything that one picture shows, at one instant.
#[derive(Clone, Copy)]
pub struct FrameInput<'a> {
    /// The hairstyle.
    pub style: &'a Arc<Hairstyle>,
    /// Where its strands are.
    pub hair: HairPose<'a>,
    /// Colour and width of the hair.
    pub look: &'a HairLook,
    /// The body and its skinned surface; hair alone is drawn where there is none.
    pub body: Option<(&'a Arc<Body>, &'a Skin)>,
    /// Where the head is: the shadow map's lattice is locked to it.
    pub world_from_head: Affine3A,
    /// The lights; those beyond [`crate::MAX_LIGHTS`] are ignored.
    pub lights: &'a [Light],
    /// How hair shadows itself.
    pub shadow: &'a ShadowSettings,
    /// Where the picture is taken from.
    pub camera: &'a Camera,
    /// Settings of the picture as a whole.
    pub picture: &'a PictureSettings,
    /// Transmittance that takes the place of what the shadow method says; the CPU backend alone draws it.
    pub known: Option<KnownTransmittance<'a>>,
}

/// Where the strands of a hairstyle are at one instant, world space.
#[derive(Clone, Copy, Debug)]
pub enum HairPose<'a> {
    /// Where their guides bring them: they are interpolated where they are drawn.
    Guides(&'a GuideFrame),
    /// As they are given: as many points as the hairstyle has.
    Strands(&'a Strands),
}

impl HairPose<'_> {
    /// The strands on the processor: those that are given, or interpolated into `made`.
    pub(crate) fn strands<'s>(&'s self, style: &Hairstyle, made: &'s mut Strands) -> &'s Strands {
        match self {
            Self::Strands(strands) => strands,
            Self::Guides(guides) => {
                interpolate(style, guides, made);
                made
            }
        }
    }
}

/// What one picture cost, and what went into it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Time to make strands of guides, milliseconds; 0 where the device does not measure its passes.
    pub interpolate_ms: f64,
    /// Time to make the shadow maps and look them up at every strand point, milliseconds; 0 as above.
    pub shadow_ms: f64,
    /// The rest of the time until the picture was there, milliseconds.
    pub draw_ms: f64,
    /// What the passes took, in their order: `shadow/…` and `draw/…`, those of all lights together. As far as the backend
    /// measures them.
    pub passes: Vec<PassTime>,
    /// Segments that were drawn.
    pub segments: u64,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Bytes of the strands as they are drawn and of what is kept for the pixels, to put strands together in them.
    pub draw_bytes: u64,
    /// Mean transmittance of the first light over the strands' points.
    pub mean_transmittance: f32,
}

impl FrameStats {
    /// Time to make the shadow maps, milliseconds: all passes `shadow/…` but those of [`FrameStats::ask_ms`]; 0 where the
    /// device does not measure its passes.
    pub fn build_ms(&self) -> f64 {
        self.sum_ms(|name| name.starts_with("shadow/") && !ASKING.contains(&name))
    }

    /// Time to read the shadow maps at strand points and at vertices of the body, and what lies behind all hair,
    /// milliseconds; 0 where the device does not measure its passes.
    pub fn ask_ms(&self) -> f64 {
        self.sum_ms(|name| ASKING.contains(&name))
    }

    fn sum_ms(&self, of: impl Fn(&str) -> bool) -> f64 {
        self.passes.iter().filter(|pass| of(&pass.name)).map(|pass| pass.ms).fold(0.0, |sum, ms| sum + ms)
    }
}

/// Passes that read maps which are made.
const ASKING: [&str; 2] = ["shadow/ask", "shadow/columns"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn building_and_asking_are_told_apart_by_the_names_of_passes() {
        let names = [
            "interpolate/strands",
            "shadow/fill",
            "shadow/ask",
            "draw/ask",
            "shadow/columns",
            "shadow/asking",
        ];
        let passes = names.iter().zip([1.0, 2.0, 4.0, 8.0, 16.0, 32.0]);
        let passes = passes.map(|(name, ms)| PassTime { name: (*name).to_owned(), ms }).collect();
        let stats = FrameStats { passes, ..FrameStats::default() };
        assert_eq!((stats.build_ms(), stats.ask_ms()), (34.0, 20.0));
        let nothing = FrameStats::default();
        assert_eq!((nothing.build_ms(), nothing.ask_ms()), (0.0, 0.0));
    }
}
