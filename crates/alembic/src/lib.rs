//! Alembic archives in the Ogawa form (`.abc`).
//!
//! An archive is a tree of *objects*. Each has a name, metadata and a compound of *properties*; a property holds samples over
//! time, and each sample is a scalar or an array of numbers. A *schema* is a convention for the names of properties: curves,
//! meshes and transforms. This crate reads and writes the archive; schemas stand in the crates that use them.
//!
//! In the file, Ogawa stores *groups* (lists of addresses) and *data* (bytes). [`Archive`] reads from memory or from a file,
//! one sample at a time. Whatever the bytes, it returns a value or an error: every address and length is compared with the file,
//! and objects that contain each other are refused. [`ArchiveWriter`] appends samples as they come and keeps only their
//! addresses in memory.
//!
//! The layout is that of the library Alembic 1.8 (`AbcCoreOgawa`). The older form in HDF5 is refused by name.

mod error;
mod hash;
mod layout;
mod pod;
mod read;
mod times;
mod write;

#[cfg(test)]
mod tests;

pub use error::AlembicError;
pub use layout::metadata_value;
pub use pod::{DataType, Pod};
pub use read::{Archive, Compound, Object, Property, PropertyKind, Source};
pub use times::Times;
pub use write::{ArchiveWriter, CompoundTree, ObjectTree, Samples, Stored};

/// The first bytes of every archive that this crate reads.
pub const OGAWA_MAGIC: &[u8] = layout::MAGIC;
/// The first bytes of an archive in the older form, which this crate refuses.
pub const HDF5_MAGIC: &[u8] = b"\x89HDF\r\n\x1a\n";
