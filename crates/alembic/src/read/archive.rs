//! The archive, its objects and their properties.

use super::headers::{self, Property, PropertyKind};
use super::source::Source;
use crate::error::AlembicError;
use crate::layout;
use crate::times::Times;

/// Bytes of headers that may be read more than once, in addition to twice the file.
const SLACK: u64 = 1 << 20;

/// The most children of a group that lists objects or properties: memory for their addresses stays small.
const MAX_CHILDREN: u64 = 1 << 24;

/// An open archive.
#[derive(Debug)]
pub struct Archive<'a> {
    pub(super) source: Source<'a>,
    metadata: String,
    table: Vec<String>,
    times: Vec<Times>,
    top: Object,
    /// Bytes of groups and headers that were read. It is limited, so that objects that contain each other come to an end.
    spent: u64,
}

/// An object of an archive.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name; empty for the top.
    pub name: String,
    /// Its metadata, `key=value;key=value`.
    pub metadata: String,
    group: u64,
}

/// The properties of an object or of a compound.
#[derive(Clone, Debug, Default)]
pub struct Compound(Vec<Property>);

impl Compound {
    /// The property with this name.
    pub fn get(&self, name: &str) -> Option<&Property> {
        self.0.iter().find(|property| property.name == name)
    }

    /// All properties in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Property> {
        self.0.iter()
    }
}

impl Object {
    /// Whether its schema has this name, `AbcGeom_Curve_v2` for example.
    pub fn has_schema(&self, schema: &str) -> bool {
        layout::metadata_value(&self.metadata, "schema") == Some(schema)
    }
}

impl<'a> Archive<'a> {
    /// Opens an archive and reads what belongs to it as a whole.
    ///
    /// # Errors
    /// For a file that is no archive in the Ogawa form, that was not finished, or that contradicts itself.
    pub fn open(mut source: Source<'a>) -> Result<Self, AlembicError> {
        let malformed = |offset, found: String, wanted| Err(AlembicError::malformed(offset, found, wanted));
        let length = source.len();
        let mut start = vec![0; length.min(layout::HEADER) as usize];
        source.read(0, &mut start)?;
        if start.starts_with(&crate::HDF5_MAGIC[..4]) {
            return malformed(
                0,
                "Alembic in HDF5, the form from before 2013".to_owned(),
                "Alembic in Ogawa (write it again so, or convert it with the tool abcconvert -toOgawa)",
            );
        }
        if !start.starts_with(layout::MAGIC) || start.len() < layout::HEADER as usize {
            return malformed(0, format!("`{}`", start.escape_ascii()), "`Ogawa` and a header of 16 bytes");
        }
        if start[layout::FROZEN_AT as usize] != layout::FROZEN {
            return malformed(
                layout::FROZEN_AT,
                "an archive whose writing was not finished".to_owned(),
                "a finished one",
            );
        }
        let version = u16::from_be_bytes([start[6], start[7]]);
        if version != 1 {
            return malformed(6, format!("version {version} of Ogawa"), "version 1");
        }
        let root = source.number(layout::ROOT_AT)?;
        let mut child = |index| source.child(root, index);
        let (top, metadata, times, table) = (child(2)?, child(3)?, child(4)?, child(5)?);
        let mut whole = |address| -> Result<(u64, Vec<u8>), AlembicError> {
            let (at, size) = source.data(address)?;
            let mut bytes = vec![0; size as usize];
            source.read(at, &mut bytes)?;
            Ok((at, bytes))
        };
        let metadata = String::from_utf8_lossy(&whole(metadata)?.1).into_owned();
        let (at, bytes) = whole(times)?;
        let times = read_times(at, &bytes)?;
        let (at, bytes) = whole(table)?;
        let table = headers::metadata_table(&bytes, at)?;
        let top = Object { name: String::new(), metadata: String::new(), group: top };
        Ok(Self { source, metadata, table, times, top, spent: 0 })
    }

    /// Metadata of the archive, `key=value;key=value`.
    pub fn metadata(&self) -> &str {
        &self.metadata
    }

    /// Length of the file in bytes.
    pub fn length(&self) -> u64 {
        self.source.len()
    }

    /// The object that contains all others.
    pub fn top(&self) -> Object {
        self.top.clone()
    }

    /// The times of a property's samples.
    pub fn times(&self, property: &Property) -> &Times {
        // `headers::properties` has compared the index.
        &self.times[property.times]
    }

