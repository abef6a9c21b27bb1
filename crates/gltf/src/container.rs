//! The container of a file: the chunks of a `.glb`, or the text of a `.gltf`.

use crate::GltfError;

/// The first bytes of a binary file.
pub const MAGIC: &[u8] = b"glTF";

/// Chunk types of a binary file.
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The chunks of a binary file, or the text of a `.gltf` file.
#[derive(Debug)]
pub struct Container<'a> {
    /// The text of the document.
    pub json: &'a [u8],
    /// The binary chunk.
    pub bin: Option<&'a [u8]>,
    /// The name of the format.
    pub format: &'static str,
}

/// A text without the mark of its byte order, with which some editors begin it.
pub fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

impl<'a> Container<'a> {
    /// Splits a binary file into its chunks (glTF 2.0, section 4.4); anything else is treated as text.
    ///
    /// # Errors
    /// If the file is truncated or of another version.
    pub fn open(file: &str, bytes: &'a [u8]) -> Result<Self, GltfError> {
        if !bytes.starts_with(MAGIC) {
            return Ok(Self { json: without_mark(bytes), bin: None, format: "glTF 2.0 (text)" });
        }
        let malformed = |at: usize, found: String, wanted: &str| {
            GltfError::malformed(file, format!("byte {at}"), found, wanted).at(at as u64)
        };
        let word = |at: usize| {
            let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
            four.map(|&four| u32::from_le_bytes(four)).ok_or_else(|| {
                malformed(at, format!("a file of {} bytes", bytes.len()), "the header of a chunk")
            })
        };
        let version = word(4)?;
        if version != 2 {
            return Err(malformed(4, format!("glTF version {version}"), "version 2"));
        }
        let (mut json, mut bin, mut at) = (None, None, 12_usize);
        // Some writers leave a few bytes of padding at the end.
        while json.is_none() || bin.is_none() && at + 8 <= bytes.len() {
            let (mut length, kind) = (word(at)? as usize, word(at + 4)?);
            let left = bytes.len().saturating_sub(at + 8);
            // Writers that are cut off leave no true length. The bytes that are there are used; what lies beyond them is refused when it is read.
            if kind == BIN && (length > left || length == 0) {
                length = left;
            }
            let data = bytes.get(at + 8..).and_then(|tail| tail.get(..length)).ok_or_else(|| {
                let found = format!("a chunk of {length} bytes, of which the file contains {left}");
                malformed(at, found, "the whole chunk: the file is truncated")
            })?;
            match kind {
                JSON if json.is_none() => json = Some(data),
                BIN if bin.is_none() => bin = Some(data),
                _ => {}
            }
            at += 8 + length;
        }
        Ok(Self { json: json.unwrap_or_default(), bin, format: "glTF 2.0 (binary)" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_truncated_container_is_refused() {
        let mut glb = b"glTF\x02\0\0\0\x1c\0\0\0\x04\0\0\0JSON{}  ".to_vec();
        assert_eq!(Container::open("f", &glb).unwrap().json, b"{}  ");
        glb.truncate(22);
        assert!(Container::open("f", &glb).is_err());
        assert!(Container::open("f", b"glTF\x01\0\0\0").is_err());
        assert_eq!(Container::open("f", b"\xef\xbb\xbf{}").unwrap().json, b"{}");
    }

    #[test]
    fn a_binary_chunk_that_states_a_wrong_length_has_the_bytes_that_are_there() {
        for total in [0_u32, 44, u32::MAX] {
            for length in [0_u32, 16, 17, u32::MAX] {
                let head = [&b"glTF\x02\0\0\0"[..], &total.to_le_bytes(), b"\x04\0\0\0JSON{}  "].concat();
                let glb = [&head[..], &length.to_le_bytes(), b"BIN\0", &[7; 16]].concat();
                let container = Container::open("f", &glb).expect("a container");
                assert_eq!(
                    (container.json, container.bin),
                    (&b"{}  "[..], Some(&[7; 16][..])),
                    "{total} {length}"
                );
            }
        }
    }
}
