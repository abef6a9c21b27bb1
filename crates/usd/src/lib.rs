//! Stages of USD in one file: text (`.usda`) and binary crates (`.usdc`).
//!
//! Only what a reader asks for is decoded: prims by type, attributes at a time sample, targets of relationships, and the transforms of
//! prims. References, payloads, sublayers and variants are not composed; [`Layer::arcs`] says which there are. Of inherited and specialized prims only [`undrawn`] asks.

mod crate_bytes;
mod crate_file;
mod crate_samples;
mod crate_tokens;
mod crate_value;
mod error;
mod imageable;
mod layer;
mod primvar;
mod source;
mod text;
mod text_check;
mod transform;
mod value;

pub use error::UsdError;
pub use imageable::{Undrawn, undrawn, visibility_changes};
pub use layer::{Around, Layer, left_out_arcs};
pub use primvar::{Primvar, primvar};
pub use source::Source;
pub use transform::{StageSpace, own_transform, stage_space, to_stage, transform_times};
pub use value::Value;

/// The first bytes of a crate.
pub const CRATE_MAGIC: &[u8] = crate_file::CRATE_MAGIC;

/// The first bytes of a text file.
pub const TEXT_MAGIC: &[u8] = b"#usda";

/// Opens a stage. `is_crate` says whether it is a binary crate, by its first bytes; `name` is used in messages.
///
/// # Errors
/// If the file cannot be read or contradicts itself. The error has the byte offset.
pub fn open<'a>(
    name: &str,
    source: Source<'a>,
    is_crate: bool,
) -> Result<Box<dyn Layer + Send + 'a>, UsdError> {
    if is_crate {
        return Ok(Box::new(crate_file::CrateLayer::open(name, source)?));
    }
    Ok(Box::new(text::TextLayer::parse(name, &source.into_bytes(name)?)?))
}
