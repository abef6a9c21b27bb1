//! Scattering of hair in the settings of a picture.

use lovelock_appearance::fibre::{FibreTables, LOBES};

use crate::Light;

/// Fibres that light has crossed per unit of optical depth of the shadow maps: they store 0.15 per fibre by default, and the setting
/// *Extinction* becomes a factor on the density of hair.
pub(crate) const FIBRES_PER_DEPTH: f32 = 1.0 / 0.15;

/// Fibres that are subtracted from those that light crosses according to the maps. A stored strand stands for many hairs, and half of the
/// hairs that it puts into the map at a point lie behind that point on average.
pub(crate) const OWN_FIBRES: f32 = 0.5;

/// Further fibres that are subtracted where the eye looks along the light. A fibre that is visible to the eye has fewer fibres than average
/// before it, and these are also the fibres between it and the light.
pub(crate) const FACING_FIBRES: f32 = 0.6;

/// Sine of the largest inclination at which a strand is seen, 70 degrees, and its cosine. Fibres that are seen end on reflect like mirrors,
/// one in a hundred of a lock: at the few points of a strand, that looks like frost.
pub(crate) const MAX_INCLINED: f32 = 0.939_692_6;
/// See [`MAX_INCLINED`].
pub(crate) const LEAST_COSINE: f32 = 0.342_020_15;

/// The smallest transmittance that maps tell from none: half of a step of 8 bits.
pub(crate) const LEAST_TRANSMITTANCE: f32 = 1.0 / 510.0;

/// Variance of the directions from which the largest source sends light.
pub(crate) const LARGEST_SOURCE: f32 = 0.25;

/// Variances of the longitudinal lobes of one light: a large source widens them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FibreLight {
    pub variances: [f32; LOBES],
}

impl FibreLight {
    /// The lobes of a light whose share of sharp highlights is `specular`, 0 to 1.
    pub fn new(tables: &FibreTables, specular: f32) -> Self {
        let wider = LARGEST_SOURCE * (1.0 - specular.clamp(0.0, 1.0));
        Self { variances: tables.variances.map(|v| v + wider) }
    }
}

/// The lobes of the lights that are on.
pub(crate) fn lights<const N: usize>(tables: &FibreTables, lights: &[Light]) -> [FibreLight; N] {
    let mut out = [FibreLight::default(); N];
    for (out, light) in out.iter_mut().zip(lights.iter().filter(|light| light.enabled)) {
        *out = FibreLight::new(tables, light.normalized().specular);
    }
    out
}
