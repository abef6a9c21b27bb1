//! Headers of properties and objects.

use crate::error::AlembicError;
use crate::layout::{METADATA_FOLLOWS, info};
use crate::pod::{DataType, Pod};

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PropertyKind {
    /// Other properties.
    Compound,
    /// One element per sample.
    Scalar,
    /// An array of elements per sample.
    Array,
}

/// A property of an object.
#[derive(Clone, Debug)]
pub struct Property {
    /// Its name.
    pub name: String,
    /// Its metadata, `key=value;key=value`.
    pub metadata: String,
    /// What it holds.
    pub kind: PropertyKind,
    /// The type of its elements; of no meaning for a compound.
    pub ty: DataType,
    /// Number of its samples.
    pub samples: u64,
    /// First and last index at which its value changed; both 0 if it does not change.
    pub(super) changed: (u64, u64),
    /// The index of its times.
    pub(super) times: usize,
    /// The address of its group.
    pub(super) group: u64,
}

impl Property {
    /// The place of a sample among the samples that are stored.
    pub(super) fn stored(&self, sample: u64) -> u64 {
        let (first, last) = self.changed;
        if sample < first || (first, last) == (0, 0) {
            0
        } else if sample >= last {
            last - first + 1
        } else {
            sample - first + 1
        }
    }

    /// Whether its samples are all equal.
    pub fn is_constant(&self) -> bool {
        self.changed == (0, 0)
    }
}

/// Takes numbers and text from the bytes of headers.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    /// The position of the bytes in the file.
    origin: u64,
}

impl Cursor<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], AlembicError> {
        let start = self.at;
        let end = start.checked_add(count).filter(|&end| end <= self.bytes.len());
        let Some(end) = end else {
            let found = format!("{count} bytes of a header where {} are left", self.bytes.len() - start);
            return Err(AlembicError::malformed(self.origin + start as u64, found, "a whole header"));
        };
        self.at = end;
        Ok(&self.bytes[start..end])
    }

    /// A number of `1 << width` bytes.
    fn number(&mut self, width: u32) -> Result<u64, AlembicError> {
        let taken = self.take(1 << width)?;
        Ok(taken.iter().rev().fold(0, |value, &byte| value << 8 | u64::from(byte)))
    }

    fn text(&mut self, count: u64) -> Result<String, AlembicError> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        Ok(String::from_utf8_lossy(self.take(count)?).into_owned())
    }

    fn metadata(&mut self, index: u8, width: u32, table: &[String]) -> Result<String, AlembicError> {
        if index == METADATA_FOLLOWS {
            let count = self.number(width)?;
            return self.text(count);
        }
        table.get(usize::from(index)).cloned().ok_or_else(|| {
            let found = format!("metadata {index} of {}", table.len());
            AlembicError::malformed(self.origin + self.at as u64, found, "metadata of the archive")
        })
    }
}

/// The table of metadata.
pub(super) fn metadata_table(bytes: &[u8], origin: u64) -> Result<Vec<String>, AlembicError> {
    let mut cursor = Cursor { bytes, at: 0, origin };
    // Index 0 is that of no metadata.
    let mut table = vec![String::new()];
    while cursor.at < bytes.len() {
        let count = cursor.number(0)?;
        table.push(cursor.text(count)?);
    }
    Ok(table)
}

/// The properties of a compound. `groups` are the addresses of their groups.
pub(super) fn properties(
    bytes: &[u8],
    origin: u64,
    table: &[String],
    times: usize,
    groups: &[u64],
) -> Result<Vec<Property>, AlembicError> {
    let mut cursor = Cursor { bytes, at: 0, origin };
    let mut properties = Vec::new();
    while cursor.at < bytes.len() {
        let at = origin + cursor.at as u64;
        let malformed = |found: String, wanted| Err(AlembicError::malformed(at, found, wanted));
        let bits = cursor.number(2)? as u32;
        let kind = match bits & info::KIND {
            0 => PropertyKind::Compound,
            1 => PropertyKind::Scalar,
            _ => PropertyKind::Array,
        };
        let width = bits >> info::SIZE_SHIFT & 3;
        if width > 2 {
            return malformed(format!("numbers of {} bytes", 1 << width), "1, 2 or 4 bytes");
        }
        let mut property = Property {
            name: String::new(),
            metadata: String::new(),
            kind,
            ty: DataType::new(Pod::U8, 1),
            samples: 0,
            changed: (0, 0),
            times: 0,
            group: 0,
        };
        if kind != PropertyKind::Compound {
            let (code, extent) = (bits >> info::POD_SHIFT & 0xf, (bits >> info::EXTENT_SHIFT) as u8);
            let Some(pod) = Pod::of_code(code).filter(|_| extent > 0) else {
                return malformed(
                    format!("elements of {extent} numbers of type {code}"),
                    "a type of Alembic",
                );
            };
            property.ty = DataType::new(pod, extent);
            property.samples = cursor.number(width)?;
            property.changed = if bits & info::HAS_CHANGES != 0 {
                (cursor.number(width)?, cursor.number(width)?)
            } else if bits & info::CONSTANT != 0 {
                (0, 0)
            } else {
                (1, property.samples.saturating_sub(1))
            };
            let (first, last) = property.changed;
            if property.samples > 0 && (first > last || last >= property.samples) {
                let found = format!("changes from {first} to {last} of {} samples", property.samples);
                return malformed(found, "changes within the samples");
            }
            if bits & info::HAS_TIMES != 0 {
                property.times = cursor.number(width)? as usize;
            }
            if property.times >= times {
                return malformed(format!("times {} of {times}", property.times), "times of the archive");
            }
        }
        let count = cursor.number(width)?;
        property.name = cursor.text(count)?;
        property.metadata = cursor.metadata((bits >> info::METADATA_SHIFT) as u8, width, table)?;
        let Some(&group) = groups.get(properties.len()) else {
            return malformed(format!("more properties than {} groups", groups.len()), "a group for each");
        };
        property.group = group;
        properties.push(property);
    }
    Ok(properties)
}

/// Names and metadata of the children of an object.
pub(super) fn objects(
    bytes: &[u8],
    origin: u64,
    table: &[String],
) -> Result<Vec<(String, String)>, AlembicError> {
    let mut cursor = Cursor { bytes, at: 0, origin };
    let mut objects = Vec::new();
    while cursor.at < bytes.len() {
        let count = cursor.number(2)?;
        let name = cursor.text(count)?;
        let index = cursor.number(0)? as u8;
        objects.push((name, cursor.metadata(index, 2, table)?));
    }
    Ok(objects)
}
