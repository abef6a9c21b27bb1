//! Which method keeps the links at their length.

use serde::{Deserialize, Serialize};

/// How the length of links is kept. Everything else of a substep (forces, shape memory, collisions, friction,
/// grid, wind) is the same, so that what differs between two runs is the method; what keeps contacts calm in the
/// clean-up pass belongs to [`Integrator::Direct`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// The direct solution of a whole chain, on velocities and then on positions, and one exact pass.
    #[default]
    Direct,
    /// Points move freely and sweeps along the chain restore one link after the other (van Overveld 1991, as
    /// Bertails, Ménier and Cani 2005 used it). Hair stretches.
    Relaxation,
    /// Every point is pulled behind the one before, and velocities are corrected for it (dynamic
    /// follow-the-leader; Müller, Kim, Chentanez 2012). Quick; its motion depends on the number of substeps.
    FollowTheLeader,
}

impl Integrator {
    /// Every method, the usual one first.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Relaxation, Self::FollowTheLeader];
}

/// The most sweeps that one substep of [`Integrator::Relaxation`] may take.
pub const MAX_SWEEPS: u32 = 200;
