//! Reads values of a crate.

use glam::Vec3;

use crate::UsdError;
use crate::crate_bytes::{CrateBytes, u64_of};
use crate::crate_tokens::Tokens;
use crate::value::{Value, half};

const IS_ARRAY: u64 = 1 << 63;
const IS_INLINED: u64 = 1 << 62;
const IS_COMPRESSED: u64 = 1 << 61;
/// The most times of an attribute, if they are compressed.
const MAX_TIMES: usize = 1 << 20;
const PAYLOAD: u64 = (1 << 48) - 1;

/// Value types by their numbers in a crate.
mod kind {
    pub(crate) const BOOL: u64 = 1;
    pub(crate) const INT: u64 = 3;
    pub(crate) const INT64: u64 = 5;
    pub(crate) const HALF: u64 = 7;
    pub(crate) const FLOAT: u64 = 8;
    pub(crate) const DOUBLE: u64 = 9;
    pub(crate) const TOKEN: u64 = 11;
    pub(crate) const ASSET_PATH: u64 = 12;
    pub(crate) const MATRIX4D: u64 = 15;
    pub(crate) const QUATD: u64 = 16;
    pub(crate) const QUATF: u64 = 17;
    pub(crate) const QUATH: u64 = 18;
    pub(crate) const VEC2D: u64 = 19;
    pub(crate) const VEC2F: u64 = 20;
    pub(crate) const VEC2H: u64 = 21;
    pub(crate) const VEC3D: u64 = 23;
    pub(crate) const VEC3F: u64 = 24;
    pub(crate) const VEC3H: u64 = 25;
    pub(crate) const VEC4D: u64 = 27;
    pub(crate) const VEC4F: u64 = 28;
    pub(crate) const PATH_LIST: u64 = 34;
    pub(crate) const TOKEN_VECTOR: u64 = 41;
    pub(crate) const TIME_SAMPLES: u64 = 46;
    pub(crate) const DOUBLE_VECTOR: u64 = 48;
}

/// The numbers that vectors and arrays consist of.
#[derive(Clone, Copy)]
enum Number {
    Half,
    Float,
    Double,
}

impl Number {
    fn size(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn of(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::Half, &[a, b, ..]) => f64::from(half(u16::from_le_bytes([a, b]))),
            (Self::Float, &[a, b, c, d, ..]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            (Self::Double, bytes) => f64::from_bits(u64_of(bytes)),
            _ => f64::NAN,
        }
    }
}

/// Reads values of a crate, with the tokens that they refer to.
pub(crate) struct CrateValues<'a> {
    pub(crate) file: CrateBytes<'a>,
    /// Version of the crate: major, minor, patch.
    pub(crate) version: [u8; 3],
    pub(crate) tokens: Tokens,
}

