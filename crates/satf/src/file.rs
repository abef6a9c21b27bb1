//! The database as a file.
//!
//! A header of 28 bytes (magic, version, length and checksum of what follows), then the finest levels of all records,
//! opacities first, as differences from byte to byte and compressed by LZ4. Numbers are little-endian.

use thiserror::Error;
use xxhash_rust::xxh3::xxh3_64;

use crate::database::Database;
use crate::layout::{OPACITIES, RECORD, REFLECTANCES, TEXELS};

/// The version of the file and of the program that makes its records. Raise it with every change of either.
pub const VERSION: u32 = 1;
/// The first bytes of the file.
pub const MAGIC: [u8; 8] = *b"LVLKSATF";
const HEADER: usize = 28;
const FINEST_OPACITIES: usize = OPACITIES / RECORD * TEXELS;
const FINEST: usize = FINEST_OPACITIES + REFLECTANCES / RECORD * TEXELS;

/// The checksum of a whole file: XXH3 of 64 bits, as `xxhsum -H3` prints it.
pub fn checksum(bytes: &[u8]) -> u64 {
    xxh3_64(bytes)
}

/// Why bytes are not a usable database.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DatabaseError {
    /// The bytes do not begin like a database.
    #[error("this is not a hair database")]
    NotADatabase,
    /// The database has another version than this program's.
    #[error("the hair database has version {0}; must be version {VERSION}")]
    OtherVersion(u32),
    /// Bytes are missing.
    #[error("the hair database ends after {found} of {wanted} bytes")]
    CutShort {
        /// Bytes found.
        found: usize,
        /// Bytes that its header announces, or the length of a header.
        wanted: usize,
    },
    /// The checksum does not fit.
    #[error("the hair database is damaged: its checksum is wrong")]
    Checksum,
    /// The checksum fits, but the contents are not those of a database.
    #[error("the hair database is damaged: its contents have the wrong length")]
    Contents,
}

impl Database {
    /// The database as the bytes of a file: about 2.3 MB.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut finest = Vec::with_capacity(FINEST);
        for all in [self.opacities(), self.reflectances()] {
            for record in all.chunks_exact(RECORD) {
                finest.extend_from_slice(&record[..TEXELS]);
            }
        }
        // Records are smooth: differences are small numbers, which pack better.
        let mut before = 0;
        for byte in &mut finest {
            (before, *byte) = (*byte, byte.wrapping_sub(before));
        }
        let packed = lz4_flex::block::compress(&finest);
        let mut bytes = Vec::with_capacity(HEADER + packed.len());
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&(packed.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&xxh3_64(&packed).to_le_bytes());
        bytes.extend_from_slice(&packed);
        bytes
    }

    /// The database from the bytes of a file.
    ///
    /// # Errors
    /// The bytes are no database, belong to another version, are incomplete or damaged.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DatabaseError> {
        let known = bytes.len().min(MAGIC.len());
        if bytes.is_empty() || bytes[..known] != MAGIC[..known] {
            return Err(DatabaseError::NotADatabase);
        }
        let short = |wanted| DatabaseError::CutShort { found: bytes.len(), wanted };
        let (header, packed) = bytes.split_at_checked(HEADER).ok_or_else(|| short(HEADER))?;
        let number = |from: usize, count: usize| {
            header[from..from + count].iter().rev().fold(0_u64, |sum, &byte| sum << 8 | u64::from(byte))
        };
        let version = number(8, 4) as u32;
        if version != VERSION {
            return Err(DatabaseError::OtherVersion(version));
        }
        let length = usize::try_from(number(12, 8)).unwrap_or(usize::MAX);
        if packed.len() < length {
            return Err(short(length.saturating_add(HEADER)));
        }
        if packed.len() > length {
            return Err(DatabaseError::Contents);
        }
        if xxh3_64(packed) != number(20, 8) {
            return Err(DatabaseError::Checksum);
        }
        let mut finest = vec![0; FINEST];
        match lz4_flex::block::decompress_into(packed, &mut finest) {
            Ok(FINEST) => {}
            _ => return Err(DatabaseError::Contents),
        }
        let mut before = 0_u8;
        for byte in &mut finest {
            before = before.wrapping_add(*byte);
            *byte = before;
        }
        Ok(Self::from_finest(&finest[..FINEST_OPACITIES], &finest[FINEST_OPACITIES..]))
    }
}
