//! The rows of a PLY file that are written as text.
//!
//! A row is a line, and the numbers of a line are divided before a sign. Some programs write a row over several lines, or all numbers in lines
//! of one length. A line that does not fit the others is refused, because a number that is missing shifts all after it.

use lovelock_base::numbers::{number, numbers_of};
use lovelock_base::words::counted;

use super::header::Element;
use crate::io::HairFileError;
use crate::io::words::start_of;

/// The most lines by which the layout of a table is told.
const LOOKED_AT: u64 = 1024;

/// The lines of a file that are not read yet; those without words do not count.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    name: &'a str,
    rest: &'a [u8],
    /// Number of the last line that was taken, from 1.
    at: u64,
}

/// A line with numbers.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    at: u64,
    bytes: &'a [u8],
}

impl<'a> Line<'a> {
    /// Its words, divided before signs.
    fn words(self) -> impl Iterator<Item = &'a str> {
        let words = self.bytes.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        // What is no text is no number either.
        words.flat_map(|word| numbers_of(std::str::from_utf8(word).unwrap_or("?")))
    }
}

/// How the rows of an element are divided into lines.
#[derive(Clone, Copy, PartialEq)]
enum Layout {
    /// Each row is a line with as many numbers as there are columns.
    Lines,
    /// Each row ends where a line does. Without lists, all rows are divided like the first one.
    Wrapped,
    /// Numbers in lines of this length, but for the last one.
    Filled(usize),
}

impl<'a> Lines<'a> {
    /// The lines from byte `start` of a file on.
    pub(super) fn new(name: &'a str, data: &'a [u8], start: usize) -> Self {
        let ends = (0..start)
            .filter(|&at| data[at] == b'\n' || (data[at] == b'\r' && data.get(at + 1) != Some(&b'\n')));
        Self { name, rest: &data[start..], at: ends.count() as u64 }
    }

    /// Reads the rows of an element, whose numbers `take` gets with their row and column.
    pub(super) fn read(
        &mut self,
        element: &Element,
        take: &mut dyn FnMut(u64, usize, f64),
    ) -> Result<(), HairFileError> {
        let mut table = Table {
            layout: self.layout(element),
            has_lists: has_lists(element),
            line: Line { at: self.at, bytes: &[] },
            lines: self,
            element,
            row: 0,
            numbers: Vec::new(),
            taken: 0,
            read: 0,
            first_row: Vec::new(),
            this_row: Vec::new(),
        };
        for row in 0..element.rows {
            table.row = row;
            for (column, property) in element.properties.iter().enumerate() {
                let value = table.next()?;
                if property.length.is_none() {
                    take(row, column, value);
                    continue;
                }
                for _ in 0..table.length(value)? {
                    take(row, column, table.next()?);
                }
            }
            table.end_row()?;
        }
        Ok(())
    }

    fn layout(&self, element: &Element) -> Layout {
        if has_lists(element) {
            return Layout::Wrapped;
        }
        let columns = element.properties.len();
        let looked_at = self.clone().take(element.rows.min(LOOKED_AT) as usize);
        let counts: Vec<usize> = looked_at.map(|line| line.words().count()).collect();
        if 2 * counts.iter().filter(|&&count| count == columns).count() >= counts.len() {
            return Layout::Lines;
        }
        let mut first_row = 0;
        let ends = counts.iter().any(|count| {
            first_row += count;
            first_row == columns
        });
        if ends { Layout::Wrapped } else { Layout::Filled(counts[0]) }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            let bytes = &self.rest[..end.unwrap_or(self.rest.len())];
            let mut after = &self.rest[end.map_or(self.rest.len(), |end| end + 1)..];
            // Windows ends lines with two characters.
            if end.is_some_and(|end| self.rest[end] == b'\r') {
                after = after.strip_prefix(b"\n").unwrap_or(after);
            }
            self.rest = after;
            self.at += 1;
            if !bytes.trim_ascii().is_empty() {
                return Some(Line { at: self.at, bytes });
            }
        }
        None
    }
}

