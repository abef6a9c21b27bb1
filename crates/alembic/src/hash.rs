//! Digests of samples and objects.
//!
//! Readers compare them to find equal samples and never compute them, so any good hash of 128 bits serves.

use xxhash_rust::xxh3::Xxh3;

/// The digest of several pieces of bytes.
pub(crate) fn digest(pieces: &[&[u8]]) -> [u8; 16] {
    let mut hash = Xxh3::new();
    for piece in pieces {
        hash.update(&(piece.len() as u64).to_le_bytes());
        hash.update(piece);
    }
    hash.digest128().to_le_bytes()
}
