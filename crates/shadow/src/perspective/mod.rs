//! Light that spreads from a place, below all methods: its rays are made parallel.
//!
//! A point becomes its distance from the light, along its ray, and the place at which the ray crosses a plane as far away as the
//! hair. There rays are parallel, and each method builds its map as for a directional light: texels and cells divide the directions
//! of the light evenly on that plane (Bertails et al. 2005 call this mapping Ψ′; Mertens et al. 2004, section 3.4). A strand becomes
//! wider as far as it is nearer to the light than the plane, so that the optical depth along a ray stays that of the hair.
//!
//! Light that has all hair before it, within [`STEEPEST`], needs one plane; otherwise there are six, the sides of a cube around it.

pub mod cube;
mod face;
mod gpu;
mod map;
mod ray;
mod strands;

pub(crate) use face::{Face, Perspective, margin};
pub(crate) use gpu::{GpuLightMaps, MakeGpuShadow};
pub(crate) use map::{LightMap, perspective_of};
pub(crate) use ray::Ray;
pub(crate) use strands::{PARALLEL, Projected};

/// The largest tangent of the angle between hair and the middle of the only plane: 60 degrees.
pub(crate) const STEEPEST: f32 = 1.732_050_8;

/// The largest factor on the width of a strand. It keeps the sums of maps in their range; a strand that is this much wider hides what
/// is behind it anyway.
pub(crate) const MAX_WIDENING: f32 = 32.0;