fn has_lists(element: &Element) -> bool {
    element.properties.iter().any(|property| property.length.is_some())
}

/// An element while its rows are read.
struct Table<'r, 'a> {
    lines: &'r mut Lines<'a>,
    element: &'r Element,
    layout: Layout,
    has_lists: bool,
    row: u64,
    /// The line that is read, its numbers, and how many of them are taken.
    line: Line<'a>,
    numbers: Vec<f64>,
    taken: usize,
    /// Numbers of all lines of the element so far.
    read: u64,
    /// Numbers of the lines of the first row, and of this one.
    first_row: Vec<usize>,
    this_row: Vec<usize>,
}

impl Table<'_, '_> {
    /// The next number.
    fn next(&mut self) -> Result<f64, HairFileError> {
        if self.taken == self.numbers.len() {
            self.next_line()?;
        }
        self.taken += 1;
        Ok(self.numbers[self.taken - 1])
    }

    fn next_line(&mut self) -> Result<(), HairFileError> {
        let Element { rows, name, properties } = self.element;
        let Some(line) = self.lines.next() else {
            let after = counted(self.row, "row", "rows");
            let found = format!("the end of the file after {after} of `{name}`");
            return Err(self.malformed(found, &format!("{rows}, as the header states")));
        };
        self.line = line;
        let left = rows.saturating_mul(properties.len() as u64).saturating_sub(self.read);
        let count = line.words().count();
        let expected = match self.layout {
            Layout::Lines => Some(properties.len()),
            Layout::Wrapped if self.row > 0 && !self.has_lists => {
                self.first_row.get(self.this_row.len()).copied()
            }
            Layout::Filled(length) if count as u64 != left => Some(length),
            Layout::Wrapped | Layout::Filled(_) => None,
        };
        if let Some(expected) = expected.filter(|&expected| expected != count) {
            return Err(self.unfit(count, &format!("{expected}, as in the other rows of `{name}`")));
        }
        self.this_row.push(count);
        self.read += count as u64;
        self.taken = 0;
        self.numbers.clear();
        for word in line.words() {
            let value = number(word).ok_or_else(|| {
                self.malformed(format!("`{}`", word.chars().take(40).collect::<String>()), "a number")
            })?;
            self.numbers.push(value);
        }
        Ok(())
    }

    /// The length of a list.
    fn length(&self, value: f64) -> Result<u64, HairFileError> {
        let room = (self.lines.rest.len() + self.line.bytes.len()) as f64;
        if !(0.0..=room).contains(&value) || value.fract() != 0.0 {
            let wanted = "a list that the file has room for";
            return Err(self.malformed(format!("a list of {value} numbers"), wanted));
        }
        Ok(value as u64)
    }

    fn end_row(&mut self) -> Result<(), HairFileError> {
        let is_last = self.row + 1 == self.element.rows;
        let is_filled = matches!(self.layout, Layout::Filled(_));
        if self.taken < self.numbers.len() && (!is_filled || is_last) {
            let wanted = format!("{}, where the row of `{}` ends", self.taken, self.element.name);
            return Err(self.unfit(self.numbers.len(), &wanted));
        }
        if self.row == 0 {
            self.first_row.clone_from(&self.this_row);
        }
        self.this_row.clear();
        Ok(())
    }

    fn unfit(&self, count: usize, wanted: &str) -> HairFileError {
        let numbers = counted(count, "number", "numbers");
        self.malformed(format!("{numbers} in `{}`", start_of(self.line.bytes)), wanted)
    }

    fn malformed(&self, found: String, wanted: &str) -> HairFileError {
        let (name, line) = (self.lines.name.to_owned(), self.line.at);
        HairFileError::MalformedLine { name, line, found, wanted: wanted.to_owned() }
    }
}
