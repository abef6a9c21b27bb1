//! The panels beside the image.

mod background;
pub(crate) mod body;
pub(crate) mod body_look;
mod brows;
pub(crate) mod camera;
pub(crate) mod colliders;
pub(crate) mod face;
pub(crate) mod hair;
pub(crate) mod health;
pub(crate) mod layers;
pub(crate) mod light;
pub(crate) mod look;
mod pigments;
pub(crate) mod recording;
pub(crate) mod records;
pub(crate) mod scalp;
pub(crate) mod shadow;
pub(crate) mod simulation;
pub(crate) mod sound;
pub(crate) mod statistics;
pub(crate) mod surroundings;
mod swatch;
pub(crate) mod ties;

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) use tests::{Bench, clicks};
