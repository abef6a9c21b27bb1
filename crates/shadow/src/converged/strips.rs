//! The light plane, divided into strips to bound memory.

use std::ops::Range;

use lovelock_base::settings::Settings;

use super::ribbons::Ribbons;
use crate::methods::texels::TexelFrame;
use crate::methods::texels::fragments::{BYTES_PER_FRAGMENT, curved, for_each_segment};
use crate::methods::texels::lines::Along;
use crate::{ShadowError, ShadowInput, ShadowMethod, ShadowSettings};

/// The target memory of a strip within the limit, bytes.
const STRIP_BYTES: u64 = 512 << 20;

/// Ranges of rows of subtexels that are processed one after another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Strips {
    pub rows: Vec<Range<u32>>,
}

impl Strips {
    /// Strips of about equal memory.
    pub(super) fn new(
        input: &ShadowInput,
        settings: &ShadowSettings,
        frame: &TexelFrame,
        ribbons: &Ribbons,
    ) -> Result<Self, ShadowError> {
        let mut fragments = vec![0_u64; frame.resolution as usize];
        for_each_segment(input, frame, 0..input.strands.count(), |from, to, first| {
            let along = input.projected.as_ref().map(|projected| curved(input, frame, projected, first));
            let widest = along.map_or(1.0, |along| along.widest());
            ribbons.bound((from, to), widest, |row, count| {
                let sum = &mut fragments[row as usize];
                *sum = sum.saturating_add(count);
            });
        });
        let limit = input.share_of(settings.exact.clamped().memory_limit_bytes);
        // An index of two numbers per subtexel, and the fragments.
        let row_bytes = |texel_row: usize| {
            let fragments = fragments[texel_row].div_ceil(u64::from(ribbons.samples));
            fragments.saturating_mul(BYTES_PER_FRAGMENT).saturating_add(u64::from(ribbons.columns()) * 8)
        };
        let mut rows = Vec::new();
        let (mut start, mut bytes) = (0, 0_u64);
        for row in 0..frame.resolution * ribbons.samples {
            let more = row_bytes((row / ribbons.samples) as usize);
            if more > limit {
                return Err(ShadowError::TooLarge {
                    method: ShadowMethod::Exact,
                    needed_bytes: more,
                    limit_bytes: limit,
                    maps: input.maps.max(1),
                });
            }
            if row > start && bytes + more > STRIP_BYTES.min(limit) {
                rows.push(start..row);
                (start, bytes) = (row, 0);
            }
            bytes += more;
        }
        rows.push(start..frame.resolution * ribbons.samples);
        Ok(Self { rows })
    }
}
