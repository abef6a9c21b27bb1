//! Reads bytes of a crate at checked positions.

use crate::Source;
use crate::UsdError;

/// The most paths, fields or specs of a crate.
const MAX_ENTRIES: u64 = 1 << 24;
/// The highest compression ratio of LZ4.
const BEST_RATIO: u64 = 255;

/// The bytes of a crate.
pub(crate) struct CrateBytes<'a> {
    /// The file's name, for messages.
    name: String,
    source: Source<'a>,
}

impl<'a> CrateBytes<'a> {
    pub(crate) fn new(name: &str, source: Source<'a>) -> Self {
        Self { name: name.to_owned(), source }
    }

    /// Reads a count, checks it against the size of the file, and returns it with the position after it.
    pub(crate) fn counted(&mut self, at: u64) -> Result<(u64, u64), UsdError> {
        let count = self.u64(at)?;
        // Four compressed integers take at least one byte.
        if count > MAX_ENTRIES || count / 4 > self.source.len().saturating_mul(BEST_RATIO) {
            return Err(self.at(
                at,
                format!("{count} entries"),
                "as many as the file can hold, 16777216 at most",
            ));
        }
        Ok((at + 8, count))
    }

    /// Reads compressed integers, stored as differences from the previous one; returns them with the position after
    /// them.
    pub(crate) fn ints(&mut self, at: u64, count: u64) -> Result<(Vec<u32>, u64), UsdError> {
        let codes = count.div_ceil(4);
        // If all differences equal the common one, no bytes follow the codes.
        let [least, most] = if count == 0 { [0; 2] } else { [4 + codes, 4 + codes + 4 * count] };
        let (packed, next) = self.unpacked(at, least, most)?;
        let mut out = Vec::with_capacity(count as usize);
        let short = || self.at(at, format!("{} bytes", packed.len()), &format!("{count} whole numbers"));
        if count > 0 {
            let (common, rest) = packed.split_first_chunk::<4>().ok_or_else(short)?;
            let common = i32::from_le_bytes(*common);
            let (codes, mut rest) = rest.split_at_checked(codes as usize).ok_or_else(short)?;
            let mut last = 0_i32;
            for i in 0..count as usize {
                let code = codes[i / 4] >> (2 * (i % 4)) & 3;
                let size = [0, 1, 2, 4][usize::from(code)];
                let (bytes, after) = rest.split_at_checked(size).ok_or_else(short)?;
                rest = after;
                let step = match *bytes {
                    [] => common,
                    [a] => i32::from(a as i8),
                    [a, b] => i32::from(i16::from_le_bytes([a, b])),
                    [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
                    _ => 0,
                };
                last = last.wrapping_add(step);
                out.push(last as u32);
            }
        }
        Ok((out, next))
    }

    /// Reads a compressed block that unpacks to between `least` and `most` bytes; returns it with the position after
    /// it.
    pub(crate) fn unpacked(&mut self, at: u64, least: u64, most: u64) -> Result<(Vec<u8>, u64), UsdError> {
        let length = self.u64(at)?;
        let block = self.bytes(at + 8, length, "bytes of a compressed block")?;
        let next = at + 8 + length;
        if least > (length + 16).saturating_mul(BEST_RATIO) {
            return Err(self.at(at, format!("{length} compressed bytes"), &format!("enough for {least}")));
        }
        let mut out = vec![0; most as usize];
        let broken = || self.at(at, "a block that is not LZ4".to_owned(), "compressed bytes");
        let Some((&chunks, mut rest)) = block.split_first() else { return Ok((Vec::new(), next)) };
        let mut filled = 0;
        for _ in 0..chunks.max(1) {
            let chunk = if chunks == 0 {
                rest
            } else {
                let (size, after) = rest.split_first_chunk::<4>().ok_or_else(broken)?;
                let (chunk, after) =
                    after.split_at_checked(u32::from_le_bytes(*size) as usize).ok_or_else(broken)?;
                rest = after;
                chunk
            };
            filled += lz4_flex::block::decompress_into(chunk, &mut out[filled..]).map_err(|_| broken())?;
        }
        out.truncate(filled);
        Ok((out, next))
    }

    /// Length of the file, bytes.
    pub(crate) fn len(&self) -> u64 {
        self.source.len()
    }

    pub(crate) fn u64(&mut self, at: u64) -> Result<u64, UsdError> {
        Ok(u64_of(&self.bytes(at, 8, "bytes of a number")?))
    }

    /// `count` bytes at `at`, if the file contains them.
    pub(crate) fn bytes(&mut self, at: u64, count: u64, what: &str) -> Result<Vec<u8>, UsdError> {
        let length = self.source.len();
        if at.checked_add(count).is_none_or(|end| end > length) {
            return Err(self.at(at, format!("a file of {length} bytes"), &format!("{count} {what}")));
        }
        self.source.read_at(&self.name, at, count)
    }

    pub(crate) fn at(&self, offset: u64, found: String, wanted: &str) -> UsdError {
        UsdError::Malformed { name: self.name.clone(), offset, found, wanted: wanted.to_owned() }
    }
}

pub(crate) fn u64_of(bytes: &[u8]) -> u64 {
    bytes.first_chunk::<8>().map_or(0, |&eight| u64::from_le_bytes(eight))
}
