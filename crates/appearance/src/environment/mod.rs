//! Light from all directions: a sky above a ground, or a picture of the surroundings.
//!
//! Whatever the source, it is reduced once to two small things that a frame reads:
//!
//! - [`Surround`], nine coefficients per colour, for the light that reaches a surface with any normal;
//! - six radiances toward the axes, for the light that reaches hair through the hair around it.
//!
//! Both turn about the vertical axis every frame, without the picture.
//!
//! # Directions of a picture
//!
//! +Y is up. The picture is seen from its inside: the top row looks along +Y, the centre column along +Z, the
//! column at a quarter of the width along +X. That is the latitude-longitude map of `OpenEXR` (`ImfEnvmap.h`),
//! which the dome light of USD and the environment light of Mitsuba follow.
//!
//! # Units
//!
//! Radiance is in the units of the file, linear, with the primaries of Rec. 709: other chromaticities in a
//! file are ignored, and so is the `EXPOSURE` of a Radiance file, as most tools do.

mod axes;
mod backdrop;
mod error;
mod panorama;
mod picture;
mod project;
mod strongest;
mod surround;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::Vec3;

pub use self::backdrop::{
    BackdropError, BackdropPicture, BackdropPixels, BackdropProblem, MAX_BACKDROP_PIXELS, MAX_BACKDROP_SIDE,
};
pub use self::error::{EnvironmentError, MAX_FILE_BYTES, MAX_HEIGHT, MAX_WIDTH, Problem};
pub use self::panorama::{Panorama, Thumbnail};
pub use self::picture::{LARGEST_RADIANCE, Notes};
pub use self::strongest::Strongest;
pub use self::surround::Surround;

/// The source of the light from all directions.
#[derive(Clone, Debug)]
pub enum Environment {
    /// A uniform sky above the horizon and a uniform ground below it.
    SkyAndGround {
        /// Radiance from every direction above the horizon.
        sky: Vec3,
        /// Radiance from every direction below the horizon.
        ground: Vec3,
    },
    /// A picture of the surroundings.
    Picture(Arc<Panorama>),
}

impl Environment {
    /// The light on surfaces, with the surroundings turned by `turn` radians about +Y.
    ///
    /// A positive turn takes +Z to +X, which moves the picture to the left.
    pub fn surround(&self, turn: f32) -> Surround {
        match self {
            Self::SkyAndGround { sky, ground } => Surround::sky_and_ground(*sky, *ground),
            Self::Picture(panorama) => panorama.surround().turned(turn),
        }
    }

    /// Mean radiance from around each axis, in the order +X, -X, +Y, -Y, +Z, -Z, with the surroundings turned as
    /// in [`surround`](Self::surround).
    ///
    /// A direction `d` counts toward an axis `a` with `max(0, dot(d, a))^2`, the ambient cube of Mitchell et
    /// al. 2006, "Shading in Valve's Source Engine". The six weights sum to one in every direction, so the mean of the six is the mean over
    /// the sphere, and they are smooth, so a sun that turns past the border of two axes makes no step.
    pub fn axis_radiance(&self, turn: f32) -> [Vec3; 6] {
        match self {
            Self::SkyAndGround { sky, ground } => {
                let side = 0.5 * (*sky + *ground);
                [side, side, *sky, *ground, side, side]
            }
            Self::Picture(panorama) => panorama.axis_radiance(turn),
        }
    }
}
