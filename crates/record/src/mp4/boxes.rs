//! Boxes of MP4 files.

/// A box with any contents.
pub(super) fn leaf(kind: [u8; 4], fill: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = vec![0; 4];
    bytes.extend(kind);
    fill(&mut bytes);
    let size = (bytes.len() as u32).to_be_bytes();
    bytes[..4].copy_from_slice(&size);
    bytes
}

/// A box with a version and flags.
pub(super) fn full(kind: [u8; 4], version: u8, flags: u32, fill: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    leaf(kind, |bytes| {
        bytes.extend((u32::from(version) << 24 | flags).to_be_bytes());
        fill(bytes);
    })
}

/// A box that contains boxes.
pub(super) fn nest(kind: [u8; 4], parts: &[Vec<u8>]) -> Vec<u8> {
    leaf(kind, |bytes| parts.iter().for_each(|part| bytes.extend(part)))
}

/// A table: the number of entries, then the numbers.
pub(super) fn numbers(bytes: &mut Vec<u8>, count: usize, values: impl IntoIterator<Item = u32>) {
    bytes.extend((count as u32).to_be_bytes());
    values.into_iter().for_each(|value| bytes.extend(value.to_be_bytes()));
}

/// The identity: 1 and 1 as 16.16 and 1 as 2.30 on the diagonal.
pub(super) fn identity_matrix() -> [u8; 36] {
    let mut matrix = [0; 36];
    matrix[1] = 1;
    matrix[17] = 1;
    matrix[32] = 0x40;
    matrix
}

/// The offsets of chunks, with 64 bits in a `large` file.
pub(super) fn chunk_offsets(chunks: &[u64], large: bool) -> Vec<u8> {
    if large {
        full(*b"co64", 0, 0, |b| {
            numbers(b, chunks.len(), []);
            b.extend(chunks.iter().flat_map(|at| at.to_be_bytes()));
        })
    } else {
        full(*b"stco", 0, 0, |b| numbers(b, chunks.len(), chunks.iter().map(|&at| at as u32)))
    }
}

/// One data reference with flag 1: the samples are in the same file.
pub(super) fn same_file() -> Vec<u8> {
    let dref = full(*b"dref", 0, 0, |b| {
        b.extend(1_u32.to_be_bytes());
        b.extend(full(*b"url ", 0, 1, |_| ()));
    });
    nest(*b"dinf", &[dref])
}
