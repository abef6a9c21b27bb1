//! A text as what differs from an earlier one: Zstandard with the earlier text as its prefix, as `zstd --patch-from` does.

use std::io::{self, Read, Write};

/// The longest text that is read. That of a project file.
const LONGEST: u64 = 64 << 20;

/// Quick rather than small: the earlier text already makes it small.
const LEVEL: i32 = 1;

/// The smallest and largest window of the compressor, as powers of two.
const WINDOWS: [u32; 2] = [16, 27];

/// The window that holds both texts.
fn window(bytes: usize) -> u32 {
    bytes.max(1).next_power_of_two().ilog2().clamp(WINDOWS[0], WINDOWS[1])
}

/// `text` as what differs from `before`. A change of one number takes some dozens of bytes.
///
/// # Errors
/// If the compressor has no memory.
pub(super) fn pack(text: &[u8], before: &[u8]) -> io::Result<Vec<u8>> {
    let mut encoder = zstd::stream::write::Encoder::with_ref_prefix(Vec::new(), LEVEL, before)?;
    encoder.window_log(window(text.len() + before.len()))?;
    // The tables of a low level do not reach far back.
    encoder.long_distance_matching(before.len() > 1 << 16)?;
    encoder.set_pledged_src_size(Some(text.len() as u64))?;
    encoder.write_all(text)?;
    encoder.finish()
}

/// The text that [`pack`] packed, with the same `before`.
///
/// # Errors
/// If the bytes are damaged, `before` is another text, or the text is longer than a project can be.
pub(super) fn unpack(packed: &[u8], before: &[u8]) -> io::Result<Vec<u8>> {
    let mut decoder = zstd::stream::read::Decoder::with_ref_prefix(packed, before)?;
    decoder.window_log_max(WINDOWS[1])?;
    let mut text = Vec::new();
    decoder.take(LONGEST + 1).read_to_end(&mut text)?;
    if text.len() as u64 > LONGEST {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "longer than a project can be"));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Text that does not compress: hexadecimal digits of a generator.
    fn noise(digits: usize, seed: u64) -> Vec<u8> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            b"0123456789abcdef"[(state >> 60) as usize]
        };
        (0..digits).map(|_| next()).collect()
    }

    #[test]
    fn a_change_of_a_long_text_is_short_and_restores_it() {
        let before = noise(3 << 20, 1);
        let mut after = before.clone();
        after[1_000_000] = b'x';
        after.splice(2_000_000..2_000_003, *b"0.123456");
        let packed = pack(&after, &before).expect("packed");
        assert!(packed.len() < 2000, "{} bytes", packed.len());
        assert!(unpack(&packed, &before).expect("unpacked") == after);
        // Control: without the earlier text it is half of its length, four bits of each digit.
        let alone = pack(&after, b"").expect("packed");
        assert!(alone.len() > 1 << 20, "{} bytes", alone.len());
        assert!(unpack(&alone, b"").expect("unpacked") == after);
        assert!(
            unpack(&packed, &noise(3 << 20, 2)).is_ok_and(|text| text != after)
                || unpack(&packed, b"").is_err()
        );
    }

    #[test]
    fn damaged_bytes_are_an_error_or_another_text_and_never_more_than_the_longest() {
        let before = noise(5000, 3);
        let packed = pack(&noise(6000, 4), &before).expect("packed");
        for at in 0..packed.len().min(400) {
            let mut damaged = packed.clone();
            damaged[at] ^= 0x55;
            assert!(
                unpack(&damaged, &before).is_ok_and(|text| text.len() as u64 <= LONGEST)
                    || unpack(&damaged, &before).is_err()
            );
        }
        let bomb = pack(&vec![b'0'; LONGEST as usize + 1], b"").expect("packed");
        assert!(unpack(&bomb, b"").is_err());
    }
}
