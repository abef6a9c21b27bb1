//! The bytes of a glTF file: its container, its buffers, and the arrays in them.

use std::borrow::Cow;
use std::io::Read;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use base64::engine::{DecodePaddingMode, general_purpose};
use percent_encoding::percent_decode_str;

use super::document::{Accessor, Buffer, Document};
use crate::io::HairFileError;
use crate::io::source::open_beside;

/// Chunk types of a binary file.
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;
/// The most elements of an array that has no bytes in the file (all zeros).
const MOST_ZEROS: u64 = 1 << 24;
/// The most bytes of all buffers together.
const MOST_BYTES: u64 = 1 << 33;

/// Builds errors about one file.
#[derive(Clone, Copy)]
pub(super) struct File<'a> {
    pub(super) name: &'a str,
}

impl File<'_> {
    pub(super) fn malformed(
        &self,
        offset: u64,
        found: impl Into<String>,
        wanted: impl Into<String>,
    ) -> HairFileError {
        HairFileError::Malformed {
            name: self.name.to_owned(),
            offset,
            found: found.into(),
            wanted: wanted.into(),
        }
    }
}

/// The document of a file and, of a binary one, its buffer (glTF 2.0, section 4.4).
pub(super) fn split<'a>(
    file: File<'_>,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), HairFileError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let word = |at: usize| {
        let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        four.map(|&four| u32::from_le_bytes(four)).ok_or_else(|| {
            file.malformed(at as u64, format!("a file of {} bytes", bytes.len()), "the header of a chunk")
        })
    };
    if word(4)? != 2 {
        return Err(file.malformed(4, format!("glTF version {}", word(4)?), "version 2"));
    }
    let (mut json, mut bin, mut at) = (None, None, 12_usize);
    // Some writers leave a few bytes of padding at the end.
    while json.is_none() || bin.is_none() && at + 8 <= bytes.len() {
        let (length, kind) = (word(at)? as usize, word(at + 4)?);
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..length)).ok_or_else(|| {
            let found = format!("a chunk of {length} bytes, of which the file has {}", bytes.len() - at - 8);
            file.malformed(at as u64, found, "the whole chunk: the file is truncated")
        })?;
        match kind {
            JSON if json.is_none() => json = Some(data),
            BIN if bin.is_none() => bin = Some(data),
            _ => {}
        }
        at += 8 + length;
    }
    Ok((json.unwrap_or_default(), bin))
}

