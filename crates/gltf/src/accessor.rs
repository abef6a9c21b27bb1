//! Typed numbers from buffers: every component type, normalisation, strides, sparse and zero-filled
//! accessors.

use std::cell::Cell;

use crate::document::{Accessor, Document};
use crate::{Buffers, GltfError};

/// Reads the accessors of one file, and refuses those that exceed their buffers.
#[derive(Debug)]
pub struct Accessors<'a> {
    /// The file as the user named it.
    pub file: &'a str,
    /// The document with the accessors.
    pub document: &'a Document,
    buffers: &'a Buffers<'a>,
    /// Remaining number of values that may be decoded, so that a small file cannot refer to the same bytes a
    /// thousand times.
    budget: Cell<u64>,
}

/// A component type of glTF.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Decodes one number from its bytes; integers are normalised as in glTF 2.0, section 3.11.
    fn decode(self, b: &[u8], normalized: bool) -> f32 {
        let n = |value: f32, largest: f32| if normalized { (value / largest).max(-1.0) } else { value };
        match self {
            Self::I8 => n(f32::from(b[0] as i8), 127.0),
            Self::U8 => n(f32::from(b[0]), 255.0),
            Self::I16 => n(f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            Self::U16 => n(f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            Self::U32 => n(u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, u32::MAX as f32),
            Self::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    /// Decodes one unsigned integer; `None` for other types.
    fn decode_index(self, b: &[u8]) -> Option<u32> {
        Some(match self {
            Self::U8 => u32::from(b[0]),
            Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            Self::I8 | Self::I16 | Self::F32 => return None,
        })
    }
}

/// What indices are.
const UNSIGNED: &str = "unsigned integers";

fn components_of(kind: &str) -> Option<usize> {
    Some(match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => return None,
    })
}

/// A sequence of elements: the bytes from the first element on, and the distance between elements.
#[derive(Clone, Copy)]
struct ElementRun<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Accessors<'a> {
    pub(crate) fn new(file: &'a str, document: &'a Document, buffers: &'a Buffers<'a>) -> Self {
        Self { file, document, buffers, budget: Cell::new(64 * buffers.total().max(1 << 16)) }
    }

    fn error(&self, index: usize, found: impl Into<String>, wanted: impl Into<String>) -> GltfError {
        GltfError::malformed(self.file, format!("accessor {index}"), found, wanted)
    }

    fn get(&self, index: usize) -> Result<&'a Accessor, GltfError> {
        let count = self.document.accessors.len();
        self.document
            .accessors
            .get(index)
            .ok_or_else(|| self.error(index, "an index out of range", format!("one of {count} accessors")))
    }

    /// Number of elements, not yet checked.
    ///
    /// # Errors
    /// If there is no such accessor.
    pub fn count(&self, index: usize) -> Result<u64, GltfError> {
        Ok(self.get(index)?.count)
    }

    /// Bytes of `count` elements of `element` bytes in a view, checked in 64 bits.
    fn run(
        &self,
        index: usize,
        view: usize,
        offset: u64,
        count: u64,
        element: usize,
    ) -> Result<ElementRun<'a>, GltfError> {
        let missing = |what: &str, i: usize| {
            self.error(index, format!("{what} {i}, which is missing"), "an existing one")
        };
        let v = self.document.buffer_views.get(view).ok_or_else(|| missing("bufferView", view))?;
        let buffer: &'a [u8] = self
            .buffers
            .bytes
            .get(v.buffer)
            .map(|bytes| &**bytes)
            .ok_or_else(|| missing("buffer", v.buffer))?;
        // Zero is not allowed but is interpreted as tightly packed.
        let stride = v.byte_stride.filter(|&s| s != 0).unwrap_or(element as u64);
        let length = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|n| n.checked_add(element as u64)),
        };
        let end_in_view = length.and_then(|n| n.checked_add(offset));
        let end = v.byte_offset.checked_add(v.byte_length);
        match (end_in_view, end) {
            (Some(in_view), Some(end)) if in_view <= v.byte_length && end <= buffer.len() as u64 => {
                let start = (v.byte_offset + offset) as usize;
                Ok(ElementRun { bytes: &buffer[start..end as usize], stride: stride as usize })
            }
            _ => Err(self.error(
                index,
                format!("{count} elements of {element} bytes from byte {offset} of bufferView {view}"),
                format!(
                    "as many as fit into its {} bytes from byte {} of a buffer of {}",
                    v.byte_length,
                    v.byte_offset,
                    buffer.len()
                ),
            )),
        }
    }

    /// Calls `store` with the bytes of each element: first the base elements, then the replacements of a
    /// sparse accessor. Elements without bytes are skipped and stay zero.
    fn each(
        &self,
        index: usize,
        element: usize,
        mut store: impl FnMut(usize, &[u8]) -> Result<(), GltfError>,
    ) -> Result<(), GltfError> {
        let accessor = self.get(index)?;
        if let Some(view) = accessor.buffer_view {
            let run = self.run(index, view, accessor.byte_offset, accessor.count, element)?;
            for i in 0..accessor.count as usize {
                store(i, &run.bytes[i * run.stride..][..element])?;
            }
        }
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let component = Component::new(sparse.indices.component_type)
            .ok_or_else(|| self.error(index, "sparse indices of an unknown component type", UNSIGNED))?;
        let places = self.run(
            index,
            sparse.indices.buffer_view,
            sparse.indices.byte_offset,
            sparse.count,
            component.size(),
        )?;
        let values =
            self.run(index, sparse.values.buffer_view, sparse.values.byte_offset, sparse.count, element)?;
        for k in 0..sparse.count as usize {
            let place = component
                .decode_index(&places.bytes[k * places.stride..])
                .ok_or_else(|| self.error(index, "sparse indices of another type", UNSIGNED))?;
            if u64::from(place) >= accessor.count {
                let wanted = format!("one of its {} elements", accessor.count);
                return Err(self.error(index, format!("the sparse index {place}"), wanted));
            }
            store(place as usize, &values.bytes[k * values.stride..][..element])?;
        }
        Ok(())
    }

    /// Checks that `count` elements may be allocated, before they are.
    fn check_budget(&self, index: usize, accessor: &Accessor, components: usize) -> Result<(), GltfError> {
        let bytes = self.buffers.total();
        // If the file has no bytes for the elements, their number must not exceed the size of the file.
        if accessor.buffer_view.is_none() && accessor.count > bytes.max(1 << 16) {
            let found = format!("{} elements without bytes in the file", accessor.count);
            return Err(self.error(index, found, format!("{} at most", bytes.max(1 << 16))));
        }
        let wanted = accessor.count.saturating_mul(components as u64);
        let left = self.budget.get().checked_sub(wanted);
        let left = left.ok_or_else(|| {
            let found = format!("{} elements, after others at the same bytes", accessor.count);
            self.error(index, found, format!("fewer in a file of {bytes} bytes"))
        })?;
        self.budget.set(left);
        Ok(())
    }

    /// Decodes elements of exactly `N` numbers. Integers are normalised where the file says so.
    ///
    /// # Errors
    /// If the accessor does not fit into its buffer or has elements of another type, and if a file refers to the same bytes very often.
    pub fn read<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, GltfError> {
        let (accessor, component, components) = self.shape(index)?;
        if components != N {
            return Err(self.error(
                index,
                format!("type {}", accessor.kind),
                format!("{N} numbers per element"),
            ));
        }
        self.decode(index, |bytes| component.decode(bytes, accessor.normalized))
    }

    /// Decodes elements of 3 or 4 numbers; a missing fourth is 1 (colours).
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_3_or_4(&self, index: usize) -> Result<Vec<[f32; 4]>, GltfError> {
        match self.shape(index)?.2 {
            4 => self.read::<4>(index),
            _ => Ok(self.read::<3>(index)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()),
        }
    }

    /// Decodes elements of `N` unsigned integers.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_indices<const N: usize>(&self, index: usize) -> Result<Vec<[u32; N]>, GltfError> {
        let (accessor, component, components) = self.shape(index)?;
        if components != N || component.decode_index(&[0; 4]).is_none() {
            let found = format!("type {} of components {}", accessor.kind, accessor.component_type);
            return Err(self.error(index, found, format!("{N} unsigned integers per element")));
        }
        self.decode(index, |bytes| component.decode_index(bytes).unwrap_or(0))
    }

    /// Decodes elements of `N` numbers, each from the bytes of one component. The shape was checked.
    fn decode<T: Copy + Default, const N: usize>(
        &self,
        index: usize,
        number: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<[T; N]>, GltfError> {
        let (accessor, component, _) = self.shape(index)?;
        let size = component.size();
        // Bounds are checked first, so that the allocation below is justified by the file.
        if let Some(view) = accessor.buffer_view {
            self.run(index, view, accessor.byte_offset, accessor.count, N * size)?;
        }
        self.check_budget(index, accessor, N)?;
        let mut out = vec![[T::default(); N]; accessor.count as usize];
        self.each(index, N * size, |i, bytes| {
            for (value, bytes) in out[i].iter_mut().zip(bytes.chunks_exact(size)) {
                *value = number(bytes);
            }
            Ok(())
        })?;
        Ok(out)
    }

    fn shape(&self, index: usize) -> Result<(&'a Accessor, Component, usize), GltfError> {
        let accessor = self.get(index)?;
        let component = Component::new(accessor.component_type).ok_or_else(|| {
            self.error(index, format!("component type {}", accessor.component_type), "one from 5120 to 5126")
        })?;
        let components = components_of(&accessor.kind).ok_or_else(|| {
            self.error(index, format!("type `{}`", accessor.kind), "SCALAR, VEC2, VEC3, VEC4 or MAT4")
        })?;
        Ok((accessor, component, components))
    }
}
