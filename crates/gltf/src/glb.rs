//! Binary glTF 2.0 files (GLB, section 4.4 of the specification): the container, and a buffer with its views and accessors.

use serde_json::{Value, json};

/// Component type of an accessor: 8-bit unsigned integers.
pub const UNSIGNED_BYTE: u32 = 5121;
/// Component type of an accessor: 16-bit unsigned integers.
pub const UNSIGNED_SHORT: u32 = 5123;
/// Component type of an accessor: 32-bit unsigned integers.
pub const UNSIGNED_INT: u32 = 5125;
/// Component type of an accessor: single-precision floats.
pub const FLOAT: u32 = 5126;
/// Target of a buffer view: vertex attributes.
pub const ARRAY_BUFFER: u32 = 34962;
/// Target of a buffer view: vertex indices.
pub const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The first four bytes of every binary glTF file.
const MAGIC: &[u8; 4] = b"glTF";

/// The buffer of a file with its views and accessors, in the form that the document stores them.
#[derive(Debug, Default)]
pub struct Buffer {
    /// Bytes of the buffer that are written elsewhere, before [`Buffer::bytes`].
    before: u64,
    bytes: Vec<u8>,
    /// The document's `bufferViews`.
    pub views: Vec<Value>,
    /// The document's `accessors`.
    pub accessors: Vec<Value>,
}

impl Buffer {
    /// A buffer whose first `before` bytes (a multiple of four) the caller writes.
    pub fn after(before: u64) -> Self {
        Self { before, ..Self::default() }
    }

    /// Appends `data`, `count` elements, on a multiple of four bytes, with a view and an accessor of its own. `kind` is the
    /// accessor's type, such as `VEC3`. Returns the accessor's index.
    pub fn add(
        &mut self,
        data: &[u8],
        kind: &str,
        component: u32,
        count: usize,
        target: Option<u32>,
    ) -> usize {
        self.pad();
        let mut view = json!({ "buffer": 0, "byteOffset": self.len(), "byteLength": data.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend_from_slice(data);
        self.views.push(view);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind,
        }));
        self.accessors.len() - 1
    }

    /// Appends bytes on a multiple of four, with a view of their own, such as those of an image. Returns the view's index.
    pub fn add_bytes(&mut self, data: &[u8]) -> usize {
        self.pad();
        self.views.push(json!({ "buffer": 0, "byteOffset": self.len(), "byteLength": data.len() }));
        self.bytes.extend_from_slice(data);
        self.views.len() - 1
    }

    /// Length of the whole buffer in bytes.
    #[expect(clippy::len_without_is_empty, reason = "nothing uses an empty buffer")]
    pub fn len(&self) -> u64 {
        self.before + self.bytes.len() as u64
    }

    /// The buffer's bytes after those that the caller writes, padded with zeros to a multiple of four.
    pub fn into_bytes(mut self) -> Vec<u8> {
        self.pad();
        self.bytes
    }

    fn pad(&mut self) {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
    }
}

/// What a file contains before its buffer: the header, the document and the head of the buffer's chunk. The buffer of
/// `buffer_bytes` bytes, padded with zeros to a multiple of four, follows.
///
/// # Errors
/// Length of the whole file in bytes if it exceeds the 32 bits that the format has for it.
pub fn head(mut document: Vec<u8>, buffer_bytes: u64) -> Result<Vec<u8>, u64> {
    document.resize(document.len().next_multiple_of(4), b' ');
    let buffer = buffer_bytes.next_multiple_of(4);
    let whole = 12 + 8 + document.len() as u64 + 8 + buffer;
    let length = u32::try_from(whole).map_err(|_| whole)?;
    let mut head = Vec::with_capacity(28 + document.len());
    head.extend(MAGIC);
    for word in [2, length, document.len() as u32] {
        head.extend(word.to_le_bytes());
    }
    head.extend(b"JSON");
    head.append(&mut document);
    head.extend((buffer as u32).to_le_bytes());
    head.extend(b"BIN\0");
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::{ARRAY_BUFFER, Buffer, FLOAT, UNSIGNED_BYTE, head};

    #[test]
    fn arrays_start_on_multiples_of_four_bytes() {
        let mut buffer = Buffer::after(8);
        assert_eq!(buffer.add(&[1, 2, 3], "SCALAR", UNSIGNED_BYTE, 3, None), 0);
        assert_eq!(buffer.add(&[4; 12], "VEC3", FLOAT, 1, Some(ARRAY_BUFFER)), 1);
        assert_eq!(buffer.views[0]["byteOffset"], 8);
        assert_eq!(buffer.views[1]["byteOffset"], 12);
        assert_eq!(buffer.views[1]["target"], ARRAY_BUFFER);
        assert_eq!(buffer.accessors[1]["bufferView"], 1);
        assert_eq!(buffer.len(), 24);
        assert_eq!(buffer.into_bytes().len(), 16);
    }

    #[test]
    fn lengths_count_the_padding() {
        let head = head(b"{ }".to_vec(), 5).unwrap();
        let word = |at: usize| u32::from_le_bytes(head[at..at + 4].try_into().unwrap());
        assert_eq!((&head[..4], word(4), word(8)), (&b"glTF"[..], 2, 12 + 8 + 4 + 8 + 8));
        assert_eq!((word(12), &head[16..24], word(24), &head[28..]), (4, &b"JSON{ } "[..], 8, &b"BIN\0"[..]));
    }

    #[test]
    fn files_beyond_32_bits_are_refused() {
        assert!(head(Vec::new(), u64::from(u32::MAX) - 31).is_ok());
        assert_eq!(head(Vec::new(), u64::from(u32::MAX)), Err(u64::from(u32::MAX) + 1 + 28));
    }
}