/// A document with its buffers.
pub(super) struct Data<'a> {
    file: File<'a>,
    document: &'a Document,
    buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Data<'a> {
    /// Fetches all buffers: the binary chunk, data URIs, and files in `folder`.
    pub(super) fn load(
        file: File<'a>,
        document: &'a Document,
        bin: Option<&'a [u8]>,
        folder: Option<&Path>,
    ) -> Result<Self, HairFileError> {
        let mut buffers = Vec::with_capacity(document.buffers.len());
        let mut total = 0;
        for (index, buffer) in document.buffers.iter().enumerate() {
            let bytes = match (&buffer.uri, bin.filter(|_| index == 0)) {
                (Some(uri), _) => Cow::Owned(fetch(uri, buffer, folder).map_err(|why| {
                    let uri: String = uri.chars().take(80).collect();
                    file.malformed(0, format!("buffer {index} in `{uri}`: {why}"), "a data URI or a file")
                })?),
                (None, Some(bin)) => Cow::Borrowed(bin),
                (None, None) if buffer.byte_length == 0 => Cow::Borrowed(&[][..]),
                (None, None) => {
                    return Err(file.malformed(0, format!("buffer {index} without bytes"), "a URI"));
                }
            };
            total += bytes.len() as u64;
            if total > MOST_BYTES || (bytes.len() as u64) < buffer.byte_length {
                let found = format!("buffer {index} of {} bytes", bytes.len());
                return Err(file.malformed(0, found, format!("{} bytes (byteLength)", buffer.byte_length)));
            }
            buffers.push(bytes);
        }
        Ok(Self { file, document, buffers })
    }

    /// The bytes of a view from `offset` on.
    fn view(&self, view: usize, offset: u64, what: &str) -> Result<(&[u8], Option<u64>), HairFileError> {
        let found = self.document.buffer_views.get(view).and_then(|view| {
            let buffer = self.buffers.get(view.buffer)?;
            let end = view.byte_offset.checked_add(view.byte_length)?;
            let bytes = buffer.get(usize::try_from(view.byte_offset).ok()?..usize::try_from(end).ok()?)?;
            Some((bytes.get(usize::try_from(offset).ok()?..)?, view.byte_stride))
        });
        found.ok_or_else(|| {
            self.file.malformed(0, format!("{what} outside its buffer view {view}"), "an array in a buffer")
        })
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, HairFileError> {
        self.document.accessors.get(index).ok_or_else(|| {
            let wanted = format!("one of {} accessors", self.document.accessors.len());
            self.file.malformed(0, format!("accessor {index}"), wanted)
        })
    }

    /// Calls `each` with every component of an accessor, as (element, component, value); elements have up to `width`
    /// components. Numbers that the file declares as normalized are scaled.
    fn components(
        &self,
        index: usize,
        width: usize,
        mut each: impl FnMut(usize, usize, f64),
    ) -> Result<(), HairFileError> {
        let what = format!("accessor {index}");
        let accessor = self.accessor(index)?;
        let has = match accessor.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            kind => return Err(self.file.malformed(0, format!("{what} of type `{kind}`"), "SCALAR or VEC3")),
        };
        if has < width.min(3) {
            let found = format!("{what} of type {}", accessor.kind);
            return Err(self.file.malformed(0, found, format!("{width} components")));
        }
        let shape = Shape::new(accessor.component_type, accessor.normalized).ok_or_else(|| {
            let found = format!("{what} of component type {}", accessor.component_type);
            self.file.malformed(0, found, "a component type from 5120 to 5126")
        })?;
        let mut read = |bytes: &[u8], stride: u64, count: u64, place: &dyn Fn(usize) -> Option<usize>| {
            let size = shape.size * has as u64;
            let needed = if count == 0 { 0 } else { (count - 1).saturating_mul(stride).saturating_add(size) };
            if needed > bytes.len() as u64 || stride < size {
                let found = format!("{what} of {count} elements in {} bytes", bytes.len());
                return Err(self.file.malformed(0, found, format!("{needed} bytes")));
            }
            for element in 0..count as usize {
                let Some(target) = place(element) else {
                    let found = format!("{what}: a sparse index that is out of range");
                    return Err(self.file.malformed(0, found, "an element of the accessor"));
                };
                for component in 0..has.min(width) {
                    let at = element * stride as usize + component * shape.size as usize;
                    each(target, component, shape.value(&bytes[at..]));
                }
            }
            Ok(())
        };
        let packed = shape.size * has as u64;
        match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view, accessor.byte_offset, &what)?;
                read(bytes, stride.unwrap_or(packed), accessor.count, &Some)?;
            }
            None if accessor.count > MOST_ZEROS => {
                let found = format!("{what} of {} elements without bytes", accessor.count);
                return Err(self.file.malformed(0, found, format!("{MOST_ZEROS} at most")));
            }
            None => {}
        }
        if let Some(sparse) = &accessor.sparse {
            let (places, _) = self.view(sparse.indices.buffer_view, sparse.indices.byte_offset, &what)?;
            let (values, _) = self.view(sparse.values.buffer_view, sparse.values.byte_offset, &what)?;
            let kind = Shape::new(sparse.indices.component_type, false).filter(|kind| kind.is_index());
            let kind = kind.filter(|kind| sparse.count.saturating_mul(kind.size) <= places.len() as u64);
            let kind = kind
                .ok_or_else(|| self.file.malformed(0, format!("{what}: sparse indices"), "whole numbers"))?;
            let place = |element: usize| {
                let place = kind.value(&places[element * kind.size as usize..]) as u64;
                (place < accessor.count).then_some(place as usize)
            };
            read(values, packed, sparse.count, &place)?;
        }
        Ok(())
    }

    /// The elements of an accessor of `N` components; those that the file lacks keep the value of `missing`.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: usize,
        missing: [f32; N],
    ) -> Result<Vec<[f32; N]>, HairFileError> {
        let count = self.bounded_count(index)?;
        let mut out = vec![missing; count];
        let accessor = self.accessor(index)?;
        if accessor.buffer_view.is_none() {
            out.fill([0.0; N]);
        }
        self.components(index, N, |element, component, value| out[element][component] = value as f32)?;
        Ok(out)
    }

    /// The whole numbers of an accessor, each below `most`.
    pub(super) fn indices(&self, index: usize, most: u64) -> Result<Vec<u32>, HairFileError> {
        let mut out = vec![0_u32; self.bounded_count(index)?];
        let mut largest = 0.0_f64;
        self.components(index, 1, |element, _, value| {
            largest = largest.max(value);
            out[element] = value as u32;
        })?;
        if largest as u64 >= most && !out.is_empty() {
            let found = format!("accessor {index} with the index {largest}");
            return Err(self.file.malformed(0, found, format!("indices of {most} points")));
        }
        Ok(out)
    }

    /// The count of an accessor, compared with the bytes behind it.
    fn bounded_count(&self, index: usize) -> Result<usize, HairFileError> {
        let accessor = self.accessor(index)?;
        let most = match accessor.buffer_view {
            Some(view) => self.view(view, accessor.byte_offset, &format!("accessor {index}"))?.0.len() as u64,
            None => MOST_ZEROS,
        };
        if accessor.count > most {
            let found = format!("accessor {index} of {} elements", accessor.count);
            return Err(self.file.malformed(0, found, format!("at most {most}, by the size of its buffer")));
        }
        Ok(accessor.count as usize)
    }
}

