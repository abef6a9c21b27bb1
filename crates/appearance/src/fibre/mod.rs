//! Light scattered by one hair fibre and by many.
//!
//! The model is that of Chiang, Bitterli, Tappan and Burley, "A Practical and Controllable Hair and Fur Model for Production Path
//! Tracing" (2016), in the form that pbrt gives it. [`near_field`] is the definition in double precision.
//!
//! Angles: theta is the inclination of a direction to the plane normal to the strand, and sin(theta) is its dot product with the
//! strand's tangent, which points from root to tip. phi is the azimuth between light and eye around the strand. The letter o
//! marks the direction to the eye and i the direction to the light.
//!
//! Every scattering function here already contains the cosine of the light. The outgoing radiance of a strand is the irradiance
//! on a surface perpendicular to the light, times the function, without any factor of pi.

pub mod arithmetic;
mod azimuthal;
mod longitudinal;
mod many;
mod many_table;
mod parameters;
pub mod pigment;
mod quadrature;
mod scattering;
mod table;

pub use azimuthal::{FibrePath, TrimmedLogistic};
pub use longitudinal::{LongitudinalLobe, longitudinal, variances};
pub use many::{FibreTables, MAX_FIBRES, PointLight, PointScatter};
pub use many_table::{ABSORPTIONS, ManyRow, ManyTable, backscattered, position};
pub use parameters::Fibre;
pub use quadrature::Quadrature;
pub use scattering::{Directions, azimuthal_distribution, far_field, near_field, near_field_with};
pub use table::{
    AZIMUTHS, COSINES, CosineStep, SMALLEST_COSINE, SMOOTHEST_AROUND, ScatterRow, ScatterTable, distributions,
};

/// Lobes of the model: R, TT, TRT, and all longer paths together.
pub const LOBES: usize = 4;
