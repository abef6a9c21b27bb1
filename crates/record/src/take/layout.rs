//! The size of a frame, which may change from chunk to chunk.

use super::bytes::Bytes;

/// The most guide points that a take can hold: ten times what the largest hairstyle has.
pub const MOST_GUIDE_POINTS: u64 = 1 << 20;

/// The size of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) guides: usize,
    pub(super) points: usize,
}

/// Bytes of a layout in a file.
pub(super) const LAYOUT_BYTES: usize = 8;

impl Layout {
    /// So many guides of so many points; says what would be right where no take can hold them.
    pub(super) fn new(guides: u32, points: u32) -> Result<Self, (String, String)> {
        if guides == 0 || points < 2 || u64::from(guides) * u64::from(points) > MOST_GUIDE_POINTS {
            return Err((
                format!("{guides} guides of {points} points"),
                format!("1 guide or more of 2 points or more, {MOST_GUIDE_POINTS} points in all at most"),
            ));
        }
        Ok(Self { guides: guides as usize, points: points as usize })
    }

    /// Whole numbers of one frame. They lie axis after axis, point after point from the root, guide after guide:
    /// number `(axis * points + point) * guides + guide`.
    pub(super) fn numbers(self) -> usize {
        3 * self.guides * self.points
    }

    pub(super) fn write(self, out: &mut Vec<u8>) {
        out.extend((self.guides as u32).to_le_bytes());
        out.extend((self.points as u32).to_le_bytes());
    }

    pub(super) fn read(bytes: &mut Bytes<'_>) -> Result<Self, String> {
        let (Some(guides), Some(points)) = (bytes.u32(), bytes.u32()) else {
            return Err("frames whose size is missing".to_owned());
        };
        Self::new(guides, points).map_err(|(found, wanted)| format!("{found}; wanted {wanted}"))
    }
}

/// From which frame on the frames of a take have how many guides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TakeLayout {
    /// The first frame of that size.
    pub first_frame: u64,
    /// Guide strands.
    pub guides: u32,
    /// Points of one guide.
    pub points_per_guide: u32,
}
