//! The rows of a PLY file, as text or binary.

use super::header::{Element, Form, Number};
use super::text::Lines;
use crate::io::HairFileError;
use lovelock_base::words::counted;

/// The rows that are not read yet.
pub(super) struct Rows<'a> {
    name: &'a str,
    data: &'a [u8],
    at: usize,
    form: Form,
    lines: Lines<'a>,
}

impl<'a> Rows<'a> {
    pub(super) fn new(name: &'a str, data: &'a [u8], at: usize, form: Form) -> Self {
        Self { name, data, at, form, lines: Lines::new(name, data, at) }
    }

    /// Reads the rows of an element. `take` gets each number with its row and column, and the numbers of lists one after the other.
    pub(super) fn read(
        &mut self,
        element: &Element,
        take: &mut dyn FnMut(u64, usize, f64),
    ) -> Result<(), HairFileError> {
        if element.properties.is_empty() {
            return Ok(());
        }
        if self.form == Form::Ascii {
            return self.lines.read(element, take);
        }
        for row in 0..element.rows {
            for (column, property) in element.properties.iter().enumerate() {
                let Some(length) = property.length else {
                    take(row, column, self.number(property.ty, element)?);
                    continue;
                };
                let start = self.at;
                let length = self.number(length, element)?;
                let room = self.data.len() as f64;
                if !(0.0..=room).contains(&length) {
                    return Err(self.malformed(
                        start,
                        format!("a list of {length} numbers"),
                        "a list that the file has room for",
                    ));
                }
                for _ in 0..length as u64 {
                    take(row, column, self.number(property.ty, element)?);
                }
            }
        }
        Ok(())
    }

    /// What follows the last row: bytes, or lines of a text.
    pub(super) fn left(&self) -> u64 {
        match self.form {
            Form::Ascii => self.lines.clone().count() as u64,
            _ => (self.data.len() - self.at) as u64,
        }
    }

    fn number(&mut self, ty: Number, element: &Element) -> Result<f64, HairFileError> {
        let start = self.at;
        let early = || format!("the end of the file within `{}`", element.name);
        let wanted = || counted(element.rows, "row", "rows");
        let Some(bytes) = self.data.get(self.at..self.at + ty.size()) else {
            return Err(self.malformed(start, early(), &wanted()));
        };
        self.at += bytes.len();
        let mut low_first = [0; 8];
        for (i, byte) in bytes.iter().enumerate() {
            let place = if self.form == Form::BigEndian { bytes.len() - 1 - i } else { i };
            low_first[place] = *byte;
        }
        let [a, b, c, d, ..] = low_first;
        Ok(match ty {
            Number::I8 => f64::from(a.cast_signed()),
            Number::U8 => f64::from(a),
            Number::I16 => f64::from(i16::from_le_bytes([a, b])),
            Number::U16 => f64::from(u16::from_le_bytes([a, b])),
            Number::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Number::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Number::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Number::F64 => f64::from_le_bytes(low_first),
        })
    }

    fn malformed(&self, offset: usize, found: String, wanted: &str) -> HairFileError {
        HairFileError::Malformed {
            name: self.name.to_owned(),
            offset: offset as u64,
            found,
            wanted: wanted.to_owned(),
        }
    }
}
