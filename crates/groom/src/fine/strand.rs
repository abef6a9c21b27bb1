//! One strand of the list of fine strands.

use glam::Vec3;

/// Root, middle and tip of a strand at rest.
pub(super) type Shape = [Vec3; 3];

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
    /// Its length as a fraction of its parents' length, in 65,535ths.
    pub length: u16,
    /// Its shade, 0 to 255; see [`StrandSet::shade`](crate::StrandSet).
    pub shade: u8,
    /// Unused; 0.
    pub spare: u8,
}
