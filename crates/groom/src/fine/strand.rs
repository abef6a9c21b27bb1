//! One strand of the list of fine strands.

/// One strand of the list, 24 bytes.
///
/// Its points are those of a polyline `q` cut at `length`, where `q_j = a_j + b(t) (b_j - a_j) + c(t) (c_j - a_j)` at the fraction `t` of
/// its parents' polylines `a`, `b` and `c`. The weights `b(t)` and `c(t)` are cubic Bézier curves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct FineStrand {
    /// Stored strands between which it lies. It is close to the first one; all three are the same for a stored strand itself.
    pub parents: [u32; 3],
    /// Control points of the weights of the second and the third parent, as signed bytes in 127ths.
    pub weights: [[i8; 4]; 2],
    /// Its length in 65,535ths: of its first parent's length, or of [`Self::SHORT_METRES`] if it is a short hair.
    pub length: u16,
    /// Its shade, 0 to 255; see [`StrandSet::shade`](crate::StrandSet).
    pub shade: u8,
    /// 1 for a short hair of the hairline, whose length does not depend on that of its parents; otherwise 0.
    pub is_short: u8,
}

impl FineStrand {
    /// The length of a short hair that has the largest number, metres.
    pub const SHORT_METRES: f32 = 0.1;

    /// What it has of a number that each stored strand has: that at its root, between those of its parents. Parents that do not exist
    /// count as 0.
    pub fn blend(&self, of_strands: &[f32]) -> f32 {
        let of = |k: usize| of_strands.get(self.parents[k] as usize).copied().unwrap_or(0.0);
        let weight = |k: usize| f32::from(self.weights[k][0]) / 127.0;
        of(0) + weight(0) * (of(1) - of(0)) + weight(1) * (of(2) - of(0))
    }

    /// Its length as a fraction of its first parent's length, which `parent_length` returns in metres.
    #[inline]
    pub(super) fn fraction(&self, parent_length: impl FnOnce() -> f32) -> f32 {
        let length = f32::from(self.length) * (1.0 / 65_535.0);
        if self.is_short == 0 {
            return length;
        }
        // Also whole beside a parent whose length is not a number.
        (length * Self::SHORT_METRES / parent_length().max(1e-3)).min(1.0)
    }
}
