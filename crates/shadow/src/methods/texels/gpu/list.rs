//! Lists of fragments, for methods that keep all of them. How many there are is known only when they are counted.
//!
//! A list holds items of two words. The first two items are its head: the number of fragments modulo 2³², and the sum of
//! the 2⁻¹⁶-th parts of what each workgroup counted, which together give the number though no word holds it.

use lovelock_gpu::{Gpu, GpuError, ShaderPart, read_buffer, wgpu};

use crate::gpu::{Buffer, fits_device, wgsl};
use crate::{ShadowError, ShadowMethod};

/// Counts fragments and gives out places.
pub(crate) const LIST_HEAD: ShaderPart = wgsl!("methods/texels/gpu/", "list_head.wgsl");
/// Reads and writes fragments.
pub(crate) const LIST_BODY: ShaderPart = wgsl!("methods/texels/gpu/", "list_body.wgsl");

const HEAD_BYTES: u64 = 16;
const ITEM_BYTES: u64 = 8;

/// Fragments that there is room for at least.
const LEAST_ROOM: u64 = 1024;

/// What a list may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Share {
    pub method: ShadowMethod,
    /// Bytes that the method may use for this map.
    pub limit_bytes: u64,
    /// Bytes of these that go elsewhere.
    pub other_bytes: u64,
    /// How many maps share the limit of all.
    pub maps: u32,
}

impl Share {
    /// Refuses `items` fragments that do not fit.
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
    /// Set by a build until its number is read back.
    pending: Option<Share>,
    /// Fragments of the last build that was counted.
    found: u64,
}

impl List {
    pub fn new(gpu: &Gpu) -> Self {
        Self { buffer: Buffer::new(gpu, "shadow list"), pending: None, found: 0 }
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

    /// Its words, the head included.
    pub fn words(&self, gpu: &Gpu) -> Result<Vec<u32>, GpuError> {
        let mut words = vec![0; bytes(self.found).min(self.buffer.bytes()) as usize / 4];
        read_buffer(gpu, self.buffer.raw(), &mut words)?;
        Ok(words)
    }

    /// Makes room as the last build needed it and a little more, or by guess, as far as that may be; encodes emptying it.
    pub fn begin(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, share: Share, segments: u32) {
        let wanted = if self.found == 0 { 2 * u64::from(segments) } else { self.found + self.found / 8 };
        self.buffer.fit(gpu, bytes(wanted.max(LEAST_ROOM).min(share.most(gpu))) / 4);
        encoder.clear_buffer(self.buffer.raw(), 0, Some(HEAD_BYTES));
        self.pending = Some(share);
    }

    /// Reads the number of fragments back: the bytes that the map needs, and whether there was no room for all, and is now.
    /// Nothing where no build came before.
    pub fn settle(&mut self, gpu: &Gpu) -> Result<Option<(u64, bool)>, Unsettled> {
        let Some(share) = self.pending.take() else { return Ok(None) };
        let mut head = [0_u32; 2];
        read_buffer(gpu, self.buffer.raw(), &mut head)?;
        self.found = total(head);
        share.check(gpu, self.found)?;
        let short = bytes(self.found) > self.buffer.bytes();
        if short {
            self.buffer.fit(gpu, bytes(self.found) / 4);
        }
        Ok(Some((share.other_bytes + bytes(self.found), short)))
    }
}

/// Why the number of fragments leads nowhere.
#[derive(Debug)]
pub(crate) enum Unsettled {
    Shadow(ShadowError),
    Gpu(GpuError),
}

impl From<ShadowError> for Unsettled {
    fn from(error: ShadowError) -> Self {
        Self::Shadow(error)
    }
}

impl From<GpuError> for Unsettled {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

/// The number that a head stands for. At most 2¹⁶ workgroups lose less than 2¹⁶ each in the second word, so that it is
/// between that word times 2¹⁶ and 2³² more; the first word says where.
fn total([low, high]: [u32; 2]) -> u64 {
    let base = u64::from(high) << 16;
    base + u64::from(low.wrapping_sub(base as u32))
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
            assert_eq!(total(head), counts.iter().map(|count| u64::from(*count)).sum::<u64>());
        }
    }
}
