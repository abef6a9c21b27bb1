//! The layout of frames: guides and points per guide. It may change from chunk to chunk.

use super::bytes::Bytes;

/// The most guide points of a frame: ten times as many as the largest hairstyle has.
pub const MAX_GUIDE_POINTS: u64 = 1 << 20;

/// Number of guides and points per guide of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) guides: usize,
    pub(super) points: usize,
}

/// Bytes of a layout in the file.
pub(super) const LAYOUT_BYTES: usize = 8;

impl Layout {
    /// A layout of `guides` guides with `points` points each. An error is what was found and what is valid.
    pub(super) fn new(guides: u32, points: u32) -> Result<Self, (String, String)> {
        if guides == 0 || points < 2 || u64::from(guides) * u64::from(points) > MAX_GUIDE_POINTS {
            return Err((
                format!("{guides} guides of {points} points"),
                format!(
                    "at least 1 guide of at least 2 points, and at most {MAX_GUIDE_POINTS} points in all"
                ),
            ));
        }
        Ok(Self { guides: guides as usize, points: points as usize })
    }

    /// Number of integers of one frame. They are ordered by axis, then by point from the root, then by guide: the index is
    /// `(axis * points + point) * guides + guide`.
    pub(super) fn numbers(self) -> usize {
        3 * self.guides * self.points
    }

    pub(super) fn write(self, out: &mut Vec<u8>) {
        out.extend((self.guides as u32).to_le_bytes());
        out.extend((self.points as u32).to_le_bytes());
    }

    pub(super) fn read(bytes: &mut Bytes<'_>) -> Result<Self, String> {
        let (Some(guides), Some(points)) = (bytes.u32(), bytes.u32()) else {
            return Err("frames without their layout".to_owned());
        };
        Self::new(guides, points).map_err(|(found, wanted)| format!("{found}; must be {wanted}"))
    }
}

/// The number of guides and points from one frame of a take on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TakeLayout {
    /// The first frame with this layout.
    pub first_frame: u64,
    /// Number of guide strands.
    pub guides: u32,
    /// Points per guide.
    pub points_per_guide: u32,
}
