//! The interface of a method with a record per texel.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use std::fmt::Debug;

use super::fragments::Fragment;
use super::{MAP_MEMORY_LIMIT_BYTES, TexelFilter, TexelFrame};
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The profile across a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LineProfile {
    /// A step of a strand is one fragment.
    Thin,
    /// A step is shared by the two nearest texels.
    TwoTexels,
    /// A Gaussian whose standard deviation is this many widths of a strand.
    Gaussian(f32),
}

/// What a method may need of a map before its records are filled.
#[derive(Clone, Copy, Debug)]
pub struct MapScale<'a> {
    /// The texels.
    pub frame: &'a TexelFrame,
    /// Factor on the optical depth of every strand, not negative and finite.
    pub extinction_scale: f32,
    /// Optical depth of a piece of strand whose length across the light is one texel.
    pub depth_per_texel: f32,
}

impl MapScale<'_> {
    /// Optical depth of one unit of the weights in which the GPU sums fragments: 1/1024 of a texel's length.
    pub(crate) fn depth_per_weight(&self) -> f32 {
        self.depth_per_texel / WEIGHT_ONE
    }
}

/// The weight of a piece of strand whose length across the light is one texel. Twin of the constant in frame.wgsl.
pub(crate) const WEIGHT_ONE: f32 = 1024.0;

/// A method with a record per texel. The value holds the method's settings, clamped to their ranges.
pub trait TexelMethod: Copy + Debug + Send + Sync {
    /// The element of a record.
    type Cell: Copy + Debug + Default + Send + Sync;

    /// The key of the method.
    const METHOD: ShadowMethod;

    /// Whether [`TexelMethod::depth_before`] receives the fragments as [`TexelMethod::fill`] left them. Otherwise it receives none.
    const READS_FRAGMENTS: bool = false;

    /// The method with its section of `settings`.
    fn new(settings: &ShadowSettings) -> Self;

    /// The method for the texels of one map.
    fn within(self, _scale: &MapScale) -> Self {
        self
    }

    /// The most texels along each edge, one of [`TEXEL_RESOLUTIONS`](super::TEXEL_RESOLUTIONS).
    fn resolution(&self) -> u32;

    /// How a point reads the texels around it.
    fn filter(&self) -> TexelFilter;

    /// The profile of the lines as which strands are drawn.
    fn profile(&self) -> LineProfile {
        LineProfile::Thin
    }

    /// The most memory that the map and its build may use together, bytes.
    fn memory_limit_bytes(&self) -> u64 {
        MAP_MEMORY_LIMIT_BYTES
    }

    /// Cells of one record.
    fn cells(&self) -> usize;

    /// Computes the record of a texel from its fragments, of which there is at least one. They have the order of the strands
    /// and may be reordered. `record` has [`TexelMethod::cells`] cells with arbitrary content.
    fn fill(&self, fragments: &mut [Fragment], record: &mut [Self::Cell]);

    /// The first and the last cell of a record that [`TexelMethod::depth_before`] reads for `depth`. This only affects speed.
    #[inline(always)]
    fn reads(&self, _depth: f32) -> [usize; 2] {
        [0, self.cells().saturating_sub(1)]
    }

    /// Optical depth of the texel's hair before `depth`, which is 0 to 1 within the depth range of the hair and larger behind it.
    fn depth_before(&self, fragments: &[Fragment], record: &[Self::Cell], depth: f32) -> f32;

    /// Whether a record could not be read as it should be, and is read in a simpler way: counted in
    /// [`ShadowReport::fallbacks`](crate::ShadowReport::fallbacks).
    fn falls_back(&self, _record: &[Self::Cell]) -> bool {
        false
    }

    /// Calls `put` for each piece of a record with its kind, its start and end depth and its optical depth. Pieces of one kind
    /// come in the order of depth.
    fn pieces(
        &self,
        fragments: &[Fragment],
        record: &[Self::Cell],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    );
}