/// The type of a component.
#[derive(Clone, Copy)]
struct Shape {
    kind: u32,
    /// Bytes.
    size: u64,
    normalized: bool,
}

impl Shape {
    fn new(kind: u32, normalized: bool) -> Option<Self> {
        let size = match kind {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return None,
        };
        Some(Self { kind, size, normalized })
    }

    fn is_index(self) -> bool {
        matches!(self.kind, 5121 | 5123 | 5125)
    }

    /// The number at the start of the bytes, of which there are enough.
    fn value(self, bytes: &[u8]) -> f64 {
        let two = || bytes.first_chunk::<2>().copied().unwrap_or_default();
        let four = || bytes.first_chunk::<4>().copied().unwrap_or_default();
        let first = bytes.first().copied().unwrap_or_default();
        let (value, one) = match self.kind {
            5120 => (f64::from(first as i8), 127.0),
            5121 => (f64::from(first), 255.0),
            5122 => (f64::from(i16::from_le_bytes(two())), 32767.0),
            5123 => (f64::from(u16::from_le_bytes(two())), 65535.0),
            5125 => (f64::from(u32::from_le_bytes(four())), f64::from(u32::MAX)),
            _ => return f64::from(f32::from_le_bytes(four())),
        };
        if self.normalized { (value / one).max(-1.0) } else { value }
    }
}

/// The bytes behind a URI; the error is the reason.
fn fetch(uri: &str, buffer: &Buffer, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("the data URI is not base64")?;
        let lenient = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let engine = GeneralPurpose::new(&base64::alphabet::STANDARD, lenient);
        let decoded = engine.decode(text.trim()).or_else(|_| general_purpose::URL_SAFE.decode(text.trim()));
        return decoded.map_err(|error| format!("invalid base64: {error}"));
    }
    let name = percent_decode_str(uri).decode_utf8().map_err(|error| error.to_string())?;
    if name.contains([':', '\\', '\0']) {
        return Err("only files in the folder of the file and below are read".to_owned());
    }
    let mut bytes = Vec::new();
    let opened = open_beside(folder, &PathBuf::from(&*name))?;
    let read = opened.take(buffer.byte_length.min(MOST_BYTES)).read_to_end(&mut bytes);
    read.map_err(|error| error.to_string())?;
    Ok(bytes)
}