impl CrateValues<'_> {
    /// The values of time samples: the position of the first one, and their number, which fits into the file.
    pub(crate) fn samples(&mut self, samples: u64) -> Result<Option<(u64, u64)>, UsdError> {
        if samples >> 48 & 0xff != kind::TIME_SAMPLES {
            return Ok(None);
        }
        let at = samples & PAYLOAD;
        // Two relative offsets: one to the times, and one after their value to the number of samples and their values.
        let times = at.wrapping_add(self.file.u64(at)?);
        let at = times.saturating_add(8);
        let values = at.wrapping_add(self.file.u64(at)?);
        let count = self.file.u64(values)?;
        let first = values.saturating_add(8);
        let fits = count.checked_mul(8).and_then(|bytes| first.checked_add(bytes));
        if fits.is_none_or(|end| end > self.file.len()) {
            return Err(self.file.at(
                values,
                format!("{count} time samples"),
                "as many as the file can hold",
            ));
        }
        Ok(Some((first, count)))
    }

    /// The times of time samples, in time codes.
    pub(crate) fn times(&mut self, samples: u64) -> Result<Vec<f64>, UsdError> {
        if samples >> 48 & 0xff != kind::TIME_SAMPLES {
            return Ok(Vec::new());
        }
        let at = samples & PAYLOAD;
        let times = at.wrapping_add(self.file.u64(at)?);
        let value = self.file.u64(times)?;
        let (at, kind) = (value & PAYLOAD, value >> 48 & 0xff);
        let (count, start) = match kind {
            kind::DOUBLE_VECTOR if at == 0 => (0, 0),
            kind::DOUBLE_VECTOR => (self.file.u64(at)?, at + 8),
            // Pixar writes a vector, the `openusd` library an array.
            kind::DOUBLE if value & (IS_ARRAY | IS_COMPRESSED) == IS_ARRAY => self.length(at)?,
            kind::DOUBLE if value & IS_ARRAY != 0 => {
                let Some(Value::Floats(times)) = self.value(value, MAX_TIMES)? else {
                    return Ok(Vec::new());
                };
                return Ok(times.into_iter().map(f64::from).collect());
            }
            _ => return Err(self.file.at(times, format!("times of type {kind}"), "numbers")),
        };
        let bytes = self.file.bytes(start, count.saturating_mul(8), "bytes of times")?;
        Ok(bytes.chunks_exact(8).map(|eight| f64::from_bits(u64_of(eight))).collect())
    }

    /// The indices of the paths in a list of targets.
    pub(crate) fn paths(&mut self, value: u64) -> Result<Vec<u32>, UsdError> {
        let (at, kind) = (value & PAYLOAD, value >> 48 & 0xff);
        if kind != kind::PATH_LIST {
            return Ok(Vec::new());
        }
        let bits = self.file.bytes(at, 1, "byte that says which lists follow")?[0];
        let (mut at, mut paths) = (at + 1, Vec::new());
        // Explicit, added, prepended and appended ones; deleted and ordered ones come after them.
        for _ in [1, 2, 5, 6].into_iter().filter(|bit| bits >> bit & 1 == 1) {
            let count = self.file.u64(at)?;
            let bytes = self.file.bytes(at + 8, count.saturating_mul(4), "bytes of paths")?;
            paths.extend(bytes.as_chunks::<4>().0.iter().map(|&four| u32::from_le_bytes(four)));
            at += 8 + 4 * count;
        }
        Ok(paths)
    }

    /// Reads a value; `None` for types that no reader needs. Compressed arrays may have at most
    /// `most` elements.
    pub(crate) fn value(&mut self, value: u64, most: usize) -> Result<Option<Value>, UsdError> {
        let (is_array, is_inlined) = (value & IS_ARRAY != 0, value & IS_INLINED != 0);
        let (at, kind) = (value & PAYLOAD, value >> 48 & 0xff);
        if kind == kind::TOKEN_VECTOR || is_array && kind == kind::TOKEN {
            return self.words(at, kind == kind::TOKEN, most).map(Some);
        }
        if is_array {
            return self.array(value, most);
        }
        let inlined = at as u32;
        Ok(Some(match kind {
            kind::BOOL => Value::Bool(inlined != 0),
            kind::TOKEN => Value::Token(self.tokens.get(inlined).unwrap_or_default().to_owned()),
            kind::ASSET_PATH if is_inlined => {
                Value::Token(self.tokens.get(inlined).unwrap_or_default().to_owned())
            }
            kind::INT => Value::Numbers(vec![f64::from(inlined as i32)]),
            kind::INT64 if is_inlined => Value::Numbers(vec![f64::from(inlined as i32)]),
            kind::INT64 => Value::Numbers(vec![self.file.u64(at)? as i64 as f64]),
            kind::HALF => Value::Numbers(vec![f64::from(half(inlined as u16))]),
            kind::FLOAT | kind::DOUBLE if is_inlined => {
                Value::Numbers(vec![f64::from(f32::from_bits(inlined))])
            }
            // Small integer components are inlined, one byte each; for a matrix only its diagonal.
            kind::VEC3D | kind::VEC3F | kind::VEC3H if is_inlined => {
                Value::Numbers(inlined.to_le_bytes()[..3].iter().map(|&b| f64::from(b as i8)).collect())
            }
            kind::VEC2F if is_inlined => {
                Value::Numbers(inlined.to_le_bytes()[..2].iter().map(|&b| f64::from(b as i8)).collect())
            }
            kind::VEC4D | kind::VEC4F if is_inlined => {
                Value::Numbers(inlined.to_le_bytes().map(|b| f64::from(b as i8)).to_vec())
            }
            kind::MATRIX4D if is_inlined => {
                let mut rows = vec![0.0; 16];
                for (i, byte) in inlined.to_le_bytes().into_iter().enumerate() {
                    rows[5 * i] = f64::from(byte as i8);
                }
                Value::Numbers(rows)
            }
            kind::FLOAT => self.numbers(at, Number::Float, 1)?,
            kind::DOUBLE => self.numbers(at, Number::Double, 1)?,
            kind::VEC2F => self.numbers(at, Number::Float, 2)?,
            kind::VEC3H => self.numbers(at, Number::Half, 3)?,
            kind::VEC3F => self.numbers(at, Number::Float, 3)?,
            kind::VEC3D => self.numbers(at, Number::Double, 3)?,
            kind::VEC4F => self.numbers(at, Number::Float, 4)?,
            kind::VEC4D => self.numbers(at, Number::Double, 4)?,
            kind::MATRIX4D => self.numbers(at, Number::Double, 16)?,
            kind::QUATH => self.quaternion(at, Number::Half)?,
            kind::QUATF => self.quaternion(at, Number::Float)?,
            kind::QUATD => self.quaternion(at, Number::Double)?,
            _ => return Ok(None),
        }))
    }

    fn numbers(&mut self, at: u64, number: Number, count: usize) -> Result<Value, UsdError> {
        let bytes = self.file.bytes(at, (count * number.size()) as u64, "bytes of a value")?;
        Ok(Value::Numbers(bytes.chunks_exact(number.size()).map(|bytes| number.of(bytes)).collect()))
    }

    /// Quaternions are stored with the real part last.
    fn quaternion(&mut self, at: u64, number: Number) -> Result<Value, UsdError> {
        let value = self.numbers(at, number, 4)?;
        let &[x, y, z, w] = value.numbers() else { return Ok(value) };
        Ok(Value::Numbers(vec![w, x, y, z]))
    }

    fn words(&mut self, at: u64, is_array: bool, most: usize) -> Result<Value, UsdError> {
        if at == 0 {
            return Ok(Value::Tokens(Vec::new()));
        }
        let (count, start) = if is_array { self.length(at)? } else { (self.file.u64(at)?, at + 8) };
        if count > most as u64 {
            return Err(self.file.at(at, format!("{count} tokens"), &format!("{most} at most")));
        }
        let indices = self.file.bytes(start, 4 * count, "bytes of tokens")?;
        let words = indices.as_chunks::<4>().0.iter().map(|&index| u32::from_le_bytes(index));
        Ok(Value::Tokens(words.map(|index| self.tokens.get(index).unwrap_or_default().to_owned()).collect()))
    }

    fn array(&mut self, value: u64, most: usize) -> Result<Option<Value>, UsdError> {
        let (at, kind) = (value & PAYLOAD, value >> 48 & 0xff);
        let (count, start) = if at == 0 { (0, 0) } else { self.length(at)? };
        let compressed = value & IS_COMPRESSED != 0 && count >= if self.version[1] < 7 { 16 } else { 4 };
        if compressed && count > most as u64 {
            return Err(self.file.at(at, format!("{count} values"), &format!("{most} at most")));
        }
        if compressed {
            return match kind {
                kind::INT => {
                    let ints = self.file.ints(start, count)?.0;
                    Ok(Some(Value::Ints(ints.into_iter().map(|v| v as i32).collect())))
                }
                kind::HALF => self.packed_floats(start, count, Number::Half).map(Some),
                kind::FLOAT => self.packed_floats(start, count, Number::Float).map(Some),
                kind::DOUBLE => self.packed_floats(start, count, Number::Double).map(Some),
                _ => Ok(None),
            };
        }
        let (number, per) = match kind {
            kind::HALF => (Number::Half, 1),
            // Integers have the same size.
            kind::FLOAT | kind::INT => (Number::Float, 1),
            kind::DOUBLE => (Number::Double, 1),
            kind::VEC2H => (Number::Half, 2),
            kind::VEC2F => (Number::Float, 2),
            kind::VEC2D => (Number::Double, 2),
            kind::VEC3H => (Number::Half, 3),
            kind::VEC3F => (Number::Float, 3),
            kind::VEC3D => (Number::Double, 3),
            kind::QUATH => (Number::Half, 4),
            kind::QUATF => (Number::Float, 4),
            kind::QUATD => (Number::Double, 4),
            kind::MATRIX4D => (Number::Double, 16),
            _ => return Ok(None),
        };
        let size = per * number.size();
        let bytes = self.file.bytes(start, count.saturating_mul(size as u64), "bytes of an array")?;
        let items = bytes.chunks_exact(size);
        Ok(Some(if kind == kind::INT {
            Value::Ints(bytes.as_chunks::<4>().0.iter().map(|&four| i32::from_le_bytes(four)).collect())
        } else if per == 1 {
            Value::Floats(items.map(|item| number.of(item) as f32).collect())
        } else if per == 16 {
            let whole = |item: &[u8]| std::array::from_fn(|k| number.of(&item[k * number.size()..]));
            Value::Matrices(items.map(whole).collect())
        } else {
            let part = |item: &[u8], k: usize| number.of(&item[k * number.size()..]) as f32;
            if per == 4 {
                // Quaternions are stored with the real part last.
                let turn = |item: &[u8]| [3, 0, 1, 2].map(|k| part(item, k));
                return Ok(Some(Value::Quaternions(items.map(turn).collect())));
            }
            let third = |item: &[u8]| if per == 2 { 0.0 } else { part(item, 2) };
            Value::Vectors(items.map(|item| Vec3::new(part(item, 0), part(item, 1), third(item))).collect())
        }))
    }

    /// Reads compressed numbers: integers, or indices into a table of few values.
    fn packed_floats(&mut self, at: u64, count: u64, number: Number) -> Result<Value, UsdError> {
        let code = self.file.bytes(at, 1, "byte that says how numbers are compressed")?[0];
        match code {
            b'i' => {
                let ints = self.file.ints(at + 1, count)?.0;
                Ok(Value::Floats(ints.into_iter().map(|v| v as i32 as f32).collect()))
            }
            b't' => {
                let size = self.file.bytes(at + 1, 4, "bytes of a number")?;
                let different = u64::from(u32::from_le_bytes([size[0], size[1], size[2], size[3]]));
                let length = different * number.size() as u64;
                let table = self.file.bytes(at + 5, length, "bytes of a table")?;
                let indices = self.file.ints(at + 5 + length, count)?.0;
                let pick = |index: u32| {
                    table.get(index as usize * number.size()..).map_or(f64::NAN, |b| number.of(b))
                };
                Ok(Value::Floats(indices.into_iter().map(|index| pick(index) as f32).collect()))
            }
            _ => Err(self.file.at(
                at,
                format!("numbers compressed by `{}`", code.escape_ascii()),
                "`i` or `t`",
            )),
        }
    }

    /// The length of an array, and the position of its elements.
    fn length(&mut self, at: u64) -> Result<(u64, u64), UsdError> {
        // Before version 0.5 the number of dimensions came first; it was always one.
        let at = if self.version[1] < 5 { at + 4 } else { at };
        if self.version[1] < 7 {
            let four = self.file.bytes(at, 4, "bytes of a length")?;
            return Ok((u64::from(u32::from_le_bytes([four[0], four[1], four[2], four[3]])), at + 4));
        }
        Ok((self.file.u64(at)?, at + 8))
    }
}
