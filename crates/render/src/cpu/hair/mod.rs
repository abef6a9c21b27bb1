//! Strands on the processor: sorted into tiles, then drawn with analytic coverage.
//!
//! `blend` puts segments together from near to far as they come; `list` keeps every fragment of a tile, for the
//! ways of transparency that need them all.

pub(super) mod blend;
pub(super) mod list;
pub(super) mod order;
pub(super) mod segment;