    /// The children of an object.
    ///
    /// # Errors
    /// For headers that contradict the file.
    pub fn children(&mut self, object: &Object) -> Result<Vec<Object>, AlembicError> {
        let mut group = self.group(object.group)?;
        let Some(headers) = group.pop().filter(|last| last & layout::DATA != 0) else {
            return Ok(Vec::new());
        };
        let (at, mut bytes) = self.bytes(headers)?;
        // Files of the first versions end with the last header.
        let length = bytes.len().saturating_sub(layout::OBJECT_DIGESTS);
        bytes.truncate(length);
        let children = headers::objects(&bytes, at, &self.table)?;
        if children.len() + 1 > group.len() && !children.is_empty() {
            let found = format!("{} children and {} groups", children.len(), group.len().saturating_sub(1));
            return Err(AlembicError::malformed(at, found, "a group for each child"));
        }
        let children = children.into_iter().zip(group.into_iter().skip(1));
        Ok(children.map(|((name, metadata), group)| Object { name, metadata, group }).collect())
    }

    /// The properties of an object.
    ///
    /// # Errors
    /// For headers that contradict the file.
    pub fn properties(&mut self, object: &Object) -> Result<Compound, AlembicError> {
        if object.group == 0 {
            return Ok(Compound::default());
        }
        match self.source.child(object.group, 0)? {
            first if first & layout::DATA != 0 => Ok(Compound::default()),
            first => self.compound_at(first),
        }
    }

    /// The properties of a compound; none for a property of another kind.
    ///
    /// # Errors
    /// For headers that contradict the file.
    pub fn compound(&mut self, property: &Property) -> Result<Compound, AlembicError> {
        if property.kind != PropertyKind::Compound {
            return Ok(Compound::default());
        }
        self.compound_at(property.group)
    }

    fn compound_at(&mut self, group: u64) -> Result<Compound, AlembicError> {
        let mut groups = self.group(group)?;
        let Some(headers) = groups.pop().filter(|last| last & layout::DATA != 0) else {
            return Ok(Compound::default());
        };
        let (at, bytes) = self.bytes(headers)?;
        Ok(Compound(headers::properties(&bytes, at, &self.table, self.times.len(), &groups)?))
    }

    /// The addresses in a group.
    fn group(&mut self, group: u64) -> Result<Vec<u64>, AlembicError> {
        let count = self.source.group_len(group)?;
        if count > MAX_CHILDREN {
            return Err(AlembicError::malformed(group, format!("{count} children"), "16777216 at most"));
        }
        self.spend(group, 8 * count)?;
        let mut bytes = vec![0; 8 * count as usize];
        if count > 0 {
            self.source.read(group + 8, &mut bytes)?;
        }
        Ok(bytes.as_chunks::<8>().0.iter().map(|&eight| u64::from_le_bytes(eight)).collect())
    }

    /// The content of data, with its position.
    fn bytes(&mut self, address: u64) -> Result<(u64, Vec<u8>), AlembicError> {
        let (at, size) = self.source.data(address)?;
        self.spend(at, size)?;
        let mut bytes = vec![0; size as usize];
        self.source.read(at, &mut bytes)?;
        Ok((at, bytes))
    }

    fn spend(&mut self, at: u64, bytes: u64) -> Result<(), AlembicError> {
        // Each piece counts, however small.
        self.spent = self.spent.saturating_add(bytes + 8);
        if self.spent > self.source.len().saturating_mul(2) + SLACK {
            return Err(AlembicError::malformed(
                at,
                "objects or properties that contain each other",
                "a tree of objects",
            ));
        }
        Ok(())
    }
}

fn read_times(at: u64, bytes: &[u8]) -> Result<Vec<Times>, AlembicError> {
    let mut rest = bytes;
    let mut all = Vec::new();
    while !rest.is_empty() {
        let here = at + (bytes.len() - rest.len()) as u64;
        let wrong =
            || AlembicError::malformed(here, "times that are cut or do not ascend", "times of samples");
        // The number of samples, the length of a cycle, the number of times in it, and these times.
        let (head, after) = rest.split_at_checked(16).ok_or_else(wrong)?;
        let number =
            |from: usize| head[from..].first_chunk::<4>().map_or(0, |&four| u32::from_le_bytes(four));
        let per_cycle = head[4..].first_chunk::<8>().map_or(0.0, |&eight| f64::from_le_bytes(eight));
        let listed = after.split_at_checked(8 * number(12) as usize).ok_or_else(wrong)?;
        let times = listed.0.as_chunks::<8>().0.iter().map(|&eight| f64::from_le_bytes(eight)).collect();
        all.push(Times::new(per_cycle, times).ok_or_else(wrong)?);
        rest = listed.1;
    }
    Ok(all)
}
