//! The outline of the scalp of the shipped dancer, relative to her skull.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;

use super::ScalpFit;

/// Elevation of the hairline, degrees, at every tenth degree from the front to the back, seen from the middle of the skull and
/// relative to its size. Measured on the shipped dancer; a test measures it again.
pub(super) const HAIRLINE: [f32; 19] = [
    27.0, 30.0, 28.0, 28.0, 24.0, 19.0, 9.0, -7.0, -29.0, -21.0, -23.0, -35.0, -53.0, -63.0, -64.0, -64.0,
    -65.0, -65.0, -65.0,
];

/// Half of the angle over which the mask fades at the hairline, degrees.
const FADE: f32 = 3.0;

/// The angle from the front, 0 to π, and the elevation of a direction, radians.
pub(super) fn angles(direction: Vec3) -> (f32, f32) {
    let across = direction.x.hypot(direction.z);
    (direction.x.abs().atan2(direction.z), direction.y.atan2(across))
}

/// Elevation of the hairline of the outline at an angle from the front, 0 to π, radians.
pub(super) fn hairline(azimuth: f32, fit: &ScalpFit) -> f32 {
    let at = (azimuth.to_degrees() / 10.0).clamp(0.0, 18.0);
    let i = (at as usize).min(17);
    let line = HAIRLINE[i] + (HAIRLINE[i + 1] - HAIRLINE[i]) * (at - i as f32);
    line.to_radians() + fit.raised(azimuth)
}

/// The mask of the outline in a direction relative to the skull: 1 above the hairline, 0 below it.
pub(super) fn mask(direction: Vec3, fit: &ScalpFit) -> f32 {
    let (azimuth, elevation) = angles(fit.to_outline(direction));
    let above = (elevation - hairline(azimuth, fit)).to_degrees();
    smoothstep(-FADE, FADE, above)
}
