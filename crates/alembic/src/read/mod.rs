//! Reading an archive.

mod archive;
mod headers;
mod sample;
mod source;

pub use archive::{Archive, Compound, Object};
pub use headers::{Property, PropertyKind};
pub use source::Source;
