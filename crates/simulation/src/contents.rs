//! Which content a device holds already.

use std::sync::atomic::{AtomicU64, Ordering};

/// Identifies a content that changes from time to time: equal stamps stand for equal contents, also those of copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(u64);

impl Stamp {
    /// A stamp that no content has had.
    pub(crate) fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// The stamps of a simulation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stamps {
    /// What does not change during a motion: rest shapes, ties, factors, ropes.
    pub(crate) guides: Stamp,
    /// Distances at rest to colliders and field.
    pub(crate) distances: Stamp,
    /// Positions, velocities and what else is carried from step to step.
    pub(crate) state: Stamp,
}

impl Stamps {
    pub(crate) fn new() -> Self {
        Self { guides: Stamp::new(), distances: Stamp::new(), state: Stamp::new() }
    }
}
