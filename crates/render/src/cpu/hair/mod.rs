//! Strands on the CPU: sorted into tiles, then rasterised with analytic coverage.
//!
//! `blend` blends segments from near to far into the `state` of a tile, and `weigh` does so before their light is known; `list` keeps the
//! fragments of a tile, for the transparency modes that need them: all, or those that `opaque_depths` does not find hidden.

pub(super) mod blend;
pub(super) mod fragments;
pub(super) mod list;
pub(super) mod opaque_depths;
pub(super) mod order;
pub(super) mod state;
pub(super) mod weigh;
