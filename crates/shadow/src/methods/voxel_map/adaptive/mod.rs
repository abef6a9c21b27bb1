//! Adaptive slices (an idea of the paper's section 6, after Mertens et al. 2004): the cells of a column hold equal shares of its hair.
//!
//! A column then needs few cells, so the memory of N³ cells has room for twice as many columns along each edge. They are never narrower
//! than a strand, because a strand in a narrower one would be too dark.

mod columns;
mod gpu;

pub use columns::Columns;

use super::super::texels::TexelMap;

/// The voxel map with adaptive slices on the CPU.
pub(super) type AdaptiveMap = TexelMap<Columns>;
