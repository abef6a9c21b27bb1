//! Records of a journal: length, checksum, kind, contents. A file that ends within a record has lost that record alone.
//!
//! | bytes | contents |
//! |---|---|
//! | 4 | length of the contents, little endian |
//! | 4 | CRC-32 of kind and contents, little endian |
//! | 1 | kind |
//! | … | contents |

/// The first bytes of a journal; the digit changes when old programs cannot read new journals.
pub(super) const MAGIC: &[u8; 8] = b"LLJOURN1";

/// Whether bytes are a journal whose version this program cannot read.
pub(super) fn is_newer(bytes: &[u8]) -> bool {
    bytes.first_chunk::<8>().is_some_and(|magic| magic[..7] == MAGIC[..7] && magic[7] > MAGIC[7])
}

/// Bytes before the contents.
const HEAD: usize = 9;

/// What a record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Who writes the journal, as JSON; the first record.
    Owner,
    /// A project: its number, eight bytes little endian, and how its text differs from that of the state before it in the file.
    State,
    /// How the history changed, as JSON.
    Change,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Owner, Self::State, Self::Change];

    fn byte(self) -> u8 {
        match self {
            Self::Owner => b'O',
            Self::State => b'S',
            Self::Change => b'C',
        }
    }
}

/// Appends a record to `out`.
pub(super) fn append(out: &mut Vec<u8>, kind: Kind, contents: &[&[u8]]) {
    let length: usize = contents.iter().map(|part| part.len()).sum();
    let mut checksum = crc32fast::Hasher::new();
    checksum.update(&[kind.byte()]);
    for part in contents {
        checksum.update(part);
    }
    out.extend((length as u32).to_le_bytes());
    out.extend(checksum.finalize().to_le_bytes());
    out.push(kind.byte());
    for part in contents {
        out.extend_from_slice(part);
    }
}

/// The whole records of a journal, in order. It ends at the first one that is cut or damaged.
pub(super) struct Records<'a> {
    rest: &'a [u8],
}

impl<'a> Records<'a> {
    /// Those of a file; `None` if it is no journal, or one of a newer version.
    pub(super) fn of(bytes: &'a [u8]) -> Option<Self> {
        Some(Self { rest: bytes.strip_prefix(MAGIC)? })
    }

    /// The number of bytes after the records that were read.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = (Kind, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let head = self.rest.first_chunk::<HEAD>()?;
        let number = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let end = HEAD.checked_add(number(0) as usize)?;
        let whole = self.rest.get(..end)?;
        if crc32fast::hash(&whole[HEAD - 1..]) != number(4) {
            self.rest = &[];
            return None;
        }
        self.rest = &self.rest[end..];
        let kind = Kind::ALL.into_iter().find(|kind| kind.byte() == head[HEAD - 1])?;
        Some((kind, &whole[HEAD..]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_cut_anywhere_keeps_the_records_before() {
        let contents: [&[u8]; 4] = [b"{}", b"", b"twelve bytes", &[0; 300]];
        let (mut file, mut ends) = (MAGIC.to_vec(), Vec::new());
        for (k, part) in contents.iter().enumerate() {
            append(&mut file, Kind::ALL[k % 3], &[part]);
            ends.push(file.len());
        }
        for cut in MAGIC.len()..=file.len() {
            let found: Vec<_> = Records::of(&file[..cut]).expect("a journal").collect();
            assert_eq!(found.len(), ends.iter().filter(|end| **end <= cut).count());
            assert!(found.iter().enumerate().all(|(k, record)| *record == (Kind::ALL[k % 3], contents[k])));
        }
        assert!(Records::of(&file[..5]).is_none() && Records::of(b"LLJOURN9").is_none());
        assert!(is_newer(b"LLJOURN9 and more") && !is_newer(&file) && !is_newer(b"LLJOURN"));
    }

    #[test]
    fn a_damaged_byte_ends_the_journal_before_its_record() {
        let mut file = MAGIC.to_vec();
        append(&mut file, Kind::Owner, &[b"first"]);
        let end = file.len();
        append(&mut file, Kind::State, &[b"sec", b"ond"]);
        assert_eq!(Records::of(&file).expect("a journal").count(), 2);
        for at in end..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 1;
            assert_eq!(Records::of(&damaged).expect("a journal").count(), 1, "byte {at}");
        }
    }
}
