//! Lists of fragments for methods that store all of them. Their number is known only after the GPU has counted them.
//!
//! An item has two words. The first two items are the header: the number of fragments modulo 2³², and the sum over workgroups of
//! their counts divided by 2¹⁶. Together they give the number even if it exceeds a word.

use lovelock_gpu::{Gpu, GpuError, ShaderPart, read_buffer, wgpu};

use crate::gpu::{Buffer, GpuList, fits_device, wgsl};
use crate::{ShadowError, ShadowMethod};

/// Counts fragments and allocates ranges of the list.
pub(crate) const LIST_HEAD: ShaderPart = wgsl!("methods/texels/gpu/", "list_head.wgsl");
/// Reads and writes fragments.
pub(crate) const LIST_BODY: ShaderPart = wgsl!("methods/texels/gpu/", "list_body.wgsl");

const HEAD_BYTES: u64 = 16;
const ITEM_BYTES: u64 = 8;

/// The least capacity, fragments.
const LEAST_ROOM: u64 = 1024;

/// The memory budget of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    pub method: ShadowMethod,
    /// The most bytes that the method may use for this map.
    pub limit_bytes: u64,
    /// Bytes of these that other buffers use.
    pub other_bytes: u64,
    /// The number of maps that share the limit.
    pub maps: u32,
}

impl Share {
    /// Returns an error if `items` fragments do not fit.
    fn check(&self, gpu: &Gpu, items: u64) -> Result<(), ShadowError> {
        let bytes = bytes(items);
        let (method, limit_bytes, maps) = (self.method, self.limit_bytes, self.maps);
        let needed_bytes = self.other_bytes.saturating_add(bytes);
        if needed_bytes > limit_bytes {
            return Err(ShadowError::TooLarge { method, needed_bytes, limit_bytes, maps });
        }
        fits_device(gpu, method, bytes)
    }

    /// The most fragments that fit.
    fn most(&self, gpu: &Gpu) -> u64 {
        let bytes = self.limit_bytes.saturating_sub(self.other_bytes).min(gpu.most_storage_bytes());
        bytes.saturating_sub(HEAD_BYTES) / ITEM_BYTES
    }
}

fn bytes(items: u64) -> u64 {
    HEAD_BYTES.saturating_add(items.saturating_mul(ITEM_BYTES))
}

/// The list of one map.
#[derive(Debug)]
pub(crate) struct List {
    buffer: Buffer,
    /// The budget of the last build.
    share: Option<Share>,
    /// Fragments of the last build that was counted.
    found: u64,
}

impl List {
    pub fn new(gpu: &Gpu) -> Self {
        Self { buffer: Buffer::new(gpu, "shadow list"), share: None, found: 0 }
    }

    pub fn raw(&self) -> &wgpu::Buffer {
        self.buffer.raw()
    }

    pub fn memory_bytes(&self) -> u64 {
        self.buffer.bytes()
    }

    /// Fragments of the last build that was counted.
    pub fn found(&self) -> u64 {
        self.found
    }

    /// The words of the list, including the header.
    pub fn words(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let mut words = vec![0; bytes(self.found).min(self.buffer.bytes()) as usize / 4];
        read_buffer(gpu, self.buffer.raw(), &mut words)?;
        Ok(words)
    }

    /// Makes room for a little more than the last build needed, or for an estimate, within the budget. Encodes clearing the list.
    pub fn begin(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, share: Share, segments: u32) {
        let wanted = if self.found == 0 { 2 * u64::from(segments) } else { self.found + self.found / 8 };
        self.buffer.fit(gpu, bytes(wanted.max(LEAST_ROOM).min(share.most(gpu))) / 4);
        encoder.clear_buffer(self.buffer.raw(), 0, Some(HEAD_BYTES));
        self.share = Some(share);
    }

    /// The fragments that fit.
    pub fn room(&self) -> u64 {
        self.buffer.bytes().saturating_sub(HEAD_BYTES) / ITEM_BYTES
    }

    /// Takes the head of a finished build. Returns the bytes that the map needs, and whether the list was too small and has been
    /// enlarged; `None` if nothing was built yet.
    ///
    /// # Errors
    /// The map needs more than its budget.
    pub fn settle(&mut self, gpu: &Gpu, head: [u32; 2]) -> Result<Option<(u64, bool)>, ShadowError> {
        let Some(share) = self.share else { return Ok(None) };
        self.found = GpuList::fragments(head);
        share.check(gpu, self.found)?;
        let short = bytes(self.found) > self.buffer.bytes();
        if short {
            // A little more, because hair that moves needs more in the next frame.
            let wanted = self.found + self.found / 8;
            self.buffer.fit(gpu, bytes(wanted.min(share.most(gpu)).max(self.found)) / 4);
        }
        Ok(Some((share.other_bytes + bytes(self.found), short)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn totals_beyond_a_word_are_found() {
        for counts in
            [vec![], vec![7; 9], vec![65_535; 65_536], vec![3_000_000; 40_000], vec![65_536; 65_536]]
        {
            let head = counts.iter().fold([0_u32; 2], |[low, high], count: &u32| {
                [low.wrapping_add(*count), high.wrapping_add(count >> 16)]
            });
            assert_eq!(GpuList::fragments(head), counts.iter().map(|count| u64::from(*count)).sum::<u64>());
        }
    }
}
