//! Writing an archive: samples first, the tree of objects last.

mod archive;
mod chunks;
mod headers;
mod samples;

pub use archive::{ArchiveWriter, CompoundTree, ObjectTree};
pub use samples::{Samples, Stored};
