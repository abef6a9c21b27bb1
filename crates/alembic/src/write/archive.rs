//! The writer of an archive.

use std::io::{self, Seek, Write};

use super::chunks::Chunks;
use super::headers::{self, MetadataTable};
use super::samples::{Samples, Stored};
use crate::hash::digest;
use crate::layout;
use crate::pod::DataType;
use crate::times::Times;

/// The version of the layout of properties in Ogawa.
const FILE_VERSION: i32 = 0;
/// The version of the library whose layout is written: 1.8.3.
const LIBRARY_VERSION: i32 = 10803;

/// Writes an archive. Samples go to the file at once; [`ArchiveWriter::finish`] writes the tree of objects that refers to them.
pub struct ArchiveWriter<W> {
    chunks: Chunks<W>,
    versions: [u64; 2],
    times: Vec<Times>,
    /// The most samples of a property with each of the times.
    most: Vec<u64>,
}

/// A compound of properties, in their order: their names, metadata and content.
#[derive(Clone, Debug, Default)]
pub struct CompoundTree(Vec<(String, String, Entry)>);

#[derive(Clone, Debug)]
enum Entry {
    Compound(CompoundTree),
    Samples(Samples),
}

/// An object with its properties and children. Names of children are unique and contain no `/`.
#[derive(Clone, Debug, Default)]
pub struct ObjectTree {
    /// Its name.
    pub name: String,
    /// Its metadata, `key=value;key=value`.
    pub metadata: String,
    /// Its properties.
    pub properties: CompoundTree,
    /// Its children.
    pub children: Vec<ObjectTree>,
}

impl CompoundTree {
    /// Adds a property with samples.
    pub fn samples(&mut self, name: &str, metadata: &str, samples: Samples) {
        self.0.push((name.to_owned(), metadata.to_owned(), Entry::Samples(samples)));
    }

    /// Adds a compound.
    pub fn compound(&mut self, name: &str, metadata: &str, compound: CompoundTree) {
        self.0.push((name.to_owned(), metadata.to_owned(), Entry::Compound(compound)));
    }
}

impl<W: Write + Seek> ArchiveWriter<W> {
    /// Starts an archive at the start of an empty file.
    ///
    /// # Errors
    /// Those of the file.
    pub fn create(out: W) -> io::Result<Self> {
        let mut chunks = Chunks::create(out)?;
        let versions =
            [chunks.data(&[&FILE_VERSION.to_le_bytes()])?, chunks.data(&[&LIBRARY_VERSION.to_le_bytes()])?];
        // The times with index 0 are those of properties without times.
        Ok(Self { chunks, versions, times: vec![Times::uniform(0.0, 1.0)], most: vec![0] })
    }

    /// Adds times and returns their index.
    pub fn add_times(&mut self, times: Times) -> u32 {
        self.times.push(times);
        self.most.push(0);
        self.times.len() as u32 - 1
    }

    /// Writes a sample: the bytes of its elements, little-endian; text is UTF-8, each string ended by a zero.
    ///
    /// # Errors
    /// Those of the file.
    pub fn store(&mut self, ty: DataType, bytes: &[u8]) -> io::Result<Stored> {
        let is_text = Samples::is_text(ty);
        let elements = if is_text {
            bytes.split(|&byte| byte == 0).count().saturating_sub(1) / usize::from(ty.extent)
        } else {
            bytes.len() / (ty.pod.bytes() * usize::from(ty.extent))
        } as u64;
        let digest = digest(&[bytes]);
        // An empty sample has no digest either.
        let at = if bytes.is_empty() { layout::DATA } else { self.chunks.data(&[&digest, bytes])? };
        let dimensions =
            if is_text { self.chunks.data(&[&(elements as u32).to_le_bytes()])? } else { layout::DATA };
        Ok(Stored { at, digest, elements, dimensions })
    }

    /// Writes the tree and completes the archive. `metadata` describes the archive. Returns the file, at its end, and its length.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(mut self, metadata: &str, children: Vec<ObjectTree>) -> io::Result<(W, u64)> {
        let mut table = MetadataTable::new();
        let top = ObjectTree { children, ..ObjectTree::default() };
        let (root, _) = self.object(&top, &mut table)?;
        let metadata = self.chunks.data(&[metadata.as_bytes()])?;
        let mut times = Vec::new();
        for (most, samples) in self.most.iter().zip(&self.times) {
            let (per_cycle, listed) = samples.parts();
            times.extend((*most as u32).to_le_bytes());
            times.extend(per_cycle.to_le_bytes());
            times.extend((listed.len() as u32).to_le_bytes());
            times.extend(listed.iter().flat_map(|time| time.to_le_bytes()));
        }
        let times = self.chunks.data(&[&times])?;
        let table = self.chunks.data(&[&table.bytes()])?;
        let [file, library] = self.versions;
        let root = self.chunks.group(&[file, library, root, metadata, times, table])?;
        self.chunks.finish(root)
    }

    /// Writes an object with all below it. Returns the address of its group, and its digest.
    fn object(&mut self, object: &ObjectTree, table: &mut MetadataTable) -> io::Result<(u64, [u8; 16])> {
        let (properties, of_properties) = self.compound(&object.properties, table)?;
        let mut group = vec![properties];
        let (mut headers, mut digests) = (Vec::new(), Vec::new());
        for child in &object.children {
            let (at, digest) = self.object(child, table)?;
            group.push(at);
            digests.push(digest);
            headers::object(&mut headers, &child.name, &child.metadata, table);
        }
        let of_children = if digests.is_empty() { [0; 16] } else { digest(&[digests.as_flattened()]) };
        group.push(self.chunks.data(&[&headers, &of_properties, &of_children])?);
        let whole =
            digest(&[object.name.as_bytes(), object.metadata.as_bytes(), &of_properties, &of_children]);
        Ok((self.chunks.group(&group)?, whole))
    }

    fn compound(
        &mut self,
        compound: &CompoundTree,
        table: &mut MetadataTable,
    ) -> io::Result<(u64, [u8; 16])> {
        let (mut group, mut headers, mut digests) = (Vec::new(), Vec::new(), Vec::new());
        for (name, metadata, entry) in &compound.0 {
            match entry {
                Entry::Compound(inner) => {
                    let (at, digest) = self.compound(inner, table)?;
                    group.push(at);
                    digests.push(digest);
                    headers::property(&mut headers, name, metadata, None, table);
                }
                Entry::Samples(samples) => {
                    group.push(self.chunks.group(&samples.children)?);
                    let last = samples.children.iter().flat_map(|at| at.to_le_bytes()).collect::<Vec<_>>();
                    digests.push(digest(&[name.as_bytes(), metadata.as_bytes(), &last]));
                    headers::property(&mut headers, name, metadata, Some(samples), table);
                    let is_constant = samples.last_changed == 0;
                    let count = if is_constant { samples.count.min(1) } else { samples.count };
                    if let Some(most) = self.most.get_mut(samples.times as usize) {
                        *most = count.max(*most);
                    }
                }
            }
        }
        if !headers.is_empty() {
            group.push(self.chunks.data(&[&headers])?);
        }
        let whole = digest(&[digests.as_flattened()]);
        Ok((self.chunks.group(&group)?, whole))
    }
}
