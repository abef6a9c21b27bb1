//! Everything that one picture shows.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::{HairLook, Hairstyle, Strands};
use lovelock_motion::{Body, Skin};

use crate::{Camera, Light, PictureSettings, ShadowSettings};

/// Everything that one picture shows, at one instant.
#[derive(Clone, Copy)]
pub struct FrameInput<'a> {
    /// The hairstyle that `strands` were interpolated from.
    pub style: &'a Arc<Hairstyle>,
    /// The strands, world space.
    pub strands: &'a Strands,
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
}

/// What one picture cost, and what went into it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Time to make the shadow maps and look them up at every strand point, milliseconds.
    pub shadow_ms: f64,
    /// Time to draw, milliseconds: until the commands were handed over, or until the picture was read back.
    pub draw_ms: f64,
    /// What the time to draw is made of, where the backend knows.
    pub draw: Option<DrawTimes>,
    /// Segments that were drawn.
    pub segments: u64,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Mean transmittance of the first light over the strands' points.
    pub mean_transmittance: f32,
}

/// The parts of the time to draw, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawTimes {
    /// The body as each light sees it.
    pub body_depth: f64,
    /// Strand points projected and shaded.
    pub points: f64,
    /// Segments and triangles sorted into tiles.
    pub sort: f64,
    /// Tiles drawn and put together.
    pub tiles: f64,
}
