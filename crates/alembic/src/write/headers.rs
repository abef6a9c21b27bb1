//! Headers of properties and objects, and the table of metadata.

use super::samples::Samples;
use crate::layout::{METADATA_FOLLOWS, info};

/// The metadata of an archive, each text once.
pub(super) struct MetadataTable(Vec<String>);

impl MetadataTable {
    pub(super) fn new() -> Self {
        Self(Vec::new())
    }

    /// The index of a text, or [`METADATA_FOLLOWS`] for one that is too long or one too many.
    fn index(&mut self, text: &str) -> u8 {
        if text.is_empty() {
            return 0;
        }
        let known = self.0.iter().position(|known| known == text);
        let index = known.unwrap_or_else(|| {
            if text.len() <= 0xff && self.0.len() + 1 < usize::from(METADATA_FOLLOWS) {
                self.0.push(text.to_owned());
                self.0.len() - 1
            } else {
                usize::from(METADATA_FOLLOWS) - 1
            }
        });
        index as u8 + 1
    }

    /// The table as it stands in the file.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.0.iter().flat_map(|text| std::iter::once(text.len() as u8).chain(text.bytes())).collect()
    }
}

/// Appends the header of a property; `None` stands for a compound.
pub(super) fn property(
    out: &mut Vec<u8>,
    name: &str,
    metadata: &str,
    samples: Option<&Samples>,
    table: &mut MetadataTable,
) {
    let largest = [name.len() as u64, metadata.len() as u64]
        .into_iter()
        .chain(samples.into_iter().flat_map(|samples| [samples.count, u64::from(samples.times)]))
        .fold(0, u64::max);
    let width = match largest {
        0..=0xff => 0,
        0x100..=0xffff => 1,
        _ => 2,
    };
    let number = |out: &mut Vec<u8>, value: u64| out.extend(&(value as u32).to_le_bytes()[..1 << width]);
    let index = table.index(metadata);
    let mut bits = width << info::SIZE_SHIFT | u32::from(index) << info::METADATA_SHIFT;
    let Some(samples) = samples else {
        out.extend(bits.to_le_bytes());
        text(out, name, metadata, index, number);
        return;
    };
    let (first, last) = (samples.first_changed, samples.last_changed);
    bits |= if samples.is_array { 2 | u32::from(samples.is_single) } else { 1 };
    bits |= (samples.ty.pod as u32) << info::POD_SHIFT;
    bits |= u32::from(samples.ty.extent) << info::EXTENT_SHIFT;
    let has_changes = (first, last) != (0, 0) && (first != 1 || last + 1 != samples.count);
    for (bit, is_set) in [
        (info::HAS_TIMES, samples.times != 0),
        (info::CONSTANT, (first, last) == (0, 0)),
        (info::HAS_CHANGES, has_changes),
        (info::HOMOGENEOUS, samples.is_homogeneous),
    ] {
        bits |= if is_set { bit } else { 0 };
    }
    out.extend(bits.to_le_bytes());
    number(out, samples.count);
    if has_changes {
        number(out, first);
        number(out, last);
    }
    if samples.times != 0 {
        number(out, u64::from(samples.times));
    }
    text(out, name, metadata, index, number);
}

fn text(out: &mut Vec<u8>, name: &str, metadata: &str, index: u8, number: impl Fn(&mut Vec<u8>, u64)) {
    number(out, name.len() as u64);
    out.extend(name.bytes());
    if index == METADATA_FOLLOWS {
        number(out, metadata.len() as u64);
        out.extend(metadata.bytes());
    }
}

/// Appends the header of an object.
pub(super) fn object(out: &mut Vec<u8>, name: &str, metadata: &str, table: &mut MetadataTable) {
    let index = table.index(metadata);
    out.extend((name.len() as u32).to_le_bytes());
    out.extend(name.bytes());
    out.push(index);
    if index == METADATA_FOLLOWS {
        out.extend((metadata.len() as u32).to_le_bytes());
        out.extend(metadata.bytes());
    }
}
