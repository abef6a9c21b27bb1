//! Corrects two faults in USD crates that the `openusd` library (0.6) writes.
//!
//! It stores the names of children as arrays of tokens. Pixar's reader requires vectors of tokens there, which have the same
//! bytes but another type, and refuses the file otherwise. It also writes the newest version, 0.12, for values that are not
//! used here; programs from before 2024 would refuse that.

use std::io::{self, Read, Seek, SeekFrom, Write};

/// The version that is written: the one of all crates since 2019 that need nothing newer.
const VERSION: [u8; 3] = [0, 8, 0];
const VERSION_AT: u64 = 8;
const TOC_AT: u64 = 16;

/// Type and flags of values, in the upper 16 bits.
const ARRAY_OF_TOKENS: u64 = 0x800b;
const VECTOR_OF_TOKENS: u64 = 0x0029;

/// The most bytes of the sections after the values. Ours take some hundred bytes.
const MAX_TAIL: u64 = 64 << 20;

/// Rewrites the end of a crate file. `read` and `write` access the same file.
///
/// The sections at the end contain only tables. Every array of tokens in the files of this module contains names of children.
///
/// # Errors
/// For errors of the disk and for a file in a form that the library does not write.
pub(super) fn mend(read: &mut (impl Read + Seek), write: &mut (impl Write + Seek)) -> io::Result<()> {
    let length = read.seek(SeekFrom::End(0))?;
    read.seek(SeekFrom::Start(TOC_AT))?;
    let mut eight = [0; 8];
    read.read_exact(&mut eight)?;
    let toc = u64::from_le_bytes(eight);
    read.seek(SeekFrom::Start(toc))?;
    let mut table = Vec::new();
    read.by_ref().take(MAX_TAIL).read_to_end(&mut table)?;
    let mut sections = Vec::new();
    for section in 0..word(&table, 0)? {
        let at = 8 + 32 * section as usize;
        let name = table.get(at..at + 16).ok_or_else(wrong)?.to_vec();
        sections.push((name, word(&table, at + 16)?, word(&table, at + 24)?));
    }
    let fields = sections.iter().position(|(name, ..)| name.starts_with(b"FIELDS\0")).ok_or_else(wrong)?;
    let start = sections[fields].1;
    if toc < start || toc - start > MAX_TAIL {
        return Err(wrong());
    }
    read.seek(SeekFrom::Start(start))?;
    let mut tail = vec![0; (toc - start) as usize];
    read.read_exact(&mut tail)?;

    let mut out = Vec::with_capacity(tail.len() + 64);
    for (section, (_, begin, size)) in sections.iter_mut().enumerate().skip(fields) {
        let from = (*begin - start) as usize;
        let bytes = tail.get(from..from + *size as usize).ok_or_else(wrong)?;
        let bytes = if section == fields { mend_fields(bytes)? } else { bytes.to_vec() };
        (*begin, *size) = (start + out.len() as u64, bytes.len() as u64);
        out.extend(bytes);
    }
    // If the new end were shorter, the old end would stay behind it.
    let new_length = start + out.len() as u64 + 8 + 32 * sections.len() as u64;
    out.resize(out.len() + length.saturating_sub(new_length) as usize, 0);
    let toc = start + out.len() as u64;
    out.extend((sections.len() as u64).to_le_bytes());
    for (name, begin, size) in &sections {
        out.extend(name.iter().copied().chain(begin.to_le_bytes()).chain(size.to_le_bytes()));
    }
    write.seek(SeekFrom::Start(start))?;
    write.write_all(&out)?;
    write.seek(SeekFrom::Start(TOC_AT))?;
    write.write_all(&toc.to_le_bytes())?;
    write.seek(SeekFrom::Start(VERSION_AT))?;
    write.write_all(&VERSION)
}

/// Corrects the section of fields: their number, a block with their names, and a block with their values.
fn mend_fields(section: &[u8]) -> io::Result<Vec<u8>> {
    let count = word(section, 0)? as usize;
    let values = 16 + word(section, 8)? as usize;
    let size = word(section, values)? as usize;
    let block = section.get(values + 8..values + 8 + size).ok_or_else(wrong)?;
    // A first byte of 0 means that there is a single block.
    let [0, packed @ ..] = block else { return Err(wrong()) };
    let mut reps = lz4_flex::block::decompress(packed, 8 * count).map_err(io::Error::other)?;
    for rep in reps.as_chunks_mut::<8>().0 {
        let value = u64::from_le_bytes(*rep);
        if value >> 48 == ARRAY_OF_TOKENS {
            *rep = (value & ((1 << 48) - 1) | VECTOR_OF_TOKENS << 48).to_le_bytes();
        }
    }
    let packed = lz4_flex::block::compress(&reps);
    let mut out = section[..values].to_vec();
    out.extend((packed.len() as u64 + 1).to_le_bytes());
    out.push(0);
    out.extend(packed);
    Ok(out)
}

fn word(bytes: &[u8], at: usize) -> io::Result<u64> {
    bytes
        .get(at..)
        .and_then(|rest| rest.first_chunk::<8>())
        .map(|&eight| u64::from_le_bytes(eight))
        .ok_or_else(wrong)
}

fn wrong() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the USD library has written a crate in an unexpected form")
}
