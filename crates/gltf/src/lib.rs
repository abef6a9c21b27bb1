//! glTF 2.0 files: the container, the document, the bytes of buffers and the numbers of accessors.
//!
//! The document is parsed leniently, and every index, offset and count is checked in 64 bits before use. A validating reader would
//! refuse files that are legal (accessors without bytes, quantised meshes) or that only lack a texture. What nodes, meshes and
//! animations become is up to the reader of hair or of characters.

mod accessor;
mod buffers;
mod container;
pub mod document;
mod error;
pub mod glb;
mod images;

use std::path::Path;

pub use accessor::Accessors;
pub use buffers::{Buffers, gltf_reference};
pub use container::{Container, MAGIC, without_mark};
pub use document::Document;
pub use error::{DRACO, GltfError};
pub use images::ImageFiles;

/// A file whose buffers are in memory.
#[derive(Debug)]
pub struct Asset<'a> {
    /// The file as the user named it.
    pub file: &'a str,
    /// The name of the format.
    pub format: &'static str,
    /// What the file contains.
    pub document: Document,
    buffers: Buffers<'a>,
    folder: Option<&'a Path>,
}

impl<'a> Asset<'a> {
    /// Reads a file and fetches its buffers: the binary chunk, data URIs, and files in `folder` and below. `file` is used in messages.
    ///
    /// # Errors
    /// If the file contradicts itself, lacks a buffer, refers to data outside its folder, or needs an extension that is not supported.
    pub fn read(file: &'a str, bytes: &'a [u8], folder: Option<&'a Path>) -> Result<Self, GltfError> {
        let container = Container::open(file, bytes)?;
        let document: Document = serde_json::from_slice(container.json).map_err(|error| {
            let offset = (container.json.as_ptr() as usize - bytes.as_ptr() as usize) as u64;
            let found = format!("{error}");
            GltfError::malformed(file, "the JSON text", found, "a glTF 2.0 document").at(offset)
        })?;
        if let Some(extension) = document.extensions_required.iter().find(|name| !is_harmless(name)) {
            return Err(GltfError::extension(file, extension));
        }
        let buffers = Buffers::load(file, &document, container.bin, folder)?;
        Ok(Self { file, format: container.format, document, buffers, folder })
    }

    /// A reader of the accessors.
    pub fn accessors(&self) -> Accessors<'_> {
        Accessors::new(self.file, &self.document, &self.buffers)
    }

    /// A reader of the encoded images.
    pub fn images(&self) -> ImageFiles<'_> {
        ImageFiles { file: self.file, document: &self.document, buffers: &self.buffers, folder: self.folder }
    }
}

/// Required extensions that are supported or do not affect shape and motion.
fn is_harmless(extension: &str) -> bool {
    const KNOWN: [&str; 9] = [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "KHR_lights_punctual",
        "KHR_xmp_json_ld",
        "KHR_node_visibility",
        "EXT_texture_webp",
        "EXT_texture_avif",
        "MSFT_texture_dds",
    ];
    KNOWN.contains(&extension) || ["KHR_materials_", "VRM"].iter().any(|prefix| extension.starts_with(prefix))
}
