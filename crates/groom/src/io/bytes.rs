//! Reads little-endian arrays from a file in memory, with checked positions.

use glam::Vec3;

use super::HairFileError;

/// A file in memory whose reads are checked for position and size.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    name: &'a str,
    data: &'a [u8],
}

impl<'a> Bytes<'a> {
    pub(super) fn new(name: &'a str, data: &'a [u8]) -> Self {
        Self { name, data }
    }

    /// Length of the file, bytes.
    pub(super) fn len(&self) -> u64 {
        self.data.len() as u64
    }

    /// An error at a byte of this file.
    pub(super) fn malformed(
        &self,
        offset: u64,
        found: impl Into<String>,
        wanted: impl Into<String>,
    ) -> HairFileError {
        HairFileError::Malformed {
            name: self.name.to_owned(),
            offset,
            found: found.into(),
            wanted: wanted.into(),
        }
    }

    /// `count` elements of `size` bytes at `offset`, without a copy. An array that does not lie within the file is an
    /// error that names it `what`.
    pub(super) fn array(
        &self,
        offset: u64,
        count: u64,
        size: u64,
        what: &str,
    ) -> Result<&'a [u8], HairFileError> {
        // u64 holds any product of two u32 counts with an element size, so only the sum of a malicious file can
        // overflow.
        let end = count.checked_mul(size).and_then(|bytes| bytes.checked_add(offset));
        match end {
            Some(end) if end <= self.len() => Ok(&self.data[offset as usize..end as usize]),
            _ => Err(self.malformed(
                offset,
                format!("a file of {} bytes", self.len()),
                end.map_or_else(
                    || format!("{count} {what}, more than any file holds"),
                    |end| format!("{end} bytes or more for {count} {what}"),
                ),
            )),
        }
    }

    /// The header of `size` bytes at the start.
    pub(super) fn header(&self, size: u64) -> Result<(), HairFileError> {
        self.array(0, size, 1, "bytes of header").map(|_| ())
    }

    /// The u32 at `offset`, which lies inside a checked header.
    pub(super) fn u32(&self, offset: usize) -> u32 {
        u32::from_le_bytes(self.four(offset))
    }

    /// The f32 at `offset`, which lies inside a checked header.
    pub(super) fn f32(&self, offset: usize) -> f32 {
        f32::from_le_bytes(self.four(offset))
    }

    fn four(&self, offset: usize) -> [u8; 4] {
        self.data.get(offset..offset + 4).and_then(|bytes| bytes.try_into().ok()).unwrap_or_default()
    }
}

/// Reads floats from an array of bytes, which may be unaligned.
pub(super) fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|&four| f32::from_le_bytes(four)).collect()
}

/// Reads three floats from every `stride` bytes (12 or more) of an array.
pub(super) fn triples(bytes: &[u8], stride: usize) -> impl ExactSizeIterator<Item = [f32; 3]> + '_ {
    let float = |bytes: &[u8], at: usize| {
        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    };
    bytes.chunks_exact(stride).map(move |item| [float(item, 0), float(item, 4), float(item, 8)])
}

/// The little-endian bytes of three floats.
pub(super) fn triple_bytes(v: Vec3) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (to, value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(v.to_array()) {
        *to = value.to_le_bytes();
    }
    bytes
}
