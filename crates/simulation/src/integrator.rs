//! The choice of integrator, the method that preserves link lengths.

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// How the length of links is preserved. Everything else in a substep (forces, shape memory, collisions,
/// friction, grid, wind) is the same, so that two runs differ only by the method. Only [`Integrator::Direct`]
/// has the measures that keep contacts calm in the placement pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Solves a whole chain directly, first for velocities and then for positions, followed by one exact
    /// pass.
    #[default]
    Direct,
    /// Points move freely, and sweeps along the chain restore one link after the other (van Overveld 1991, as
    /// used by Bertails, Ménier and Cani 2005). Hair stretches.
    Relaxation,
    /// Every point is pulled behind its predecessor, and velocities are corrected for it (dynamic
    /// follow-the-leader; Müller, Kim, Chentanez 2012). Fast, but the motion depends on the number of
    /// substeps.
    FollowTheLeader,
}

impl Integrator {
    /// Every method, the default first.
    pub const ALL: [Self; 3] = [Self::Direct, Self::Relaxation, Self::FollowTheLeader];
}

impl Choices for Integrator {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Direct => ("direct", "Direct"),
            Self::Relaxation => ("relaxation", "Relaxation, as published"),
            Self::FollowTheLeader => ("follow-the-leader", "Follow the leader"),
        }
    }
}

/// Upper limit of sweeps per substep of [`Integrator::Relaxation`].
pub const MAX_SWEEPS: u32 = 200;
