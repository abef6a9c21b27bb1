//! Settings of the picture as a whole, and the finished picture.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Backend, RenderError, Transparency};

/// The longest side of a picture, pixels.
pub const MOST_SIDE: u32 = 8192;

/// The most pixels of a picture: 8192 by 4320, a little more than 8K video.
pub const MOST_PIXELS: u64 = 8192 * 4320;

/// Returns an error for sizes that no backend supports.
///
/// # Errors
/// The size with the limit.
pub fn check_size(width: u32, height: u32) -> Result<(), RenderError> {
    check_size_for(width, height, MOST_SIDE)
}

/// Returns an error for sizes out of range. `limit` is the longest side that the backend supports.
pub(crate) fn check_size_for(width: u32, height: u32, limit: u32) -> Result<(), RenderError> {
    let limit = limit.min(MOST_SIDE);
    let fits = (1..=limit).contains(&width) && (1..=limit).contains(&height);
    if fits && u64::from(width) * u64::from(height) <= MOST_PIXELS {
        Ok(())
    } else {
        Err(RenderError::Size { width, height, limit })
    }
}

/// Settings of the picture as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureSettings {
    /// Exposure in stops relative to the default: -6 to 6.
    pub exposure_stops: f32,
    /// Brightness of the light that comes from everywhere: 0 to 4.
    pub ambient: f32,
    /// Background at the upper edge, linear sRGB.
    pub background_top: Vec3,
    /// Background at the horizon, linear sRGB.
    pub background_bottom: Vec3,
    /// Whether the ground is drawn, with the shadows on it.
    pub ground: bool,
    /// How overlapping strands are put together.
    pub transparency: Transparency,
    /// Opacity of a strand where it covers a pixel wholly: 0.05 to 1.
    pub strand_opacity: f32,
    /// What draws.
    pub backend: Backend,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            exposure_stops: 0.0,
            ambient: 0.5,
            background_top: Vec3::new(0.055, 0.062, 0.075),
            background_bottom: Vec3::new(0.20, 0.215, 0.235),
            ground: true,
            transparency: Transparency::default(),
            strand_opacity: 0.85,
            backend: Backend::default(),
        }
    }
}

impl PictureSettings {
    /// A copy whose every value is finite and in range.
    pub fn clamped(&self) -> Self {
        let default = Self::default();
        let finite = |v: f32, low: f32, high: f32, default: f32| {
            if v.is_finite() { v.clamp(low, high) } else { default }
        };
        let color = |v: Vec3, d: Vec3| {
            if v.is_finite() { v.clamp(Vec3::ZERO, Vec3::splat(4.0)) } else { d }
        };
        Self {
            exposure_stops: finite(self.exposure_stops, -6.0, 6.0, 0.0),
            ambient: finite(self.ambient, 0.0, 4.0, default.ambient),
            background_top: color(self.background_top, default.background_top),
            background_bottom: color(self.background_bottom, default.background_bottom),
            ground: self.ground,
            transparency: self.transparency,
            strand_opacity: finite(self.strand_opacity, 0.05, 1.0, default.strand_opacity),
            backend: self.backend,
        }
    }
}

/// A finished picture in memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Rows from the top, four bytes per pixel: red, green, blue (sRGB-encoded) and alpha.
    pub rgba: Vec<u8>,
}
