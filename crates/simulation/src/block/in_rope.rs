//! The places of a block's guides in ropes; [`crate::rope`] finds and uses them.

use crate::lanes::{LANES, Lane};

/// Where the guides of a block lie in ropes.
#[derive(Clone, Debug)]
pub(crate) struct InRope {
    /// The rope of each lane; [`NO_ROPE`] for a loose guide.
    pub(crate) rope: [u32; LANES],
    /// Distance of each point beyond the tie, in spacings of the middle line; negative before it.
    pub(crate) place: Vec<Lane>,
    /// Distance of each point from the middle line at rest, metres.
    pub(crate) radius: Vec<Lane>,
}

/// Stands for the rope of a loose guide.
pub(crate) const NO_ROPE: u32 = u32::MAX;
