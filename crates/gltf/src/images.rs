//! The bytes of images: views of buffers, data URIs, and separate files.

use std::borrow::Cow;
use std::path::Path;

use crate::buffers::{data_uri, file_bytes};
use crate::{Buffers, Document, GltfError};

/// Fetches the encoded images of one file.
#[derive(Clone, Copy, Debug)]
pub struct ImageFiles<'a> {
    pub(crate) file: &'a str,
    pub(crate) document: &'a Document,
    pub(crate) buffers: &'a Buffers<'a>,
    pub(crate) folder: Option<&'a Path>,
}

impl<'a> ImageFiles<'a> {
    /// What an image is called: its name, otherwise its file, otherwise its number.
    pub fn name(&self, index: usize) -> String {
        let image = self.document.images.get(index);
        let uri = image.and_then(|image| image.uri.as_deref()).filter(|uri| !uri.starts_with("data:"));
        let name = image.and_then(|image| image.name.as_deref()).filter(|name| !name.is_empty());
        uri.or(name).map_or_else(|| format!("image {index}"), |name| name.chars().take(80).collect())
    }

    /// The bytes of an image as the file stores them, whatever they are.
    ///
    /// # Errors
    /// If there is no such image, its bytes are missing or outside the folder, or its file is larger than `limit` bytes.
    pub fn bytes(&self, index: usize, limit: u64) -> Result<Cow<'a, [u8]>, GltfError> {
        let place = format!("image {index}");
        let malformed = |found: String, wanted: &str| GltfError::malformed(self.file, &*place, found, wanted);
        let image = self.document.images.get(index);
        let image = image.ok_or_else(|| {
            malformed(format!("{} images", self.document.images.len()), "one with this number")
        })?;
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match data_uri(self.file, &place, uri)? {
                Some(bytes) => Ok(Cow::Owned(bytes)),
                None => file_bytes(self.file, &place, uri, self.folder, limit).map(Cow::Owned),
            },
            (None, Some(view)) => self.view(view).map(Cow::Borrowed).ok_or_else(|| {
                malformed(
                    format!("bufferView {view}, which the buffers do not hold"),
                    "one within its buffer",
                )
            }),
            (None, None) => Err(malformed("neither a URI nor a bufferView".to_owned(), "one of them")),
        }
    }

    fn view(&self, index: usize) -> Option<&'a [u8]> {
        let view = self.document.buffer_views.get(index)?;
        let buffer: &'a [u8] = self.buffers.bytes.get(view.buffer)?;
        let start = usize::try_from(view.byte_offset).ok()?;
        let length = usize::try_from(view.byte_length).ok()?;
        buffer.get(start..)?.get(..length)
    }
}
